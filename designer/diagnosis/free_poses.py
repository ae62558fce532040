"""Poses that nobody measured, taken row by row from what was read.

Lengths and tensions of all cables are twice as many readings as a row's balance has unknowns: its
pose, and one internal force for each cable to spare, together as many as cables. For any effects
each row is put where it suits its own readings best; what is left then is a residual of those
effects alone (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973). The work is
linear in the rows.

Of exit points that were not measured either, nothing tells where their frame is. All exit points
and all poses may move together, as a rigid body, and no length changes; where the scale of every
winch is unknown as well, they may grow. Coordinates of poses that were measured in part exclude
what would change them. As many coordinates of exit points stay as drawn as there are such motions
left; what is fitted is reported in that frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import HUBER, huber, jacobian, starting_vector
from designer.diagnosis.problem import Kind, Predictor, Problem, kind_of, readings_of
from designer.diagnosis.statistics import SIGNIFICANCE
from designer.effects.effect import Effect, Readings, Setting, frame_size_m
from designer.model.measurements import UNIT_NOISE, Measured, Noise
from designer.model.region import Region
from designer.model.robot import Machine, Poses, Robot
from designer.statics.forward import moved_poses
from designer.statics.geometry import cable_geometry

ABSORBED = "taken up by the estimated poses"
"""Why an effect cannot be identified."""
_CANDIDATES = 4000
"""Places to start from: neighbours are a sixteenth of the region's side apart."""
_POSE_STEP = 1e-6
"""Over the frame's size: slopes to six digits, as the catenaries have ten."""
_FAR_LOSS = 4.0
"""Over the least loss of a set of effects: where a start is not near what was the best."""
_TOLERANCE = 5e-2
"""Of the noise, or of what is left where that is more: the rest of the way is straight, to a small
share of this."""
_WEIGHT_TOLERANCE = 1e-7
"""Of the noise: what weights may still change, as slopes over short steps show more."""
_UNHELD = 1e9
"""What is left of a reading where the model cannot hold the pose: worse than any error."""


@dataclass(eq=False)
class FreePredictor(Predictor):
    """Predicts readings of rows without poses, each where it suits its own readings best."""

    _near: dict[Kind, tuple[Poses, FloatArray]] = field(init=False, default_factory=dict)
    _best: dict[Kind, tuple[float, Poses]] = field(init=False, default_factory=dict)
    _first: Poses = field(init=False)

    def __post_init__(self) -> None:
        """Keep where each row started: it starts there again where other effects lose it."""
        self._first = self.measured.poses

    @property
    def row_unknowns(self) -> int:
        """The pose, and the internal forces where tensions tell them."""
        robot = self.machine.robot
        return robot.n_cables if self.has_tensions else robot.degrees_of_freedom

    @property
    def has_tensions(self) -> bool:
        """Whether internal forces can be taken from what was read.

        Lengths alone tell the pose and how well the cables fit together. Internal forces are then
        the least that hold the platform, as the robot's least tension has them.
        """
        return bool(np.isfinite(self.measured.tension_N).any())

    def placed(self, settings: Sequence[Setting]) -> Measured:
        """Return the rows; without readings where internal forces shall not follow them."""
        placed = super().placed(settings)
        every = np.ones(placed.n_rows, dtype=np.bool_)
        return placed if self.has_tensions else placed.without_readings(every)

    def __call__(self, settings: Sequence[Setting], noise: Noise = UNIT_NOISE) -> Readings:
        """Return what the sensors would show with these effects, in the poses that suit them."""
        return self._remembered(settings, noise, self._nearest)[1]

    def surroundings(self, settings: Sequence[Setting], noise: Noise = UNIT_NOISE) -> Readings:
        """Return lengths and tensions that a residual may go with."""
        return self(settings, noise)

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings can be trusted in the poses that suit these effects."""
        if self.spare_cables:
            self._nearest(settings, noise)
        return super().trust_anew(settings, noise)

    def poses(self, settings: Sequence[Setting], noise: Noise) -> Poses:
        """Return the poses that suit the readings with these effects."""
        self._nearest(settings, noise)
        return self.measured.poses

    def _nearest(self, settings: Sequence[Setting], noise: Noise) -> tuple[Readings, Readings]:
        """Put each row where its robust loss is least; Gauss-Newton, with slopes that are kept."""
        kind = kind_of(settings, noise)
        start = self._near.get(kind, self._near.get((noise,)))
        poses, slopes = start if start else (self.measured.poses, None)
        answer, residual = self._left_at(poses, settings, noise)
        least, best_poses = self._best.get(kind, (np.inf, poses))
        if (
            _loss(residual).sum() > _FAR_LOSS * least
        ):  # from far away a row may stay in another balance
            at_best = self._left_at(best_poses, settings, noise)[1]
            poses, slopes = _select(_loss(at_best) < _loss(residual), best_poses, poses), None
            answer, residual = self._left_at(poses, settings, noise)
        is_lost = np.asarray((np.abs(residual) >= _UNHELD).any(axis=1))
        if is_lost.any():  # without a slope it would never come back
            poses, slopes = _select(is_lost, self._first, poses), None
            answer, residual = self._left_at(poses, settings, noise)
        share = np.ones(len(residual))
        for _ in range(12):  # turns at most
            if slopes is None:
                slopes = self._slopes_at(poses, residual, settings, noise)
            for _ in range(4):  # steps with these slopes: near the end two will do
                step = _step(slopes, residual)
                rest = np.einsum("rcp,rp->rc", slopes, step)
                still = _TOLERANCE * np.maximum(1.0, np.abs(residual).max(axis=1))
                if np.all(np.abs(rest).max(axis=1) < still):
                    self._near[kind] = poses, slopes
                    if _loss(residual).sum() < least:
                        self._best[kind] = float(_loss(residual).sum()), poses
                    # And a last short step, which takes that off what is left.
                    return answer[0], self._moved_by(answer[1], rest, noise)
                trial = moved_poses(self.machine.robot, poses, share[:, None] * step)
                answer, residual_trial = self._left_at(trial, settings, noise)
                closer = _loss(residual_trial) <= _loss(residual)
                poses = _select(closer, trial, poses)
                residual = np.where(closer[:, None], residual_trial, residual)
                share = np.where(closer, np.minimum(1.0, 4.0 * share), 0.25 * share)
                if not closer.all():  # slopes from elsewhere may lead the wrong way
                    answer, residual = self._left_at(poses, settings, noise)
                    break
            slopes = None
        self._near[kind] = poses, self._slopes_at(poses, residual, settings, noise)
        return self._left_at(poses, settings, noise)[0]

    def _moved_by(self, displayed: Readings, change: FloatArray, noise: Noise) -> Readings:
        """Return what is shown a change of all that is left further (n_rows, …)."""
        n_cables, off = self.machine.robot.n_cables, displayed.coordinates_off
        readings, coordinates = np.split(change, [2 * n_cables], axis=1)
        stacked = displayed.stacked + noise.of_channels(n_cables) * readings
        length_m, tension_N = np.hsplit(stacked, 2)
        return Readings(length_m, tension_N, off if off is None else off - coordinates)

    def _left_at(
        self, poses: Poses, settings: Sequence[Setting], noise: Noise
    ) -> tuple[tuple[Readings, Readings], FloatArray]:
        """Return true and shown readings in poses, and what is left in units of noise."""
        measured = self.measured = replace(self.measured, poses=poses)
        if self.spare_cables:
            answer = self._with_forces(settings, noise)
        else:
            true, _ = self._physical(settings, noise)
            answer = true, self._shown(true, settings)
        displayed = answer[1]
        sigma = noise.of_channels(self.machine.robot.n_cables)
        residual = (measured.readings - displayed.stacked) / sigma
        residual = np.where(np.isnan(residual), _UNHELD, residual)
        residual = np.where(np.isfinite(measured.readings), residual, 0.0)
        if measured.coordinates is None:
            return answer, residual
        off = measured.coordinates.scaled_residuals(poses)
        answer = answer[0], replace(displayed, coordinates_off=off)
        return answer, np.hstack([residual, off])

    def _slopes_at(
        self, poses: Poses, residual: FloatArray, settings: Sequence[Setting], noise: Noise
    ) -> FloatArray:
        """Return how much less is left for a step of each degree of freedom (rows, …, dof)."""
        robot = self.machine.robot
        step_m = _POSE_STEP * frame_size_m(self.machine)
        slopes = np.empty((*residual.shape, robot.degrees_of_freedom))
        for k in range(robot.degrees_of_freedom):
            step = np.zeros((len(residual), robot.degrees_of_freedom))
            step[:, k] = step_m
            residual_moved = self._left_at(moved_poses(robot, poses, step), settings, noise)[1]
            is_held = np.maximum(np.abs(residual), np.abs(residual_moved)) < _UNHELD
            slopes[..., k] = np.where(is_held, (residual - residual_moved) / step_m, 0.0)
        self.measured = replace(self.measured, poses=poses)
        return slopes


def first_poses(machine: Machine, measured: Measured, region: Region) -> Poses:
    """Return for each row the place, of many in a region, whose readings are most like its own.

    The platform is level there. Lengths and tensions count over their scatter in the region.

    The machine has the declared effects.
    """
    robot = machine.robot
    places = np.concatenate(list(region.samples_m(_CANDIDATES, "low_discrepancy", 0)))
    readings = readings_of(machine, Poses.at(places))
    if np.isnan(measured.tension_N).all():  # what pulls the cables is not known: rather straight
        chord_m = cable_geometry(robot, Poses.at(places)).chord_m
        readings = replace(readings, length_m=chord_m + 0.0 * readings.length_m)
    stacked = readings.stacked
    scale = np.maximum(np.nanstd(stacked, axis=0), 1e-12)
    unlike = np.where(np.isnan(stacked), np.inf, 0.0).sum(axis=1)  # what the machine cannot hold
    rows = measured.readings
    if measured.coordinates is not None:
        rows = np.hstack([rows, measured.coordinates.values[:, :3]])
        stacked = np.hstack([stacked, places])
        scale = np.hstack([scale, np.maximum(np.std(places, axis=0), 1e-12)])
    nearest = [
        int(np.argmin(np.nansum(((row - stacked) / scale) ** 2, axis=1) + unlike)) for row in rows
    ]
    rotation = np.eye(3) if robot.is_point_mass else np.tile(np.eye(3), (measured.n_rows, 1, 1))
    poses = Poses(places[nearest], rotation)
    return poses if measured.coordinates is None else measured.coordinates.imposed_on(poses)


def absorbed_by_poses(
    problem: Problem, effects: Sequence[Effect], unconditional: Sequence[Effect], rows: BoolArray
) -> list[tuple[str, str]]:
    """Return effects that poses take up, each with the reason.

    Such an effect, even as large as an engineer would believe, would leave less in the readings
    than a search takes for chance.
    """
    from scipy.stats import chi2

    answer = []
    for effect in effects:
        all_effects = [*unconditional, effect]
        slopes = jacobian(problem, all_effects, starting_vector(all_effects, (), {}))[rows]
        effect_slopes = np.nan_to_num(
            slopes[..., -len(effect.parameters) :]
        )  # 0 where nothing was read
        largest = [max(abs(end - p.neutral) for end in p.plausible) for p in effect.parameters]
        gain = float(np.max(np.sum(effect_slopes**2, axis=(0, 1)) * np.square(largest)))
        if chi2.sf(gain, len(effect.parameters)) * len(effects) > SIGNIFICANCE:
            size = f"{np.sqrt(gain):.2g} standard deviations in all at its largest plausible value"
            answer.append((effect.key, f"{ABSORBED}: {size}"))
    return answer


def _step(slopes: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the Gauss-Newton step of each row (n_rows, dof): the least robust loss, if linear.

    Outliers are weighted down, as they are after the step.
    """
    is_held = np.abs(residual) < _UNHELD
    rest, step = residual, np.zeros((len(residual), slopes.shape[-1]))
    for _ in range(30):  # weights anew: where none stands off, the second time changes nothing
        weight = np.where(is_held, np.minimum(1.0, HUBER / np.maximum(np.abs(rest), HUBER)), 0.0)
        weighted = slopes * weight[..., None]
        square = np.einsum("rcp,rcq->rpq", weighted, slopes)
        pull = np.einsum("rcp,rc->rp", weighted, residual)
        # Nothing moves where nothing was read; no slope has the last digits of a double.
        least = 1e-13 * np.trace(square, axis1=1, axis2=2) + np.finfo(np.float64).tiny
        ridge = least[:, None, None] * np.eye(square.shape[-1])
        step = np.asarray(np.linalg.solve(square + ridge, pull[..., None])[..., 0])
        before, rest = rest, residual - np.einsum("rcp,rp->rc", slopes, step)
        if not (
            is_held & (np.abs(rest - before) > _WEIGHT_TOLERANCE) & (np.abs(rest) > HUBER)
        ).any():
            break
    return step


def _loss(values: FloatArray) -> FloatArray:
    return np.asarray(huber(values).sum(axis=1))


def _select(mask: BoolArray, poses: Poses, alternative: Poses) -> Poses:
    """Return the poses of one where ``mask`` (n_rows,), else of the other."""
    rotation = poses.rotation
    if rotation.ndim > 2:
        rotation = np.where(mask[:, None, None], rotation, alternative.rotation)
    return Poses(np.where(mask[:, None], poses.position_m, alternative.position_m), rotation)


# The frame of exit points that were not measured.

_AXES = ("x_m", "y_m", "z_m")
_MOTIONS = ("x", "y", "z", "the turn about x", "the turn about y", "the turn about z", "the scale")
_RANK_RTOL = 1e-6
"""Of a motion that is as large as the frame: rounding."""
_MOTION_STEP, _LEAST_CHANGE = 1e-4, 1e-3
"""Of a motion [m], for its slopes; and what of it changes no coordinate."""


def with_frame_held(
    given: Sequence[Effect], robot: Robot, measured: Measured
) -> tuple[tuple[Effect, ...], tuple[str, ...]]:
    """Return what is unknown less the coordinates that hold the frame, and a note that names them.

    The rows have no poses, or poses in part; where they roughly are is known.
    """
    unknown = {e.cable: {p.name for p in e.parameters} for e in given if e.id == "anchor_offset"}
    if not unknown:
        return tuple(given), ()
    free = np.array([[axis in unknown.get(k, ()) for axis in _AXES] for k in _cables(robot)])
    has_tensions = bool(np.isfinite(measured.tension_N).any())
    scales = {e.cable for e in given if e.id == "winch_scale"}
    may_grow = scales >= set(_cables(robot)) or any(e.id == "drum_scale" for e in given)
    motions = _motions_left(robot, measured, free, is_level=has_tensions, may_grow=may_grow)
    held = _held_coordinates(robot, motions)
    across = {axis for axis, share in zip(_AXES, np.abs(robot.level[1]), strict=True) if share == 1}
    still = {(cable, axis) for cable in unknown for axis in across if robot.is_planar} | set(held)
    effects = [
        replace(e, parameters=tuple(p for p in e.parameters if (e.cable, p.name) not in still))
        if e.id == "anchor_offset" and e.cable is not None
        else e
        for e in given
    ]
    names = [f"{axis[0]} of exit point {cable}" for cable, axis in held]
    shares = np.sum(motions**2, axis=1)
    unread = [name for name, share in zip(_MOTIONS, shares, strict=True) if share > 1e-6]
    note = (
        f"the frame is held by {', '.join(names)}, which stay as drawn: nothing read tells "
        f"{', '.join(unread)}"
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
    before = measured.coordinates.scaled_residuals(poses)
    columns = []
    for step_m, turn in zip(steps_m, _MOTION_STEP * turns, strict=True):
        rotation = poses.rotation
        if rotation.ndim > 2:
            rotation = Rotation.from_rotvec(turn).as_matrix() @ rotation
        moved = Poses(poses.position_m + _MOTION_STEP * step_m, rotation)
        columns.append(
            (measured.coordinates.scaled_residuals(moved) - before) * measured.coordinates.noise
        )
    return np.reshape(columns, (7, -1)).T / _MOTION_STEP


def _motions_left(
    robot: Robot, measured: Measured, free: BoolArray, *, is_level: bool, may_grow: bool
) -> FloatArray:
    """Return an orthonormal basis of the motions that change no reading (7, n)."""
    from scipy.linalg import null_space

    motions = _motions(robot, robot.exit_points_m).reshape(7, -1).T
    changes = _changes_read(robot, measured)
    # What poses that are all about alike would tell is lost in the noise.
    impossible = [motions[~free.ravel()], np.where(np.abs(changes) < _LEAST_CHANGE, 0.0, changes)]
    level = robot.level
    if robot.is_planar:
        impossible += [_rows(level[1], 0), _rows(level[0], 3), _rows(level[2], 3)]
    if is_level:  # the vertical shows in the tensions
        impossible += [_rows(level[0], 3), _rows(level[1], 3)]
    if not may_grow:
        impossible.append(_rows(np.ones(1), 6))
    return np.asarray(null_space(np.concatenate(impossible), rcond=_RANK_RTOL))


def _held_coordinates(robot: Robot, unread: FloatArray) -> list[tuple[int, str]]:
    """Return coordinates of exit points, as many as motions that change no reading.

    The ones that each motion moves most, by a QR decomposition with pivoting.
    """
    from scipy.linalg import qr

    if unread.size == 0:
        return []
    motions = _motions(robot, robot.exit_points_m).reshape(7, -1).T
    order = qr((motions @ unread).T, mode="r", pivoting=True)[1]
    cables, axes = np.divmod(np.sort(order[: unread.shape[1]]), 3)
    return [(int(cable) + 1, _AXES[axis]) for cable, axis in zip(cables, axes, strict=True)]


def _rows(values: FloatArray, first: int) -> FloatArray:
    """Return one row of conditions on the seven motions."""
    row = np.zeros((1, 7))
    row[0, first : first + len(values)] = values
    return row


def _cables(robot: Robot) -> range:
    return range(1, robot.n_cables + 1)
