"""The thinnest cable of a pose by SLSQP from many starts: another formulation, another solver.

A cable is written by the slope angles of its arc (in the hyperbolic sense) at platform and exit,
a = μ - δ and b = μ + δ. With h = horizontal force over weight per length and κ = weight over EA,

    l = 2 h cosh μ sinh δ                          X = 2 h δ + κ h l
    D = 2 h sinh μ sinh δ + κ h²/2 sinh 2μ sinh 2δ
    upward pull h sinh a, tensions h cosh a and h cosh b.

Unknown are log h of every cable and c, the load over the weight per length; SLSQP makes c large.
Of a given cable c is known, and SLSQP makes the largest tension over the strength small. With
cables to spare no h is below that of the largest sag. Over pulleys the cables leave where those of
the last answer do, until that rests. Nothing is shared with the compiled solvers but the robot.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.optimize import linprog, minimize

from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Material
from designer.model.robot import Poses, Robot
from designer.physics import catenary

STARTS = 14
_STEEPEST = 3.0  # of δ: no cable more than about three times as long as its horizontal distance
_BALANCED = 1e-9
_NO_CABLE = 1e-6
_NEWTONS = 30
# Share of the sag that the tables of least pulls leave out, over the sag and over the strain that
# the cable's own weight would cause.
_SAG_OF_STRETCH = 0.3
_LARGEST_STRAIN = 0.5  # beyond, a cable counts as broken
_MOST_TURNS = 80
_PATIENCE = 15
_AT_REST = 1e-9  # of the radius: what an exit point still moves by


@dataclass(frozen=True)
class Thinnest:
    """The best of all starts: diameter [m], NaN if no start ended in a cable; lengths [m]."""

    diameter_m: float
    length_m: np.ndarray
    residual: float


@njit(cache=True)
def _cables(h: np.ndarray, X: np.ndarray, D: np.ndarray, k: float) -> np.ndarray:
    """Return what `Problem.cables` tells, a row each; compiled, for SLSQP asks a thousand times."""
    found = np.empty((9, len(h)))
    for i in range(len(h)):
        delta = min(X[i] / (2 * h[i]), _STEEPEST)
        mu = np.arcsinh(D[i] / (2 * h[i] * np.sinh(delta)))
        e = k * h[i] * h[i] / 2
        F_m = F_d = G_m = G_d = det = 0.0
        for _ in range(_NEWTONS):
            sm, cm, sd, cd = np.sinh(mu), np.cosh(mu), np.sinh(delta), np.cosh(delta)
            s2m, c2m, s2d, c2d = 2 * sm * cm, cm * cm + sm * sm, 2 * sd * cd, cd * cd + sd * sd
            length, l_mu, l_delta = 2 * h[i] * cm * sd, 2 * h[i] * sm * sd, 2 * h[i] * cm * cd
            F = 2 * h[i] * delta + k * h[i] * length - X[i]
            G = 2 * h[i] * sm * sd + e * s2m * s2d - D[i]
            F_m, F_d = k * h[i] * l_mu, 2 * h[i] + k * h[i] * l_delta
            G_m = 2 * h[i] * cm * sd + 2 * e * c2m * s2d
            G_d = 2 * h[i] * sm * cd + 2 * e * s2m * c2d
            det = F_m * G_d - F_d * G_m
            step_m, step_d = (G_d * F - F_d * G) / det, (F_m * G - G_m * F) / det
            mu, delta = mu - step_m, max(delta - step_d, 0.1 * delta)
            if abs(step_d) < 1e-14 * delta and abs(step_m) < 1e-13:
                break
        sm, cm, sd, cd = np.sinh(mu), np.cosh(mu), np.sinh(delta), np.cosh(delta)
        length = 2 * h[i] * cm * sd
        F_h = 2 * h[i] * delta + 2 * k * h[i] * length
        G_h = 2 * h[i] * sm * sd + 2 * e * 4 * sm * cm * sd * cd
        m_h, d_h = -(G_d * F_h - F_d * G_h) / det, -(F_m * G_h - G_m * F_h) / det
        a, b = mu - delta, mu + delta
        up, low, top = h[i] * np.sinh(a), h[i] * np.cosh(a), h[i] * np.cosh(b)
        up_h, low_h = up + low * (m_h - d_h), low + up * (m_h - d_h)
        top_h = top + h[i] * np.sinh(b) * (m_h + d_h)
        # The lowest point of the cable has the least tension; without one, the end that is lower.
        least, least_h = (low, low_h) if a >= 0 else (top, top_h) if b <= 0 else (h[i], h[i])
        found[:, i] = up, low, top, length, up_h, low_h, top_h, least, least_h
    return found


class Problem:
    """One pose, forces over the strength; see the head of the file.

    Where it ``is_taut`` no cable sags more than allowed, also of a robot without cables to spare.
    """

    def __init__(
        self,
        robot: Robot,
        position: np.ndarray,
        turn: np.ndarray,
        material: Material,
        weight_N_per_m: float | None = None,
        exit_points_m: np.ndarray | None = None,
        is_taut: bool = False,
    ):
        pose = Poses.at(position, None if robot.is_point_mass else turn)
        up = robot.upright
        self.robot, self.attachments_m = robot, pose.attachment_points_m(robot)
        self.exits_m = robot.exit_points_m if exit_points_m is None else exit_points_m
        chord = (self.exits_m - self.attachments_m) @ up.T  # all in the base frame until here
        lever = (self.attachments_m - pose.position_m) @ up.T
        self.reach = float(np.abs(lever).sum(axis=1).max()) or 1.0
        self.rows = robot.balance_rows
        self.X, self.D = np.hypot(chord[:, 0], chord[:, 1]), chord[:, 2]
        self.L = np.hypot(self.X, self.D)
        self.plan = np.column_stack([chord[:, :2] / self.X[:, None], np.zeros(len(chord))])
        self.level = self.wrench(lever, self.plan)
        self.lift = self.wrench(lever, np.array([0, 0, 1.0]))
        force = robot.pull_N[:3]
        centre = up @ pose.rotation @ robot.platform.centre_of_mass_m
        moment = robot.pull_N[3:] + np.cross(centre, robot.centre_pull_N)
        load = np.concatenate([force, moment / self.reach])[self.rows]
        self.size = float(np.abs(load).max())
        self.load = load / self.size
        self.material = material
        self.strength = material.strength_length_m
        self.kappa = material.elastic_compliance_per_m
        self.least = robot.tension_min_N / self.size if robot.is_redundant else 0.0
        self.given = (
            None if weight_N_per_m is None else self.size / (weight_N_per_m * self.strength)
        )
        self.low = np.log(self.X / (2 * _STEEPEST))
        if robot.is_redundant or is_taut:
            self.low = np.maximum(self.low, np.log(self._of_sag(robot.sag_max)))
        self.last: tuple[bytes, tuple[np.ndarray, ...]] = (b"", ())

    def wrench(self, lever: np.ndarray, force: np.ndarray) -> np.ndarray:
        force = np.broadcast_to(force, lever.shape)
        both = np.hstack([force, np.cross(lever, force) / self.reach])
        return both[:, self.rows].T

    def _of_sag(self, sag: float) -> np.ndarray:
        """Return the least h at which no cable sags more than this share of its chord.

        Hardly less, as the tables of the compiled solvers have it for what cables stretch.
        """
        EA = 1.0 / self.kappa
        most = sag * (1.0 - _SAG_OF_STRETCH * sag * self.kappa * self.L)
        low, high = self.X / (2 * _STEEPEST), 1e3 * self.L
        for _ in range(100):
            h = np.sqrt(low * high)
            length, force_z = catenary.length_and_force_z(h / self.X, self.X, self.D, EA, 1.0)
            deep = catenary.sag_m(length, h, force_z, EA, 1.0, self.X, self.D)
            slack = ~(deep <= most * self.L)
            low, high = np.where(slack, h, low), np.where(slack, high, h)
        return high

    def c(self, z: np.ndarray) -> float:
        """Return the load over the weight per length, over the strength."""
        return float(z[-1]) if self.given is None else self.given

    def cables(self, u: np.ndarray) -> tuple[np.ndarray, ...]:
        """Upward pull, both end tensions, length, the slopes of the first three in log h, and the
        least tension anywhere in the cable with its slope.
        """
        if self.last[0] == u.tobytes():
            return self.last[1]
        self.last = (u.tobytes(), tuple(_cables(np.exp(u), self.X, self.D, self.kappa)))
        return self.last[1]

    def balance(self, z: np.ndarray) -> np.ndarray:
        up = self.cables(z[:-1])[0]
        return (self.level @ np.exp(z[:-1]) + self.lift @ up) / self.strength - self.c(
            z
        ) * self.load

    def balance_slope(self, z: np.ndarray) -> np.ndarray:
        slope = self.cables(z[:-1])[4]
        columns = (self.level * np.exp(z[:-1]) + self.lift * slope) / self.strength
        return np.column_stack([columns, -self.load * (self.given is None)])

    def room(self, z: np.ndarray) -> np.ndarray:
        _, low, top, *_, least, _ = self.cables(z[:-1])
        most = 1.0 if self.given is None else z[-1]
        found = [most - low / self.strength, most - top / self.strength]
        if self.least > 0:
            found.append(least / self.strength - self.c(z) * self.least)
        return np.concatenate(found)

    def room_slope(self, z: np.ndarray) -> np.ndarray:
        *_, low, top, _, least = self.cables(z[:-1])
        n = len(low)
        is_sizing = self.given is None
        in_top = np.full((n, 1), 0.0 if is_sizing else 1.0)
        found = [np.hstack([np.diag(-low / self.strength), in_top])]
        found.append(np.hstack([np.diag(-top / self.strength), in_top]))
        if self.least > 0:
            in_least = np.full((n, 1), -self.least if is_sizing else 0.0)
            found.append(np.hstack([np.diag(least / self.strength), in_least]))
        return np.vstack(found)

    def straight(self) -> tuple[np.ndarray, float]:
        """Straight cables' tensions over the strength, and c; a small share where none hold."""
        unit = self.level * (self.X / self.L) + self.lift * (self.D / self.L)
        n = len(self.X)
        answer = linprog(
            -np.eye(n + 1)[-1],
            A_eq=np.column_stack([unit, -self.load]),
            b_eq=np.zeros(len(self.load)),
            bounds=[(0, 1)] * n + [(0, None)],
        )
        if answer.x is None or answer.x[-1] < 1e-9:
            return np.full(n, 0.1), 0.1
        return answer.x[:-1], float(answer.x[-1])

    def starts(self, count: int, rng: np.random.Generator) -> list[np.ndarray]:
        share, c = self.straight()
        n = len(share)
        slack = 0.5 * self.X
        taut = np.maximum(share * self.strength * self.X / self.L, slack)
        found = [
            np.append(np.log(taut), c),
            np.append(np.log(np.maximum(0.2 * taut, slack)), 0.2 * c),
        ]
        for i in rng.permutation(n)[: (count - 2) * 2 // 3]:
            h = taut.copy()
            h[i] = rng.uniform(0.15, 1.0) * self.X[i]
            found.append(np.append(np.log(h), rng.uniform(0.3, 1.0) * c))
        high = np.log(np.maximum(self.strength * self.X / self.L, 2 * slack))
        while len(found) < count:
            h = rng.uniform(np.log(0.3 * self.X), high)
            found.append(np.append(h, rng.uniform(0.05, 1.0) * c))
        return found

    def solve(self, start: np.ndarray) -> tuple[float, np.ndarray, float]:
        low, sign = self.low, -1.0 if self.given is None else 1.0
        most = 2 if self.given is None else 1e4 * max(1.0, self.given)
        most_s = None if self.given is None else _LARGEST_STRAIN / (self.kappa * self.strength)
        high = np.maximum(np.log(most * self.strength * self.X / self.L + self.X), low + 1.0)
        with np.errstate(all="ignore"):
            answer = minimize(
                lambda z: sign * z[-1],
                np.clip(start, np.append(low, 0), np.append(high, most_s or np.inf)),
                jac=lambda z: sign * np.eye(z.size)[-1],
                method="SLSQP",
                bounds=[*zip(low, high, strict=True), (0.0, most_s)],
                constraints=[
                    {"type": "eq", "fun": self.balance, "jac": self.balance_slope},
                    {"type": "ineq", "fun": self.room, "jac": self.room_slope},
                ],
                options={"ftol": 1e-11, "maxiter": 100},
            )
            z = answer.x
            worst = max(np.abs(self.balance(z)).max(), -self.room(z).min())
        return float(z[-1]), z, float(worst)

    def leaving_points_m(self, z: np.ndarray) -> np.ndarray:
        """Return where these cables leave their pulleys, which stand on the exit points."""
        up, _, _, length, *_ = self.cables(z[:-1])
        toward = np.exp(z[:-1, None]) * -self.plan
        toward[:, 2] = -(up + length)
        toward = toward @ self.robot.upright
        out = self.attachments_m - self.robot.exit_points_m
        out[:, 2] = 0.0
        out /= np.linalg.norm(out, axis=1)[:, None]
        slope = np.arctan2(-toward[:, 2], (toward * out).sum(axis=1))
        rim = (1.0 + np.sin(slope))[:, None] * out
        rim[:, 2] = np.cos(slope)
        return np.asarray(self.robot.exit_points_m + self.robot.pulley_radius_m * rim)

    def best(
        self, starts: list[np.ndarray], make: Callable[[np.ndarray], Problem]
    ) -> tuple[Problem, np.ndarray, float] | None:
        """Return the best that the starts end in, the problem that it solves, and its error.

        Over pulleys each better one is followed until its exit points rest: ``make`` makes the
        problem with others. None if no start ends in an equilibrium.
        """
        best = None
        sign = -1.0 if self.given is None else 1.0
        for start in starts:
            problem, (value, z, worst) = self, self.solve(start)
            if not problem.is_answer(value, worst):
                continue
            if best is not None and sign * value >= sign * best[1][-1]:
                continue
            rests = self.robot.pulley_radius_m == 0.0
            for turn in range(0 if rests else _MOST_TURNS):
                moved = problem.leaving_points_m(z) - problem.exits_m
                rests = bool(np.abs(moved).max() < _AT_REST * self.robot.pulley_radius_m)
                if rests:
                    break
                problem = make(problem.exits_m + (1.0 if turn < _PATIENCE else 0.3) * moved)
                value, z, worst = problem.solve(z)
            is_better = best is None or sign * value < sign * best[1][-1]
            if rests and is_better and problem.is_answer(value, worst):
                best = problem, z, worst
        return best

    def is_answer(self, value: float, worst: float) -> bool:
        """Tell whether what the solver ended in is an equilibrium."""
        if self.given is None:
            return bool(worst < _BALANCED * min(1.0, value) and value > _NO_CABLE)
        return bool(worst < _BALANCED * max(1.0, self.given))


def least_utilisation(
    robot: Robot,
    position: np.ndarray,
    turn: np.ndarray,
    material: Material,
    weight_N_per_m: float,
    rng: np.random.Generator,
    starts: int = STARTS,
    exit_points_m: np.ndarray | None = None,
    is_taut: bool = False,
) -> tuple[float, np.ndarray]:
    """Return the least largest tension over the strength that any start ends in, and the pulls h.

    NaN where none ends in an equilibrium. Of a cable of the family with this weight per length.
    """

    def make(exits_m: np.ndarray | None) -> Problem:
        return Problem(robot, position, turn, material, weight_N_per_m, exits_m, is_taut)

    problem = make(exit_points_m)
    starts_at = problem.starts(starts, rng)
    for start in starts_at:
        start[-1] = np.exp(start[:-1]).max() / problem.strength
    best = problem.best(starts_at, make)
    if best is None:
        return float("nan"), np.full(robot.n_cables, np.nan)
    return float(best[1][-1]), np.exp(best[1][:-1])


def thinnest(
    robot: Robot,
    position: np.ndarray,
    turn: np.ndarray,
    material: Material,
    rng: np.random.Generator,
    starts: int = STARTS,
    exit_points_m: np.ndarray | None = None,
    is_taut: bool = False,
) -> Thinnest:
    """Return the thinnest cable that any of the starts ends in; see `Problem`."""

    def make(exits_m: np.ndarray | None) -> Problem:
        return Problem(robot, position, turn, material, None, exits_m, is_taut)

    first = make(exit_points_m)
    best = first.best(first.starts(starts, rng), make)
    if best is None:
        return Thinnest(float("nan"), np.full(robot.n_cables, np.nan), float("nan"))
    problem, z, worst = best
    weight = problem.size / (z[-1] * problem.strength)
    area = weight / (STANDARD_GRAVITY_M_PER_S2 * material.density_kg_per_m3)
    diameter_m = float(np.sqrt(4 * area / np.pi))
    return Thinnest(diameter_m, problem.cables(z[:-1])[3], float(worst / z[-1]))
