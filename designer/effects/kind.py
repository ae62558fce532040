"""One kind of effect: how files spell it, and how it is made for a machine."""

from __future__ import annotations

from dataclasses import dataclass

from designer.effects.effect import Builder
from designer.effects.names import EffectName


@dataclass(frozen=True, slots=True)
class EffectKind:
    """What `register_effects` of a plugin gives, and what our own effects are.

    Parameters
    ----------
    name : EffectName
        Id and parameters, as config and result files spell them.
    build : callable
        From a machine to the effects of this kind that it may have: one; one for each cable where
        the name says ``takes_cable``; none where it cannot have any. Where an effect acts, on the
        machine or on readings, each `designer.effects.effect.Effect` says itself.
    """

    name: EffectName
    build: Builder
