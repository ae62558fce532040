"""What nothing measured tells of exit points that were not measured either: where their frame is.

All exit points and all poses may move together, as a rigid body, and no length changes; where the
scale of every winch is unknown as well, they may grow. Coordinates of poses that were measured in
part exclude what would change them. As many coordinates of exit points stay as drawn as there are
such motions left; what is fitted is told in that frame.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray
from designer.effects.effect import Effect
from designer.model.measured_data import Measured
from designer.model.robot import Poses, Robot

_AXES = ("x_m", "y_m", "z_m")
_MOTIONS = ("x", "y", "z", "the turn about x", "the turn about y", "the turn about z", "the scale")
_NOTHING = 1e-6
"""Of a motion that is as large as the frame: rounding."""
_STEP, _LEAST = 1e-4, 1e-3
"""Of a motion [m], for its slopes; and what of it changes no coordinate."""


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
        Rows without poses, or with poses in part; where they roughly are.
    """
    unknown = {e.cable: {p.name for p in e.parameters} for e in given if e.id == "anchor_offset"}
    if not unknown:
        return tuple(given), ()
    free = np.array([[axis in unknown.get(k, ()) for axis in _AXES] for k in _cables(robot)])
    has_tensions = bool(np.isfinite(measured.tension_N).any())
    scales = {e.cable for e in given if e.id == "winch_scale"}
    may_grow = scales >= set(_cables(robot)) or any(e.id == "drum_scale" for e in given)
    left = _motions_left(robot, measured, free, is_level=has_tensions, may_grow=may_grow)
    held = _held(robot, left)
    across = {axis for axis, share in zip(_AXES, np.abs(robot.level[1]), strict=True) if share == 1}
    still = {(cable, axis) for cable in unknown for axis in across if robot.is_planar} | set(held)
    effects = [_without(effect, still) for effect in given]
    names = [f"{axis[0]} of exit point {cable}" for cable, axis in held]
    note = (
        f"the frame is held by {', '.join(names)}, which stay as drawn: nothing read tells "
        f"{_named(left)}"
    )
    return tuple(effect for effect in effects if effect.parameters), (note,) * bool(held)


def _motions(robot: Robot, points: FloatArray) -> FloatArray:
    """Return how points (n, 3) [m] move by `_MOTIONS` about the exit points' middle (7, n, 3).

    By a metre; turns and growth as far, over the size of the frame.
    """
    exits = robot.exit_points_m
    from_middle = (points - exits.mean(axis=0)) / np.ptp(exits, axis=0).max()
    turned = np.cross(np.eye(3)[:, None], from_middle)
    shifted = np.broadcast_to(np.eye(3)[:, None], turned.shape)
    return np.concatenate([shifted, turned, from_middle[None]])


def _changes_read(robot: Robot, measured: Measured) -> FloatArray:
    """Return by how much each motion changes the coordinates that were measured (n_rows 6, 7)."""
    if measured.coordinates is None:
        return np.empty((0, 7))
    poses = measured.poses
    steps_m = _motions(robot, poses.position_m)
    turns = np.zeros((7, 3))
    turns[3:6] = np.eye(3) / np.ptp(robot.exit_points_m, axis=0).max()
    before = measured.coordinates.off(poses)
    columns = []
    for step_m, turn in zip(steps_m, _STEP * turns, strict=True):
        rotation = poses.rotation
        if rotation.ndim > 2:
            rotation = Rotation.from_rotvec(turn).as_matrix() @ rotation
        moved = Poses(poses.position_m + _STEP * step_m, rotation)
        columns.append((measured.coordinates.off(moved) - before) * measured.coordinates.noise)
    return np.reshape(columns, (7, -1)).T / _STEP


def _motions_left(
    robot: Robot, measured: Measured, free: BoolArray, *, is_level: bool, may_grow: bool
) -> FloatArray:
    """Return an orthonormal basis of the motions that change no reading (7, n)."""
    from scipy.linalg import null_space

    motions = _motions(robot, robot.exit_points_m).reshape(7, -1).T
    told = _changes_read(robot, measured)
    # What poses that are all about alike would tell is lost in the noise.
    impossible = [motions[~free.ravel()], np.where(np.abs(told) < _LEAST, 0.0, told)]
    level = robot.level
    if robot.is_planar:
        impossible += [_rows(level[1], 0), _rows(level[0], 3), _rows(level[2], 3)]
    if is_level:  # the vertical shows in the tensions
        impossible += [_rows(level[0], 3), _rows(level[1], 3)]
    if not may_grow:
        impossible.append(_rows(np.ones(1), 6))
    return np.asarray(null_space(np.concatenate(impossible), rcond=_NOTHING))


def _held(robot: Robot, left: FloatArray) -> list[tuple[int, str]]:
    """Return coordinates of exit points, as many as motions that change no reading.

    The ones that each motion moves most, by a QR decomposition with pivoting.
    """
    from scipy.linalg import qr

    if left.size == 0:
        return []
    motions = _motions(robot, robot.exit_points_m).reshape(7, -1).T
    order = qr((motions @ left).T, mode="r", pivoting=True)[1]
    cables, axes = np.divmod(np.sort(order[: left.shape[1]]), 3)
    return [(int(cable) + 1, _AXES[axis]) for cable, axis in zip(cables, axes, strict=True)]


def _named(left: FloatArray) -> str:
    """Return what motions that change no reading are called: those that have a share in them."""
    shares = np.sum(left**2, axis=1)
    return ", ".join(name for name, share in zip(_MOTIONS, shares, strict=True) if share > 1e-6)


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
