"""What a study asks for beside strength, evaluated plainly from a state of the reference."""

from __future__ import annotations

from itertools import combinations

import finite_elements as fe
import numpy as np
from pairs.reference import State, compliance, reach_of, sag_of
from scipy.optimize import minimize, minimize_scalar, nnls
from scipy.spatial.distance import cdist, pdist

POINTS = 400


def point_m(state: State, cable: int, share: float) -> np.ndarray:
    """Return where a cable is at a share of its free length, from the platform."""
    return (
        state.attachment_m[cable]
        + reach_of(state.problem, state.pull_N, share * state.free_m)[0][cable]
    )


def lowest_m(state: State) -> float:
    """Return the height of the lowest point of any cable, along the vertical."""
    heights = state.points_m(POINTS) @ state.problem.up
    cable, at = np.unravel_index(heights.argmin(), heights.shape)
    ends = np.clip([(at - 1) / (POINTS - 1), (at + 1) / (POINTS - 1)], 0.0, 1.0)
    found = minimize_scalar(
        lambda share: point_m(state, cable, share) @ state.problem.up,
        bounds=tuple(ends), method="bounded", options={"xatol": 1e-10},
    )  # fmt: skip
    return float(min(found.fun, heights.min()))


def least_stiffness_N_per_m(state: State) -> float:
    """Return the smallest force over displacement of the platform; NaN where it cannot be told."""
    displacement = compliance(state)
    return np.nan if displacement is None else float(1.0 / np.linalg.norm(displacement, ord=2))


def frequencies_Hz(state: State) -> np.ndarray:
    """Return the lowest frequency of each cable as a string of its mean end tension."""
    ends = np.linalg.norm(state.pull_N, axis=1), np.linalg.norm(state.exit_pull_N, axis=1)
    speed = np.sqrt(0.5 * (ends[0] + ends[1]) / state.problem.mass_kg_per_m)
    return speed / (2.0 * state.free_m)


def platform_frequencies_Hz(state: State, text) -> np.ndarray:
    """Return the natural frequencies of the platform on cables of finite elements."""
    problem, turn, platform = state.problem, state.pose.rotation, text["robot"]["platform"]
    case = next(iter(text.get("load_cases", ())), {})
    mass = case.get("mass") or platform["mass"]
    mass += text.get("effects", {}).get("platform_mass", {}).get("offset_kg", 0.0)
    inertia = turn @ np.diag(platform.get("inertia", [0.0, 0.0, 0.0])) @ turn.T
    levers, arm = problem.arms_m @ turn.T, turn @ problem.centre_m
    body = fe.Body(mass, inertia, arm, levers, problem.centre_force_N)
    chains = [
        fe.Chain(
            state.support_m[k], state.attachment_m[k], state.free_m[k], problem.stiffness_N[k],
            problem.mass_kg_per_m[k], problem.load_N_per_m[k], -state.pull_N[k],
        )
        for k in range(problem.n)
    ]  # fmt: skip
    K, M = fe.assembled(body, chains)
    if "inertia" not in platform:  # a point, whose turns mean nothing
        free = [0, 1, 2, *range(6, len(K))]
        K, M = K[np.ix_(free, free)], M[np.ix_(free, free)]
    width = 6 if "inertia" in platform else 3
    K, M = fe.condensed(K, M, width)
    along = problem.freedoms[:, :width].T
    return fe.frequencies_Hz(along.T @ K @ along, along.T @ M @ along)[0]


def sag_ratio(state: State) -> float:
    """Return the largest sag of a cable over its chord."""
    return float(
        sag_of(state.problem, state.attachment_m, state.support_m, state.pull_N, state.free_m).max()
    )


def clearance_m(state: State, hull_m: np.ndarray | None = None) -> float:
    """Return the smallest distance of two cables without a common end, or of one and the hull."""
    return min(among_cables_m(state), to_platform_m(state, hull_m))


def among_cables_m(state: State) -> float:
    problem, points = state.problem, state.points_m(POINTS)
    near = 1e-9 * np.linalg.norm(np.ptp(problem.exits_m, axis=0))
    best = np.inf
    for i, j in combinations(range(problem.n), 2):
        ends = problem.exits_m[i] - problem.exits_m[j], problem.arms_m[i] - problem.arms_m[j]
        if min(map(np.linalg.norm, ends)) <= near:
            continue
        every = cdist(points[i], points[j])
        at = np.array(np.unravel_index(every.argmin(), every.shape)) / (POINTS - 1)

        def apart(shares: np.ndarray, i: int = i, j: int = j) -> float:
            gap = point_m(state, i, shares[0]) - point_m(state, j, shares[1])
            return float(gap @ gap)

        found = minimize(
            apart, at, method="L-BFGS-B", bounds=[(0.0, 1.0)] * 2,
            options={"ftol": 1e-15, "gtol": 1e-14},
        )  # fmt: skip
        best = min(best, np.sqrt(found.fun), every.min())
    return float(best)


def to_platform_m(state: State, hull_m: np.ndarray | None) -> float:
    """Return how near a cable comes to the platform but for its last piece; infinite of a point."""
    problem = state.problem
    if not problem.arms_m.any():
        return np.inf
    corners = problem.arms_m if hull_m is None else hull_m
    margin = 0.25 * pdist(corners).max()
    best = np.inf
    for cable in range(problem.n):
        beyond = margin / state.free_m[cable]

        def distance(share: float, cable: int = cable) -> float:
            point = point_m(state, cable, share) - state.pose.position_m
            return from_hull_m(corners, point @ state.pose.rotation)

        shares = np.linspace(beyond, 1.0, 60)
        each = [distance(share) for share in shares]
        at = int(np.argmin(each))
        ends = shares[max(at - 1, 0)], shares[min(at + 1, len(shares) - 1)]
        found = minimize_scalar(distance, bounds=ends, method="bounded", options={"xatol": 1e-9})
        best = min(best, found.fun, *each)
    return float(best)


def from_hull_m(corners: np.ndarray, point: np.ndarray) -> float:
    """Return how far a point is from the convex hull of corners, zero inside."""
    much = 1e4 * np.linalg.norm(np.ptp(corners, axis=0))
    rows = np.vstack([corners.T - point[:, None], much * np.ones(len(corners))])
    shares = nnls(rows, np.append(np.zeros(3), much))[0]
    return float(np.linalg.norm(corners.T @ (shares / shares.sum()) - point))
