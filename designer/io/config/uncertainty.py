"""How surely the inputs are known, as a config has it: a distribution for each."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Discriminator, Tag, model_validator

from designer.documents.fields import WholeNumber, bounded, list_of, refusal
from designer.documents.section import Section, config_field
from designer.model.uncertainty import INPUTS, Normal, Spread, Uncertainty, Uniform
from designer.units import describe

_ENDS = "a half width or [lowest, highest]"


def _rising(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] >= ends[1]:
        raise refusal(f"the lower end {ends[0]:g} is not below the upper {ends[1]:g}", _ENDS)
    return ends


def _tag(value: object) -> str:
    return "ends" if isinstance(value, list | tuple) else "a half width"


Ends = Annotated[
    tuple[Annotated[float, bounded("deviation")], Annotated[float, bounded("deviation")]],
    list_of(2, 2, _ENDS),
    AfterValidator(_rising),
]
EndsOfPoint = Annotated[
    tuple[Annotated[float, bounded("shift")], Annotated[float, bounded("shift")]],
    list_of(2, 2, _ENDS),
    AfterValidator(_rising),
]
Width = Annotated[
    Annotated[float, bounded("half width"), Tag("a half width")] | Annotated[Ends, Tag("ends")],
    Discriminator(_tag),
]
WidthOfPoint = Annotated[
    Annotated[float, bounded("scatter of points"), Tag("a half width")]
    | Annotated[EndsOfPoint, Tag("ends")],
    Discriminator(_tag),
]


class SpreadSection(Section):
    """The distribution of a relative deviation."""

    example: ClassVar = "2 %"
    standard_deviation: Annotated[float, bounded("relative scatter")] | None = config_field(
        "Scatter of the {title}"
    )
    """Standard deviation, of a normal distribution, relative. {meaning}"""
    uniform: Width | None = config_field("Range of the {title}")
    """Half width of a uniform distribution, relative, or its two ends. {meaning}"""

    @model_validator(mode="before")
    @classmethod
    def _is_one_distribution(cls, given: object) -> object:
        expected = f"{{standard_deviation: {cls.example}}} for a normal distribution, or "
        expected += f"{{uniform: {cls.example}}}"
        if not isinstance(given, dict):
            raise refusal(f"{describe(given)} is not a distribution", expected)
        unknown = [name for name in given if name not in cls.model_fields]
        if unknown:
            raise refusal(f"the distribution {describe(unknown[0])} is not known", expected)
        count = sum(value is not None for value in given.values())
        if count != 1:
            raise refusal(f"names {'two distributions' if count else 'no distribution'}", expected)
        return given

    def value(self) -> Spread:
        """Return the distribution."""
        if self.standard_deviation is not None:
            return Normal(self.standard_deviation)
        assert self.uniform is not None  # see above
        if isinstance(self.uniform, tuple):
            return Uniform(*self.uniform)
        return Uniform(-self.uniform, self.uniform)


class PointSpreadSection(SpreadSection):
    """The distribution of each coordinate of each exit point."""

    example: ClassVar = "20 mm"
    standard_deviation: Annotated[float, bounded("scatter of points")] | None = config_field(
        "Scatter of the {title}"
    )
    """Standard deviation, of a normal distribution. {meaning}"""
    uniform: WidthOfPoint | None = config_field("Range of the {title}")
    """Half width of a uniform distribution, or its two ends. {meaning}"""


class UncertaintySection(Section):
    """How surely the inputs are known; what is left out is taken for certain.

    But a modulus that is left out is drawn from what the rope's grade states of it.
    """

    payload: SpreadSection | None = None
    """Of weight, inertia and constant loads of the platform."""
    modulus: SpreadSection | None = None
    """Of the rope's modulus; left out, what its grade states."""
    linear_mass: SpreadSection | None = config_field("Rope's mass")
    """Of the rope's mass per length, on all cables alike."""
    breaking_load: SpreadSection | None = None
    """Of the rope's breaking load, on all cables alike."""
    exit_points: PointSpreadSection | None = None
    """Of each coordinate of each exit point, for itself."""
    samples: Annotated[int, WholeNumber(100, 1_000_000)] = config_field("Draws", 4096)
    """How often the inputs are drawn."""
    seed: Annotated[int, WholeNumber(0, 2**32 - 1)] = config_field("Seed of the draws", 0)
    """Of the random numbers; other seeds, other draws."""

    def value(self) -> Uncertainty:
        """Return how surely the inputs are known."""
        payload, modulus, linear_mass, breaking_load, exit_points = (
            None if section is None else section.value()
            for section in (getattr(self, name) for name in INPUTS)
        )
        return Uncertainty(
            payload, modulus, linear_mass, breaking_load, exit_points, self.samples, self.seed
        )
