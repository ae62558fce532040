"""Our own effects, which come in by the same door as everybody else's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from designer.plugins import hookimpl

if TYPE_CHECKING:
    from designer.effects.effect import Effect


@hookimpl
def register_effects() -> tuple[Effect, ...]:
    """Return the effects that are shipped, in the order in which they act."""
    from designer.effects.registry import EFFECTS

    return EFFECTS
