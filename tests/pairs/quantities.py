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


def _on_elements(state: State, text) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Stiffness and mass of the platform's freedoms and all inner nodes, and of the platform."""
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
    own, width = body.matrices(np.zeros((problem.n, 3)))[1], len(problem.freedoms)
    along = np.zeros((width + len(K) - 6, len(K)))
    along[:width, :6], along[width:, 6:] = problem.freedoms, np.eye(len(K) - 6)
    own = problem.freedoms @ own @ problem.freedoms.T
    return along @ K @ along.T, along @ M @ along.T, own, width


def frequencies_Hz(state: State, text) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies of platform and cables, and the platform's shares of the energy.

    Of the cables alone where the inertia of a body is not given.
    """
    K, M, own, width = _on_elements(state, text)
    platform = text["robot"]["platform"]
    if "attachments" in platform and "inertia" not in platform:
        held = fe.frequencies_Hz(K[width:, width:], M[width:, width:])[0]
        return held, np.zeros(len(held))
    frequencies, shapes = fe.frequencies_Hz(K, M)
    moved = shapes[:width]
    return frequencies, np.einsum("ik,ij,jk->k", moved, own, moved)


def least_eigenvalue_N_per_m(state: State) -> float:
    """Return the lowest eigenvalue of the stiffness, turns as displacements of attachments."""
    farthest = float(np.linalg.norm(state.problem.arms_m, axis=1).max()) or 1.0
    displacement = compliance(state, reach_m=farthest)
    return np.nan if displacement is None else float(1.0 / np.linalg.norm(displacement, ord=2))


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
