"""A small proof: true where brute force finds nothing above it, refused where a rope fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable, Material
from designer.model.prism import Prism
from designer.model.robot import Poses, Robot
from designer.model.space import Orientations, Space
from designer.proof.cover import covers_of
from designer.proof.encloser import Encloser
from designer.proof.prove import Budget, prove
from designer.statics.inverse import solve_sagging

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
