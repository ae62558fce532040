"""What the enclosures of a box are made from: its middle as the product's solver has it.

In the middle of a box of poses the robot is solved; where internal forces are free, at the middles
of its faces as well, to see how they follow the pose. What these answers are worth in all of the
box is then for `enclosure.box` to prove.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.kernel.calling import plain, share_out
from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.model.space import Space
from designer.proof.cover import Cover
from designer.statics.geometry import upright_exit_points_m, upright_poses
from designer.statics.inverse import Statics, solve_sagging

_SHARE = 128
"""Boxes that one thread takes at a time."""
_ULPS = 64.0 * 2.0**-53
FIRST_RAISE, _LEAST_RAISE, _MOST_RAISE = 0.25, 2.0**-14, 1.0
"""Relative, of least tension and pull in the middle of a box, so that all of the box keeps them."""
_MOST_FOLLOWED = 0.25
"""Share of its pull by which that of a cable may change in half a box by choice."""


def why_not(robot: Robot, space: Space) -> str:
    """Return why nothing can be proved of a robot in a space; empty where something can."""
    if robot.pulley_radius_m != 0.0:
        return "cables that run over pulleys are not enclosed"
    if not robot.has_equal_cables:
        return "cables to which different things are attached are not enclosed"
    if space.region.frame() is None:
        return "a region of this kind is not covered by boxes"
    if space.orientations.law is not None and not space.region.is_discrete:
        return "orientations that follow the position are not enclosed"
    return ""


@dataclass(frozen=True, slots=True, eq=False)
class BoxBounds:
    """What an encloser tells of boxes (n_boxes,): bounds, coordinates to halve, worst corners.

    ``estimate`` is what the cable is about used to in the worst corners ``worst`` (n_boxes, k);
    ``solved`` tells whether the product's solver has an answer in the ``middle``; ``needs`` is by
    how much least tensions, and pulls that keep the sag, had to be raised there, relative, NaN
    where that is not known.
    """

    bound: FloatArray
    cut: IntArray
    estimate: FloatArray
    worst: FloatArray
    middle: FloatArray
    solved: BoolArray
    needs: FloatArray


class Encloser:
    """Bounds tensions in boxes of one cover."""

    def __init__(self, robot: Robot, cable: Cable, cover: Cover) -> None:
        from designer.proof.enclosure.tables import Scene

        self.cover = cover
        self._robot, self._cable = robot, cable
        ends = (cover.places(corner)[:, :3] for corner in (cover.low, cover.high))
        self._size = np.abs(np.concatenate([robot.exit_points_m, *ends])).max()
        self._least_N = robot.tension_min_N if robot.is_redundant else 0.0
        self._sag = robot.sag_max if robot.is_redundant else None
        weight = float(np.mean(cable.weight_N_per_m))  # `why_not` refuses those that differ
        levers = np.linalg.norm(robot.attachments_m, axis=1)
        self._reach = float(levers.max()) or 1.0
        self._fuzz = _ULPS * max(float(self._size + self._reach), 1.0)
        self._scene = Scene(
            rows=robot.balance_rows,
            kappa=weight / cable.axial_stiffness_N,
            strength=cable.allowable_tension_N / weight,
            least=self._least_N / weight,
            sag=self._sag or np.inf,
            inverse_weight=1.0 / weight,
            reach=self._reach,
            fuzz=self._fuzz,
            axes=plain(robot.upright @ cover.frame.axes),
            level=1.0,
        )

    def utilisation(self, places: FloatArray) -> FloatArray:
        """Return largest over allowable tension (n,) in places (n, 6); inf where none is found."""
        statics = solve_sagging(self._robot, Poses.at(places), self._cable)
        used = statics.largest_tension_N / self._cable.allowable_tension_N
        return np.where(statics.is_solved, used, np.inf)

    def bound(
        self, low: FloatArray, high: FloatArray, raised: FloatArray, level: float
    ) -> BoxBounds:
        """Bound the largest utilisation in boxes (n, k), where one of `level` would do.

        Least tensions are ``raised`` (n,) in their middles, sags lowered.
        """
        from designer.proof.enclosure.tables import BOUND, CUT, ESTIMATE, SPARE, TOLD

        low, high, corners = self.cover.cut(low, high)
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low) * (1.0 + 4.0 * _ULPS) + _ULPS * np.abs(middle)
        steps = 2.0 ** np.ceil(np.log2(np.clip(raised, _LEAST_RAISE, _MOST_RAISE)))
        pull, solved, follow = self._pulls(middle, half, steps)
        out = self._enclose(middle, half, corners, pull, follow, level)
        return BoxBounds(
            bound=np.where(solved, out[:, BOUND], np.inf),
            cut=out[:, CUT].astype(np.int64),
            estimate=np.nan_to_num(out[:, ESTIMATE], nan=-np.inf),
            worst=middle + out[:, TOLD:],
            middle=middle,
            solved=solved,
            needs=steps - out[:, SPARE],
        )

    def compile(self) -> None:
        """Have the machine code of `bound` made, before any pull is known."""
        low, _, corners = self.cover.cut(self.cover.low[:1], self.cover.high[:1])
        pull = np.ones((1, self._robot.n_cables))
        follow = np.zeros((*pull.shape, low.shape[1]))
        self._enclose(low, np.zeros_like(low), corners, pull, follow, 1.0)

    def _enclose(
        self,
        middle: FloatArray,
        half: FloatArray,
        corners: FloatArray,
        pull: FloatArray,
        follow: FloatArray,
        level: float,
    ) -> FloatArray:
        """Return what the kernel tells of boxes, a row each."""
        from designer.proof.enclosure.box import bound_range
        from designer.proof.enclosure.tables import TOLD, Boxes

        upright = upright_poses(self._robot, Poses.at(self.cover.places(middle)))
        rotation = upright.rotations
        levers = np.einsum("bij,nj->bni", rotation, self._robot.attachments_m)
        start = upright_exit_points_m(self._robot)
        load = np.repeat(self._robot.loads_N(), len(middle), axis=0)
        for point_m, pull_N in self._robot.turning_pulls_N:
            load[:, 3:] += np.cross(rotation @ point_m, pull_N)
        turns, load_turns, bent = self._turns(middle, half, levers, rotation)
        boxes = Boxes(
            half=half,
            corners=corners - middle[:, None, :2],
            vectors=start - upright.position_m[:, None] - levers,
            levers=levers,
            turns=turns,
            load=load,
            load_turns=load_turns,
            bent=bent,
            pull=pull,
            follow=follow,
        )
        out = np.empty((len(middle), TOLD + middle.shape[1]))
        share_out(
            bound_range,
            len(middle),
            _SHARE,
            self._scene._replace(level=level),
            Boxes(*map(np.ascontiguousarray, boxes)),
            out,
        )
        return out

    def _turns(
        self,
        middle: FloatArray,
        half: FloatArray,
        levers: FloatArray,
        rotation: FloatArray,
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return slopes of levers and of the load's moment with the turn, and how far others are.

        The rotation is the exponential of a skew matrix, so that its derivative changes by no more
        than the angle between two turns; a slope from the middle is the mean of derivatives on the
        way, hence within half of that.
        """
        count, n = levers.shape[:2]
        if middle.shape[1] == 3:
            return np.zeros((count, n, 3, 0)), np.zeros((count, 3, 0)), np.zeros((count, n + 1))
        axes = _turning_axes(middle[:, 3:]).transpose(0, 2, 1) @ self._robot.upright.T
        turns = np.cross(axes[:, None], levers[:, :, None])
        load_turns, moment = np.zeros_like(axes), 0.0
        for point_m, pull_N in self._robot.turning_pulls_N:
            load_turns += np.cross(np.cross(axes, (rotation @ point_m)[:, None]), pull_N)
            moment += float(np.linalg.norm(point_m) * np.linalg.norm(pull_N))
        size = np.append(np.linalg.norm(self._robot.attachments_m, axis=1), moment)
        bent = (0.5 * np.linalg.norm(half[:, 3:], axis=1)[:, None] + _ULPS) * size * (1.0 + _ULPS)
        return turns.transpose(0, 1, 3, 2), load_turns.transpose(0, 2, 1), bent

    def _pulls(
        self, middle: FloatArray, half: FloatArray, raised: FloatArray
    ) -> tuple[FloatArray, BoolArray, FloatArray]:
        """Solve the middles; where internal forces are free, see how they follow the pose."""
        pull, solved = self._solve(middle, raised)
        follow = np.zeros((*pull.shape, middle.shape[1]))
        if not self._robot.is_redundant:
            return pull, solved, follow
        for d in np.flatnonzero(half.max(axis=0) > _ULPS * self._size):
            step = np.zeros_like(half)
            step[:, d] = half[:, d]
            ahead, there = self._solve(middle + step, raised)
            behind, too = self._solve(middle - step, raised)
            # The smaller difference: where another branch begins on one side, that of the middle.
            before, after = pull - behind, ahead - pull
            change = np.where(np.abs(before) < np.abs(after), before, after)
            change = np.where((there & too)[:, None] & (before * after > 0.0), change, 0.0)
            largest_change = _MOST_FOLLOWED * pull
            follow[..., d] = np.clip(change, -largest_change, largest_change) / half[:, d, None]
        return pull, solved, follow

    def _solve(self, coordinates: FloatArray, raised: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return pulls (n, n_cables) of unit weight, and where there are any."""
        pull, solved = np.ones((len(raised), self._robot.n_cables)), np.zeros(len(raised), np.bool_)
        if self._least_N == 0.0 and self._sag is None:
            raised = np.zeros(len(raised))
        for share in np.unique(raised):
            at = np.flatnonzero(raised == share)
            robot = replace(
                self._robot,
                tension_min_N=(1.0 + share) * self._least_N,
                sag_max=self._robot.sag_max / (1.0 + share),
            )
            poses = Poses.at(self.cover.places(coordinates[at]))
            statics = solve_sagging(robot, poses, self._cable)
            pulls = _pulls_of(statics, self._cable)
            solved[at] = statics.is_solved & np.isfinite(pulls).all(axis=1)
            pull[at] = np.where(solved[at][:, None], pulls, 1.0)
        return pull, solved


def _pulls_of(statics: Statics, cable: Cable) -> FloatArray:
    """Return horizontal force over horizontal distance and weight per length.

    Where the cable is all but vertical, by its upward pull: with y of `enclosure.cable`.
    """
    weight, geometry = cable.weight_N_per_m, statics.geometry()
    X, D, length = geometry.horizontal_distance_m, geometry.drop_m, statics.length_m
    kappa = weight / cable.axial_stiffness_N
    with np.errstate(invalid="ignore", divide="ignore"):
        level = statics.force_x_N / (weight * X)
        share = (-statics.force_z_N / weight + 0.5 * length) / D
        y = share * length / (1.0 - kappa * share * length)
        upright = 1.0 / (2.0 * np.arctanh(0.5 * length / y) + kappa * length)
    return np.where(1e-3 * np.abs(D) > X, upright, level)


def _turning_axes(turn: FloatArray) -> FloatArray:
    """Return J (n, 3, 3): the turn by rotation vector + d is that by J d after the former."""
    angle2 = np.einsum("ni,ni->n", turn, turn)[:, None, None]
    angle = np.sqrt(angle2)
    small = angle < 1e-2
    with np.errstate(invalid="ignore", divide="ignore"):
        half = np.where(angle2 > 0.0, np.sin(0.5 * angle) / angle, 0.5)
        series = 1.0 / 6.0 - angle2 / 120.0 + angle2**2 / 5040.0
        rest = np.where(small, series, (angle - np.sin(angle)) / (angle2 * angle))
    sine = 2.0 * half**2
    cross = -np.cross(np.eye(3)[None], turn[:, None]).transpose(0, 2, 1)
    return np.asarray(np.eye(3) + sine * cross + rest * (cross @ cross))
