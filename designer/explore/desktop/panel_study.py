"""Every number of the study that can vary: as an entry with its unit, and as a slider."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import (
    QComboBox,
    QGridLayout,
    QScrollArea,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from designer.explore.desktop.live_session import LiveSession
from designer.explore.desktop.widgets import (
    LineEntry,
    check_box,
    clear_layout,
    label,
    named,
    result,
    row_of,
)
from designer.explore.session import Session
from designer.report import format as fmt

if TYPE_CHECKING:
    from designer.explore.fields import Field
    from designer.explore.session import Rejected

_STEPS = 1000  #: Finer than a pixel of the slider
_BESIDE = 75  #: Width of a name that has room beside its entry in a narrow panel, also in bold [px]
_OF_MANY = {"robot.anchors": "Exit points", "robot.platform.attachments": "Attachments"}
"""Lists that are sections of their own here, folded: they rarely vary."""
_FOLDED = frozenset(_OF_MANY.values())


class PanelStudy(QWidget):
    """The fields of the study by their sections."""

    def __init__(self, live: LiveSession) -> None:
        super().__init__()
        self._live = live
        self.setObjectName("study")
        self.setMinimumWidth(240)
        self.rows: dict[str, FieldRow] = {}
        self._headings: dict[str, _Heading] = {}
        self._find = named(LineEntry(), "find field")
        self._find.setPlaceholderText("Find a number …")
        self._find.setClearButtonEnabled(True)
        self._find.textChanged.connect(self._filter)
        self._changed_only = check_box(
            "changed only", "changed", self._filter, "Only what differs from the file."
        )
        above = row_of(self._find, self._changed_only)
        above.setContentsMargins(8, 0, 8, 0)
        self._inside = QWidget()
        self._list = QVBoxLayout(self._inside)
        self._list.setContentsMargins(8, 4, 8, 8)
        self._list.setSpacing(3)
        self._list.setAlignment(Qt.AlignmentFlag.AlignTop)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(self._inside)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(0, 6, 0, 0)
        rows.addLayout(above)
        rows.addWidget(area, 1)
        live.changed.connect(self._show_fields)

    def _show_fields(self) -> None:
        """Show the fields as they stand; rows are made anew only where other fields are there."""
        session = self._live.session
        if session is None:
            return
        fields, differing = session.fields(), session.differing
        if {field.path for field in fields} != self.rows.keys():
            self._rebuild(fields)
        for field in fields:
            row, refused = self.rows[field.path], session.rejected.get(field.path)
            row.show_field(field, field.path in differing)
            row.show_refused(refused)
        self._filter()

    def _rebuild(self, fields: Sequence[Field]) -> None:
        clear_layout(self._list)
        self.rows, self._headings = {}, {}
        groups: dict[str, list[Field]] = {}
        for field in fields:
            groups.setdefault(_group(field), []).append(field)
        for group, members in sorted(groups.items(), key=lambda item: item[0] in _FOLDED):
            heading = _Heading(group, is_open=group not in _FOLDED)
            heading.toggled.connect(self._filter)
            self._headings[group] = heading
            self._list.addWidget(heading)
            for field in members:
                row = FieldRow(field, self._live)
                self.rows[field.path] = row
                self._list.addWidget(row)

    def _filter(self) -> None:
        sought = self._find.text().strip().lower()
        is_sought = bool(sought) or self._changed_only.isChecked()
        groups: set[str] = set()
        for row in self.rows.values():
            field, group = row.field, _group(row.field)
            is_match = sought in f"{group} {field.label} {field.path}".lower()
            is_shown = is_match and (row.is_changed or not self._changed_only.isChecked())
            groups |= {group} if is_shown else set()
            row.setVisible(is_shown and (is_sought or self._headings[group].isChecked()))
        for group, heading in self._headings.items():
            heading.setVisible(group in groups)


class _Heading(QToolButton):
    """The title of a section, which folds it."""

    def __init__(self, title: str, *, is_open: bool) -> None:
        super().__init__()
        self.setObjectName(f"section {title}")
        self.setProperty("role", "section")
        self.setText(title)
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.setCheckable(True)
        self.toggled.connect(self._point)
        self.setChecked(is_open)
        self._point(is_open)

    def _point(self, is_open: bool) -> None:
        self.setArrowType(Qt.ArrowType.DownArrow if is_open else Qt.ArrowType.RightArrow)


class FieldRow(QWidget):
    """One field: its name, its entry or its choices, a slider, and what is wrong with it."""

    def __init__(self, field: Field, live: LiveSession) -> None:
        super().__init__()
        self.field, self._live = field, live
        self.is_changed = False
        self._label = label(field.label, tip=f"{field.definition}</p><p><code>{field.path}</code>")
        self._label.setWordWrap(True)
        self._back = named(
            QToolButton(),
            f"put back {field.path}",
            "Put this field alone back to what the file says.",
        )
        self._back.setText("↺")
        self._back.setProperty("role", "put-back")
        self._back.setAccessibleName(f"Put back {field.label}")
        self._back.clicked.connect(lambda: live.do(lambda s: s.put_back(self.field.path)))
        policy = self._back.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self._back.setSizePolicy(policy)
        self._fault = result(f"fault {field.path}", "fault")
        self.entry = named(LineEntry(), f"entry {field.path}")
        self.choices = named(QComboBox(), f"choice {field.path}")
        self.slider = named(_Slider(), f"slider {field.path}")
        for widget in (self.entry, self.choices, self.slider):
            widget.setAccessibleName(field.label)
        self._rest = QTimer(self, singleShot=True, interval=400)  # several steps of keys: one edit
        self._rest.timeout.connect(self._settle)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(4)
        grid.setVerticalSpacing(0)
        grid.setColumnStretch(0, 1)
        has_slider = field.low is not None and field.high is not None
        width = self._label.fontMetrics().horizontalAdvance(field.label)
        row = 0 if width <= _BESIDE and not has_slider else 1
        grid.addWidget(self._label, 0, 0, 1, 1 if row == 0 else 3)
        if field.kind == "choice":
            self.choices.setFixedWidth(124)
            self.choices.addItems(list(field.choices))
            self.choices.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            self.choices.textActivated.connect(self._edit)
        else:
            self.entry.setFixedWidth(104)
            self.entry.setAlignment(Qt.AlignmentFlag.AlignRight)
            self.entry.editingFinished.connect(self._entered)
            self.entry.installEventFilter(self)
        grid.addWidget(self.choices if field.kind == "choice" else self.entry, row, 1)
        grid.addWidget(self._back, row, 2)
        if has_slider:
            self.slider.valueChanged.connect(self._slide)
            self.slider.sliderReleased.connect(self._settle)
            grid.addWidget(self.slider, 1, 0)
        grid.addWidget(self._fault, 2, 0, 1, 3)
        self._fault.hide()

    def show_field(self, field: Field, is_changed: bool) -> None:
        self.field, self.is_changed = field, is_changed
        font = self._label.font()
        font.setBold(is_changed)
        self._label.setFont(font)
        self._back.setVisible(is_changed)
        if field.kind == "choice":
            self.choices.setCurrentText(field.text)
        elif not (self.entry.hasFocus() and self.entry.isModified()):
            self.entry.setText(field.text)
            self.entry.setCursorPosition(0)
        self.entry.setPlaceholderText("none" if field.is_optional else "")
        has_slider = field.low is not None and field.high is not None
        if field.value_SI is not None and has_slider and not self.slider.isSliderDown():
            low, high = self._ends()
            value = math.log(max(field.value_SI, 1e-300)) if field.is_log else field.value_SI
            self.slider.put((value - low) / (high - low) if high > low else 0.0)

    def show_refused(self, refused: Rejected | None) -> None:
        """Show what was refused, to be mended, and what is wrong with it; None for nothing."""
        fault = ""
        for problem in () if refused is None else refused.faults:
            expected = f" (expected {problem.expected})" if problem.expected else ""
            fault = f"{fault} {fmt.capital(problem.problem)}{expected}.".lstrip()
        self._fault.setText(fault)
        self._fault.setVisible(bool(fault))
        self.entry.mark(fault)
        if refused is not None and not (self.entry.hasFocus() and self.entry.isModified()):
            self.entry.setText(refused.text)
            self.choices.setCurrentText(refused.text)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.KeyPress and event.key() == Qt.Key.Key_Escape:  # type: ignore[attr-defined]
            self.entry.setModified(False)
            self.entry.setText(self.field.text)
            self._live.drop_rejected(self.field.path)
            return True
        return super().eventFilter(watched, event)

    def _edit(self, text: str, *, moving: bool = False) -> None:
        path = self.field.path
        self._live.do(lambda session: session.edit(path, text, continuous=moving), moving=moving)

    def _settle(self) -> None:
        self._live.do(Session.settle)

    def _entered(self) -> None:
        if self.entry.isModified():
            self.entry.setModified(False)
            self._edit(self.entry.text().strip())

    def _slide(self) -> None:
        if not self.slider.is_put:
            low, high = self._ends()
            value = low + self.slider.value() / _STEPS * (high - low)
            value = math.exp(value) if self.field.is_log else value
            self._edit(self.field.text_of(value), moving=True)
            if not self.slider.isSliderDown():
                self._rest.start()

    def _ends(self) -> tuple[float, float]:
        low, high = self.field.low, self.field.high
        assert low is not None
        assert high is not None
        return (math.log(low), math.log(high)) if self.field.is_log else (low, high)


def _group(field: Field) -> str:
    return _OF_MANY.get(field.path.split("[")[0], field.group)


class _Slider(QSlider):
    """A slider that the wheel does not move by chance, and that jumps to where it is clicked."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setRange(0, _STEPS)
        self.setPageStep(_STEPS // 20)
        self.setSingleStep(_STEPS // 200)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.is_put = False

    def put(self, share: float) -> None:
        """Show a share of the range; this is no edit."""
        self.is_put = True
        self.setValue(round(min(max(share, 0.0), 1.0) * _STEPS))
        self.is_put = False

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()
