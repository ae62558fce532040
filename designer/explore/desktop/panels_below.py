"""Panels below the scene: requirements, ropes, the comparison with A, and measured data."""

from __future__ import annotations

import math
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QModelIndex, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from designer.arrays import FloatArray
from designer.explore.answers import Differences
from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.widgets import (
    Column,
    DropDown,
    Table,
    button,
    check_box,
    current_theme,
    fill,
    grey_when_old,
    number_column,
    panel,
    restyle,
    result,
    row_of,
)
from designer.model.verdict import Answer, Requirement, State
from designer.report import format as fmt
from designer.report.design.sections import proof_statement
from designer.report.figures.parts import ticks_between
from designer.report.phrases import STATES, with_unit

if TYPE_CHECKING:
    from designer.explore.answers import RopeRow, Ropes
    from designer.explore.measurements import DiagnosisAnswer, Residuals
    from designer.explore.question import Rope, RopePerCable
    from designer.selection.groups import GroupChoice

_NOT_EVALUATED = "Not evaluated yet: the full selection evaluates all requirements of the study."
_UNMET_FIRST = (State.FAILS, State.OPEN, State.HOLDS)
_ROLES = {Answer.YES: "good", Answer.NO: "fault", Answer.OPEN: "doubt"}


def _requirement_rank(requirement: Requirement) -> float:
    """What fails first, then what is not known; of each the nearest to its limit first."""
    used = requirement.utilisation
    nearest = 0.0 if math.isnan(used) else 1.0 - 1.0 / (1.0 + max(used, 0.0))
    return _UNMET_FIRST.index(requirement.state) - 0.9 * nearest


REQUIREMENT_COLUMNS = (
    Column("state", lambda r: STATES[r.state], "Whether it holds; what does not, first.",
           _requirement_rank),
    Column("requirement", attrgetter("title"), "Title of the requirement."),
    Column("load case", attrgetter("load_case"),
           "The load case; 'all' for what no load case changes."),
    Column("demand", lambda r: with_unit(r.demand, r.unit),
           "What is required, where it comes nearest to failing.", attrgetter("demand"), True),
    Column("capacity", lambda r: with_unit(r.capacity, r.unit), "What there is.",
           attrgetter("capacity"), True),
    number_column("utilisation", "utilisation", "Up to 100 % where it holds.",
                  lambda v: fmt.MISSING if math.isnan(v) else fmt.utilisation(v),
                  attrgetter("utilisation")),
    number_column("cable", "cable", "The cable that comes nearest to failing.", str),
    Column("where", lambda r: ", ".join(filter(None, [
               "" if r.place is None else fmt.position(r.place[:3]), fmt.printed(r.direction)])),
           "Where the platform is; a click takes it there. Then the direction of wind and inertia, "
           "or the lost cable."),
    Column("remark or formula", lambda r: fmt.capital(r.remark or r.formula),
           "What must be known beside the figures; else how it is evaluated.",
           attrgetter("formula")),
)  # fmt: skip
_REQUIREMENT_WIDTHS = (104, 150, 120, 90, 90, 84, 48, 220)


class PanelRequirements(QWidget):
    """The answer, and the table of what it follows from."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.table = Table(
            "all requirements", REQUIREMENT_COLUMNS, _REQUIREMENT_WIDTHS, sorted_by=0
        )
        self.table.rows.bold = lambda requirement: not requirement.holds
        self.table.rows.hint = lambda r: (
            f"{fmt.capital(r.formula)} ({r.source}). {fmt.capital(r.remark)}".strip()
        )
        self.table.clicked.connect(self._go)
        self.table.activated.connect(self._go)
        self.answer = result("answer")
        self.answer.setText(_NOT_EVALUATED)
        tip = "Evaluates all requirements, as in the report."
        self.evaluate = button(
            "evaluate all", "Full selection", lambda: live.begin_long("select"), tip
        )
        above = row_of(self.answer, self.evaluate)
        above.setStretch(0, 1)
        panel(self, "requirements", above, self.table)
        live.listen(self._show_requirements, "select", "requirements")
        grey_when_old(live, {"select"}, self.answer, self.table)

    def _show_requirements(self, ropes: Ropes | None) -> None:
        """Show what a full selection has evaluated; that nothing is known for None."""
        self.table.rows.show(() if ropes is None else ropes.requirements)
        answer = None if ropes is None else ropes.answer
        self.answer.setText(_NOT_EVALUATED if ropes is None else answer_words(ropes))
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


_ALL_MATERIALS, _ALL_MAKERS = "all materials", "all makers"
_NO_ROPES = "Nothing yet: ropes are compared over the workspace of the study."


def _scaled(title: str, name: str, scale: float, digits: int, definition: str) -> Column:
    return number_column(title, name, definition, lambda v: fmt.number(scale * v, digits))


_STANDINGS = (
    *("chosen", "undominated", "dominated", "not_comparable"),
    *("rejected", "too_thin", "not_held"),
)


def _rope_rank(row: RopeRow) -> float:
    """What became of it, then its mass; of what does not hold, how far it is from that."""
    known = row.standing in _STANDINGS
    standing = _STANDINGS.index(row.standing) if known else len(_STANDINGS)
    then = row.figures.mass_kg if row.holds else row.verification.utilisation
    return 1e9 * standing + (5e8 if math.isnan(then) else min(then, 1e8))


ROPE_COLUMNS = (
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
    _scaled("max. tension [kN]", "verification.max_tension_N", 1e-3, 4, "Largest in any cable."),
    _scaled("drum [mm]", "figures.drum_diameter_m", 1e3, 4, "Least diameter of drums and sheaves."),
    _scaled("stiffness [kN/m]", "figures.stiffness_N_per_m", 1e-3, 3, "Least, of the platform."),
    _scaled("cost", "figures.cost", 1.0, 4, "Of all cables; estimated where no grade has a price."),
    Column(
        "outcome",
        attrgetter("reason"),
        "Why it is chosen or rejected; the best by the objectives of the study first.",
        _rope_rank,
    ),
)
_ROPE_WIDTHS = (72, 180, 116, 72, 60, 84, 78, 56, 80, 104, 84, 116, 60)


class PanelRopes(QWidget):
    """The table of candidates with its filters."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self._ropes: Ropes | None = None
        self._rope: Rope | RopePerCable | None = None
        self.table = Table(
            "candidates", ROPE_COLUMNS, _ROPE_WIDTHS, sorted_by=len(ROPE_COLUMNS) - 1
        )
        self.table.rows.bold = lambda row: self._ropes is not None and row.rope == self._ropes.best
        self.table.rows.muted = lambda row: not row.holds
        self.table.rows.hint = attrgetter("reason")
        self.table.selectionModel().currentRowChanged.connect(self._current_changed)
        self.material = DropDown("material", 9, _ALL_MATERIALS)
        self.maker = DropDown("maker", 9, _ALL_MAKERS)
        for choice in (self.material, self.maker):
            choice.currentTextChanged.connect(self._filter)
        self.only_holding = check_box("only what holds", "only ropes that hold", self._filter)
        tip = "Colours the map for the thinnest cable of the configured family at each pose."
        family = button("no rope", "Use generic cable", lambda: live.choose(None), tip)
        tip = (
            "Chooses as the report does, between the samples as well, and for groups of cables "
            "where the study has some; then proves that the best holds in all poses, as far as "
            "the study gives it time. Until then the table holds at the samples."
        )
        self.select = button(
            "full selection", "Full selection", lambda: live.begin_long("select"), tip
        )
        self.answer, self.groups = result("best rope"), result("groups")
        tip = "Colours the map with the rope of each group."
        self.look_at_groups = button("look at groups", "Show the groups", self._choose_groups, tip)
        groups = row_of(self.groups, self.look_at_groups)
        groups.setStretch(0, 1)
        panel(
            self,
            "ropes",
            row_of(self.material, self.maker, self.only_holding, None, family, self.select),
            self.answer,
            groups,
            self.table,
        )
        live.listen(self._show_ropes, "ropes", "select")
        live.changed.connect(self._follow_rope)
        grey_when_old(live, {"ropes"}, self.answer, self.groups, self.table)

    def _choose_groups(self) -> None:
        if self._ropes is not None:
            self._live.choose(self._ropes.assignment)

    def _follow_rope(self) -> None:
        if self._live.rope != self._rope:
            self._rope = self._live.rope
            self._mark_current()

    def _show_ropes(self, ropes: Ropes | None) -> None:
        self._ropes, self._rope = ropes, self._live.rope
        self.table.rows.show(() if ropes is None else ropes.rows)
        if ropes is not None:
            self.material.refill([_ALL_MATERIALS, *ropes.materials])
            self.maker.refill([_ALL_MAKERS, *ropes.makers])
        self.answer.setText(_NO_ROPES if ropes is None else _answer(ropes))
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
    lines = [] if ropes.answer is None else [answer_words(ropes)]
    if ropes.best is None:
        return "\n".join([*lines, fmt.capital(ropes.reason) or _NO_ROPES])
    sure = "between the samples as well" if ropes.is_final else "at the samples, not proved"
    lines.append(f"Best: {ropes.best.label} ({sure})")
    if ropes.proof is not None:
        proof = proof_statement(ropes.proof)
        lines.append(f"{proof.title}. {proof.text}")
    return "\n".join(lines)


def _groups_text(choice: GroupChoice) -> str:
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


_DIFFERENCE_COLUMNS = (
    Column("quantity", attrgetter("title"), "Figure, or value of the study."),
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
        self.table = Table("differences", _DIFFERENCE_COLUMNS, (190, 190, 190))
        self.table.rows.hint = lambda r: f"{r.title}: {r.before or '–'} → {r.after or '–'}"
        above = row_of(pin, self._release, self.in_map, None)
        panel(self, "compare", above, self._summary, self.table)
        live.answered.connect(self._show_differences)
        live.changed.connect(self._show_differences)
        grey_when_old(live, {"pose", "worst", "ropes"}, self._summary, self.table)
        self._show_differences()

    def _show_differences(self) -> None:
        differences = self._live.differences()
        self._release.setEnabled(differences is not None)
        self.in_map.setEnabled(differences is not None)
        if differences is None:
            self.in_map.setChecked(False)
            self._summary.setText(
                "Nothing is pinned. Pin a state as A, change the study, and compare the two."
            )
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


_ALL_CHANNELS = "all, in units of noise"


class PanelMeasured(QWidget):
    """Residuals over any covariate; the diagnosis, and taking over what it found."""

    rows_wanted = Signal(bool)  #: The measured rows shall be seen in the scene

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self._residuals: Residuals | None = None
        self._diagnosis: DiagnosisAnswer | None = None
        self.channel, self.over = DropDown("channel", 14), DropDown("covariate", 10)
        for box in (self.channel, self.over):
            box.currentIndexChanged.connect(self._draw)
        tip = "Draws, paler, what a model without the declared effects leaves as well."
        self.without = check_box("without effects", "also without effects", self._draw, tip)
        in_scene = check_box("rows in the scene", "in the scene", self.rows_wanted.emit)
        self.plot, self.summary = ScatterPlot(), result("diagnosis")
        self.summary.setTextFormat(Qt.TextFormat.RichText)
        self.summary.setAlignment(Qt.AlignmentFlag.AlignTop)
        tip = (
            "Writes the effects into the study as one step, with this state pinned as A: the "
            "comparison shows map and answer with and without them."
        )
        self._take = button("take over", "Take over the effects", self._take_over, tip)
        area = QScrollArea()  # beside the plot: a long answer shall not squeeze it
        area.setWidget(self.summary)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        tip = "Searches for the physical effects that the model lacks; some minutes."
        diagnose = button("diagnose", "Diagnose", lambda: live.begin_long("diagnose"), tip)
        answer, both = QVBoxLayout(), QHBoxLayout()
        answer.addWidget(area, 1)
        fill(answer, diagnose, self._take)
        both.addWidget(self.plot, 2)
        both.addLayout(answer, 1)
        above = row_of("Residual of", self.channel, "over", self.over, self.without, in_scene, None)
        panel(self, "measured", above, both)
        live.listen(self._show_residuals, "residuals")
        live.listen(self._show_diagnosis, "diagnose")
        grey_when_old(live, {"residuals"}, self.plot)
        grey_when_old(live, {"diagnose"}, self.summary)
        self._show_diagnosis(None)

    def _show_residuals(self, residuals: Residuals | None) -> None:
        self._residuals = residuals
        if residuals is None:
            self.plot.show_points("", "", np.empty((0, 2)), np.empty((0, 2)), np.nan)
            return
        measured = [
            name
            for name, column in zip(residuals.channels, residuals.residual.T, strict=True)
            if np.isfinite(column).any()
        ]
        self.channel.refill([_ALL_CHANNELS, *measured])
        self.over.refill(list(residuals.covariates))
        self._draw()

    def _show_diagnosis(self, diagnosis: DiagnosisAnswer | None) -> None:
        self._diagnosis = diagnosis
        self._take.setEnabled(diagnosis is not None and bool(diagnosis.effects))
        if diagnosis is None:
            self.summary.setText("No search has been made.")
            return
        answer = f"<b>{diagnosis.title}</b> {diagnosis.text}"
        self.summary.setText("<br>".join((answer, *diagnosis.effects, *diagnosis.errors)))

    def _take_over(self) -> None:
        if self._diagnosis is not None:
            self._live.take_over(self._diagnosis.diagnosed_text)

    def _draw(self) -> None:
        residuals = self._residuals
        if residuals is None or self.over.currentText() not in residuals.covariates:
            return
        over = residuals.covariates[self.over.currentText()]
        name = self.channel.currentText()
        if name == _ALL_CHANNELS:
            values, before, label = residuals.size(), np.full(len(over), np.nan), "residual / noise"
            noise = 1.0
        else:
            column = residuals.channels.index(name)
            values, before = residuals.residual[:, column], residuals.without[:, column]
            label = f"{name} [{residuals.units[column]}]"
            noise = float(residuals.noise[column])
        without = before if self.without.isChecked() else np.full(len(over), np.nan)
        now, pale = (np.column_stack([over, column]) for column in (values, without))
        self.plot.show_points(self.over.currentText(), label, now, pale, noise)


class ScatterPlot(QWidget):
    """Points over an axis, paler ones behind them, and a band of twice the noise."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("residual plot")
        self.setMinimumHeight(90)
        self.points = np.empty((0, 2))
        self._pale = np.empty((0, 2))
        self._labels = ("", "")
        self._noise = np.nan

    def show_points(
        self, across: str, upward: str, points: FloatArray, pale: FloatArray, noise: float
    ) -> None:
        """Show points (n, 2) and paler ones (n, 2); rows with NaN are left out."""
        self.points = points[np.isfinite(points).all(axis=1)]
        self._pale = pale[np.isfinite(pale).all(axis=1)]
        self._labels, self._noise = (across, upward), noise
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter, colours = QPainter(self), current_theme()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        everything = np.concatenate([self.points, self._pale])
        if len(everything) == 0:
            painter.setPen(QColor(colours.muted))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "no residuals")
            return
        low, high = everything.min(axis=0), everything.max(axis=0)
        reach = 2.0 * self._noise if np.isfinite(self._noise) else 0.0
        low[1], high[1] = min(low[1], -reach), max(high[1], reach)
        room = np.where(high > low, 0.04 * (high - low), 0.5)
        low, high = low - room, high + room
        area = QRectF(66, 6, self.width() - 76, self.height() - 42)

        def at(point: FloatArray) -> QPointF:
            share = (point - low) / (high - low)
            return QPointF(
                area.left() + share[0] * area.width(), area.bottom() - share[1] * area.height()
            )

        self._draw_axes(painter, area, low, high)
        painter.setClipRect(area)
        painter.setPen(Qt.PenStyle.NoPen)
        band = QColor(colours.good)
        band.setAlpha(40)
        bottom, top = at(np.array([low[0], -reach])), at(np.array([high[0], reach]))
        painter.fillRect(QRectF(bottom, top).normalized(), band)
        fresh = colours.muted if self.property("old") else colours.accent
        for points, colour in ((self._pale, colours.muted), (self.points, fresh)):
            ink = QColor(colour)
            ink.setAlpha(110 if points is self._pale else 200)
            painter.setBrush(ink)
            for point in points:
                painter.drawEllipse(at(point), 2.4, 2.4)

    def _draw_axes(
        self, painter: QPainter, area: QRectF, low: FloatArray, high: FloatArray
    ) -> None:
        colours = current_theme()
        painter.setPen(QPen(QColor(colours.border)))
        painter.drawRect(area)
        line = self.fontMetrics().height()
        for axis in (0, 1):
            for tick in ticks_between(float(low[axis]), float(high[axis])):
                share = (tick - low[axis]) / (high[axis] - low[axis])
                painter.setPen(QColor(colours.muted))
                text = fmt.trimmed(float(tick), 4)
                if axis == 0:
                    x = area.left() + share * area.width()
                    box = QRectF(x - 40, area.bottom() + 2, 80, line)
                    painter.drawText(box, Qt.AlignmentFlag.AlignHCenter, text)
                else:
                    y = area.bottom() - share * area.height()
                    box = QRectF(0, y - 0.5 * line, area.left() - 5, line)
                    painter.drawText(box, Qt.AlignmentFlag.AlignRight, text)
                    painter.setPen(QPen(QColor(colours.border), 0.5))
                    painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
        painter.setPen(QColor(colours.ink))
        below = QRectF(area.left(), area.bottom() + line, area.width(), line + 4)
        painter.drawText(below, Qt.AlignmentFlag.AlignHCenter, self._labels[0])
        painter.drawText(QPointF(area.left() + 6, area.top() + line), self._labels[1])
