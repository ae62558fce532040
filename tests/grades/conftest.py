"""Keeps the tests away from the grades that this machine's user may have."""

from __future__ import annotations

from pathlib import Path

import pytest

from designer.grades import registry


@pytest.fixture(autouse=True)
def user_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An own user folder, which does not exist yet."""
    folder = tmp_path / "user-catalog"
    monkeypatch.setattr(registry, "user_catalogue_folder", lambda: folder)
    return folder
