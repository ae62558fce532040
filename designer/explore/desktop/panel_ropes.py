"""All candidates: which hold, which is best, and why one falls out; and the choice for groups."""

from __future__ import annotations

import math
from operator import attrgetter
from typing import TYPE_CHECKING

from PySide6.QtCore import QModelIndex
from PySide6.QtWidgets import QWidget

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.panel_requirements import answer_words
from designer.explore.desktop.tables import Column, Table, number_column
from designer.explore.desktop.widgets import (
    DropDown,
    beside,
    button,
    check_box,
    grey_when_old,
    panel,
    result,
)
from designer.report import format as fmt
from designer.report.design.sections import proof_statement

if TYPE_CHECKING:
    from designer.explore.question import Rope, RopePerCable
    from designer.explore.ropes import RopeRow, Ropes
    from designer.selection.groups.result import GroupChoice

_ALL_MATERIALS, _ALL_MAKERS = "all materials", "all makers"
_NOTHING = "Nothing yet: ropes are compared over the workspace of the study."


def _scaled(title: str, name: str, scale: float, digits: int, definition: str) -> Column:
    return number_column(title, name, definition, lambda v: fmt.number(scale * v, digits))


_STANDINGS = (
    *("chosen", "undominated", "dominated", "not_comparable"),
    *("rejected", "too_thin", "not_held"),
)


def _rank(row: RopeRow) -> float:
    """What became of it, then its mass; of what does not hold, how far it is from that."""
    known = row.standing in _STANDINGS
    standing = _STANDINGS.index(row.standing) if known else len(_STANDINGS)
    then = row.figures.mass_kg if row.holds else row.verification.utilisation
    return 1e9 * standing + (5e8 if math.isnan(then) else min(then, 1e8))


COLUMNS = (
    Column("rope", attrgetter("size.id"), "Size of the grade.", attrgetter("size.diameter_m")),
    Column("grade", attrgetter("grade.id"), "Grade of the catalogue."),
    Column("maker", attrgetter("grade.manufacturer"), "Who sells it, or its standard."),
    Column("material", lambda row: row.grade.material or "", "What it is made of."),
    _scaled("d [mm]", "size.diameter_m", 1e3, 3, "Nominal diameter."),
    number_column(
        "utilisation",
        "verification.utilisation",
        "Largest tension at any pose of the workspace over the allowable tension; over 100 % it is "
        "too weak.",
        fmt.utilisation,
        share=attrgetter("verification.utilisation"),
    ),
    _scaled("mass [kg]", "figures.mass_kg", 1.0, 4, "All cables at the longest length each needs."),
    _scaled("kg/m", "size.linear_density_kg_per_m", 1.0, 3, "Mass per length."),
    _scaled("MBL [kN]", "size.minimum_breaking_load_N", 1e-3, 4, "Minimum breaking load."),
    _scaled("largest T [kN]", "verification.max_tension_N", 1e-3, 4, "Largest in any cable."),
    _scaled("drum [mm]", "figures.drum_diameter_m", 1e3, 4, "Least diameter of drums and sheaves."),
    _scaled("stiffness [kN/m]", "figures.stiffness_N_per_m", 1e-3, 3, "Least, of the platform."),
    _scaled(
        "cost",
        "figures.cost",
        1.0,
        4,
        "Of all cables; estimated where no grade has a price.",
    ),
    Column(
        "what became of it",
        attrgetter("reason"),
        "Why it is in or out; the best by the objectives of the study first.",
        _rank,
    ),
)
_WIDTHS = (72, 180, 116, 72, 60, 84, 78, 56, 80, 104, 84, 116, 60)


class PanelRopes(QWidget):
    """The table of candidates with its filters."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self._ropes: Ropes | None = None
        self._rope: Rope | RopePerCable | None = None
        self.table = Table("candidates", COLUMNS, _WIDTHS, sorted_by=len(COLUMNS) - 1)
        self.table.rows.bold = lambda row: self._ropes is not None and row.rope == self._ropes.best
        self.table.rows.muted = lambda row: not row.holds
        self.table.rows.hint = attrgetter("reason")
        self.table.selectionModel().currentRowChanged.connect(self._current_changed)
        self.material = DropDown("material", 9, _ALL_MATERIALS)
        self.maker = DropDown("maker", 9, _ALL_MAKERS)
        for choice in (self.material, self.maker):
            choice.currentTextChanged.connect(self._filter)
        self.only_holding = check_box("only what holds", "only what holds", self._filter)
        family = button(
            "no rope",
            "No rope: the family",
            lambda: live.choose(None),
            "Colours the map for the thinnest cable of the configured family at each pose.",
        )
        self.select = button(
            "full selection",
            "Full selection",
            lambda: live.begin_long("select"),
            "Chooses as the report does, between the samples as well, and for groups of cables "
            "where the study has some; then proves that the best holds in all poses, as far as "
            "the study gives it time. Until then the table holds at the samples.",
        )
        self.answer, self.groups = result("best rope"), result("groups")
        self.look_at_groups = button(
            "look at groups",
            "Look at the groups",
            self._choose_groups,
            "Colours the map with each group's own rope.",
        )
        panel(
            self,
            "ropes",
            beside(self.material, self.maker, self.only_holding, None, family, self.select),
            self.answer,
            beside(self.groups, self.look_at_groups),
            self.table,
        )
        live.listen(self._show_ropes, "ropes", "select")
        live.changed.connect(self._follow_rope)
        grey_when_old(live, {"ropes"}, self.answer, self.groups, self.table)

    def _choose_groups(self) -> None:
        if self._ropes is not None:
            self._live.choose(self._ropes.assignment)

    def _follow_rope(self) -> None:
        """Mark the rope that colours the map."""
        if self._live.rope != self._rope:
            self._rope = self._live.rope
            self._mark_current()

    def _show_ropes(self, ropes: Ropes | None) -> None:
        """Show the candidates, and which of them colours the map."""
        self._ropes, self._rope = ropes, self._live.rope
        self.table.rows.show(() if ropes is None else ropes.rows)
        if ropes is not None:
            self.material.refill([_ALL_MATERIALS, *ropes.materials])
            self.maker.refill([_ALL_MAKERS, *ropes.makers])
        self.answer.setText(_NOTHING if ropes is None else _answer(ropes))
        self.answer.setToolTip(self.answer.text())
        groups = None if ropes is None else ropes.groups
        self.groups.setText("" if groups is None else _groups_text(groups))
        self.groups.setVisible(groups is not None)
        self.look_at_groups.setVisible(ropes is not None and ropes.assignment is not None)
        self._mark_current()

    def _mark_current(self) -> None:
        self.table.mark(lambda row: row.rope == self._rope)

    def _current_changed(self, current: QModelIndex, _: QModelIndex) -> None:
        if current.isValid():
            rope = self.table.row_at(current).rope
            if rope != self._rope:
                self._rope = rope
                self._live.choose(rope)

    def _filter(self) -> None:
        materials = (_ALL_MATERIALS, self.material.currentText())
        makers = (_ALL_MAKERS, self.maker.currentText())
        only_holding = self.only_holding.isChecked()
        self.table.narrow(
            lambda row: (
                (materials[0] == materials[1] or row.grade.material == materials[1])
                and (makers[0] == makers[1] or row.grade.manufacturer == makers[1])
                and (row.holds or not only_holding)
            )
        )
        self._mark_current()


def _answer(ropes: Ropes) -> str:
    """The best rope, and how far to trust it."""
    lines = [] if ropes.answer is None else [answer_words(ropes)]
    if ropes.best is None:
        return "\n".join([*lines, fmt.capital(ropes.reason) or _NOTHING])
    sure = "between the samples as well" if ropes.is_final else "at the samples, not proved"
    lines.append(f"Best: {ropes.best.label} ({sure})")
    if ropes.proof is not None:
        proof = proof_statement(ropes.proof)
        lines.append(f"{proof.title}. {proof.text}")
    return "\n".join(lines)


def _groups_text(choice: GroupChoice) -> str:
    """Which rope each group gets, and how sure that is."""
    chosen, proof = choice.chosen, choice.proof_sentence
    if not chosen.is_found:
        return f"Groups: none was found. {proof}"
    each = zip(chosen.groups, chosen.ropes, chosen.verification.utilisation, strict=True)
    words = "; ".join(
        f"{group.name}: {rope.label} ({fmt.utilisation(used)})" for group, rope, used in each
    )
    masses = f"{fmt.kilograms(chosen.total_mass_kg)}, one rope for all "
    masses += fmt.kilograms(choice.single.total_mass_kg)
    return f"Groups: {words}. All cables {masses}. {proof}"
