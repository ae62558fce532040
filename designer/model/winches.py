"""The winches of a robot, one for each cable and all alike."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer import checked
from designer.arrays import frozen_array


@dataclass(frozen=True, slots=True, eq=False)
class Winches(checked.Value):
    """The winches of a robot; None for what is not known, or not asked for.

    Parameters
    ----------
    tension_max_N : float or None
        Largest tension that a winch may see, where its cable leaves toward the platform [N].
    positions_m : array (n_cables, 3) or None
        Where each cable comes from to its exit point: its winch, or the last sheave before that,
        world frame [m].
    """

    tension_max_N: checked.Positive | None = None
    positions_m: checked.Points | None = None

    def without(self, cable: int) -> Winches:
        """Return the winches without that of one cable, counted from 1."""
        if self.positions_m is None:
            return self
        return replace(self, positions_m=frozen_array(np.delete(self.positions_m, cable - 1, 0)))
