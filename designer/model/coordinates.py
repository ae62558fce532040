"""Coordinates of poses that were measured in part: data beside lengths and tensions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray
from designer.model.robot import Poses


@dataclass(frozen=True, slots=True, eq=False)
class Coordinates:
    """Some coordinates of each row's pose, in the robot's frame.

    Parameters
    ----------
    names : tuple of str
        Of the columns of ``values``, as in a log.
    values : array (n_rows, 6)
        Position [m], then three Euler angles [rad]; NaN where not measured.
    axes : str
        Axes of the angles as SciPy has them: small letters for axes that stand still, capitals for
        such as turn with the body.
    noise : array (6,)
        Standard deviations [m, rad].
    """

    names: tuple[str, ...]
    values: FloatArray
    axes: str
    noise: FloatArray

    @property
    def is_read(self) -> BoolArray:
        """Which were measured (n_rows, 6)."""
        return np.isfinite(self.values)

    @property
    def counts(self) -> dict[str, int]:
        """In how many rows each was measured, of those that were in any."""
        counts = self.is_read.sum(axis=0).tolist()
        return {name: n for name, n in zip(self.names, counts, strict=True) if n}

    def off(self, poses: Poses) -> FloatArray:
        """Return measured less those of poses (n_rows,), over the noise; 0 where not measured."""
        angles = np.zeros((len(self.values), 3))
        if self.is_read[:, 3:].any():
            angles = Rotation.from_matrix(poses.rotations).as_euler(self.axes)
        off = self.values - np.hstack([poses.position_m, angles])
        off[:, 3:] = (off[:, 3:] + np.pi) % (2.0 * np.pi) - np.pi
        return np.nan_to_num(off / self.noise)

    def left(self, poses: Poses) -> dict[str, dict[str, float]]:
        """Return, of each that was measured, its rows and the root mean square of `off`."""
        square = np.sum(self.off(poses) ** 2, axis=0)
        rms = dict(zip(self.names, square.tolist(), strict=True))
        return {
            name: {"rows": n, "rms_over_noise": float(np.sqrt(rms[name] / n))}
            for name, n in self.counts.items()
        }

    def put_into(self, poses: Poses) -> Poses:
        """Return poses (n_rows,) with what was measured instead; angles that were not are 0."""
        position = np.where(self.is_read[:, :3], self.values[:, :3], poses.position_m)
        if not self.is_read[:, 3:].any():
            return Poses(position, poses.rotation)
        turn = Rotation.from_euler(self.axes, np.nan_to_num(self.values[:, 3:]))
        return Poses(position, turn.as_matrix())

    def without(self, rows: BoolArray) -> Coordinates:
        """Return them with nothing measured in some rows (n_rows,)."""
        return replace(self, values=np.where(rows[:, None], np.nan, self.values))
