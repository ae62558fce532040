"""A state that is kept as A, and what has become otherwise since."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from designer.explore.fields import Field
from designer.explore.here import Here
from designer.explore.map import WorstAnswer
from designer.explore.question import Question, Rope, RopePerCable
from designer.explore.ropes import Ropes


@dataclass(frozen=True, slots=True, eq=False)
class Pin:
    """A state with what was known of it; None for what was not yet."""

    question: Question
    fields: tuple[Field, ...]
    here: Here | None = None
    worst: WorstAnswer | None = None
    ropes: Ropes | None = None


@dataclass(frozen=True, slots=True)
class FigureDifference:
    """A figure in both states [SI], NaN where there is none."""

    title: str
    unit: str
    scale: float  # From SI to the unit
    before: float
    after: float

    @property
    def difference(self) -> float:
        """What it has become less what it was [SI]."""
        return self.after - self.before


@dataclass(frozen=True, slots=True)
class Change:
    """What reads otherwise in the two states; empty for what is not there."""

    title: str
    before: str
    after: str


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """What has become otherwise.

    Parameters
    ----------
    changes : tuple of Change
        Values of the study, the rope that is looked at, the verdict, the best rope.
    lines : tuple of FigureDifference
        Figures of the answer.
    utilisation : mapping of Rope to FigureDifference
        Of every rope in both states.
    gained, lost : tuple of Rope
        Ropes that hold now and did not, and the other way round.
    is_like_with_like : bool
        Whether the ropes of both were found in the same way; else a part of the differences is that
        one is the full selection, and the other what some samples tell.
    """

    changes: tuple[Change, ...]
    lines: tuple[FigureDifference, ...]
    utilisation: dict[Rope, FigureDifference]
    gained: tuple[Rope, ...]
    lost: tuple[Rope, ...]
    is_like_with_like: bool


def compare(before: Pin, after: Pin) -> Differences:
    """Return what has become otherwise; what is not known of one of the states is left out."""
    was = {row.rope: row for row in before.ropes.rows} if before.ropes else {}
    now = {row.rope: row for row in after.ropes.rows} if after.ropes else {}
    both = [rope for rope in now if rope in was]
    finals = {pin.ropes.is_final for pin in (before, after) if pin.ropes}
    return Differences(
        changes=tuple(_changes(before, after)),
        lines=tuple(_lines(before, after)),
        utilisation={
            rope: FigureDifference(
                rope.label, "%", 100.0, was[rope].utilisation, now[rope].utilisation
            )
            for rope in both
        },
        gained=tuple(rope for rope in both if now[rope].holds and not was[rope].holds),
        lost=tuple(rope for rope in both if was[rope].holds and not now[rope].holds),
        is_like_with_like=len(finals) < 2,
    )


def _changes(before: Pin, after: Pin) -> Iterator[Change]:
    was, now = ({one.path: one for one in pin.fields} for pin in (before, after))
    for path in dict.fromkeys([*was, *now]):
        old, new = was.get(path), now.get(path)
        if (old and old.meaning) != (new and new.meaning):
            title = (new or old).label  # type: ignore[union-attr]
            yield Change(title, old.text if old else "", new.text if new else "")
    words = {
        "Rope": [_label(pin.question.rope) for pin in (before, after)],
        "Verdict": [pin.here.sentence if pin.here else "" for pin in (before, after)],
        "Best rope": [_label(pin.ropes.best if pin.ropes else None) for pin in (before, after)],
    }
    for title, (old_text, new_text) in words.items():
        if old_text != new_text:
            yield Change(title, old_text, new_text)


def _label(rope: Rope | RopePerCable | None) -> str:
    return "" if rope is None else rope.label


def _lines(before: Pin, after: Pin) -> Iterator[FigureDifference]:
    if before.here and after.here:
        a, b = before.here, after.here
        yield FigureDifference("Diameter needed here", "mm", 1e3, a.diameter_m, b.diameter_m)
        yield FigureDifference("Largest tension here", "kN", 1e-3, a.max_tension_N, b.max_tension_N)
        yield FigureDifference("Utilisation here", "%", 100.0, a.utilisation, b.utilisation)
        yield FigureDifference(
            "Stiffness here", "kN/m", 1e-3, a.stiffness_N_per_m, b.stiffness_N_per_m
        )
    if before.worst and after.worst:
        was, now = before.worst, after.worst
        if was.workspace.sagging and now.workspace.sagging:
            d = was.workspace.sagging.diameter_m, now.workspace.sagging.diameter_m
            yield FigureDifference("Diameter needed at worst", "mm", 1e3, *d)
        if was.rope and now.rope:
            yield FigureDifference(
                "Utilisation at worst", "%", 100.0, was.rope.utilisation, now.rope.utilisation
            )
    best = [pin.ropes.row(pin.ropes.best) if pin.ropes else None for pin in (before, after)]
    if best[0] and best[1]:
        masses = best[0].total_mass_kg, best[1].total_mass_kg
        yield FigureDifference("Mass of all cables, best rope", "kg", 1.0, *masses)
