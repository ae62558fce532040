"""Studies for other programs: a format a file, over one description of the robot at its poses.

The hooks are those of the ring, which has the importers of `designer/foreign` as well.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from designer.plugins import hookimpl

if TYPE_CHECKING:
    from designer.exports.formats import Format
    from designer.foreign.robot import Importer


@hookimpl
def register_commands() -> list[Callable[..., object]]:
    """Return `designer import` and `designer export`."""
    from designer.exports.command import export
    from designer.foreign.command import import_

    return [import_, export]


@hookimpl
def register_importers() -> list[Importer]:
    """Return what reads robots of CASPR and WireX."""
    from designer.foreign.study import IMPORTERS

    return IMPORTERS


@hookimpl
def register_exporters() -> list[Format]:
    """Return our own formats."""
    from designer.exports.formats import FORMATS

    return [*FORMATS.values()]
