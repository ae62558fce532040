"""The scene with what is set above and beside it: quantity, surface, slice, exaggeration."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QStandardItemModel
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from designer.arrays import FloatArray
from designer.explore.desktop.hit import Hit
from designer.explore.desktop.layouts import emptied
from designer.explore.desktop.painting import Painting
from designer.explore.desktop.scene import Scene
from designer.explore.desktop.theme import LIGHT, Theme
from designer.explore.quantities import BY_KEY, QUANTITIES, category_labels
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.figures import canvas
from designer.report.figures.colours import Steps
from designer.report.figures.view import clear_azimuth_rad, facing_azimuth_rad

if TYPE_CHECKING:
    from designer.explore.here import Here
    from designer.explore.map import MapAnswer, WorstAnswer
    from designer.study import Study

FACTORS = (1, 2, 5, 10, 20, 50)
_ELEVATION_RAD = float(np.radians(28.0))


class WorkPage(QWidget):
    """Scene, the bar above it, the slider of the slice, and a notice when there is one."""

    slice_moved = Signal(float, bool)
    """Share of the height, and whether it is still on its way."""
    quantity_changed = Signal(str)
    notice_answered = Signal(str)
    """The name of the button of the notice that was pressed."""

    def __init__(self) -> None:
        super().__init__()
        self.scene = Scene(self)
        self.map: MapAnswer | None = None
        self.painting: Painting | None = None
        self._theme: Theme = LIGHT
        self._here: Here | None = None
        self._study: Study | None = None
        self._place = np.zeros(6)
        self._held: Steps | None = None
        self._hit: Hit | None = None
        self._rows_note = ""
        self._is_old = False
        self._where = "home"
        self._notice = _Notice()
        self._notice.answered.connect(self.notice_answered)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(0)
        rows.addWidget(self._bar())
        rows.addWidget(self._notice)
        middle = QHBoxLayout()
        middle.setSpacing(0)
        middle.addWidget(self.scene, 1)
        middle.addWidget(self._slice_slider())
        rows.addLayout(middle, 1)
        self.scene.pointed_at.connect(self._point)
        self.scene.resized.connect(self._look_again)

    def _bar(self) -> QWidget:
        bar = QWidget()
        row = QHBoxLayout(bar)
        row.setContentsMargins(8, 4, 8, 4)
        self.quantity = QComboBox()
        self.quantity.setObjectName("quantity")
        self.quantity.setAccessibleName("What the map is coloured by")
        for number, one in enumerate(QUANTITIES):
            self.quantity.addItem(one.title, one.key)
            self.quantity.setItemData(number, one.definition, Qt.ItemDataRole.ToolTipRole)
        self.quantity.currentIndexChanged.connect(self._quantity_chosen)
        self.surface = QCheckBox("Surface")
        self.surface.setObjectName("show surface")
        self.surface.setToolTip("<p>The outside of the region, seen from within.</p>")
        self.slice = QCheckBox("Slice")
        self.slice.setObjectName("show slice")
        self.slice.setToolTip("<p>A level slice through the region; the slider moves it.</p>")
        for box in (self.surface, self.slice):
            box.setChecked(True)
            box.toggled.connect(self._show_surfaces)
        self.exaggeration = QComboBox()
        self.exaggeration.setObjectName("sag exaggeration")
        self.exaggeration.setToolTip(
            "<p>Draws the cables as many times farther from the straight line between their ends "
            "as they are; numbers stay what they are.</p>"
        )
        for factor in FACTORS:
            self.exaggeration.addItem("true sag" if factor == 1 else f"sag × {factor}", factor)
        self.exaggeration.currentIndexChanged.connect(self._show_place)
        self.held = QCheckBox("Hold the scale")
        self.held.setObjectName("hold scale")
        self.held.setToolTip("<p>The colours keep their meaning while the study changes.</p>")
        self.held.toggled.connect(self._hold)
        row.addWidget(QLabel("Colour by"))
        row.addWidget(self.quantity)
        row.addSpacing(8)
        for widget in (self.held, self.surface, self.slice, self.exaggeration):
            row.addWidget(widget)
        row.addStretch(1)
        return bar

    def _slice_slider(self) -> QSlider:
        self.height_slider = QSlider(Qt.Orientation.Vertical)
        self.height_slider.setObjectName("slice height")
        self.height_slider.setAccessibleName("Height of the slice")
        self.height_slider.setRange(0, 100)
        self.height_slider.setValue(50)
        self.height_slider.valueChanged.connect(self._slice_slid)
        self.height_slider.sliderReleased.connect(
            lambda: self.slice_moved.emit(self.height_slider.value() / 100.0, False)
        )
        return self.height_slider

    def put_on(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._theme = theme
        self.scene.put_on(theme)
        self._show_map()

    # What is shown

    def show_study(self, study: Study, *, afresh: bool) -> None:
        """Show base and region; look at all of it where the study was opened ``afresh``."""
        if afresh:
            self.map, self.painting, self._here, self._held = None, None, None, None
            self.held.setChecked(False)
            self.scene.stage.put_map(None, None)
            self.show_rows(np.empty((0, 3)), np.empty(0))
            self.scene.colour_legend.show_meaning("", None, (), self._theme)
            self.scene.overlay.worst = None
        self._study = study
        stage = self.scene.stage
        stage.put_study(study)
        together = 0.04 * float(np.linalg.norm(np.ptp(stage.bounds_m, axis=0)))
        self.scene.overlay.names = canvas.names_of(study.robot.exit_points_m, together)
        self.scene.can_turn = not study.robot.is_point_mass
        if afresh:
            self.look("home")
        self.scene.redraw()

    def show_place(self, place: FloatArray) -> None:
        """Show the platform somewhere; its cables are straight until they are answered."""
        if not np.array_equal(place, self._place):
            self._here = None
        self._place = np.array(place)
        self._show_place()

    def show_here(self, here: Here) -> None:
        """Show the cables in their true shape."""
        self._here = here
        self._show_place()

    def _show_place(self) -> None:
        if self._study is None:
            return
        factor = float(self.exaggeration.currentData())
        self.scene.stage.put_place(self._study, self._place, self._here, factor)
        self.scene.overlay.platform_m = self._place[:3].copy()
        self._write_note()
        self.scene.redraw()

    def show_map(self, answer: MapAnswer) -> None:
        """Show the map."""
        self.map = answer
        self._show_map()

    def show_age(self, *, is_map_old: bool, is_worst_old: bool) -> None:
        """Show in grey what is of an older state of the study."""
        if is_map_old != self._is_old:
            self._is_old = is_map_old
            self._show_map()
        if is_worst_old != self.scene.overlay.is_worst_old:
            self.scene.overlay.is_worst_old = is_worst_old
            self.scene.overlay.update()

    def show_worst(self, worst: WorstAnswer | None) -> None:
        """Mark the worst pose."""
        marked = None
        if worst is not None and worst.place is not None:
            marked = (worst.place[:3], "worst pose")
        self.scene.overlay.worst = marked
        self.scene.overlay.setToolTip(worst.sentence if worst else "")
        self.scene.overlay.update()

    def show_rows(self, position_m: FloatArray, sizes: FloatArray) -> None:
        """Show where was measured (n, 3), by the size of the residuals in units of noise (n,)."""
        most = 5.0
        self.scene.stage.put_rows(position_m, sizes, most)
        text = f"measured rows: residual from 0 (dark) to {most:g} times the noise (bright)"
        self._rows_note = text if len(position_m) else ""
        self._write_note()
        self.scene.redraw()

    def _write_note(self) -> None:
        factor = self.exaggeration.currentData()
        sag = f"sag drawn {factor} times" if factor != 1 else ""
        self.scene.overlay.note = "\n".join(filter(None, [sag, self._rows_note]))
        self.scene.overlay.update()

    def _show_map(self) -> None:
        answer = self.map
        if answer is None or not answer.grids:
            return
        quantity = BY_KEY[str(self.quantity.currentData())]
        if any(quantity.key not in values for values in answer.values.values()):
            return  # it was asked for, and comes with the next answer
        if quantity.key == "utilisation" and answer.rope is None:
            return  # of the thinnest cable it is 100 % everywhere; that of the rope comes
        painting = Painting.over(answer, quantity, self._held)
        self.painting = replace(painting, is_old=self._is_old)
        self.scene.stage.put_map(answer, self.painting)
        keys = self.painting.keys(answer, self._theme)
        self.scene.colour_legend.show_meaning(
            self.painting.title,
            self.painting.steps,
            keys,
            self._theme,
            self.painting.note(answer),
            is_old=self._is_old,
        )
        self.scene.place_legend()
        has_slice = "slice" in answer.grids
        self.slice.setVisible(has_slice)
        self.height_slider.setVisible(has_slice and self.slice.isChecked())
        self.surface.setVisible("points" not in answer.grids)
        self._show_surfaces()

    def _show_surfaces(self) -> None:
        self.scene.stage.shell.show(self.surface.isChecked())
        self.scene.stage.slice.show(self.slice.isChecked())
        self.scene.stage.rim.show(self.slice.isChecked())
        has_slice = self.map is not None and "slice" in self.map.grids
        self.height_slider.setVisible(has_slice and self.slice.isChecked())
        self.scene.redraw()

    def _quantity_chosen(self) -> None:
        self.held.setChecked(False)
        self.quantity.setToolTip(f"<p>{BY_KEY[self.quantity.currentData()].definition}</p>")
        self._show_map()
        self.quantity_changed.emit(str(self.quantity.currentData()))

    def allow_utilisation(self, has_rope: bool) -> None:
        """Offer the utilisation where there is a rope; else what the family needs stands there."""
        index = self.quantity.findData("utilisation")
        model = self.quantity.model()
        assert isinstance(model, QStandardItemModel)
        model.item(index).setEnabled(has_rope)
        if not has_rope and self.quantity.currentIndex() == index:
            self.choose_quantity("diameter")

    def choose_quantity(self, key: str) -> None:
        """Colour the map by another quantity."""
        self.quantity.setCurrentIndex(self.quantity.findData(key))

    def _hold(self, wanted: bool) -> None:
        self._held = self.painting.steps if wanted and self.painting is not None else None
        self._show_map()

    def _slice_slid(self, value: int) -> None:
        self.slice_moved.emit(value / 100.0, self.height_slider.isSliderDown())

    # Where one looks from

    def look(self, where: str) -> None:
        """Look from ``home``, ``top``, ``front`` or ``side`` at all that there is."""
        stage, study = self.scene.stage, self._study
        self._where, self.scene.is_turned = where, False
        if study is None:
            return
        sides = {"top": (-90.0, 89.0), "front": (-90.0, 0.0), "side": (0.0, 0.0)}
        azimuth, elevation = self._home(study)
        if where in sides:
            azimuth, elevation = (float(angle) for angle in np.radians(sides[where]))
        legend_px = self.scene.colour_legend.sizeHint().width()
        self.scene.camera_.fit(stage.everything_m(), azimuth, elevation, legend_px)
        self.scene.redraw()

    def _look_again(self) -> None:
        if not self.scene.is_turned:
            self.look(self._where)

    def _home(self, study: Study) -> tuple[float, float]:
        robot = study.robot
        if robot.is_planar:
            return facing_azimuth_rad(robot.upright[0, :2]), _ELEVATION_RAD
        stage = self.scene.stage
        centre = stage.bounds_m.mean(axis=0)
        lines = np.stack([robot.exit_points_m, np.broadcast_to(centre, robot.exit_points_m.shape)])
        return clear_azimuth_rad(np.swapaxes(lines, 0, 1), _ELEVATION_RAD), _ELEVATION_RAD

    # What the mouse is over

    def _point(self, hit: Hit | None) -> None:
        self._hit = hit
        text = "" if hit is None else self.read(hit)
        self.scene.write_pointed(text)

    def read(self, hit: Hit) -> str:
        """Return what the map says at the grid point next to a place, and where that is."""
        if self.map is None or self.painting is None or hit.grid not in self.map.grids:
            return ""
        values = {key: v.ravel()[hit.number] for key, v in self.map.values[hit.grid].items()}
        where = fmt.position(self.map.grids[hit.grid].reshape(-1, 3)[hit.number])
        quantity = self.painting.quantity
        value = float(values[quantity.key])
        if values["left_out"]:
            text = "left out: a cable hangs below"
        elif quantity.is_category:
            assert self._study is not None
            labels = category_labels(quantity.key, self._study.robot.n_cables)
            text = labels.get(int(value), fmt.MISSING) if math.isfinite(value) else fmt.MISSING
        else:
            text = f"{fmt.number(value * quantity.scale, 4)} {quantity.unit}".strip()
        lines = [f"{quantity.title}: {text}", where]
        change = self.map.difference(hit.grid, quantity.key)
        if change is not None and not quantity.is_category:
            less = fmt.number(float(change.ravel()[hit.number]) * quantity.scale, 3)
            lines.insert(1, f"now less A: {less} {quantity.unit}".strip())
        verdict = Verdict(int(values["verdict"]))
        if verdict is not Verdict.SOLVED:
            lines.append(verdict.reason)
        elif values.get("unserved"):
            lines.append("no rope serves")
        return "\n".join(lines)

    def show_notice(self, text: str, *buttons: str) -> None:
        """Show a notice above the scene, with buttons; nothing for no text."""
        self._notice.show_text(text, buttons)


class _Notice(QFrame):
    """One line that asks for attention without stopping anything."""

    answered = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("notice")
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(10, 3, 10, 3)
        self.hide()

    def show_text(self, text: str, buttons: tuple[str, ...]) -> None:
        emptied(self._row)
        label = QLabel(text)
        label.setWordWrap(True)
        self._row.addWidget(label, 1)
        for name in buttons:
            button = QPushButton(name)
            button.setObjectName(f"notice {name}")
            button.clicked.connect(lambda _=False, name=name: self.answered.emit(name))
            self._row.addWidget(button)
        self.setVisible(bool(text))
