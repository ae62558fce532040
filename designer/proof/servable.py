r"""Which part of a region no rope can serve, and which part some rope can: volumes from both sides.

Whatever the rope, the wrench of cable i lies in the cone of two rays: that of the straight cable,
with the vector e_i to the exit point, and that of the slackest one, e_i less ν_i |e_i| straight
down, with ν_i from the largest sag (with as many cables as degrees of freedom, which may sag as
they like: that of a force straight down). A wrench y of force f and moment m that is not above zero
with any of them, and above zero with the load, proves that nothing holds the pose (Farkas' lemma):

    e_i · g_i ≤ 0,    e_i · g_i - ν_i |e_i| g_i,z ≤ 0,    g_i = f + m × r_i,    y · load > 0.

In one orientation only e_i changes with the position, linearly, and |e_i| is convex: with the
largest ν_i of a box one y does for all of it if it does at its corners. It is found by a linear
programme, which makes the products as clear as they can be, and is then evaluated with room for
rounding.

That a box can be served is proved with a rope that weighs next to nothing, beside what is attached
along it, and bears any tension.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product

import numpy as np

from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable
from designer.model.robot import Poses, Robot
from designer.model.space import Space
from designer.proof.encloser import (
    BoxEnds,
    Cover,
    Encloser,
    border_m,
    covers_of,
    halves,
    unsupported_reason,
)
from designer.proof.prove import Budget
from designer.statics.geometry import upright_exit_points_m, upright_poses

_LIGHT, _STRONG = 1e-6, 1e9
"""Weight of the rope over the load, and its strength."""
_CLEAR = 1e-10
"""Product of unit vectors beyond which rounding cannot have changed its sign."""
_BATCH = 256
MOST_BOXES = 3000
"""Tried in all: as a rule what is left undecided then is a few per cent."""
_ENOUGH_TO_SEE = 500
"""Boxes of which not one was decided, after which the rest are left."""
_WRENCHES = 8
"""Of those that separated other boxes, tried before a linear programme."""
_SLOPES = np.sinh(np.linspace(-12.0, 12.0, 4801))
_BETWEEN = 1e-3
"""Relative room for what is between two nodes of the table."""
_TWO_SIDES = np.array(list(product((0, 1), repeat=3)))


@dataclass(frozen=True, slots=True, eq=False)
class Servable:
    """Shares of a space, by volume."""

    impossible: float  #: proved that no rope holds the platform there
    possible: float  #: proved that some rope does, if it is light and strong enough
    boxes: int  #: how many were tried
    #: (n, 3, 3) triangles in which that part ends, inside the region, of a prism in one
    #: orientation; else none [m]
    border_m: FloatArray = field(metadata={"json": None})


def servable(robot: Robot, space: Space, budget: Budget) -> Servable | None:
    """Bound the part of a space that no rope can serve; None where that is not to be had.

    That is over pulleys, where the orientation has a range, and without a load.
    """
    load_N = float(np.linalg.norm(robot.loads_N()[0, :3]))
    if (
        unsupported_reason(robot, space)
        or space.orientations.range_rad is not None
        or load_N == 0.0
    ):
        return None
    size = float(np.ptp(np.vstack([robot.exit_points_m, space.region.bounds_m]), axis=0).max())
    density = _LIGHT * load_N / size / STANDARD_GRAVITY_M_PER_S2
    rope = Cable(np.nan, density, np.inf, _STRONG * load_N).with_attached(robot.attached)
    covers = [_Part(robot, rope, cover) for cover in covers_of(space)]
    covers[0].compile()  # which is not counted
    boxes, max_boxes, clock = 0, min(MOST_BOXES, budget.boxes), budget.start()
    while boxes < max_boxes and not clock.is_over:
        part = max(covers, key=lambda cover: cover.largest)
        if part.largest == 0.0:
            break
        boxes += part.step(min(_BATCH, max_boxes - boxes))
        if boxes >= _ENOUGH_TO_SEE and not any(part.no or part.yes for part in covers):
            break
    total = sum(part.whole for part in covers)
    impossible, possible = sum(part.no for part in covers), sum(part.yes for part in covers)
    has_border = space.region.volume_m3 is not None and len(covers) == 1
    border = covers[0].border_m() if has_border else np.empty((0, 3, 3))
    return Servable(impossible / total, possible / total, boxes, frozen_array(border))


class _Part:
    """Boxes of one orientation that are not decided yet, and the volumes of those that are."""

    def __init__(self, robot: Robot, rope: Cable, cover: Cover) -> None:
        self._robot, self._cover = robot, cover
        self._encloser = Encloser(robot, rope, cover)
        self._low, self._high, corners = cover.cut(cover.low, cover.high)
        self._volume = cover.share(self._low, self._high, corners)
        self.whole = float(self._volume.sum())
        self.no = self.yes = 0.0
        self._wrenches: list[FloatArray] = []
        self._no: list[BoxEnds] = []
        self._yes: list[BoxEnds] = []

    @property
    def largest(self) -> float:
        return float(self._volume.max(initial=0.0))

    def compile(self) -> None:
        """Have the kernels compiled, on one box."""
        self._encloser.bound(self._low[:1], self._high[:1], np.zeros(1), 1.0)

    def border_m(self) -> FloatArray:
        """Return where boxes that no rope can serve end, and the others begin (n, 3, 3) [m]."""
        return border_m(
            self._cover, _joined(self._no), _joined([*self._yes, (self._low, self._high)])
        )

    def step(self, count: int) -> int:
        """Decide the largest boxes, halve the others; return how many there were."""
        at = np.argsort(-self._volume)[:count]
        low, high, volume = self._low[at], self._high[at], self._volume[at]
        bounds = self._encloser.bound(low, high, np.zeros(len(at)), 1.0)
        yes = np.isfinite(bounds.bound)
        no = ~yes & self._is_impossible(low, high, ~bounds.solved)
        self.yes += float(volume[yes].sum())
        self.no += float(volume[no].sum())
        self._no.append((low[no], high[no]))
        self._yes.append((low[yes], high[yes]))
        undecided = ~yes & ~no & ((high - low).max(axis=1) > 0.0)
        cut = np.where(bounds.solved, bounds.cut, (high - low)[:, :3].argmax(axis=1))[undecided]
        low, high = low[undecided], high[undecided]
        first, second = halves(low, high, cut)
        low, high = np.concatenate([low, second]), np.concatenate([first, high])
        low, high, corners = self._cover.cut(low, high)
        overlaps = (low <= high).all(axis=1)
        rest = np.delete(np.arange(len(self._volume)), at)
        self._low = np.concatenate([self._low[rest], low[overlaps]])
        self._high = np.concatenate([self._high[rest], high[overlaps]])
        more = self._cover.share(low[overlaps], high[overlaps], corners[overlaps])
        self._volume = np.concatenate([self._volume[rest], more])
        return len(at)

    def _is_impossible(self, low: FloatArray, high: FloatArray, mask: BoolArray) -> BoolArray:
        """Tell of which boxes (n, 3) it is proved that no rope holds any of their poses."""
        out = np.zeros(len(low), dtype=np.bool_)
        for k in np.flatnonzero(mask):
            corners = np.tile(low[k], (len(_TWO_SIDES), 1))
            corners[:, :3] = np.where(_TWO_SIDES, high[k, :3], low[k, :3])
            out[k] = self._separates(self._cover.places(corners))
        return out

    def _separates(self, places: FloatArray) -> bool:
        """Tell whether one wrench separates the load from the cones of all poses in a box.

        Of its corners ``places`` (8, n_coordinates).
        """
        from scipy.optimize import linprog

        robot, poses = self._robot, upright_poses(self._robot, Poses.at(places))
        rotation = poses.rotations[0]
        levers = robot.attachments_m @ rotation.T
        reach = float(np.linalg.norm(levers, axis=1).max()) or 1.0
        vectors = upright_exit_points_m(robot) - poses.position_m[:, None] - levers
        down = np.broadcast_to([0.0, 0.0, -1.0], (1, *levers.shape))
        if robot.is_redundant:
            drop = _largest_drop(robot.sag_max, vectors)[:, None] * down
            down = vectors + np.linalg.norm(vectors, axis=-1, keepdims=True) * drop
        forces = np.concatenate([vectors, down])
        moments = np.cross(levers, forces) / reach
        rays = np.concatenate([forces, moments], axis=-1)[..., robot.balance_rows]
        rays = rays.reshape(-1, len(robot.balance_rows))
        size = np.linalg.norm(rays, axis=1, keepdims=True)
        rays = np.divide(rays, size, out=np.zeros_like(rays), where=size > 0.0)
        load = robot.loads_N()[0].copy()
        load[3:] += np.cross(rotation @ robot.platform.centre_of_mass_m, robot.centre_pull_N)
        load[3:] /= reach
        load = load[robot.balance_rows] / np.linalg.norm(load[robot.balance_rows])
        m = len(load)

        def is_apart(y: FloatArray) -> bool:
            return bool((rays @ y).max() < -_CLEAR and load @ y > _CLEAR)

        if any(map(is_apart, self._wrenches)):
            return True
        # Largest margin z: rays · y + z ≤ 0 and load · y ≥ z, components of y at most one.
        A = np.vstack([np.column_stack([rays, np.ones(len(rays))]), np.append(-load, 1.0)])
        solution = linprog(
            np.append(np.zeros(m), -1.0), A_ub=A, b_ub=np.zeros(len(A)),
            bounds=[(-1.0, 1.0)] * m + [(None, 1.0)],
        )  # fmt: skip
        if solution.x is None or not is_apart(solution.x[:m]):
            return False
        self._wrenches = [solution.x[:m], *self._wrenches[: _WRENCHES - 1]]
        return True


def _largest_drop(sag_max: float, vectors: FloatArray) -> FloatArray:
    """Return ν (n_cables,) of the slackest taut cables with vectors (n, n_cables, 3) in a box.

    The largest over all slopes that the box may have, with a node of the table more on either side.
    """
    high, level = vectors[..., 2], np.linalg.norm(vectors[..., :2], axis=-1)
    # The nearest point of the box in plan may be none of its corners.
    spread = np.linalg.norm(np.ptp(vectors[..., :2], axis=0), axis=-1)
    nearest = np.maximum(level.min(axis=0) - spread, 1e-12)
    first = np.searchsorted(_SLOPES, np.minimum(high.min(axis=0), 0.0) / nearest) - 2
    last = np.searchsorted(_SLOPES, np.maximum(high.max(axis=0), 0.0) / nearest) + 2
    table = _drops(sag_max)
    ends = zip(first.clip(0), last.clip(max=len(table)), strict=True)
    return np.array([table[a:b].max(initial=0.0) for a, b in ends])


@lru_cache(maxsize=8)
def _drops(sag_max: float) -> FloatArray:
    """Return ν at the slopes of the table: by how much a force leaves its chord at the platform.

    Of inextensible cables at the largest sag; those that stretch are straighter. With a chord of
    horizontal distance 1 and drop m, and the pull p, the force is p (1, m) less ν p chord upward.
    """
    from designer.kernel.least_pull import largest_theta

    chord = np.hypot(1.0, _SLOPES)
    theta = largest_theta(sag_max, np.abs(_SLOPES))
    length = np.sqrt(_SLOPES**2 + (np.sinh(theta) / theta) ** 2)
    lift = 0.5 * (_SLOPES / np.tanh(theta) - length)  # at p = 1 / (2 θ)
    return np.asarray((1.0 + _BETWEEN) * (_SLOPES - 2.0 * theta * lift) / chord)


def _joined(boxes: list[BoxEnds]) -> BoxEnds:
    low, high = zip(*boxes, strict=True)
    return np.concatenate(low), np.concatenate(high)
