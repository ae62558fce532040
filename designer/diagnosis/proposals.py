"""Where to measure next, so that rivals part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.problem import Problem
from designer.effects.effect import Setting
from designer.model.measured_data import Measured
from designer.model.region import Region
from designer.model.robot import Poses

_CANDIDATES = 2000
"""Positions to look at: in a cube, neighbours are a twelfth of its side apart."""
_APART = 0.15
"""Share of the region between proposals: else all three would be one place."""
_TOLD_APART = 3.0
"""Standard deviations between two rivals that are told apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """Poses whose measurement would tell two rivals apart.

    Parameters
    ----------
    found, rival : str
        The two.
    positions_m : array (n_poses, 3)
        Where to measure.
    separation : array (n_poses,)
        Difference of their predictions there, in units of noise, over all readings of a pose.
    """

    found: str
    rival: str
    positions_m: FloatArray = field(metadata={"json": "poses"})
    separation: FloatArray

    @property
    def repeats(self) -> FloatArray:
        """How often to measure each pose, until the two are three deviations apart (n_poses,).

        Inf where both predict the same.
        """
        with np.errstate(divide="ignore"):
            return np.ceil((_TOLD_APART / self.separation) ** 2)


def propose(
    problem: Problem,
    region: Region | None,
    fitted: Sequence[Setting],
    rival: Sequence[Setting],
    names: tuple[str, str],
) -> Proposal:
    """Return the poses at which the predictions of two models, both fitted, differ most.

    Parameters
    ----------
    problem : Problem
        As in the diagnosis; the surroundings of a new pose are taken from the middle row.
    region : Region or None
        Where to look; the box of the measured poses if there is none.
    fitted, rival : sequence of Setting
        The two models.
    names : tuple of str
        What to call them.
    """
    positions = _candidates(problem.measured, region)
    measured = _measured_at(problem.measured, positions)
    elsewhere = replace(problem, measured=measured, predict=problem.predict.at(measured))
    readings, rival_readings = (
        elsewhere.predicted(settings).stacked for settings in (fitted, rival)
    )
    is_measured = ~np.isnan(problem.measured.readings).all(axis=0)
    gap = (readings - rival_readings)[:, is_measured] / problem.sigma[is_measured]
    separation = np.sqrt(np.nansum(gap**2, axis=1))
    size = np.maximum(np.ptp(positions, axis=0), 1e-9)
    chosen: list[int] = []
    for k in np.argsort(-separation):
        apart = [np.abs((positions[k] - positions[c]) / size).max() > _APART for c in chosen]
        if all(apart):
            chosen.append(int(k))
        if len(chosen) == 3:  # one to decide, two in case that it cannot be reached
            break
    return Proposal(*names, positions[chosen], separation[chosen])


def _candidates(measured: Measured, region: Region | None) -> FloatArray:
    if region is not None:
        return np.concatenate(list(region.samples_m(_CANDIDATES, "low_discrepancy", 0)))
    position = measured.poses.position_m
    rng = np.random.default_rng(0)
    return rng.uniform(position.min(axis=0), position.max(axis=0), (_CANDIDATES, 3))


def _measured_at(measured: Measured, positions: FloatArray) -> Measured:
    """Return rows at rest at other positions, turned as the middle row, in its surroundings."""
    middle, count = measured.n_rows // 2, len(positions)
    rotation = measured.poses.rotation
    unread = np.full((count, measured.length_m.shape[1]), np.nan)

    def repeated(column: FloatArray | None) -> FloatArray | None:
        return None if column is None else np.repeat(column[middle : middle + 1], count, axis=0)

    return replace(
        measured,
        settled=True,
        poses=Poses(positions, rotation if rotation.ndim == 2 else rotation[middle]),
        length_m=unread,
        tension_N=unread,
        time_s=repeated(measured.time_s),
        temperature_C=repeated(measured.temperature_C),
        wind_m_per_s=repeated(measured.wind_m_per_s),
        covariates={},
        row_numbers=np.arange(1, count + 1),
        session=None,
    )
