"""Light and dark: colours of the window and of the scene, from one small table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication

from designer.report.figures import palette

Choice = Literal["system", "light", "dark"]
CHOICES: tuple[Choice, ...] = get_args(Choice)


@dataclass(frozen=True, slots=True)
class Theme:
    """Colours by what they are for; accents are those of the report, brighter on dark ground."""

    name: Literal["light", "dark"]
    window: str
    base: str
    raised: str
    stripe: str
    border: str
    ink: str
    muted: str
    accent: str
    good: str
    amber: str
    warning: str
    cable: str
    left_out: str
    hatch: tuple[str, str]


LIGHT = Theme(
    name="light",
    window="#f3f4f6",
    base="#ffffff",
    raised="#fbfbfc",
    stripe="#f5f7f9",
    border="#cfd4da",
    ink=palette.INK,
    muted="#646c76",
    accent=palette.SAG,
    good="#00795c",
    amber="#7a5c00",
    warning="#b84f00",
    cable=palette.INK,
    left_out=palette.LEFT_OUT,
    hatch=(palette.WARNING_PALE, palette.WARNING),
)
DARK = Theme(
    name="dark",
    window="#2a2f36",
    base="#15181c",
    raised="#363c44",
    stripe="#1d2126",
    border="#4b535d",
    ink="#e7eaee",
    muted="#9ba5b1",
    accent="#56b4e9",
    good="#3fc79a",
    amber="#e5c04a",
    warning="#ff9548",
    cable="#f4f6f8",
    left_out="#4a515a",
    hatch=("#40230f", "#e8762c"),
)


def theme_of(choice: str) -> Theme:
    """Return the theme that was chosen; of any other word that of the system."""
    if choice in ("light", "dark"):
        return DARK if choice == "dark" else LIGHT
    is_dark = QApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark
    return DARK if is_dark else LIGHT


def current() -> Theme:
    """Return the theme that the application has on."""
    app = QApplication.instance()
    return DARK if app is not None and app.property("theme") == DARK.name else LIGHT


def put_on(app: QApplication, theme: Theme) -> None:
    """Give the whole application the colours of a theme."""
    app.setProperty("theme", theme.name)
    app.setPalette(_palette(theme))
    app.setStyleSheet(_sheet(theme))


def _palette(theme: Theme) -> QPalette:
    role, colours = QPalette.ColorRole, QPalette()
    accent = QColor(theme.accent)
    everywhere = {
        role.Window: theme.window,
        role.Base: theme.base,
        role.AlternateBase: theme.stripe,
        role.Button: theme.raised,
        role.ToolTipBase: theme.raised,
        role.WindowText: theme.ink,
        role.Text: theme.ink,
        role.ButtonText: theme.ink,
        role.ToolTipText: theme.ink,
        role.BrightText: theme.warning,
        role.PlaceholderText: theme.muted,
        role.Mid: theme.border,
        role.Dark: theme.border,
        role.Midlight: theme.border,
        role.Light: theme.raised,
        role.Highlight: accent,
        role.HighlightedText: "#ffffff" if theme.name == "light" else "#10151a",
        role.Link: accent,
        role.Accent: accent,
    }
    for which, colour in everywhere.items():
        colours.setColor(which, QColor(colour))
    for which in (role.WindowText, role.Text, role.ButtonText):
        colours.setColor(QPalette.ColorGroup.Disabled, which, QColor(theme.muted))
    return colours


def _sheet(theme: Theme) -> str:
    return f"""
QToolTip {{ color: {theme.ink}; background: {theme.raised}; border: 1px solid {theme.border};
    padding: 4px; }}
QDockWidget::title {{ padding: 4px 8px; background: {theme.window}; }}
QHeaderView::section {{ background: {theme.window}; color: {theme.muted}; border: none;
    border-bottom: 1px solid {theme.border}; padding: 3px 4px; }}
QTableView {{ border: none; gridline-color: {theme.border}; }}
QScrollArea {{ border: none; }}
QFrame#legend {{ background: #e1{theme.base[1:]}; border: 1px solid {theme.border};
    border-radius: 4px; }}
QStatusBar {{ border-top: 1px solid {theme.border}; }}
QToolBar {{ border: none; border-bottom: 1px solid {theme.border}; spacing: 6px; padding: 3px; }}
QLabel[role="muted"], QCheckBox[role="muted"] {{ color: {theme.muted}; }}
QLabel[role="fault"] {{ color: {theme.warning}; }}
QLabel[role="doubt"] {{ font-style: italic; color: {theme.amber}; }}
QLabel[role="good"] {{ color: {theme.good}; }}
QLabel[role="heading"] {{ font-weight: 600; }}
QLabel[role="title"] {{ font-size: 18pt; font-weight: 600; }}
QLabel[old="true"], QTableView[old="true"] {{ color: {theme.muted}; }}
QLineEdit[faulty="true"] {{ border: 1px solid {theme.warning}; }}
QToolButton[role="put-back"] {{ border: none; color: {theme.accent}; padding: 0 2px; }}
QToolButton[role="section"] {{ border: none; font-weight: 600; padding: 6px 0 2px 0; }}
QPushButton[role="study"] {{ text-align: left; padding: 8px; background: {theme.base};
    border: 1px solid {theme.border}; border-radius: 4px; }}
QPushButton[role="study"]:hover, QPushButton[role="study"]:focus {{
    border: 1px solid {theme.accent}; }}
"""
