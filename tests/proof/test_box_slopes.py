"""Slopes from the middle of a box enclose all changes in it: the balance of random poses."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from redundant_robots import FOUR, SEVEN
from sample_robots import COGIRO

from designer.arrays import FloatArray
from designer.kernel.compiling import kernel
from designer.model.cable import Cable
from designer.model.region import Prism
from designer.model.robot import Poses, Robot
from designer.model.space import Orientations, Space
from designer.physics import catenary
from designer.proof import encloser as encloser_module
from designer.proof.encloser import Encloser, covers_of
from designer.proof.enclosure.box import (
    T_P,
    T,
    _bend,
    _lowest_slope,
    _place,
    _prepare,
    _slopes,
    along,
    new_work,
)

pytestmark = pytest.mark.slow  # compiles a kernel that other quick tests do without


@kernel
def slopes_of_box(scene, boxes, at, U, P, Z, of_x, of_u, tension, lowest):
    """Fill what is enclosed over a box where the balance is mended by U at most."""
    n, k = P.shape
    work = new_work(n, U.size, k)
    if not _prepare(scene, boxes, at, work):
        return False
    work.U[:] = U
    _place(scene, boxes, at, 1.0, work)
    if not _bend(scene, boxes, at, 1.0, work):
        return False
    _slopes(scene, boxes, at, 1.0, work)
    P[:], Z[:], of_x[:], of_u[:] = work.P, work.Z, work.of_x, work.of_u
    for i in range(n):
        for d in range(k):
            tension[i, d] = along(work, i, d, T)
            lowest[i, d] = _lowest_slope(work, i, d)
        tension[i, k] = work.cable[i, T_P, 0], work.cable[i, T_P, 1]
        lowest[i, k] = _lowest_slope(work, i, -1)
    return True


def boxes_of(
    robot: Robot, cable: Cable, space: Space, low: FloatArray, high: FloatArray
) -> tuple[Encloser, Any, Any]:
    """Return the encloser, and what it hands to the kernel."""
    (cover,) = covers_of(space)
    encloser = Encloser(robot, cable, cover)
    handed: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:

        def keep(_solve: Any, count: int, _share: int, *arguments: Any) -> None:
            handed.extend(arguments)
            handed[-1][:] = 0.0

        patch.setattr(encloser_module, "share_out", keep)
        encloser.bound(low, high, np.full(len(low), 0.25), 1.0)
    return encloser, handed[0], handed[1]


def balance(robot: Robot, cable: Cable, place: FloatArray, pull: FloatArray) -> tuple[Any, ...]:
    """Return the unbalanced wrench over weight, top tensions, and squares of the least ones."""
    w, poses = cable.weight_N_per_m, Poses.at(place[None])
    rotation = poses.rotation.reshape(3, 3)
    levers = robot.attachments_m @ rotation.T
    vectors = robot.exit_points_m - place[:3] - levers
    X, D = np.hypot(vectors[:, 0], vectors[:, 1]), vectors[:, 2]
    length, force_z = catenary.length_and_force_z(w * pull, X, D, cable.axial_stiffness_N, w)
    force = np.column_stack([pull * vectors[:, 0], pull * vectors[:, 1], -force_z / w])
    wrench = np.concatenate([force.sum(axis=0), np.cross(levers, force).sum(axis=0)])
    load = robot.loads_N()[0].copy()
    for point_m, pull_N in robot.turning_pulls_N:
        load[3:] += np.cross(rotation @ point_m, pull_N)
    top, bottom = catenary.end_tensions_N(length, w * pull * X, force_z, w)
    lift = np.where(D >= 0.0, -force_z, w * length + force_z) / w
    at_end = (pull * X) ** 2 + np.maximum(lift, 0.0) ** 2
    return (wrench - load / w)[robot.balance_rows], np.maximum(top, bottom) / w, at_end


IN_WIND = replace(
    COGIRO.platform,
    drag_force_N=np.array([400.0, -250.0, 0.0]), drag_centre_m=np.array([0.2, 0.1, 1.5]),
)  # fmt: skip
CASES = {
    "eight in wind": (
        replace(COGIRO, platform=IN_WIND),
        ((-2.0, 2.0), (-2.0, 2.0), (1.0, 2.5)),
        0.3,
    ),
    "four": (FOUR, ((30.0, 70.0), (20.0, 60.0), (-60.0, -30.0)), 0.0),
    "eight": (COGIRO, ((-2.0, 2.0), (-2.0, 2.0), (1.0, 2.5)), 0.3),
    "seven": (SEVEN, ((-1.0, 1.0), (-1.0, 1.0), (1.0, 2.5)), 0.3),
}


@pytest.mark.parametrize("case", list(CASES))
def test_changes_lie_within_the_slopes(case: str) -> None:
    robot, sides, turn = CASES[case]
    cable = Cable(0.004, 0.06, 8e5, 5e3)
    orientations = Orientations.within([-turn] * 3, [turn] * 3) if turn else Orientations()
    space = Space(Prism.box(*sides), orientations)
    (cover,) = covers_of(space)
    rng = np.random.default_rng(11)
    extent, k = (cover.high - cover.low)[0], cover.low.shape[1]
    size = extent * 2.0 ** rng.uniform(-9.0, -3.0, (60, 1)) * rng.uniform(0.3, 1.0, (60, k))
    size[::3, :3] *= 1e-3  # there turns alone tell
    low = cover.low[0] + rng.random((60, k)) * (extent - size)
    encloser, scene, boxes = boxes_of(robot, cable, space, low, low + size)
    n, m = robot.n_cables, robot.balance_rows.size
    enclosed = 0
    for at in range(len(low)):
        U = 1e-6 * rng.uniform(0.1, 1.0, m) * robot.weight_N / cable.weight_N_per_m
        P, Z = np.zeros((n, k)), np.zeros((n, m))
        of_x, of_u = np.zeros((m, k, 2)), np.zeros((m, m, 2))
        tension, lowest = np.zeros((2, n, k + 1, 2))
        if not slopes_of_box(scene, boxes, at, U, P, Z, of_x, of_u, tension, lowest):
            continue
        enclosed += 1
        middle, half = low[at] + 0.5 * size[at], 0.5 * size[at]
        start = balance(robot, cable, encloser.cover.places(middle[None])[0], boxes.pull[at])
        for _ in range(20):
            x = half * rng.choice([-1.0, 1.0], k) * rng.choice([1.0, rng.random()], k)
            u = U * rng.choice([-1.0, 1.0], m)
            pull = boxes.pull[at] + P @ x + Z @ u
            place = encloser.cover.places((middle + x)[None])[0]
            rest, top, at_end = balance(robot, cable, place, pull)
            # of_u is of the identity less the slopes
            mended = _sum(of_x, x) + _sum(of_u, -u)
            scale = np.abs(start[0]).max() + robot.weight_N / cable.weight_N_per_m
            assert _within(rest - start[0] - u, mended, 1e-10 * scale)
            grows = _sum(tension[:, :k], x) + _ends(tension[:, k], P @ x + Z @ u)
            assert _within(top - start[1], grows, 1e-10 * start[1].max())
            ends = boxes.vectors[at, :, 2] + np.outer([-1.0, 1.0], np.abs(half).sum() * np.ones(n))
            known = (ends > 0.0).all(axis=0)  # all of these cables have their lower end below
            change = _sum(lowest[:, :k], x) + _ends(lowest[:, k], Z @ u)
            inside = _inside(at_end - start[2], change, 1e-10 * start[2].max())
            assert inside[known].all()
    assert enclosed > 35


def _ends(slope: FloatArray, change: FloatArray) -> FloatArray:
    """Return the ends (2, …) of slopes (…, 2) times changes (…)."""
    both = slope * change[..., None]
    return np.stack([both.min(axis=-1), both.max(axis=-1)])


def _sum(slopes: FloatArray, change: FloatArray) -> FloatArray:
    """Return the ends (2, n) of Σ slopes (n, k, 2) times changes (k,)."""
    return _ends(slopes, np.broadcast_to(change, slopes.shape[:2])).sum(axis=-1)


def _inside(value: FloatArray, ends: FloatArray, slack: float) -> Any:
    return (ends[0] - slack <= value) & (value <= ends[1] + slack)


def _within(value: FloatArray, ends: FloatArray, slack: float) -> bool:
    return bool(_inside(value, ends, slack).all())
