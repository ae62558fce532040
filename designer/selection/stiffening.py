r"""The stiffness of a rope at the tension that it has.

EA of a fibre rope depends on its tension, and a cable is solved with one EA. That is the one at the
largest tension that any of the cables meets, in any pose, in one direction of a load case (of its
wind and inertia force, without one lost cable):

.. math::

    EA = EA(T_{max}(EA)),

a fixed point, found by the secant method. The safety factor is not in it. Where winches keep their
lengths, after the loss of a cable or by warmth, the largest tension is that afterwards, and the
cables have that EA before as well. Where a pose is not held, there is no such tension, and the EA
that was tried stays. Ropes with one EA for all loads are left as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from designer.model.cable import Cable
from designer.model.load_case import Loaded

_STILL = 1e-6
"""Relative change of EA at which it is taken to stay."""
_MOST_ROUNDS = 20
"""Of the secant method, so that it ends where the tension jumps."""


class StiffnessSearch:
    """The search for the EA that one rope has at the largest tension that it meets with it."""

    def __init__(self) -> None:
        self._rounds = 0
        self._last: tuple[float, float] | None = None  # EA tried, and how far it was off [N]

    def next(self, cable: Cable, max_tension_N: float) -> Cable | None:
        """Return the cable to try next, given what it met; None where its EA stays.

        After `_MOST_ROUNDS` it stays as well: the tension jumps where a platform falls elsewhere.
        """
        if cable.stiffening is None or not math.isfinite(max_tension_N):
            return None
        here_N = cable.axial_stiffness_N
        off_N = cable.stiffening.at(max_tension_N) - here_N
        self._rounds += 1
        if abs(off_N) <= _STILL * here_N or self._rounds > _MOST_ROUNDS:
            return None
        step_N = off_N
        if self._last is not None:
            before_N, off_before_N = self._last
            slope = (off_N - off_before_N) / (here_N - before_N)
            if slope < 0.0:  # else both steps lead away from it
                step_N = -off_N / slope
        self._last = here_N, off_N
        allowed_N = cable.stiffening.axial_stiffness_N
        next_N = min(max(here_N + step_N, min(allowed_N)), max(allowed_N))
        return None if next_N == here_N else replace(cable, axial_stiffness_N=next_N)

    def next_of(self, loaded: Loaded, max_tension_N: float) -> Loaded | None:
        """Return the same for a cable in a load case, with the load on it."""
        cable = self.next(loaded.cable, max_tension_N)
        if cable is None:
            return None
        robot, bare = loaded.bare
        return loaded.on(robot, replace(bare, axial_stiffness_N=cable.axial_stiffness_N))


def as_it_meets(cable: Cable, max_tension_N: Callable[[Cable], float]) -> Cable:
    """Return a cable as stiff as at the largest tension [N] that a function finds it to meet."""
    search, trial = StiffnessSearch(), cable
    while cable.stiffening is not None:
        stiffer = search.next(trial, max_tension_N(trial))
        if stiffer is None:
            break
        trial = stiffer
    return trial
