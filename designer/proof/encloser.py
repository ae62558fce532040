"""Boxes of poses, and what their enclosures are made from: the middle as the solver has it.

A space is covered by boxes of three coordinates of position, then three or none of rotation. In the
middle of a box the robot is solved; where internal forces are free, at the middles of its faces as
well, to see how they follow the pose. What these answers are worth in all of the box is then for
`enclosure.box` to prove.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.kernel.calling import plain, share_out
from designer.model.cable import Cable
from designer.model.region import BoxFrame
from designer.model.robot import Poses, Robot
from designer.model.space import Space
from designer.statics.geometry import upright_exit_points_m, upright_poses
from designer.statics.inverse import Statics, solve_sagging

FIRST_RAISE, _MIN_RAISE, _MAX_RAISE = 0.25, 2.0**-14, 1.0
"""Relative, of least tension and pull in the middle of a box, so that all of the box keeps them."""
_MAX_FOLLOWED = 0.25
"""Share of its pull by which that of a cable may change in half a box by choice."""
_SHARE = 128
"""Boxes that one thread takes at a time."""
_ULPS = 64.0 * 2.0**-53
BoxEnds = tuple[FloatArray, FloatArray]
"""Low and high corners, each (n, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """The positions of a region by three coordinates, in one orientation or a range of them."""

    frame: BoxFrame  #: what the coordinates of positions are
    low: FloatArray  #: (n_boxes, 3 or 6) corners of boxes that cover it [m or share, rad]
    high: FloatArray
    turn_rad: FloatArray  #: (3,) orientation, where that is no coordinate [rad]

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
    assert frame is not None  # asked before, by `unsupported_reason`
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


def border_m(cover: Cover, boxes: BoxEnds, others: BoxEnds) -> FloatArray:
    """Return the faces that boxes have in common with others, inside the region.

    Parameters
    ----------
    cover : Cover
        Whose coordinates they have.
    ones, others : pair of array (n, 3)
        Low and high corners of boxes that do not overlap.

    Returns
    -------
    array (n_triangles, 3, 3)
        Corners of triangles [m].
    """
    triangles = [np.empty((0, 3, 3))]
    for axis in range(3):
        low, high, plan = cover.cut(*_touching(boxes, others, axis))
        overlaps = (low <= high).all(axis=1)
        low, high, plan = low[overlaps], high[overlaps], plan[overlaps]
        if axis == 2:
            level = np.broadcast_to(low[:, None, 2:], (*plan.shape[:2], 1))
            faces = np.concatenate([plan, level], axis=2)
        else:
            faces = np.stack([low, high, high, low], axis=1)
            faces[:, 1, 2], faces[:, 3, 2] = low[:, 2], high[:, 2]
        triangles += [faces[:, [0, k, k + 1]] for k in range(1, faces.shape[1] - 1)]
    corners = np.concatenate(triangles)
    edges = corners[:, 1:] - corners[:, :1]
    corners = corners[np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) > 0.0]
    return cover.places(corners.reshape(-1, 3))[:, :3].reshape(-1, 3, 3)


def _touching(boxes: BoxEnds, others: BoxEnds, axis: int) -> BoxEnds:
    """Return the common faces across an axis, as boxes that are flat along it."""
    across = [k for k in range(3) if k != axis]
    faces = []
    for side, facing in ((1, 0), (0, 1)):
        at, planes = boxes[side][:, axis], others[facing][:, axis]
        order = np.argsort(planes)
        first, last = (np.searchsorted(planes[order], at, end) for end in ("left", "right"))
        count = last - first
        at_one = np.repeat(np.arange(len(at)), count)
        nth = np.arange(len(at_one)) - np.repeat(np.cumsum(count) - count, count)
        at_other = order[first[at_one] + nth]
        low = np.maximum(boxes[0][at_one], others[0][at_other])
        high = np.minimum(boxes[1][at_one], others[1][at_other])
        low[:, axis] = high[:, axis] = at[at_one]
        overlaps = (low < high)[:, across].all(axis=1)
        faces.append((low[overlaps], high[overlaps]))
    return np.concatenate([low for low, _ in faces]), np.concatenate([high for _, high in faces])


def unsupported_reason(robot: Robot, space: Space) -> str:
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
        from designer.proof.enclosure.box import Scene

        self.cover = cover
        self._robot, self._cable = robot, cable
        ends = (cover.places(corner)[:, :3] for corner in (cover.low, cover.high))
        self._size = np.abs(np.concatenate([robot.exit_points_m, *ends])).max()
        self._least_N = robot.tension_min_N if robot.is_redundant else 0.0
        self._sag = robot.sag_max if robot.is_redundant else None
        weight = float(
            np.mean(cable.weight_N_per_m)
        )  # `unsupported_reason` refuses those that differ
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
        from designer.proof.enclosure.box import BOUND, CUT, ESTIMATE, SPARE, TOLD

        low, high, corners = self.cover.cut(low, high)
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low) * (1.0 + 4.0 * _ULPS) + _ULPS * np.abs(middle)
        steps = 2.0 ** np.ceil(np.log2(np.clip(raised, _MIN_RAISE, _MAX_RAISE)))
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
        from designer.proof.enclosure.box import TOLD, Boxes, bound_range

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
            ahead, ahead_solved = self._solve(middle + step, raised)
            behind, behind_solved = self._solve(middle - step, raised)
            # The smaller difference: where another branch begins on one side, that of the middle.
            before, after = pull - behind, ahead - pull
            change = np.where(np.abs(before) < np.abs(after), before, after)
            change = np.where(
                (ahead_solved & behind_solved)[:, None] & (before * after > 0.0), change, 0.0
            )
            largest_change = _MAX_FOLLOWED * pull
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


def _turning_axes(rotation_vector: FloatArray) -> FloatArray:
    """Return J (n, 3, 3): the turn by rotation vector + d is that by J d after the former."""
    angle2 = np.einsum("ni,ni->n", rotation_vector, rotation_vector)[:, None, None]
    angle = np.sqrt(angle2)
    small = angle < 1e-2
    with np.errstate(invalid="ignore", divide="ignore"):
        half = np.where(angle2 > 0.0, np.sin(0.5 * angle) / angle, 0.5)
        series = 1.0 / 6.0 - angle2 / 120.0 + angle2**2 / 5040.0
        rest = np.where(small, series, (angle - np.sin(angle)) / (angle2 * angle))
    sine = 2.0 * half**2
    cross = -np.cross(np.eye(3)[None], rotation_vector[:, None]).transpose(0, 2, 1)
    return np.asarray(np.eye(3) + sine * cross + rest * (cross @ cross))
