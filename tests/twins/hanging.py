"""Where a platform comes to rest that its cables let sway, by the quadrature of `twins.physics`.

With fewer cables than degrees of freedom some directions of the platform are free: it moves along
them until weight and pulls balance. The pulls are eliminated cable by cable: as the platform moves
by (δx, δω), the end of a cable with lever a moves by δx + δω × a, and its pull changes by the
inverse of the slope of its reach.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from twins.physics import (
    MAX_STEPS,
    NODES,
    Equilibrium,
    Machine,
    _balance_matrix,
    _cable,
    _load,
    _strain,
    _support,
    _weight,
    _wrench,
    least_tensions_N,
)

STEP_M, STEP_RAD = 0.02, 0.1


def hang(
    machine: Machine,
    position_m: np.ndarray,
    rotation: np.ndarray,
    free: tuple[int, ...],
    length_m: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray, Equilibrium]:
    """Return positions, rotations and equilibrium near given poses (rows, 3), (rows, 3, 3).

    Raises where Newton fails.

    Parameters
    ----------
    free : tuple of int
        Directions in which the platform may move: 0 … 2 along the axes, 3 … 5 about them. As many
        as degrees of freedom beyond the cables, which find their lengths; or all of them.
    length_m : array (rows, cables), optional
        Lengths between exit and platform to start from, or to keep where all directions are free.
    """
    arm = np.einsum("rij,nj->rni", rotation, machine.attachment_m)
    chord = machine.exit_m - position_m[:, None, :] - arm
    length = np.linalg.norm(chord, axis=-1) if length_m is None else length_m
    tension = np.abs(least_tensions_N(machine, position_m, rotation))
    tension = np.maximum(tension, 0.02 * tension.max())[..., None]
    pull = tension * chord / length[..., None] + 0.5 * _weight(machine, length)
    for _ in range(10 * MAX_STEPS):
        arm = np.einsum("rij,nj->rni", rotation, machine.attachment_m)
        move, spool, tug, wrap = _step(machine, position_m, rotation, arm, pull, length, free)
        far = np.linalg.norm(move[:, :3], axis=1) / (STEP_M * length.max(1))
        turn = np.linalg.norm(move[:, 3:], axis=1) / STEP_RAD
        change = (np.linalg.norm(tug, axis=-1) / np.linalg.norm(pull, axis=-1)).max(1) / 0.5
        part = 1.0 / np.maximum.reduce([np.ones_like(far), far, turn, change])[:, None]
        position_m = position_m + part * move[:, :3]
        if machine.has_moments:
            rotation = Rotation.from_rotvec(part * move[:, 3:]).as_matrix() @ rotation
        length = length + part * spool
        pull = pull + part[..., None] * tug
        if max(far.max(), turn.max(), change.max()) < 1e-11:
            break
    else:
        raise RuntimeError("no equilibrium")
    end = pull - _weight(machine, length)
    tension = np.linalg.norm(end, axis=-1)
    whole = length + wrap / (1 + _strain(machine, tension)[0])
    return position_m, rotation, Equilibrium(whole, tension, pull, end)


def _step(
    machine: Machine,
    position_m: np.ndarray,
    rotation: np.ndarray,
    arm: np.ndarray,
    pull: np.ndarray,
    length: np.ndarray,
    free: tuple[int, ...],
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | float]:
    """Return Newton's step of platform, lengths and pulls, the support held still, and the wrap."""
    end, reach, slope, along = _cable(machine, pull, length, NODES[1])
    point = position_m[:, None, :] + arm
    support, wrap = _support(machine, point, pull, end, length)
    gap = point + reach - support
    balance = _balance_matrix(machine, arm)
    by_gap = np.einsum("rdni,rnij->rdnj", balance, np.linalg.inv(slope))
    carried = np.broadcast_to(np.eye(3), (*arm.shape, 3))
    if machine.has_moments:
        carried = np.concatenate([carried, -_cross(arm)], axis=-1)
    stiffness = np.einsum("rdnj,rnjk->rdk", by_gap, carried)
    left = _load(machine, rotation) + _wrench(machine, pull, arm)
    left = left - np.einsum("rdnj,rnj->rd", by_gap, gap)
    if machine.has_moments:
        weight = np.asarray(machine.mass_kg)[..., None] * machine.gravity
        stiffness[:, 3:, 3:] -= (_cross(pull) @ _cross(arm)).sum(1)
        stiffness[:, 3:, 3:] -= _cross(weight) @ _cross(rotation @ machine.centre_m)
    move, spool = np.zeros(left.shape), np.zeros(length.shape)
    matrix = stiffness[:, :, list(free)]
    if len(free) < left.shape[1]:
        by_length = np.einsum("rdnj,rnj->rdn", by_gap, along)
        matrix = np.concatenate([matrix, by_length], axis=-1)
    found = np.linalg.solve(matrix, left[..., None])[..., 0]
    move[:, list(free)] = found[:, : len(free)]
    if len(free) < left.shape[1]:
        spool = found[:, len(free) :]
    follow = gap + np.einsum("rnik,rk->rni", carried, move) + along * spool[..., None]
    return move, spool, -np.einsum("rnij,rnj->rni", np.linalg.inv(slope), follow), wrap


def _cross(vector: np.ndarray) -> np.ndarray:
    """Return the matrices of ``vector ×`` (..., 3, 3)."""
    return np.cross(vector[..., None, :], np.eye(3)).swapaxes(-1, -2)
