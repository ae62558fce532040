"""What nothing measured tells of exit points that were not measured either: where their frame is.

All exit points and all poses may move together, as a rigid body, and no length changes; where the
scale of every winch is unknown as well, they may grow. As many coordinates of exit points stay as
drawn as there are such motions left; what is fitted is told in that frame.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.effects.effect import Effect
from designer.model.measured_data import Measured
from designer.model.robot import Robot

_AXES = ("x_m", "y_m", "z_m")
_NOTHING = 1e-9
"""Of a motion that is as large as the frame: rounding."""


def in_a_held_frame(
    given: Sequence[Effect], robot: Robot, measured: Measured
) -> tuple[tuple[Effect, ...], tuple[str, ...]]:
    """Return what is unknown less the coordinates that hold the frame, and a note that names them.

    Parameters
    ----------
    given : sequence of Effect
        What is unknown.
    robot : Robot
        As drawn.
    measured : Measured
        Rows without poses.
    """
    unknown = {e.cable: {p.name for p in e.parameters} for e in given if e.id == "anchor_offset"}
    if not unknown:
        return tuple(given), ()
    free = np.array([[axis in unknown.get(k, ()) for axis in _AXES] for k in _cables(robot)])
    has_tensions = bool(np.isfinite(measured.tension_N).any())
    scales = {e.cable for e in given if e.id == "winch_scale"}
    may_grow = scales >= set(_cables(robot)) or any(e.id == "drum_scale" for e in given)
    held = _held(robot, free, is_level=has_tensions, may_grow=may_grow)
    across = {axis for axis, share in zip(_AXES, np.abs(robot.level[1]), strict=True) if share == 1}
    still = {(cable, axis) for cable in unknown for axis in across if robot.is_planar} | set(held)
    effects = [_without(effect, still) for effect in given]
    names = [f"{axis[0]} of exit point {cable}" for cable, axis in held]
    note = f"the frame is held by {', '.join(names)}, which stay as drawn: nothing read tells it"
    return tuple(effect for effect in effects if effect.parameters), (note,) * bool(held)


def _held(
    robot: Robot, free: BoolArray, *, is_level: bool, may_grow: bool
) -> list[tuple[int, str]]:
    """Return coordinates of exit points, as many as motions that change no reading.

    The ones that each motion moves most, by a QR decomposition with pivoting.
    """
    from scipy.linalg import null_space, qr

    points = robot.exit_points_m
    from_middle = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    turned = np.cross(np.eye(3)[:, None], from_middle)  # (3 axes, n_cables, 3)
    shifted = np.broadcast_to(np.eye(3)[:, None], turned.shape)
    motions = np.concatenate([shifted, turned, from_middle[None]]).reshape(7, -1).T
    impossible = [motions[~free.ravel()]]
    level = robot.level
    if robot.is_planar:
        impossible += [_rows(level[1], 0), _rows(level[0], 3), _rows(level[2], 3)]
    if is_level:  # the vertical shows in the tensions
        impossible += [_rows(level[0], 3), _rows(level[1], 3)]
    if not may_grow:
        impossible.append(_rows(np.ones(1), 6))
    left = null_space(np.concatenate(impossible), rcond=_NOTHING)
    if left.size == 0:
        return []
    order = qr((motions @ left).T, mode="r", pivoting=True)[1]
    cables, axes = np.divmod(np.sort(order[: left.shape[1]]), 3)
    return [(int(cable) + 1, _AXES[axis]) for cable, axis in zip(cables, axes, strict=True)]


def _rows(values: FloatArray, first: int) -> FloatArray:
    """Return one row of conditions on the seven motions."""
    row = np.zeros((1, 7))
    row[0, first : first + len(values)] = values
    return row


def _cables(robot: Robot) -> range:
    return range(1, robot.n_cables + 1)


def _without(effect: Effect, still: Collection[tuple[int | None, str]]) -> Effect:
    if effect.id != "anchor_offset" or effect.cable is None:
        return effect
    kept = tuple(p for p in effect.parameters if (effect.cable, p.name) not in still)
    return replace(effect, parameters=kept)
