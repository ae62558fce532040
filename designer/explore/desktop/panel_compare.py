"""The present state beside one that was pinned as A: figures, values, candidates."""

from __future__ import annotations

from operator import attrgetter

from PySide6.QtWidgets import QWidget

from designer.explore.compare import Differences
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.tables import Column, Table
from designer.explore.desktop.widgets import (
    beside,
    button,
    check_box,
    grey_when_old,
    panel,
    result,
)
from designer.report import format as fmt

_COLUMNS = (
    Column("", attrgetter("title"), "Figure, or value of the study."),
    Column("A", lambda r: r.before or "–", "In the pinned state.", is_number=True),
    Column("now", lambda r: r.after or "–", "In the present state.", is_number=True),
    Column("difference", attrgetter("difference_text"), "Now less A.", is_number=True),
)


class PanelCompare(QWidget):
    """What has become otherwise since A was pinned."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        pin = button("pin", "Pin this state as A", live.pin)
        self._release = button("release", "Release A", live.release)
        self.in_map = check_box(
            "difference in the map", "The map shows the difference to A", live.compare_in_map
        )
        self._summary = result("ropes gained and lost")
        self.table = Table("differences", _COLUMNS, (190, 190, 190))
        self.table.rows.hint = lambda r: f"{r.title}: {r.before or '–'} → {r.after or '–'}"
        above = beside(pin, self._release, self.in_map, None)
        panel(self, "compare", above, self._summary, self.table)
        live.answered.connect(self._show_differences)
        live.changed.connect(self._show_differences)
        grey_when_old(live, {"here", "worst", "ropes"}, self._summary, self.table)
        self._show_differences()

    def _show_differences(self) -> None:
        differences = self._live.differences()
        self._release.setEnabled(differences is not None)
        self.in_map.setEnabled(differences is not None)
        if differences is None:
            self.in_map.setChecked(False)
            self._summary.setText("Nothing is pinned: pin a state, go on, and see what changes.")
            self.table.rows.show(())
        else:
            self._summary.setText(_summary(differences))
            self.table.rows.show((*differences.changes, *differences.figures))


def _summary(differences: Differences) -> str:
    parts = []
    for word, ropes in (("gained", differences.gained), ("lost", differences.lost)):
        if ropes:
            first = "; ".join(rope.label for rope in ropes[:3])
            more = f" and {len(ropes) - 3} more" if len(ropes) > 3 else ""
            parts.append(f"{fmt.plural(len(ropes), 'rope')} {word}: {first}{more}.")
    if not differences.is_like_with_like:
        parts.append("The candidates of one state are at the samples, those of the other in full.")
    return " ".join(parts) or "The same ropes hold as in A."
