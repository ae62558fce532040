"""A platform on cables of truss elements, by nothing of ours but lengths and sections.

Each cable is a chain of straight elastic elements with its mass in the nodes, hung between exit
point and attachment; its stiffness is EA along an element and its tension over its length across.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import root

GRAVITY = 9.81


@dataclass(frozen=True)
class Chain:
    """A cable: end points (3,), unstrained length, EA, mass and load (3,) per length."""

    start_m: np.ndarray
    end_m: np.ndarray
    length_m: float
    axial_stiffness_N: float
    linear_density: float
    load_N_per_m: np.ndarray
    force_N: np.ndarray  # first guess of the force on it at its end, (3,)
    elements: int = 40

    def forces(self, end_force_N: np.ndarray) -> np.ndarray:
        """Force in each element, from the exit point down, toward the end (elements, 3)."""
        n = self.elements
        below = (n - 1 - np.arange(n) + 0.5) * self.length_m / n
        return end_force_N + np.outer(below, self.load_N_per_m)

    def spans(self, end_force_N: np.ndarray) -> np.ndarray:
        force = self.forces(end_force_N)
        tension = np.linalg.norm(force, axis=1)[:, None]
        return force / tension * (1.0 + tension / self.axial_stiffness_N) * self.unstrained

    @property
    def unstrained(self) -> float:
        return self.length_m / self.elements

    def hung(self) -> np.ndarray:
        """Force at the end with which the chain reaches it."""
        size = np.linalg.norm(self.force_N)
        gap = self.end_m - self.start_m

        def miss(force):
            return (self.spans(force * size).sum(axis=0) - gap) / np.linalg.norm(gap)

        found = root(miss, self.force_N / size, tol=1e-12)
        assert np.abs(miss(found.x)).max() < 1e-9
        return found.x * size

    def matrices(self, end_force_N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness and mass of its nodes but the first (3 elements, 3 elements)."""
        n, h = self.elements, self.unstrained
        K, m = np.zeros((n + 1, 3, n + 1, 3)), np.zeros(n + 1)
        rows = zip(self.forces(end_force_N), self.spans(end_force_N), strict=True)
        for k, (force, span) in enumerate(rows):
            long, tension = np.linalg.norm(span), np.linalg.norm(force)
            t = span / long
            along = np.outer(t, t)
            block = self.axial_stiffness_N / h * along + tension / long * (np.eye(3) - along)
            for i, j, sign in ((k, k, 1), (k + 1, k + 1, 1), (k, k + 1, -1), (k + 1, k, -1)):
                K[i, :, j] += sign * block
            m[k : k + 2] += 0.5 * self.linear_density * h
        size = 3 * n
        return K[1:, :, 1:].reshape(size, size), np.diag(np.repeat(m[1:], 3))


def cross(v: np.ndarray) -> np.ndarray:
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


@dataclass(frozen=True)
class Body:
    """Mass, inertia about the centre of mass and its lever, levers (n, 3), force there; world."""

    mass_kg: float
    inertia: np.ndarray
    arm_m: np.ndarray
    levers_m: np.ndarray
    centre_force_N: np.ndarray
    turns: bool = True

    def matrices(self, end_forces_N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness of forces that stay as the body turns, by the second variation, and mass."""
        K, M, c = np.zeros((6, 6)), np.zeros((6, 6)), self.arm_m
        pulls = [*zip(-end_forces_N, self.levers_m, strict=True)]
        for f, b in (*pulls, (self.centre_force_N, c)):
            K[3:, 3:] += (f @ b) * np.eye(3) - 0.5 * (np.outer(f, b) + np.outer(b, f))
        T = np.hstack([np.eye(3), -cross(c)])
        M += self.mass_kg * T.T @ T
        M[3:, 3:] += self.inertia
        return K, M


def assembled(body: Body, chains: list[Chain]) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of the platform (first 3 or 6) and of all inner nodes."""
    dof = 6 if body.turns else 3
    inner = 3 * (chains[0].elements - 1)
    size = dof + inner * len(chains)
    ends = np.array([chain.hung() for chain in chains])
    K, M = np.zeros((size, size)), np.zeros((size, size))
    own_K, own_M = body.matrices(ends)
    K[:dof, :dof], M[:dof, :dof] = own_K[:dof, :dof], own_M[:dof, :dof]
    for number, (chain, lever) in enumerate(zip(chains, body.levers_m, strict=True)):
        T = np.zeros((inner + 3, size))
        T[:inner, dof + number * inner : dof + (number + 1) * inner] = np.eye(inner)
        T[inner:, :dof] = np.hstack([np.eye(3), -cross(lever)])[:, :dof]
        k, m = chain.matrices(ends[number])
        K += T.T @ k @ T
        M += T.T @ m @ T
    return 0.5 * (K + K.T), M


def frequencies_Hz(K: np.ndarray, M: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies, ascending, and shapes in columns of unit modal mass."""
    squares, shapes = eigh(K, M)
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi), shapes


def condensed(K: np.ndarray, M: np.ndarray, dof: int) -> tuple[np.ndarray, np.ndarray]:
    """The platform alone, inner nodes following it at rest."""
    follow = np.vstack([np.eye(dof), -np.linalg.solve(K[dof:, dof:], K[dof:, :dof])])
    return follow.T @ K @ follow, follow.T @ M @ follow
