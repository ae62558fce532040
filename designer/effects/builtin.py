"""Our own effects, which come in by the same door as everybody else's."""

from __future__ import annotations

from designer.effects.effect import Effect
from designer.effects.registry import EFFECTS
from designer.plugins import hookimpl


@hookimpl
def register_effects() -> tuple[Effect, ...]:
    """Return the effects that are shipped, in the order in which they act."""
    return EFFECTS
