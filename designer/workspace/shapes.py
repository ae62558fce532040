"""The true shapes of hanging cables as fine polylines, with a bound on what these cut off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.physics import catenary
from designer.statics.inverse import Statics


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Cables of many poses, any of which can be sampled anywhere."""

    start_m: FloatArray  # (n_curves, 3): Where they leave base or pulley, upright frame [m]
    outward: FloatArray  # (n_curves, 2): Horizontal unit vector of the plane that each hangs in
    # (n_curves,): As in `designer.physics.catenary`; the length is that between pulley and platform
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray
    axial_stiffness_N: FloatArray
    weight_N_per_m: FloatArray

    @classmethod
    def of(cls, statics: Statics) -> Curves:
        """Return the cables of poses (n_poses,), cable by cable within pose by pose."""
        shape = statics.length_m.shape

        def flat(values: FloatArray) -> FloatArray:
            return np.broadcast_to(values, shape).reshape(-1)

        return cls(
            start_m=np.broadcast_to(statics.run.exit_points_m, (*shape, 3)).reshape(-1, 3),
            outward=statics.geometry().outward.reshape(-1, 2),
            length_m=flat(statics.free_length_m),
            force_x_N=flat(statics.force_x_N),
            force_z_N=flat(statics.force_z_N),
            axial_stiffness_N=flat(statics.axial_stiffness_N),
            weight_N_per_m=flat(statics.weight_N_per_m),
        )

    def polylines(
        self, which: IntArray, low: FloatArray, high: FloatArray, segments: int
    ) -> Polylines:
        """Return polylines through points of the curves, evenly spaced in unstrained length.

        Of the curves of these numbers (n,), each from ``low`` to ``high`` (n,), shares of its
        unstrained length.
        """
        share = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, segments + 1)
        length = self.length_m[which, None]
        s = share * length
        F_x, F_z = self.force_x_N[which, None], self.force_z_N[which, None]
        EA, w = self.axial_stiffness_N[which, None], self.weight_N_per_m[which, None]
        x, z = catenary.position_m(s, length, F_x, F_z, EA, w)
        plan = x[..., None] * self.outward[which, None, :]
        points = self.start_m[which, None, :] + np.concatenate([plan, z[..., None]], axis=-1)
        slope = np.arctan2(F_z + w * (s - length), F_x)
        # A convex plane arc lies in the triangle of its chord and its end tangents; with a turn φ
        # from one tangent to the other its height is at most c/2 tan(φ/2). Where the arc folds
        # over, it is still no farther from the chord's ends than half its length, here bounded by
        # the triangle of a nearly full turn.
        chord = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
        turn = np.minimum(np.abs(np.diff(slope, axis=-1)), 0.999 * np.pi)
        return Polylines(points, share, 0.5 * chord * np.tan(0.5 * turn))


@dataclass(frozen=True, slots=True, eq=False)
class Polylines:
    """Points of curves, and how far the curves stray from the straight pieces between them."""

    points_m: FloatArray  # (n, segments + 1, 3): Upright frame [m]
    share: FloatArray  # (n, segments + 1): Where they lie, as shares of the unstrained length
    # (n, segments): No point of the curve is farther than this from its straight piece [m]
    sagitta_m: FloatArray
