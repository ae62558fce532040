"""Boxes that cover a space of poses: three coordinates of position, then three or none of turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.region import BoxFrame
from designer.model.space import Space


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """The positions of a region by three coordinates, in one orientation or a range of them.

    Parameters
    ----------
    frame : BoxFrame
        What the coordinates of positions are.
    low, high : array (n_boxes, 3 or 6)
        Boxes that cover it at the start [m or share, rad].
    turn_rad : array (3,)
        Orientation, where that is no coordinate [rad].
    """

    frame: BoxFrame
    low: FloatArray
    high: FloatArray
    turn_rad: FloatArray

    def places(self, coordinates: FloatArray) -> FloatArray:
        """Return the places (n, 6) of coordinates (n, 3 or 6) [m, rad]."""
        position = self.frame.origin_m + coordinates[:, :3] @ self.frame.axes.T
        turn = coordinates[:, 3:]
        if turn.shape[1] == 0:
            turn = np.broadcast_to(self.turn_rad, position.shape)
        return np.hstack([position, turn])

    def cut(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Cut boxes at the border of the region.

        Parameters
        ----------
        low, high : array (n, k)
            Boxes.

        Returns
        -------
        low, high : array (n, k)
            The smallest boxes around what is left; low above high where that is nothing.
        corners : array (n, n_corners, 2)
            Corners of what is left, first two coordinates; some stand there more than once.
        """
        x, y = np.stack([low[:, :2], high[:, :2]], axis=-1).transpose(1, 0, 2)
        plan = np.stack([x[:, [0, 1, 1, 0]], y[:, [0, 0, 1, 1]]], axis=-1)
        for side in self.frame.sides:
            plan = _cut_at(plan, side)
        low, high = low.copy(), high.copy()
        with np.errstate(invalid="ignore"):
            low[:, :2] = np.fmin.reduce(plan, axis=1)
            high[:, :2] = np.fmax.reduce(plan, axis=1)
        gone = np.isnan(low[:, 0])
        low[gone], high[gone] = 1.0, 0.0
        return low, high, np.where(np.isnan(plan), np.nan_to_num(plan[:, :1]), plan)

    def share(self, low: FloatArray, high: FloatArray, corners: FloatArray) -> FloatArray:
        """Return the volumes of cut boxes (n,), flat directions left out."""
        flat = (self.high == self.low).all(axis=0)
        size = np.where(flat, 1.0, high - low)
        if not flat[:2].any():
            size[:, 1] = 1.0
            x, y = corners[..., 0], corners[..., 1]
            after_x, after_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
            size[:, 0] = 0.5 * np.abs(np.sum(x * after_y - after_x * y, axis=1))
        return np.asarray(np.prod(size, axis=1))


def halves(low: FloatArray, high: FloatArray, cut: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return where the lower halves of boxes (n, k) end, and where the upper ones begin.

    Each box is cut in two across a coordinate of its own, ``cut`` (n,).
    """
    rows = np.arange(len(low))
    first, second = high.copy(), low.copy()
    first[rows, cut] = second[rows, cut] = 0.5 * (low[rows, cut] + high[rows, cut])
    return first, second


def covers_of(space: Space) -> list[Cover]:
    """Return what covers a space: one for each orientation of a position, one for a range."""
    frame, ends = space.region.frame(), space.orientations.range_rad
    assert frame is not None  # asked before, by `designer.proof.encloser.why_not`
    made = []
    if space.orientations.law is not None:  # of listed positions, each a box without size
        turns = space.orientations.at(frame.low).swapaxes(0, 1)
        boxes = [np.hstack([frame.low, turn]) for turn in turns]
        return [Cover(frame, box, box, np.zeros(3)) for box in boxes]
    for turn in space.orientations.turns_rad[: 1 if ends is not None else None]:
        low, high = frame.low, frame.high
        if ends is not None:
            low = np.hstack([low, np.broadcast_to(ends[0], low.shape)])
            high = np.hstack([high, np.broadcast_to(ends[1], high.shape)])
        made.append(Cover(frame, low, high, turn))
    return made


def _cut_at(plan: FloatArray, side: FloatArray) -> FloatArray:
    """Cut convex polygons (n, n_corners, 2), NaN where there is no corner, at a straight line."""
    height = plan @ side[:2] + side[2]
    order = np.argsort(np.isnan(height), axis=1, kind="stable")  # corners first, in their order
    plan = np.take_along_axis(plan, order[..., None], axis=1)
    height = np.take_along_axis(height, order, axis=1)
    last = np.maximum((~np.isnan(height)).sum(axis=1) - 1, 0)
    rows = np.arange(len(plan))
    before, before_height = np.roll(plan, 1, axis=1), np.roll(height, 1, axis=1)
    before[:, 0], before_height[:, 0] = plan[rows, last], height[rows, last]
    with np.errstate(invalid="ignore", divide="ignore"):
        crosses = (height <= 0.0) != (before_height <= 0.0)
        crosses &= ~np.isnan(height) & ~np.isnan(before_height)
        share = before_height / (before_height - height)
        crossing = before + share[..., None] * (plan - before)
    out = np.full((len(plan), 2 * plan.shape[1], 2), np.nan)
    out[:, 0::2] = np.where(crosses[..., None], crossing, np.nan)
    with np.errstate(invalid="ignore"):
        out[:, 1::2] = np.where((height <= 0.0)[..., None], plan, np.nan)
    order = np.argsort(np.isnan(out[..., 0]), axis=1, kind="stable")
    return np.take_along_axis(out, order[..., None], axis=1)[:, : plan.shape[1] + 1]
