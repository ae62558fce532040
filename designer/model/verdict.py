"""What became of a pose, what a study asks for, and the answer that follows from all of it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum
from typing import ClassVar, Self

import numpy as np

from designer.arrays import BoolArray, FloatArray, VerdictArray
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
    """One thing that a study asks for, in one load case, where it comes nearest to failing."""

    id: str  #: Its name in result files
    #: What is required, how it is evaluated, and by which clause or field of the study
    title: str = field(metadata={"json": None})
    formula: str
    source: str
    state: State  #: Whether it holds
    load_case: str  #: In which load case; ``all`` for what no load case changes
    #: What is required, and what there is [unit]; NaN where there is no such figure
    demand: float = math.nan
    capacity: float = math.nan
    unit: str = ""  #: SI; empty for a ratio
    #: Up to 1 where it holds; NaN where the two figures make no ratio
    utilisation: float = math.nan
    cable: int | None = None  #: The cable, from 1
    #: (n_coordinates,): Where the platform is, see `designer.model.space` [m, rad]
    place: FloatArray | None = field(default=None, metadata={"json": named_place})
    #: Robot and cable under the load case, in its direction of wind and inertia force
    loaded: Loaded | None = field(
        default=None,
        metadata={"json": lambda loaded: {"direction": (loaded and loaded.words) or None}},
    )
    remark: str = ""  #: What the reader must know beside the figures; empty for nothing

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


class Verdict(IntEnum):
    """Outcome of solving one pose; every pose has exactly one.

    Each has a code; whether the pose is held, and ``OPEN`` where the verdict proves nothing and
    another way may still find a solution; its colour among those of `designer.report.figures` and
    its hatch in charts; and its reason in two or three words and in a clause.
    """

    state: State
    colour: str
    hatch: str
    reason: str
    clause: str

    def __new__(
        cls,
        code: int,
        state: State = State.OPEN,
        look: tuple[str, str] = ("INK", ""),
        reason: str = "",
        clause: str = "",
    ) -> Self:
        """Return the member of this code with its properties."""
        verdict = int.__new__(cls, code)
        verdict._value_ = code
        verdict.state, (verdict.colour, verdict.hatch) = state, look
        verdict.reason, verdict.clause = reason, clause
        return verdict

    SOLVED = (
        0,
        State.HOLDS,
        ("SAG", ""),
        "solved",
        "the cables hold the platform; both residuals are within tolerance",
    )
    OUTSIDE_HULL = (
        1,
        State.FAILS,
        ("WARNING", ""),
        "no taut cables hold it",
        "no tensions of taut cables hold the platform, which is proved",
    )
    NO_FINITE_CABLE = (
        2,
        State.FAILS,
        ("WARNING_PALE", "//////"),
        "no finite cable",
        "no section of the family, however thick, holds the platform within its allowable stress, "
        "which is proved",
    )
    NOT_CONVERGED = (
        3,
        State.OPEN,
        ("INK", ""),
        "not converged",
        "the solver found no solution and no proof that there is none",
    )
    RANK_DEFICIENT = (
        4,
        State.FAILS,
        ("LEFT_OUT", ""),
        "rank deficient",
        "no cables were found that hold the platform; straight ones leave some force or moment, "
        "if not the present load, that no tensions can take up",
    )
    NOT_FOUND = (
        5,
        State.OPEN,
        ("WARNING_PALE", "......"),
        "none found",
        "straight cables cannot hold the platform; sagging ones might, but none were found",
    )
    NO_LENGTH = (
        6,
        State.FAILS,
        ("LEFT_OUT", "xxxxxx"),
        "a cable of no length",
        "a cable has no length: its attachment is at its exit point, or within its pulley",
    )

    @property
    def is_proved(self) -> bool:
        """Whether it is certain: the pose is solved, or shown to be impossible."""
        return self.state is not State.OPEN

    @property
    def questions_all_ropes(self) -> bool:
        """Whether it may be that no rope whatever holds the pose, sized or of the catalogue."""
        return self in (Verdict.OUTSIDE_HULL, Verdict.RANK_DEFICIENT, Verdict.NOT_FOUND)

    @property
    def label(self) -> str:
        """The name used in result files, such as ``no_finite_cable``."""
        return self.name.lower()

    @property
    def sentence(self) -> str:
        """One sentence for the reader of a report."""
        return f"{self.clause[0].upper()}{self.clause[1:]}."


_IS_OPEN = np.array([not verdict.is_proved for verdict in Verdict])


def are_open(verdicts: VerdictArray) -> BoolArray:
    """Tell which verdicts (...) prove nothing."""
    return _IS_OPEN[verdicts]


def hanging_cables(force_z_N: FloatArray, drop_m: FloatArray) -> BoolArray:
    """Tell which cables (..., n_cables) come from above and are lowest below the platform end.

    Where the platform holds the cable up, force above zero, and the drop to it is positive. A cable
    that comes from below pulls the platform down by design and does not count.
    """
    return np.asarray((force_z_N > 0.0) & (drop_m >= 0.0))
