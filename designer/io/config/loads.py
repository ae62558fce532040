"""What load cases of a config are made of: drag, wind, ice, and a lost cable."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from designer.documents import fields
from designer.documents.fields import WholeNumber, only_word
from designer.documents.section import Section
from designer.io.config.orientation import only_one_of

MOST_CABLES = 64

LostCable = Annotated[
    Annotated[Literal["each"], only_word("each", "'each' or the number of a cable"), Tag("a word")]
    | Annotated[int, WholeNumber(1, MOST_CABLES), Tag("a number")],
    Discriminator(lambda given: "a word" if isinstance(given, str) else "a number"),
]

Directions = Annotated[
    Annotated[Literal["all"], only_word("all", "'all' or a number of directions"), Tag("a word")]
    | Annotated[int, WholeNumber(1, 72), Tag("a number")],
    Discriminator(lambda given: "a word" if isinstance(given, str) else "a number"),
]


class DragSection(Section):
    """What the wind finds of the platform."""

    area: fields.DragArea = Field(description="an area such as '1.2 m^2'")
    coefficient: fields.DragCoefficient = Field(description="a drag coefficient such as 1.1")


class WindSection(Section):
    """Wind of one speed, from the worst horizontal direction, from so many or along one."""

    speed: fields.Speed = Field(description="a speed such as '20 m/s'")
    directions: Directions | None = None
    direction: fields.Direction | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_kind_of_direction(cls, value: object) -> object:
        return only_one_of(value, ("directions", "direction"), "the wind")


class IceSection(Section):
    """Ice around the cables."""

    thickness: fields.IceThickness = Field(description="a length such as '10 mm'")
    density: fields.Density = 900.0
