"""The hook by which rope grades come in.

A plugin is a Python distribution with an entry point in the group ``designer.plugins`` whose
module implements the hook::

    from pathlib import Path
    from designer.catalogue.hookspecs import hookimpl

    @hookimpl
    def register_grades():
        return [Path(__file__).parent / "grades"]
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

import pluggy

from designer.catalogue.grade import Grade

PROJECT = "designer"
ENTRY_POINT_GROUP = "designer.plugins"

hookspec = pluggy.HookspecMarker(PROJECT)
hookimpl = pluggy.HookimplMarker(PROJECT)

Item = PathLike[str] | str | Grade
"""A grade file, a folder of grade files (both as absolute paths), or a grade made in Python."""


@hookspec
def register_grades() -> Sequence[Item]:
    """Return a list of grade files, folders of grade files, and `Grade` objects."""
    raise NotImplementedError  # only the signature counts
