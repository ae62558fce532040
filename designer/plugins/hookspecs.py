"""The hooks of the plugin door.

A plugin is a Python distribution with an entry point in the group ``designer.plugins`` whose
module implements one of the hooks, or both::

    from pathlib import Path
    from designer.plugins import hookimpl

    @hookimpl
    def register_grades():
        return [Path(__file__).parent / "grades"]
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from designer.effects.effect import Effect
    from designer.grades.grade import Grade

PROJECT = "designer"
ENTRY_POINT_GROUP = "designer.plugins"

hookspec = pluggy.HookspecMarker(PROJECT)
hookimpl = pluggy.HookimplMarker(PROJECT)


@hookspec
def register_grades() -> Sequence[PathLike[str] | str | Grade]:
    """Return a list of grade files, folders of grade files, and `Grade` objects.

    Files and folders are absolute paths.
    """
    raise NotImplementedError  # only the signature counts


@hookspec
def register_effects() -> Sequence[Effect]:
    """Return a list of effects; they act after ours, in the order of the list."""
    raise NotImplementedError  # only the signature counts


HOOKS = (register_grades.__name__, register_effects.__name__)
"""Names of all hooks."""
PLAIN = {register_grades.__name__: "designer.grades.plain"}
"""Of hooks whose answers come from another process: what makes them plain data, and back."""
