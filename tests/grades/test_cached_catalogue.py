"""The catalogue that is kept between studies."""

from __future__ import annotations

import os
from pathlib import Path

from designer.grades import registry
from designer.grades.registry import cached_catalogue, load_catalogue
from designer.plugins import find_plugins


def test_it_is_read_anew_for_other_plugins_and_changed_files_only(tmp_path: Path) -> None:
    plugins = find_plugins(with_plugins=False)
    first = cached_catalogue((), plugins)
    assert first == load_catalogue((), plugins=plugins)
    assert cached_catalogue((), plugins) is first
    assert cached_catalogue((), find_plugins(with_plugins=False)) is not first


def test_the_users_folder_is_looked_at(tmp_path: Path, monkeypatch) -> None:
    folder = tmp_path / "catalog"
    monkeypatch.setattr(registry, "user_catalogue_folder", lambda: folder)
    plugins = find_plugins(with_plugins=False)
    first = cached_catalogue((), plugins)
    folder.mkdir()
    (folder / "a.yaml").write_text("")
    second = cached_catalogue((), plugins)
    assert second is not first
    os.utime(folder / "a.yaml", (1e9, 1e9))
    assert cached_catalogue((), plugins) is not second
