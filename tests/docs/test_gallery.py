"""Which reports are made when the docs are built."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

from designer.resources import example_names

CONF = Path(__file__).parents[2] / "docs" / "conf.py"


class App:
    """What `setup` of ``conf.py`` asks of Sphinx."""

    def __init__(self) -> None:
        self.values: dict[str, object] = {}

    def connect(self, event: str, called: object) -> None:
        """Take what is called at an event."""

    def add_config_value(self, name: str, default: object, rebuild: str) -> None:
        """Note a config value."""
        self.values[name] = default


def test_all_studies_are_shown_unless_some_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("sphinx")
    monkeypatch.setattr(sys, "path", [*sys.path])
    namespace, app = runpy.run_path(str(CONF)), App()
    namespace["setup"](app)
    assert len(app.values["gallery"]) == len(example_names()) - 1
    assert "gallery" not in namespace  # else Sphinx takes it for the value
