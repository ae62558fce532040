"""Slopes that were taken lately, which are good near the place where they were taken.

What a reading gains by a parameter hardly changes while this and the others move by little. So a
fit that nears its end, or that adds an effect to a model, asks for few slopes anew. The price is a
fit off by a small share of its standard deviations; one that goes to the end asks for exact slopes.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Setting

_OWN, _OTHER = 0.02, 0.3
"""By how much values of the effect itself, and of others, may have moved, over `_Values.unit`."""
_MOST_PLACES = 12
"""Those of the parts of one validation, and a few more."""


class _Values(NamedTuple):
    """Values of an effect, those at which it does nothing, and what counts as a change.

    That is a typical change, or a tenth of the way from doing nothing where that is more.
    """

    values: FloatArray
    neutral: FloatArray
    unit: FloatArray


_Place = Mapping[str, _Values]


@dataclass(frozen=True, slots=True, eq=False)
class _Taken:
    place: _Place
    trust: Hashable
    slopes: dict[str, FloatArray]


@dataclass(eq=False)
class KeptSlopes:
    """Remembers slopes by the values of all effects; the latest places only."""

    _taken: list[_Taken] = field(init=False, default_factory=list)

    def of(
        self,
        settings: Sequence[Setting],
        trust: Hashable,
        compute: Callable[[Setting], FloatArray],
        *,
        nearly: bool,
    ) -> FloatArray:
        """Return the slopes (…, n_parameters) of all effects at their values.

        Parameters
        ----------
        settings : sequence of Setting
            The effects with their values.
        trust : hashable
            What else slopes depend on.
        compute : callable
            Returns the slopes in the parameters of one of the settings.
        nearly : bool
            Whether those of a place near by will do.
        """
        place = {s.effect.key: _values_of(s) for s in settings}
        slopes: dict[str, FloatArray] = {}
        for taken in reversed([t for t in self._taken if t.trust == trust]):
            near = _good_for(place, taken, nearly=nearly) - slopes.keys()
            slopes |= {key: taken.slopes[key] for key in near}
            if near:  # those in use are the last to go
                self._taken.remove(taken)
                self._taken.append(taken)
        fresh = {s.effect.key: compute(s) for s in settings if s.effect.key not in slopes}
        if fresh:
            self._taken = [*self._taken[1 - _MOST_PLACES :], _Taken(place, trust, fresh)]
        slopes |= fresh
        return np.concatenate([slopes[s.effect.key] for s in settings], axis=-1)


def _values_of(setting: Setting) -> _Values:
    effect = setting.effect
    values = np.array([setting.values[p.name] for p in effect.parameters])
    neutral = np.array([p.neutral for p in effect.parameters])
    typical = np.array([p.typical for p in effect.parameters])
    return _Values(values, neutral, np.maximum(typical, 0.1 * np.abs(values - neutral)))


def _good_for(place: _Place, taken: _Taken, *, nearly: bool) -> set[str]:
    """Return the effects whose slopes, taken elsewhere, are good at a place."""
    moved = {key: _moved(key, place, taken.place) for key in {**place, **taken.place}}
    own, other = (_OWN, _OTHER) if nearly else (0.0, 0.0)
    if max(moved.values()) > other:
        return set()
    return {key for key in taken.slopes if key in place and moved[key] <= own}


def _moved(key: str, place: _Place, other: _Place) -> float:
    """Return how far an effect's values are apart; without the effect it does nothing."""
    here, there = place.get(key), other.get(key)
    known = here or there
    assert known is not None
    a, b = (known.neutral if values is None else values.values for values in (here, there))
    return float(np.max(np.abs(a - b) / known.unit))
