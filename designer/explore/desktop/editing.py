"""Changes of the study, from its panel and its text, and how they are undone."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window
    from designer.explore.session import Session


class Editing:
    """What the window does with the numbers and the text of the study."""

    def __init__(self, window: Window) -> None:
        self._window = window

    def show(self) -> None:
        """Show the fields, and what was refused."""
        session = self._window.session
        assert session is not None
        panel = self._window.study_panel
        panel.show_fields(session.fields(), session.rejected, session.differing)

    def enter(self, path: str, text: str, moving: bool) -> None:
        """Give one field another value, which may be on its way."""
        self._do(lambda session: session.edit(path, text, continuous=moving), moving=moving)

    def put_back(self, path: str) -> None:
        """Make one field as the file has it."""
        self._do(lambda session: session.put_back(path))

    def put_all_back(self) -> None:
        """Make the whole study as the file has it."""
        session = self._window.session
        if session is not None and session.is_modified:
            session.settle()
            self._do(lambda session: session.set_text(session.saved_text))

    def write(self, text: str) -> None:
        """Take the study as it was written."""
        session = self._window.session
        if session is not None and text != session.text:
            self._do(lambda session: session.set_text(text, continuous=True))

    def settle(self) -> None:
        """A slider was let go."""
        session = self._window.session
        if session is not None:
            session.settle()
            self._window.changed()

    def give_up(self, path: str) -> None:
        """Forget what was refused."""
        session = self._window.session
        if session is not None:
            session.drop_rejected(path)
            self.show()

    def undo(self) -> None:
        """Take back the last step."""
        self._go(lambda session: session.undo())

    def redo(self) -> None:
        """Do again what was taken back last."""
        self._go(lambda session: session.redo())

    def _go(self, step: Callable[[Session], object]) -> None:
        window = self._window
        if window.session is not None:
            self._do(step)
            window.ropes.show_ropes(window.answers.get("ropes"), window.session.state.rope)
            window.comparing.pin_changed()

    def _do(self, step: Callable[[Session], object], *, moving: bool = False) -> None:
        session = self._window.session
        if session is not None:
            step(session)
            self.show()
            self._window.changed(moving=moving)
