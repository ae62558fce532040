"""The present state against one that was kept as A."""

from __future__ import annotations

from typing import TYPE_CHECKING

from designer.explore.compare import Pin, compare

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window


class Comparing:
    """What the window does with A."""

    def __init__(self, window: Window) -> None:
        self._window = window

    @property
    def _pinned(self) -> Pin | None:
        session = self._window.session
        pin = None if session is None else session.state.pin
        return pin if isinstance(pin, Pin) else None

    def _present(self) -> Pin | None:
        """The present state with what is known of it."""
        session, known = self._window.session, self._window.answers.get
        question = None if session is None else session.question()
        if session is None or question is None:
            return None
        return Pin(question, session.fields(), known("here"), known("worst"), known("ropes"))

    def pin(self) -> None:
        """Keep the present state as A."""
        if self._window.session is not None:
            self._window.session.set_pin(self._present())
            self.pin_changed()

    def release(self) -> None:
        """Compare with nothing any more."""
        if self._window.session is not None:
            self._window.session.set_pin(None)
            self.pin_changed()

    def pin_changed(self) -> None:
        """Show the differences to what is A now."""
        self.show()
        self.want_in_map(self._window.compare.in_map.isChecked())
        self._window.menus.refresh()

    def show(self) -> None:
        """Show the differences to A."""
        pin, now = self._pinned, self._present()
        found = compare(pin, now) if pin is not None and now is not None else None
        self._window.compare.show_differences(found)

    def want_in_map(self, wanted: bool) -> None:
        """Have the map show the difference to A, or not."""
        pin, live = self._pinned, self._window.live
        against = pin.question if wanted and pin is not None else None
        if against is not live.against:
            live.against = against
            live.ask_map()

    def take_over(self, text: str) -> None:
        """Go on with another text of the study, the present state kept as A."""
        session = self._window.session
        if session is not None:
            session.set_pin(self._present())
            self._window.editing.write(text)
            self.pin_changed()
            self._window.docks["Compare"].raise_()
