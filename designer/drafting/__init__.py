"""Grade files from makers' tables: CSV, Excel workbooks and PDFs."""

from __future__ import annotations

from collections.abc import Callable

from designer.plugins import hookimpl


@hookimpl
def register_catalog_commands() -> list[Callable[..., object]]:
    """Return `designer catalog new`."""
    from designer.drafting.command import new

    return [new]
