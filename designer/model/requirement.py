"""What a study asks for, whether it holds, and the answer that follows from all of it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import ClassVar

from designer.arrays import FloatArray
from designer.model.load_case import Loaded
from designer.model.space import named_place
from designer.spelling import digits


class State(StrEnum):
    """Whether a requirement holds; ``OPEN`` where neither that nor the opposite is known."""

    HOLDS = "holds"
    FAILS = "fails"
    OPEN = "open"


class Answer(StrEnum):
    """The answer to a study: yes if all requirements hold, no if one fails, else open."""

    YES = "yes"
    NO = "no"
    OPEN = "open"


@dataclass(frozen=True, slots=True, eq=False)
class Requirement:
    """One thing that a study asks for, in one load case, where it comes nearest to failing.

    Parameters
    ----------
    id : str
        Its name in result files.
    title, formula, source : str
        What is required, how it is evaluated, and by which clause or field of the study.
    state : State
        Whether it holds.
    load_case : str
        In which load case; ``all`` for what no load case changes.
    demand, capacity : float
        What is required, and what there is [unit]; NaN where there is no such figure.
    unit : str
        SI; empty for a ratio.
    utilisation : float
        Up to 1 where it holds; NaN where the two figures make no ratio.
    cable : int or None
        The cable, from 1.
    place : array (n_coordinates,) or None
        Where the platform is, see `designer.model.space` [m, rad].
    loaded : Loaded or None
        Robot and cable under the load case, in its direction of wind and inertia force.
    remark : str
        What the reader must know beside the figures; empty for nothing.
    """

    id: str
    title: str = field(metadata={"json": None})
    formula: str
    source: str
    state: State
    load_case: str
    demand: float = math.nan
    capacity: float = math.nan
    unit: str = ""
    utilisation: float = math.nan
    cable: int | None = None
    place: FloatArray | None = field(default=None, metadata={"json": named_place})
    loaded: Loaded | None = field(
        default=None,
        metadata={"json": lambda loaded: {"direction": (loaded and loaded.words) or None}},
    )
    remark: str = ""

    also_in_files: ClassVar = ("holds",)

    @property
    def holds(self) -> bool:
        """Whether it is known to hold."""
        return self.state is State.HOLDS

    @property
    def direction(self) -> str:
        """Direction of wind and inertia force, or the lost cable, in words; empty for none."""
        return "" if self.loaded is None else self.loaded.words

    @property
    def words(self) -> str:
        """State and figures in a line, such as ``fails: demand 28, capacity 25.2``."""
        figures = [
            f"{name} {digits(value)} {self.unit}".rstrip()
            for name, value in (("demand", self.demand), ("capacity", self.capacity))
            if math.isfinite(value)
        ]
        said = ", ".join(filter(None, [*figures, self.remark]))
        return f"{self.state.value}: {said}" if said else self.state.value


def answer_of(requirements: Iterable[Requirement]) -> Answer:
    """Return what follows from all requirements: a failing one decides, then an open one."""
    states = {requirement.state for requirement in requirements}
    if State.FAILS in states:
        return Answer.NO
    return Answer.OPEN if State.OPEN in states else Answer.YES
