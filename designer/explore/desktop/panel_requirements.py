"""All that the study asks for, whether it holds, and the answer; as in the report."""

from __future__ import annotations

import math
from operator import attrgetter
from typing import TYPE_CHECKING

from PySide6.QtCore import QModelIndex
from PySide6.QtWidgets import QWidget

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.tables import Column, Table, number_column
from designer.explore.desktop.widgets import (
    beside,
    button,
    grey_when_old,
    panel,
    restyle,
    result,
)
from designer.model.verdict import Answer, Requirement, State
from designer.report import format as fmt
from designer.report.phrases import STATES, with_unit

if TYPE_CHECKING:
    from designer.explore.ropes import Ropes

_NOTHING = "Not known yet: the full selection evaluates all that the study asks for."
_UNMET_FIRST = (State.FAILS, State.OPEN, State.HOLDS)
_ROLES = {Answer.YES: "good", Answer.NO: "fault", Answer.OPEN: "doubt"}


def _rank(requirement: Requirement) -> float:
    """What fails first, then what is not known; of each the nearest to its limit first."""
    used = requirement.utilisation
    nearest = 0.0 if math.isnan(used) else 1.0 - 1.0 / (1.0 + max(used, 0.0))
    return _UNMET_FIRST.index(requirement.state) - 0.9 * nearest


def _used(utilisation: float) -> str:
    return fmt.MISSING if math.isnan(utilisation) else fmt.utilisation(utilisation)


def _place_words(requirement: Requirement) -> str:
    place = "" if requirement.place is None else fmt.position(requirement.place[:3])
    return ", ".join(filter(None, [place, fmt.printed(requirement.direction)]))


COLUMNS = (
    Column("state", lambda r: STATES[r.state], "Whether it holds; what does not, first.", _rank),
    Column("requirement", attrgetter("title"), "What the study asks for."),
    Column("load case", attrgetter("load_case"),
           "The load case; 'all' for what no load case changes."),
    Column("demand", lambda r: with_unit(r.demand, r.unit),
           "What is required, where it comes nearest to failing.", attrgetter("demand"), True),
    Column("capacity", lambda r: with_unit(r.capacity, r.unit), "What there is.",
           attrgetter("capacity"), True),
    number_column("utilisation", "utilisation", "Up to 100 % where it holds.", _used,
                  attrgetter("utilisation")),
    number_column("cable", "cable", "The cable that comes nearest to failing.", str),
    Column("where", _place_words,
           "Where the platform is; a click takes it there. Then the direction of wind and inertia, "
           "or the lost cable."),
    Column("what it is", lambda r: fmt.capital(r.remark or r.formula),
           "What must be known beside the figures; else how it is evaluated.",
           attrgetter("formula")),
)  # fmt: skip
_WIDTHS = (104, 150, 120, 90, 90, 84, 48, 220)


class PanelRequirements(QWidget):
    """The answer, and the table of what it follows from."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.table = Table("all requirements", COLUMNS, _WIDTHS, sorted_by=0)
        self.table.rows.bold = lambda requirement: not requirement.holds
        self.table.rows.hint = _hint
        self.table.clicked.connect(self._go)
        self.table.activated.connect(self._go)
        self.answer = result("answer")
        self.answer.setText(_NOTHING)
        self.evaluate = button(
            "evaluate all",
            "Full selection",
            lambda: live.begin_long("select"),
            "Evaluates all that the study asks for, as in the report.",
        )
        panel(self, "requirements", beside(self.answer, self.evaluate), self.table)
        live.listen(self._show_requirements, "select", "requirements")
        grey_when_old(live, {"select"}, self.answer, self.table)

    def _show_requirements(self, ropes: Ropes | None) -> None:
        """Show what a full selection has evaluated; that nothing is known for None."""
        self.table.rows.show(() if ropes is None else ropes.requirements)
        answer = None if ropes is None else ropes.answer
        self.answer.setText(_NOTHING if ropes is None else answer_words(ropes))
        role = "muted" if answer is None else _ROLES[answer]
        is_subject = ropes is not None and ropes.terms is not None and ropes.terms.subject_to
        restyle(self.answer, "role", "doubt" if is_subject else role)

    def _go(self, index: QModelIndex) -> None:
        place = self.table.row_at(index).place
        if place is not None:
            self._live.move(place)


def answer_words(ropes: Ropes) -> str:
    """Return the answer to the study with how many requirements it follows from."""
    count = fmt.plural(len(ropes.requirements), "requirement")
    if ropes.answer is Answer.YES and ropes.terms is not None:
        terms = ropes.terms
        reasons = (condition.sentences for condition in terms.subject_to)
        head = f"{terms.head(ropes.answer)}: {count}, all met."
        return " ".join([head, *reasons, terms.omissions(ropes.answer)]).rstrip()
    n_failing, n_open = (
        sum(requirement.state is state for requirement in ropes.requirements)
        for state in (State.FAILS, State.OPEN)
    )
    unknown = f"{n_open} not known"
    if ropes.answer is Answer.OPEN:
        return f"Open: of {count} {unknown}, the others met."
    return f"No: of {count} {n_failing} not met{f', {unknown}' if n_open else ''}."


def _hint(requirement: Requirement) -> str:
    said = f"{fmt.capital(requirement.formula)} ({requirement.source})."
    return " ".join(filter(None, [said, fmt.capital(requirement.remark)]))
