"""Statics of a cable robot in world axes, one pose at a time, by SciPy: shares nothing with ours.

A cable is followed from the platform toward its exit point along the unstrained length s. With q
the load per unstrained length (weight, ice and wind, one vector) the tension vector is

    t(s) = p - q s,   dr/ds = (1/|t| + 1/EA) t

whose integral is Irvine's elastic catenary (Cable Structures, 1981, section 1.3) written with
vectors: no plane, no vertical. Unknowns of a pose are the pull p on the platform and the free
length of every cable; the equations say that each cable ends where it leaves its support, and that
the pulls carry the platform. Of several internal forces the largest tension over the allowable one
is made smallest, by SLSQP.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.optimize import linprog, minimize, nnls, root
from scipy.spatial.transform import Rotation

NODE, SHARE = np.polynomial.legendre.leggauss(24)
NODE, SHARE = 0.5 * (1.0 + NODE), 0.5 * SHARE
TAUT = 0.4
"""Load on a cable over its least end tension: below, quadrature is exact to rounding."""
CLOSED = 1e-9
"""Of what is left of closure over the chord, and of balance over the load."""


@dataclass(frozen=True)
class Problem:
    """A robot as loaded; vectors along the axes of the world frame, SI units.

    ``arms_m`` (n, 3) are attachments, body frame; ``load_N_per_m`` (n, 3) acts on the cables per
    unstrained length. ``force_N`` and ``moment_Nm`` act at the body's origin, ``centre_force_N``,
    weight and inertia, at ``centre_m``, body frame. ``freedoms`` (dof, 6) are the parts of the
    wrench that the cables have to balance.
    """

    exits_m: np.ndarray
    arms_m: np.ndarray
    load_N_per_m: np.ndarray
    stiffness_N: np.ndarray
    allowable_N: np.ndarray
    mass_kg_per_m: np.ndarray
    force_N: np.ndarray
    moment_Nm: np.ndarray
    centre_m: np.ndarray
    centre_force_N: np.ndarray
    freedoms: np.ndarray
    up: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    radius_m: float = 0.0
    least_N: float = 0.0
    sag_max: float | None = None

    @property
    def n(self) -> int:
        return len(self.exits_m)

    @cached_property
    def scale_N(self) -> float:
        """Size of the load."""
        total = np.linalg.norm(self.force_N) + np.linalg.norm(self.centre_force_N)
        return float(total + np.linalg.norm(self.moment_Nm) / self.reach_m)

    @cached_property
    def reach_m(self) -> float:
        reach = float(np.linalg.norm(self.arms_m, axis=1).max())
        return reach if reach > 0.0 else 1.0

    def without(self, cable: int) -> Problem:
        """Return the problem without a cable, from 1."""
        names = ("exits_m", "arms_m", "load_N_per_m", "stiffness_N", "allowable_N", "mass_kg_per_m")
        left = np.arange(self.n) != cable - 1
        return replace(self, **{name: getattr(self, name)[left] for name in names})


@dataclass(frozen=True)
class Pose:
    """Position (3,) [m] and rotation vector (3,) [rad]."""

    position_m: np.ndarray
    turn_rad: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @classmethod
    def of(cls, place: np.ndarray) -> Pose:
        """Return the pose of a row of 3 or 6 coordinates."""
        place = np.asarray(place, dtype=float)
        return cls(place[:3], place[3:] if len(place) == 6 else np.zeros(3))

    @cached_property
    def rotation(self) -> np.ndarray:
        return Rotation.from_rotvec(self.turn_rad).as_matrix()


@dataclass(frozen=True)
class State:
    """A balanced pose: pulls on the platform (n, 3), free and total unstrained lengths (n,)."""

    problem: Problem
    pose: Pose
    pull_N: np.ndarray
    free_m: np.ndarray
    total_m: np.ndarray
    support_m: np.ndarray

    @property
    def exit_pull_N(self) -> np.ndarray:
        return self.pull_N - self.free_m[:, None] * self.problem.load_N_per_m

    @property
    def tension_N(self) -> np.ndarray:
        """Largest tension of each cable: at one of its ends, for |t| is convex in s."""
        ends = self.pull_N, self.exit_pull_N
        return np.max([np.linalg.norm(end, axis=1) for end in ends], axis=0)

    @property
    def utilisation(self) -> float:
        return float((self.tension_N / self.problem.allowable_N).max())

    @property
    def least_tension_N(self) -> np.ndarray:
        """Least tension anywhere in each cable."""
        return np.linalg.norm(least_pull_N(self.problem, self.pull_N, self.free_m), axis=1)

    @property
    def attachment_m(self) -> np.ndarray:
        return self.pose.position_m + self.problem.arms_m @ self.pose.rotation.T

    def points_m(self, count: int = 200) -> np.ndarray:
        """Return points of each cable from the platform to its support (n, count, 3)."""
        shares = np.linspace(0.0, 1.0, count)
        reach = [reach_of(self.problem, self.pull_N, share * self.free_m)[0] for share in shares]
        return self.attachment_m[:, None] + np.stack(reach, axis=1)


def least_pull_N(problem: Problem, pull: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return the tension vector where it is smallest (n, 3)."""
    square = (problem.load_N_per_m**2).sum(axis=1)
    at = np.clip((pull * problem.load_N_per_m).sum(axis=1) / square, 0.0, length)
    return pull - at[:, None] * problem.load_N_per_m


def sag_of(
    problem: Problem,
    attachment: np.ndarray,
    support: np.ndarray,
    pull: np.ndarray,
    length: np.ndarray,
) -> np.ndarray:
    """Return how far each cable strays from its chord, over the chord (n,).

    Farthest where it is parallel to the chord; or, if that is more, how far it hangs along its load
    below its lower end.
    """
    load = problem.load_N_per_m
    chord = np.linalg.norm(support - attachment, axis=1)
    along = (support - attachment) / chord[:, None]
    across = load - (load * along).sum(axis=1)[:, None] * along
    square = np.maximum((across**2).sum(axis=1), 1e-300)
    point = reach_of(problem, pull, np.clip((pull * across).sum(axis=1) / square, 0.0, length))[0]
    off = np.linalg.norm(point - (point * along).sum(axis=1)[:, None] * along, axis=1)
    down = load / np.linalg.norm(load, axis=1)[:, None]
    square = (load**2).sum(axis=1)
    low = reach_of(problem, pull, np.clip((pull * load).sum(axis=1) / square, 0.0, length))[0]
    below = (low * down).sum(axis=1) - np.maximum(((support - attachment) * down).sum(axis=1), 0.0)
    return np.maximum(off, below) / chord


def reach_of(
    problem: Problem, pull: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where cables end from where they begin (n, 3), and its slopes in pull and length."""
    load, stiffness = problem.load_N_per_m, problem.stiffness_N
    end = pull - length[:, None] * load
    w = np.linalg.norm(load, axis=1)
    along = load / w[:, None]
    up_0 = (pull * along).sum(axis=1)
    across = pull - up_0[:, None] * along
    a, up_1 = np.linalg.norm(across, axis=1), up_0 - w * length
    T_0, T_1 = np.hypot(a, up_0), np.hypot(a, up_1)
    taut = w * length < TAUT * np.linalg.norm(least_pull_N(problem, pull, length), axis=1)
    # Quadrature, for cables along which the tension hardly changes.
    t = pull[:, None] - (NODE * length[:, None])[..., None] * load[:, None]
    size = np.linalg.norm(t, axis=2)
    weight = SHARE * length[:, None]
    inverse = (weight / size).sum(axis=1)
    reach = np.einsum("ik,ikj->ij", weight / size, t)
    outer = np.einsum("ik,ika,ikb->iab", weight / size**3, t, t)
    if not taut.all():  # the closed form, which cancels in taut cables
        safe = np.where(a > 0.0, a, 1e-300)
        unit = across / safe[:, None]
        asinh = (np.arcsinh(up_0 / safe) - np.arcsinh(up_1 / safe)) / w
        fall = (T_0 - T_1) / w
        sines = (up_0 / T_0 - up_1 / T_1) / w
        mixed = a * (1.0 / T_1 - 1.0 / T_0) / w
        both = np.einsum("ia,ib->iab", unit, along)
        closed = (
            sines[:, None, None] * np.einsum("ia,ib->iab", unit, unit)
            + mixed[:, None, None] * (both + both.swapaxes(1, 2))
            + (asinh - sines)[:, None, None] * np.einsum("ia,ib->iab", along, along)
        )
        slack = ~taut
        inverse = np.where(slack, asinh, inverse)
        flat = across * asinh[:, None] + along * fall[:, None]
        reach = np.where(slack[:, None], flat, reach)
        outer = np.where(slack[:, None, None], closed, outer)
    stretch = (pull - 0.5 * length[:, None] * load) * (length / stiffness)[:, None]
    by_pull = (inverse + length / stiffness)[:, None, None] * np.eye(3) - outer
    by_length = end * (1.0 / T_1 + 1.0 / stiffness)[:, None]
    return reach + stretch, by_pull, by_length


def support_of(
    problem: Problem, attachment: np.ndarray, end: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return where cables leave the base (n, 3), and the wrap (n,), each with its slope in tension.

    An upright pulley swivels toward the attachment; the cable leaves it as a tangent, at an angle
    told by the part of its tension that lies in the pulley's plane.
    """
    if problem.radius_m == 0.0:
        n = problem.n
        return problem.exits_m, np.zeros((n, 3, 3)), np.zeros(n), np.zeros((n, 3))
    up, radius = problem.up, problem.radius_m
    toward = attachment - problem.exits_m
    toward = toward - (toward @ up)[:, None] * up
    toward = toward / np.linalg.norm(toward, axis=1, keepdims=True)
    rise, out = end @ up, -(end * toward).sum(axis=1)
    slope = np.arctan2(rise, out)
    sine, cosine = np.sin(slope)[:, None], np.cos(slope)[:, None]
    point = problem.exits_m + radius * ((1.0 + sine) * toward + cosine * up)
    slope_by = (out[:, None] * up + rise[:, None] * toward) / (rise**2 + out**2)[:, None]
    by_end = radius * np.einsum("ia,ib->iab", cosine * toward - sine * up, slope_by)
    wrap = radius * (0.5 * np.pi + slope)
    tension = np.linalg.norm(end, axis=1)
    stretch = 1.0 + tension / problem.stiffness_N
    by_stretch = wrap / (stretch * tension * problem.stiffness_N)
    wrap_by = (radius * slope_by - by_stretch[:, None] * end) / stretch[:, None]
    return point, by_end, wrap / stretch, wrap_by


def load_on(problem: Problem, rotation: np.ndarray) -> np.ndarray:
    """Return what acts on the platform beside the cables (6,), about the body's origin."""
    force = problem.force_N + problem.centre_force_N
    moment = problem.moment_Nm + np.cross(rotation @ problem.centre_m, problem.centre_force_N)
    return np.concatenate([force, moment])


def wrench_matrix(problem: Problem, arms: np.ndarray) -> np.ndarray:
    """Return the wrench of unit pulls (dof, n, 3), moments over the reach."""
    cross = np.zeros((problem.n, 3, 3))
    x, y, z = arms.T
    cross[:, 0, 1], cross[:, 0, 2] = -z, y
    cross[:, 1, 0], cross[:, 1, 2] = z, -x
    cross[:, 2, 0], cross[:, 2, 1] = -y, x
    force = np.broadcast_to(np.eye(3), (problem.n, 3, 3))
    whole = np.concatenate([force, cross / problem.reach_m], axis=1)
    return np.einsum("dw,nwk->dnk", problem.freedoms, whole)


@dataclass(frozen=True)
class Equations:
    """Closure and balance of a pose in the unknowns (p / scale, l / chord)."""

    problem: Problem
    pose: Pose
    attachment: np.ndarray
    balance: np.ndarray
    load: np.ndarray
    chord: np.ndarray

    @classmethod
    def of(cls, problem: Problem, pose: Pose) -> Equations:
        rotation = pose.rotation
        arms = problem.arms_m @ rotation.T
        attachment = pose.position_m + arms
        given = load_on(problem, rotation)
        given[3:] /= problem.reach_m
        chord = np.linalg.norm(attachment - problem.exits_m, axis=1)
        return cls(
            problem, pose, attachment, wrench_matrix(problem, arms), problem.freedoms @ given, chord
        )

    def split(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        n = self.problem.n
        return x[: 3 * n].reshape(n, 3) * self.problem.scale_N, x[3 * n : 4 * n] * self.chord

    def join(self, pull: np.ndarray, length: np.ndarray) -> np.ndarray:
        return np.concatenate([(pull / self.problem.scale_N).ravel(), length / self.chord])

    def residual(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what is left (3 n + dof,), and its slopes (3 n + dof, 4 n)."""
        problem, n = self.problem, self.problem.n
        pull, length = self.split(x)
        reach, by_pull, by_length = reach_of(problem, pull, length)
        end = pull - length[:, None] * problem.load_N_per_m
        support, by_end, *_ = support_of(problem, self.attachment, end)
        gap = (self.attachment + reach - support) / self.chord[:, None]
        held = np.einsum("dnk,nk->d", self.balance, pull) + self.load
        slope = np.zeros((3 * n + len(held), 4 * n))
        by_pull = (by_pull - by_end) * (problem.scale_N / self.chord)[:, None, None]
        by_length = by_length + np.einsum("iab,ib->ia", by_end, problem.load_N_per_m)
        for i in range(n):
            slope[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = by_pull[i]
            slope[3 * i : 3 * i + 3, 3 * n + i] = by_length[i]
        slope[3 * n :, : 3 * n] = self.balance.reshape(len(held), -1)
        return np.concatenate([gap.ravel(), held / problem.scale_N]), slope

    def lengths_left(self, x: np.ndarray, total_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return by how much total lengths are others (n,), over the chord, and slopes (n, 4 n)."""
        pull, length = self.split(x)
        load, cables = self.problem.load_N_per_m, np.arange(self.problem.n)
        *_, wrap, by_end = support_of(self.problem, self.attachment, pull - length[:, None] * load)
        slope = np.zeros((len(cables), 4 * len(cables)))
        for axis in range(3):
            slope[cables, 3 * cables + axis] = by_end[:, axis] * self.problem.scale_N / self.chord
        slope[cables, 3 * len(cables) + cables] = 1.0 - (by_end * load).sum(axis=1)
        return (length + wrap - total_m) / self.chord, slope

    def state(self, x: np.ndarray) -> State:
        pull, length = self.split(x)
        end = pull - length[:, None] * self.problem.load_N_per_m
        support, _, wrap, _ = support_of(self.problem, self.attachment, end)
        return State(self.problem, self.pose, pull, length, length + wrap, support)

    def start(self, tension: np.ndarray) -> np.ndarray:
        """Return straight cables of these tensions, none so slack that it hardly pulls."""
        q = self.problem.load_N_per_m
        support = support_of(self.problem, self.attachment, self.problem.exits_m - self.attachment)
        toward = support[0] - self.attachment
        length = np.linalg.norm(toward, axis=1)
        tension = np.maximum(tension, 0.5 * np.linalg.norm(q, axis=1) * length)
        pull = tension[:, None] * toward / length[:, None] + 0.5 * length[:, None] * q
        return self.join(pull, length / (1.0 + tension / self.problem.stiffness_N))

    def straight_tensions(self, rng: np.random.Generator | None = None) -> np.ndarray:
        """Return tensions of straight cables that hold the load and half of the cables' own."""
        toward = self.problem.exits_m - self.attachment
        unit = toward / self.chord[:, None]
        matrix = np.einsum("dnk,nk->dn", self.balance, unit)
        half = 0.5 * self.chord[:, None] * self.problem.load_N_per_m
        load = self.load + np.einsum("dnk,nk->d", self.balance, half)
        if rng is not None or len(load) == self.problem.n:
            bias = (
                0.0 if rng is None else rng.uniform(0.0, 0.5, self.problem.n) * np.abs(load).max()
            )
            return nnls(matrix, -load - matrix @ (bias * np.ones(self.problem.n)))[0] + bias
        cost = np.append(np.zeros(self.problem.n), 1.0)
        share = self.problem.allowable_N / self.problem.allowable_N.max()
        equal = np.column_stack([matrix, np.zeros(len(load))])
        over = np.column_stack([np.eye(self.problem.n), -share])
        found = linprog(
            cost, over, np.zeros(self.problem.n), equal, -load,
            bounds=[(self.problem.least_N, None)] * self.problem.n + [(0.0, None)],
        )  # fmt: skip
        return found.x[:-1] if found.status == 0 else nnls(matrix, -load)[0]


def solve(problem: Problem, pose: Pose, starts: int = 4, seed: int = 0) -> State | None:
    """Return the balance whose largest tension over the allowable one is smallest; None without."""
    found = solutions(problem, pose, starts, seed)
    return min(found, key=lambda one: one.utilisation, default=None)


def solutions(problem: Problem, pose: Pose, starts: int = 4, seed: int = 0) -> list[State]:
    """Return what is found from straight cables, and from others at random."""
    equations, rng = Equations.of(problem, pose), np.random.default_rng(seed)
    is_square = len(problem.freedoms) == problem.n
    found: list[State] = []
    for k in range(starts):
        tension = equations.straight_tensions(rng if is_square and k else None)
        if k:
            tension = tension * rng.uniform(0.3 if is_square else 0.8, 3.0 if is_square else 1.3)
        one = (_root if is_square else _least)(equations, equations.start(tension))
        if one is not None:
            found.append(one)
        best = sorted(one.utilisation for one in found)[:2]
        if not is_square and len(best) == 2 and best[1] <= best[0] * (1.0 + 1e-6):
            break  # one alone may have ended anywhere
        if found and is_square and not problem.arms_m.any():
            break  # a point mass on as few cables as hold it has one balance
    return found


def _root(equations: Equations, x: np.ndarray) -> State | None:
    with np.errstate(all="ignore"):
        found = root(equations.residual, x, jac=True, method="hybr", options={"xtol": 1e-14})
        return _polished(equations, found.x)


def _polished(equations: Equations, x: np.ndarray, turns: int = 4) -> State | None:
    """Take a few steps of least norm, and return the state if it is closed and balanced."""
    with np.errstate(all="ignore"):
        for _ in range(turns):
            left, slope = equations.residual(x)
            if not (np.isfinite(left).all() and np.isfinite(slope).all()):
                return None
            x = x - np.linalg.lstsq(slope, left, rcond=None)[0]
        left = np.abs(equations.residual(x)[0]).max()
    n = equations.problem.n
    if not left < CLOSED or (x[3 * n : 4 * n] <= 0.0).any():
        return None
    return equations.state(x)


def feasible(problem: Problem, pose: Pose, seed: int | None = None) -> State | None:
    """Return some balance near straight cables, not the best one; None where there is none."""
    equations = Equations.of(problem, pose)
    rng = None if seed is None else np.random.default_rng(seed)
    x = equations.start(equations.straight_tensions(rng))
    n = problem.n
    with np.errstate(all="ignore"):
        for _ in range(60):
            left, slope = equations.residual(x)
            if not np.isfinite(left).all() or not np.isfinite(slope).all():
                return None
            step = np.linalg.lstsq(slope, -left, rcond=None)[0]
            most = np.max(np.abs(step[3 * n :]) / x[3 * n :])
            x = x + step * min(1.0, 0.3 / max(most, 1e-300))
            if np.abs(left).max() < 1e-12:
                break
    found = _polished(equations, x, 1)
    return found if found is not None and keeps_limits(found) else None


def keeps_limits(state: State) -> bool:
    """Tell whether no cable is slacker than the internal forces may leave it."""
    problem = state.problem
    if problem.n == len(problem.freedoms):  # nothing to choose
        return True
    sag = 0.0
    if problem.sag_max is not None:
        ends = problem, state.attachment_m, state.support_m
        sag = sag_of(*ends, state.pull_N, state.free_m).max() / problem.sag_max
    least = state.least_tension_N.min() if problem.least_N else 0.0
    return bool(least >= problem.least_N * (1.0 - 1e-6) and sag <= 1.0 + 1e-6)


@dataclass(frozen=True)
class Limits:
    """What no cable may exceed, in the unknowns (p / scale, l / chord, largest tension / scale)."""

    equations: Equations

    @property
    def allowed(self) -> np.ndarray:
        return self.equations.problem.allowable_N / self.equations.problem.allowable_N.max()

    def values(self, y: np.ndarray) -> np.ndarray:
        """Return what is left of each limit."""
        problem = self.equations.problem
        pull, length = self.equations.split(y[:-1])
        parts = [
            y[-1] * self.allowed - np.linalg.norm(end, axis=1) / problem.scale_N
            for end in (pull, pull - length[:, None] * problem.load_N_per_m)
        ]
        if problem.least_N > 0.0:
            least = np.linalg.norm(least_pull_N(problem, pull, length), axis=1)
            parts.append((least - problem.least_N) / problem.scale_N)
        if problem.sag_max is not None:
            parts.append(self.sag_left(pull, length))
        return np.concatenate(parts)

    def slopes(self, y: np.ndarray) -> np.ndarray:
        """Return the slopes of `values`."""
        problem = self.equations.problem
        pull, length = self.equations.split(y[:-1])
        end, zero = pull - length[:, None] * problem.load_N_per_m, np.zeros(problem.n)
        blocks = [self._of_size(pull, zero, -1.0), self._of_size(end, zero + 1.0, -1.0)]
        for block in blocks:
            block[:, -1] = self.allowed
        if problem.least_N > 0.0:
            least = least_pull_N(problem, pull, length)
            is_end = np.isclose(least, end, rtol=1e-13).all(axis=1) & (length > 0.0)
            blocks.append(self._of_size(least, is_end.astype(float), 1.0))
        if problem.sag_max is not None:
            blocks.append(self._of_sag(pull, length))
        return np.concatenate(blocks)

    def _of_size(self, vector: np.ndarray, at_end: np.ndarray, sign: float) -> np.ndarray:
        """Slope of sign times |vector|, which a length moves by its load where ``at_end``."""
        problem, n = self.equations.problem, self.equations.problem.n
        unit = sign * vector / np.linalg.norm(vector, axis=1, keepdims=True)
        block = np.zeros((n, 4 * n + 1))
        for i in range(n):
            block[i, 3 * i : 3 * i + 3] = unit[i]
        along = (unit * problem.load_N_per_m).sum(axis=1) * self.equations.chord / problem.scale_N
        block[np.arange(n), 3 * n + np.arange(n)] = -at_end * along
        return block

    def sag_left(self, pull: np.ndarray, length: np.ndarray) -> np.ndarray:
        problem, attachment = self.equations.problem, self.equations.attachment
        end = pull - length[:, None] * problem.load_N_per_m
        support = support_of(problem, attachment, end)[0]
        return problem.sag_max - sag_of(problem, attachment, support, pull, length)

    def _of_sag(self, pull: np.ndarray, length: np.ndarray) -> np.ndarray:
        """Differences, of all cables at once: none has a part in another's sag."""
        n = self.equations.problem.n
        block = np.zeros((n, 4 * n + 1))
        for k in range(4):
            columns = 3 * n + np.arange(n) if k == 3 else 3 * np.arange(n) + k
            step = np.zeros(4 * n)
            step[columns] = 1e-7
            x = self.equations.join(pull, length)
            up, down = (
                self.sag_left(*self.equations.split(x + sign * step)) for sign in (1.0, -1.0)
            )
            block[np.arange(n), columns] = (up - down) / 2e-7
        return block


def _least(equations: Equations, x: np.ndarray) -> State | None:
    """Make the largest tension over the allowable one smallest, by SLSQP."""
    problem, n, limits = equations.problem, equations.problem.n, Limits(equations)

    def slope(y: np.ndarray) -> np.ndarray:
        closure = equations.residual(y[:-1])[1]
        return np.column_stack([closure, np.zeros(len(closure))])

    pull, length = equations.split(x)
    ends = pull, pull - length[:, None] * problem.load_N_per_m
    most = max((np.linalg.norm(end, axis=1) / limits.allowed).max() for end in ends)
    cost = np.append(np.zeros(4 * n), 1.0)
    with np.errstate(all="ignore"):
        found = minimize(
            lambda y: y[-1], np.append(x, most / problem.scale_N), jac=lambda _: cost,
            method="SLSQP",
            bounds=[(None, None)] * (3 * n) + [(1e-3, None)] * n + [(0.0, None)],
            constraints=[
                {"type": "eq", "fun": lambda y: equations.residual(y[:-1])[0], "jac": slope},
                {"type": "ineq", "fun": limits.values, "jac": limits.slopes},
            ],
            options={"maxiter": 100, "ftol": 1e-13},
        )  # fmt: skip
    one = _polished(equations, found.x[:-1], 1)
    return one if one is not None and keeps_limits(one) else None


def hang(
    problem: Problem, pose: Pose, total_m: np.ndarray, near: State | None = None
) -> State | None:
    """Return the cables of given total lengths in a pose; the platform need not be in balance."""
    equations = Equations.of(problem, pose)
    if near is None:
        wrap = support_of(problem, equations.attachment, problem.exits_m - equations.attachment)[2]
        slack = (total_m - wrap) / equations.chord - 1.0
        q = np.linalg.norm(problem.load_N_per_m, axis=1)
        taut = problem.stiffness_N * np.maximum(-slack, 0.0)
        hung = q * equations.chord / np.sqrt(24.0 * np.maximum(slack, 1e-4))
        x = equations.start(taut + hung)
    else:
        x = equations.join(near.pull_N, near.free_m)
    n = problem.n

    def left(x):
        (gap, gap_by), (lengths, lengths_by) = (
            equations.residual(x), equations.lengths_left(x, total_m)
        )  # fmt: skip
        return np.append(gap[: 3 * n], lengths), np.vstack([gap_by[: 3 * n], lengths_by])

    with np.errstate(all="ignore"):
        found = root(left, x, jac=True, method="hybr", options={"xtol": 1e-14})
    is_closed = np.abs(left(found.x)[0]).max() < CLOSED
    return equations.state(found.x) if is_closed else None


def settle(
    problem: Problem, start: Pose, total_m: np.ndarray, near: State | None = None
) -> State | None:
    """Return the pose near another in which cables of given lengths hold the platform.

    ``near`` are cables of these lengths in the other pose, where they are known.
    """
    n, dof = problem.n, len(problem.freedoms)
    size = float(np.linalg.norm(np.ptp(problem.exits_m, axis=0)))
    first = Equations.of(problem, start)
    near = near or hang(problem, start, total_m)
    if near is None:
        return None

    def pose_at(step: np.ndarray) -> Pose:
        twist = problem.freedoms.T @ step
        turn = Rotation.from_rotvec(twist[3:] * size / problem.reach_m) * Rotation.from_rotvec(
            start.turn_rad
        )
        return Pose(start.position_m + size * twist[:3], turn.as_rotvec())

    def at(x: np.ndarray) -> tuple[Equations, np.ndarray, np.ndarray]:
        equations = Equations.of(problem, pose_at(x[4 * n :]))
        scale = np.append(np.ones(3 * n), first.chord / equations.chord)
        return equations, x[: 4 * n] * scale, scale

    def left(x: np.ndarray) -> np.ndarray:
        equations, x, _ = at(x)
        return np.append(equations.residual(x)[0], equations.lengths_left(x, total_m)[0])

    def slopes(x: np.ndarray) -> np.ndarray:
        """Slopes in the pose are differences."""
        equations, cables, scale = at(x)
        parts = equations.residual(cables)[1], equations.lengths_left(cables, total_m)[1]
        steps, here = 1e-7 * np.eye(4 * n + dof)[4 * n :], left(x)
        by_pose = [(left(x + step) - here) / 1e-7 for step in steps]
        return np.column_stack([np.vstack(parts) * scale, *by_pose])

    x = np.append(first.join(near.pull_N, near.free_m), np.zeros(dof))
    with np.errstate(all="ignore"):
        found = root(left, x, jac=slopes, method="hybr", options={"xtol": 1e-14})
        is_closed = np.abs(left(found.x)).max() < CLOSED
    equations, cables, _ = at(found.x)
    return equations.state(cables) if is_closed else None


def compliance(state: State, step: float = 1e-6, reach_m: float = 0.0) -> np.ndarray | None:
    """Return displacement under forces at the body's origin, by differences (n, n).

    With a reach also turns times it, under moments over it.
    """
    problem = state.problem
    axes = problem.freedoms
    if reach_m == 0.0:
        axes = axes[np.abs(axes[:, :3]).max(axis=1) > 0.0]
    force = step * problem.scale_N
    columns = []
    for axis in axes:
        ends = []
        for sign in (1.0, -1.0):
            pushed = replace(
                problem,
                force_N=problem.force_N + sign * force * axis[:3],
                moment_Nm=problem.moment_Nm + sign * force * reach_m * axis[3:],
            )
            moved = settle(pushed, state.pose, state.total_m, near=state)
            if moved is None:
                return None
            turn = Rotation.from_matrix(moved.pose.rotation @ state.pose.rotation.T).as_rotvec()
            ends.append(np.concatenate([moved.pose.position_m, reach_m * turn]))
        columns.append(axes @ (ends[0] - ends[1]) / (2.0 * force))
    return np.array(columns).T
