"""Our own effects, which come in by the same door as everybody else's."""

from __future__ import annotations

from designer.effects.kind import EffectKind
from designer.effects.registry import KINDS
from designer.plugins import hookimpl


@hookimpl
def register_effects() -> tuple[EffectKind, ...]:
    """Return the effects that are shipped, in the order in which they act."""
    return KINDS
