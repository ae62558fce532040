"""Finding a design by hand: a study that is edited, and answers that follow."""

from __future__ import annotations

from collections.abc import Callable

from designer.plugins import hookimpl


@hookimpl
def register_commands() -> list[Callable[..., object]]:
    """Return `designer explore`."""
    from designer.explore.command import explore

    return [explore]
