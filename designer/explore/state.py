"""What a step may change."""

from __future__ import annotations

from dataclasses import dataclass

from designer.arrays import FloatArray
from designer.errors import Fault
from designer.explore.question import Assignment, Rope
from designer.explore.reading import Reading


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """All that a step may change.

    Parameters
    ----------
    reading : Reading
        The text, and what it is.
    live : Reading
        The same, or, where the text is faulty, what was sound last; where nothing ever was, the
        text.
    place : array (6,)
        Where the platform is, and its rotation vector [m, rad].
    rope : Rope, Assignment or None
        The rope, or the ropes of groups, that are looked at.
    pin : object
        What the present state is compared with; None for nothing.
    """

    reading: Reading
    live: Reading
    place: FloatArray
    rope: Rope | Assignment | None = None
    pin: object = None


@dataclass(frozen=True, slots=True)
class Rejected:
    """An entry that was refused: what was typed, and why."""

    text: str
    faults: tuple[Fault, ...]
