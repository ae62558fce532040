"""The robot optimised: fields of a study as design variables, a result of it as the objective.

The hooks are those of the ring, which has the sweeps of `designer/sweeps` as well.
"""

from __future__ import annotations

from collections.abc import Callable

from designer.plugins import hookimpl


@hookimpl
def register_commands() -> list[Callable[..., object]]:
    """Return `designer sweep` and `designer optimise`."""
    from designer.optimum.command import optimise
    from designer.sweeps.command import sweep

    return [sweep, optimise]
