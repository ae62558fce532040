"""The catalogue that was read last, kept: checking every grade takes longer than most studies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from designer.grades.registry import Catalogue, load_catalogue, user_catalogue_folder
from designer.plugins.find import Plugins

_State = tuple[tuple[Path, tuple[float, ...]], ...]

_kept: list[tuple[Plugins, _State, Catalogue]] = []


def kept_catalogue(paths: Sequence[Path], plugins: Plugins) -> Catalogue:
    """Return what `load_catalogue` does, read anew only for other plugins or changed files.

    Raises
    ------
    InputError
        If a file in ``paths`` is faulty, or has the id of another grade.
    """
    state = tuple((path, _changed_at(path)) for path in (*paths, user_catalogue_folder()))
    if not (_kept and _kept[0][0] is plugins and _kept[0][1] == state):
        _kept[:] = [(plugins, state, load_catalogue(paths, plugins=plugins))]
    return _kept[0][2]


def _changed_at(path: Path) -> tuple[float, ...]:
    """Return when a file, or those of a folder, were changed; nothing where there is none."""
    try:
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        return tuple(file.stat().st_mtime for file in files)
    except OSError:
        return ()
