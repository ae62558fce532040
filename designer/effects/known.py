"""The effects that a study may declare and a diagnosis may find."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from designer.effects.effect import Effect, Setting
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName
from designer.model.machine import Machine


@dataclass(frozen=True, slots=True)
class KnownEffects:
    """Our own effects and those of plugins.

    Parameters
    ----------
    kinds : tuple of EffectKind
        In the order in which they act; ids are unique.
    problems : tuple of str
        What was left out and why, one line each.
    """

    kinds: tuple[EffectKind, ...]
    problems: tuple[str, ...] = ()

    @property
    def names(self) -> Mapping[str, EffectName]:
        """Every effect by its id, as files spell it."""
        return {kind.name.id: kind.name for kind in self.kinds}

    def of(self, machine: Machine) -> list[Effect]:
        """Return every effect that this machine may have, in the order in which they act.

        Raises
        ------
        designer.errors.EffectError
            If an effect of a plugin fails at this machine.
        """
        return [effect for kind in self.kinds for effect in kind.build(machine)]

    def in_order(self, settings: Iterable[Setting]) -> list[Setting]:
        """Return settings in the order in which they act: a model is one, however it was found."""
        place = {effect_id: k for k, effect_id in enumerate(self.names)}
        return sorted(settings, key=lambda s: (place[s.effect.id], s.effect.cable or 0))

    def without(self, effect_id: str, problem: str) -> KnownEffects:
        """Return all effects but one, with the reason why it is left out."""
        kept = tuple(kind for kind in self.kinds if kind.name.id != effect_id)
        return KnownEffects(kept, (*self.problems, problem))
