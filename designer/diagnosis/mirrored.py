"""Poses in a left-handed frame, told by what the readings leave in each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from designer.arrays import BoolArray
from designer.diagnosis.problem import Problem
from designer.diagnosis.statistics import spread
from designer.diagnosis.structure import Event
from designer.effects.effect import Setting
from designer.measured.sense import left_handed

_FAR = 3.0
"""Times the noise from which on a frame may be to blame."""
_NEAR = 0.1
"""Of the mean square, what the right frame leaves at most: other errors may be there as well."""


def find_mirrored(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> Event | None:
    """Return the mirrored frame in which the poses suit the readings; None where there is none.

    As for exchanged plugs, each reading counts about its own mean, and of the mean square no more
    than a tenth may be left.
    """
    measured = problem.measured
    as_it_is = _mean_square(problem, settings, rows)
    if not measured.has_poses or not as_it_is > _FAR**2:
        return None
    left: dict[str, float] = {}
    for text, view in left_handed(problem.predict.machine.robot, measured):
        mirrored = replace(problem, measured=view, predict=problem.predict.at(view))
        left[text] = min(_mean_square(mirrored, settings, rows), left.get(text, np.inf))
    best = min(left, key=left.__getitem__)
    if left[best] > _NEAR * as_it_is:
        return None
    return Event(
        f"a mirrored frame of the poses: {best}", 1.0 - left[best] / as_it_is, 0.0, "mistake"
    )


def _mean_square(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> float:
    residual = problem.residual(settings)[rows]
    read = residual[:, ~np.isnan(residual).all(axis=0)]
    return float(np.mean([spread(channel) ** 2 for channel in read.T]))
