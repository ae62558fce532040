"""A small proof: true where brute force finds nothing above it, refused where a rope fails."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import Cable, Material
from designer.model.region import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import Orientations, Space
from designer.proof.ahead import compile_apart, compile_here
from designer.proof.encloser import Encloser, covers_of
from designer.proof.enclosure.box import bound_range
from designer.proof.prove import Budget, prove
from designer.statics.inverse import solve_sagging

FOUR = Robot(
    frozen_array([[0, 0, 0], [100, 0, 0], [100, 80, 0], [0, 80, 0]]),
    Platform(1000.0),
    tension_min_N=1100.0,
)
ROPE = Cable(0.01, 0.4, 6e6, 12_000.0)
PART = Space(Prism.box((200.0, 260.0), (120.0, 170.0), (-120.0, -90.0)), Orientations())


def utilisation(robot: Robot, cable: Cable, positions_m: FloatArray) -> FloatArray:
    statics = solve_sagging(robot, Poses.at(positions_m), cable)
    return statics.largest_tension_N / cable.allowable_tension_N


def test_no_pose_exceeds_a_small_proof(fast_robot: Robot, steel: Material) -> None:
    cable = steel.cable(0.06)
    inside = PART.region.inside_m(np.random.default_rng(0), 2000)
    corners = np.stack(np.meshgrid(*PART.region.bounds_m.T), axis=-1).reshape(-1, 3)
    used = utilisation(fast_robot, cable, np.concatenate([inside, corners])).max()
    proof = prove(fast_robot, cable, PART, 0.5 * used, Budget(boxes=1000))
    assert proof.status == "proved"
    assert proof.worst is not None
    assert utilisation(fast_robot, cable, proof.worst[None, :3])[0] == proof.found
    assert used <= proof.found * (1.0 + 1e-9) <= proof.bound <= proof.found * 1.001
    assert proof.fraction == 1.0
    assert 100 < proof.boxes < 1000


def test_proof_counts_wind_off_the_centre_of_mass(six_cable_robot: Robot) -> None:
    body = replace(
        six_cable_robot.platform,
        drag_force_N=np.array([1500.0, -900.0, 0.0]), drag_centre_m=np.array([0.3, 0.2, 20.0]),
    )  # fmt: skip
    robot, cable = replace(six_cable_robot, platform=body), Cable(0.03, 4.0, 1e8, 4e5)
    box, turn = Prism.box((3.0, 5.0), (-4.0, -2.0), (-80.0, -79.0)), [0.01, -0.02, 0.03]
    space = Space(box, Orientations(frozen_array([turn])))
    inside = space.places(box.inside_m(np.random.default_rng(1), 300))
    used = utilisation(robot, cable, inside).max()
    proof = prove(robot, cable, space, 0.5 * used, Budget(boxes=3000), within=0.02)
    assert proof.status == "proved"
    assert used <= proof.bound <= 1.03 * used


def test_a_rope_that_fails_somewhere_is_refuted(fast_robot: Robot, steel: Material) -> None:
    strong = steel.cable(0.06)
    used = float(utilisation(fast_robot, strong, np.array([[200.0, 120.0, -90.0]]))[0])
    weak = replace(strong, allowable_tension_N=0.999 * used * strong.allowable_tension_N)
    proof = prove(fast_robot, weak, PART, 0.5, Budget(boxes=1000))
    assert proof.status == "refuted"
    assert proof.found > 1.0
    assert proof.bound > 1.0


def test_no_pose_of_a_box_exceeds_its_bound(fast_robot: Robot, steel: Material) -> None:
    """Boxes of all shapes, so that each end of distance and drop is that of the bound in some."""
    cable, rng = steel.cable(0.06), np.random.default_rng(1)
    (cover,) = covers_of(PART)
    encloser = Encloser(fast_robot, cable, cover)
    extent = (cover.high - cover.low)[0] * 10.0 ** rng.uniform(-2.0, 0.0, (60, 3))
    low = cover.low[0] + rng.random((60, 3)) * ((cover.high - cover.low)[0] - extent)
    bound = encloser.bound(low, low + extent, np.ones(60), np.inf).bound
    fractions = np.concatenate([rng.random((200, 3)), list(np.ndindex(2, 2, 2))])
    places = cover.places((low[:, None] + fractions * extent[:, None]).reshape(-1, 3))
    used = encloser.utilisation(places).reshape(60, -1).max(axis=1)
    assert np.isfinite(bound).mean() > 0.8
    assert (used <= bound * (1.0 + 1e-12)).all()
    assert (bound / used)[extent.max(axis=1) < 2.0].max() < 1.05


@pytest.mark.parametrize(
    ("name", "share", "falls"),
    # That of three cables is quick, and of the first order.
    [("three", 2.0**-7, 4.0), ("six", 2.0**-5, 16.0), ("four", 2.0**-6, 16.0)],
)
def test_bounds_of_small_boxes_come_near_what_poses_ask_for(
    name: str, share: float, falls: float, fast_robot: Robot, six_cable_robot: Robot
) -> None:
    """The gap falls with the square of the size, so that few boxes prove much."""
    robot, sides = {
        "three": (fast_robot, ((200.0, 260.0), (120.0, 170.0), (-120.0, -90.0))),
        "six": (six_cable_robot, ((-15.0, 15.0), (-15.0, 15.0), (-60.0, -40.0))),
        "four": (replace(FOUR, tension_min_N=0.0), ((30.0, 70.0), (20.0, 60.0), (-40.0, -20.0))),
    }[name]
    (cover,) = covers_of(Space(Prism.box(*sides), Orientations()))
    encloser, extent = Encloser(robot, ROPE, cover), (cover.high - cover.low)[0]
    middle = cover.low[0] + np.random.default_rng(3).uniform(0.1, 0.9, (20, 3)) * extent
    gaps = []
    for half in (0.5 * share * extent, 0.125 * share * extent):
        bound = encloser.bound(middle - half, middle + half, np.full(20, 1e-6), np.inf).bound
        corners = middle[:, None] + half * np.array(list(np.ndindex(2, 2, 2))) * 2.0 - half
        used = encloser.utilisation(cover.places(corners.reshape(-1, 3))).reshape(20, 8)
        gaps.append(bound / used.max(axis=1) - 1.0)
    assert gaps[0].max() < 0.02
    assert (gaps[0] / gaps[1] > 0.85 * falls).all()


def test_bounds_of_a_machine_on_a_desk_are_those_of_a_large_one(fast_robot: Robot) -> None:
    """All lengths and forces divided by the same number, the weight of the cables left as it is."""
    small, rng = 1.0 / 1024.0, np.random.default_rng(4)
    platform = replace(FOUR.platform, mass_kg=small * FOUR.platform.mass_kg)
    desk = replace(
        FOUR,
        exit_points_m=frozen_array(small * FOUR.exit_points_m),
        platform=platform,
        tension_min_N=small * FOUR.tension_min_N,
    )
    thread = Cable(0.01, 0.4, small * ROPE.axial_stiffness_N, small * ROPE.allowable_tension_N)
    low = rng.uniform([10.0, 10.0, -60.0], [80.0, 65.0, -30.0], (40, 3))
    high = low + 10.0 ** rng.uniform(-1.0, 1.0, (40, 3))
    bounds = []
    for robot, rope, scale in ((FOUR, ROPE, 1.0), (desk, thread, small)):
        box = Prism.box(*(scale * np.array([[0, 100], [0, 80], [-70, -10]])).tolist())
        (cover,) = covers_of(Space(box, Orientations()))
        encloser = Encloser(robot, rope, cover)
        bounds.append(encloser.bound(scale * low, scale * high, np.full(40, 0.1), np.inf).bound)
    is_bounded = np.isfinite(bounds[0])
    assert 5 < is_bounded.sum() < 35
    assert (is_bounded == np.isfinite(bounds[1])).all()
    assert bounds[1][is_bounded] == pytest.approx(bounds[0][is_bounded], rel=1e-9)


def test_what_is_compiled_ahead_is_what_a_proof_runs(fast_robot: Robot, steel: Material) -> None:
    compile_here()
    prove(fast_robot, steel.cable(0.06), PART, 0.5, Budget(boxes=10))
    assert len(bound_range.signatures) == 1


@pytest.mark.slow
def test_another_process_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert compile_apart().wait() == 0
    assert [*tmp_path.rglob("*bound_range*.nbc")]


def test_a_proof_is_the_same_however_fast_the_clock_goes(
    fast_robot: Robot, steel: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Boxes end it unless a time is given, which is told where it did."""
    cable = steel.cable(0.06)
    calm = prove(fast_robot, cable, PART, 0.5, Budget(boxes=900))
    now = time.monotonic()
    ticks = count()
    monkeypatch.setattr("designer.proof.prove.time.monotonic", lambda: now + 1e4 * next(ticks))
    hurried = prove(fast_robot, cable, PART, 0.5, Budget(boxes=900))
    assert hurried.status == calm.status
    assert hurried.boxes == calm.boxes
    assert hurried.bound == calm.bound
    whole = Space(Prism.over(fast_robot.exit_points_m, 10.35, (-200.0, -40.0)), Orientations())
    cut = prove(fast_robot, cable, whole, 0.5, Budget(seconds=20.0), enough=1.001)
    assert cut.status == "partial"
    assert cut.reason == "the time given, 20 s, ended it before all was decided"
