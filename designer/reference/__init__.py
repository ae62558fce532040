"""Numbers of others that this package reproduces: theirs, their source, and how to get ours."""

from __future__ import annotations

from collections.abc import Callable

from designer.plugins import hookimpl


@hookimpl
def register_commands() -> list[Callable[..., object]]:
    """Return `designer verify`."""
    from designer.reference.command import verify

    return [verify]
