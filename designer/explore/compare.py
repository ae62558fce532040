"""A state that is kept as A, and what has become otherwise since."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from designer.explore.fields import Field
from designer.explore.here import Here
from designer.explore.map import WorstAnswer
from designer.explore.question import Question, Rope, RopePerCable
from designer.explore.ropes import RopeRow, Ropes
from designer.report import format as fmt


@dataclass(frozen=True, slots=True, eq=False)
class Pin:
    """A state with what was known of it; None for what was not yet."""

    question: Question
    fields: tuple[Field, ...]
    here: Here | None = None
    worst: WorstAnswer | None = None
    ropes: Ropes | None = None

    @property
    def best(self) -> RopeRow | None:
        """The best rope."""
        return None if self.ropes is None else self.ropes.row(self.ropes.best)


@dataclass(frozen=True, slots=True)
class Change:
    """What reads otherwise in the two states, empty for what is not there.

    ``difference`` is what the figure has become less what it was, in its unit, NaN where it is not
    known; None of all that is no figure.
    """

    title: str
    before: str
    after: str
    difference: float | None = None
    unit: str = ""

    @property
    def difference_text(self) -> str:
        """The difference with its sign."""
        if self.difference is None or math.isnan(self.difference):
            return "" if self.difference is None else fmt.MISSING
        text = fmt.number(self.difference, 3)
        has_sign = text.startswith("−") or self.difference == 0.0
        return f"{'' if has_sign else '+'}{text} {self.unit}"


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """What has become otherwise.

    Parameters
    ----------
    changes : tuple of Change
        Values of the study, the rope that is looked at, the verdict, the best rope.
    figures : tuple of Change
        Figures of the answer, those that are the same among them.
    gained, lost : tuple of Rope
        Ropes that hold now and did not, and the other way round.
    is_like_with_like : bool
        Whether the ropes of both were found in the same way; else a part of the differences is that
        one is the full selection, and the other what some samples tell.
    """

    changes: tuple[Change, ...]
    figures: tuple[Change, ...]
    gained: tuple[Rope, ...]
    lost: tuple[Rope, ...]
    is_like_with_like: bool


def _needed_at_worst_m(pin: Pin) -> float | None:
    sizing = None if pin.worst is None else pin.worst.workspace.sagging
    return None if sizing is None else sizing.diameter_m


def _used_at_worst(pin: Pin) -> float | None:
    rope = None if pin.worst is None else pin.worst.rope
    return None if rope is None else rope.utilisation


_FIGURES: tuple[tuple[str, str, float, Callable[[Pin], float | None]], ...] = (
    ("Diameter needed here", "mm", 1e3, lambda p: p.here.diameter_m if p.here else None),
    ("Largest tension here", "kN", 1e-3, lambda p: p.here.max_tension_N if p.here else None),
    ("Utilisation here", "%", 100.0, lambda p: p.here.utilisation if p.here else None),
    ("Stiffness here", "kN/m", 1e-3, lambda p: p.here.stiffness_N_per_m if p.here else None),
    ("Diameter needed at worst", "mm", 1e3, _needed_at_worst_m),
    ("Utilisation at worst", "%", 100.0, _used_at_worst),
    (
        "Mass of all cables, best rope",
        "kg",
        1.0,
        lambda p: p.best.figures.mass_kg if p.best else None,
    ),
)
"""Title, unit, what leads to it from SI, and the figure of a state; None where it is not known."""


def compare(before: Pin, after: Pin) -> Differences:
    """Return what has become otherwise; what is not known of one of the states is left out."""
    held, holds = (
        {row.rope: row.holds for row in pin.ropes.rows} if pin.ropes else {}
        for pin in (before, after)
    )
    both = [rope for rope in holds if rope in held]
    finals = {pin.ropes.is_final for pin in (before, after) if pin.ropes}
    return Differences(
        changes=tuple(_changes(before, after)),
        figures=tuple(_figures(before, after)),
        gained=tuple(rope for rope in both if holds[rope] and not held[rope]),
        lost=tuple(rope for rope in both if held[rope] and not holds[rope]),
        is_like_with_like=len(finals) < 2,
    )


def _changes(before: Pin, after: Pin) -> Iterator[Change]:
    was, now = ({field.path: field for field in pin.fields} for pin in (before, after))
    for path in dict.fromkeys([*was, *now]):
        old, new = was.get(path), now.get(path)
        if (old and old.meaning) != (new and new.meaning):
            title = (new or old).label  # type: ignore[union-attr]
            yield Change(title, old.text if old else "", new.text if new else "")
    words = {
        "Rope": [_label(pin.question.rope) for pin in (before, after)],
        "Verdict": [pin.here.sentence if pin.here else "" for pin in (before, after)],
        "Best rope": [_label(pin.best.rope if pin.best else None) for pin in (before, after)],
    }
    for title, (old_text, new_text) in words.items():
        if old_text != new_text:
            yield Change(title, old_text, new_text)


def _label(rope: Rope | RopePerCable | None) -> str:
    return "" if rope is None else rope.label


def _figures(before: Pin, after: Pin) -> Iterator[Change]:
    for title, unit, scale, figure in _FIGURES:
        was, now = figure(before), figure(after)
        if was is not None and now is not None:
            texts = [
                fmt.MISSING if math.isnan(value) else f"{fmt.number(scale * value, 4)} {unit}"
                for value in (was, now)
            ]
            yield Change(title, texts[0], texts[1], scale * (now - was), unit)
