"""Sets of wrenches: nothing in a box asks for more than is stated of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linprog

import designer
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded, WrenchSet
from designer.model.robot import Platform, Poses, Robot
from designer.selection.cases import worst_load_direction
from designer.statics.inverse import solve_massless, solve_sagging

G = 9.81
CABLE = Cable(0.006, 0.1, 2e6, 5e3)
CRANE = """
name: Crane
robot:
  anchors: [[0, 0, 12], [14, 0, 12], [6, 11, 12]]
  platform: {mass: 60 kg}
cable: {grade: unirope-6x36-iwrc-1960}
workspace:
  region: {box: [[4, 8], [3, 5], [2, 8]]}
  samples: 200
  proof: 0 s
selection: {grades: [unirope-6x36-iwrc-1960], safety_factor: 5}
load_cases:
  - name: pulled
    dynamic_factor: 1.2
    wrench_set: {force: [[-60, 90], [-80, 40], [-900, 250]]}
  - name: tool
    wrench_set: [{force: [50, 0, -400]}, {force: [-80, 20, 0]}]
"""


def straight_tension_N(exits_m: np.ndarray, place_m: np.ndarray, load_N: np.ndarray) -> float:
    """Return the least largest tension of straight cables; infinite where none holds the load."""
    along = (exits_m - place_m).T
    along = along / np.linalg.norm(along, axis=0)
    n = len(exits_m)
    held = np.column_stack([along, np.zeros(3)])
    below = np.column_stack([np.eye(n), -np.ones(n)])
    answer = linprog(
        np.eye(n + 1)[n], below, np.zeros(n), held, -load_N, bounds=[(0.0, None)] * (n + 1)
    )
    return float(answer.fun) if answer.status == 0 else np.inf


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n_cables", [3, 4])
def test_corners_bound_straight_cables(n_cables: int, seed: int) -> None:
    rng = np.random.default_rng([734, n_cables, seed])
    turn = 2.0 * np.pi * (np.arange(n_cables) + rng.uniform(-0.2, 0.2, n_cables)) / n_cables
    exits_m = np.column_stack(
        [8.0 * np.cos(turn), 8.0 * np.sin(turn), rng.uniform(8, 10, n_cables)]
    )
    robot, place = Robot(exits_m, Platform(80.0)), rng.uniform([-1, -1, 2], [1, 1, 5])
    ends = rng.uniform([-80, -80, -500], [80, 80, 200], (2, 3))
    bounds = [np.append(end, np.zeros(3)) for end in ends]
    case = LoadCase("box", dynamic_factor=1.3, wrench_set=WrenchSet.between(*bounds))
    loads = list(case.on(robot, CABLE))
    assert len(loads) == case.direction_count(robot) == 8
    corners = [float(solve_massless(one.robot, Poses.at(place)).largest_tension_N) for one in loads]
    shares = rng.uniform(size=(300, 3))
    weight = np.array([0.0, 0.0, -80.0 * G])
    forces = ends[0] + shares * (ends[1] - ends[0])
    inside = [straight_tension_N(exits_m, place, 1.3 * (weight + force)) for force in forces]
    assert max(inside) <= max(corners) * (1.0 + 1e-9)
    at_corners = [
        straight_tension_N(exits_m, place, 1.3 * weight + one.robot.platform.wrench_N[:3])
        for one in loads
    ]
    np.testing.assert_allclose(corners, at_corners, rtol=1e-7)


@pytest.fixture(scope="module")
def analysis(tmp_path_factory: pytest.TempPathFactory) -> designer.Analysis:
    path = Path(tmp_path_factory.mktemp("crane")) / "crane.yaml"
    path.write_text(CRANE, encoding="utf-8")
    return designer.analyse(designer.read_study(path))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_no_wrench_of_a_box_asks_sagging_cables_for_more(
    analysis: designer.Analysis, seed: int
) -> None:
    rng = np.random.default_rng([91, seed])
    assert analysis.chosen is not None
    pulled, tool = analysis.chosen.cases
    places = rng.uniform([4, 3, 2], [8, 5, 8], (150, 3))
    for found, low, high in (
        (pulled, [-60, -80, -900], [90, 40, 250]),
        (tool, [50, 0, -400], [50, 0, -400]),
        (tool, [-80, 20, 0], [-80, 20, 0]),
    ):
        for _ in range(20):
            wrench_N = np.append(rng.uniform(low, high), np.zeros(3))
            robot, cable = found.loaded.bare
            other = found.case.under(robot, cable, wrench_N=wrench_N)
            statics = solve_sagging(other.robot, Poses.at(places), other.cable)
            assert statics.is_solved.all()
            most_N = found.verification.max_tension_N * (1.0 + 1e-6)
            assert statics.cable_tension_N.max() <= most_N
    assert pulled.utilisation > tool.utilisation


@pytest.mark.slow
def test_worst_wrench_is_in_words_and_files(analysis: designer.Analysis) -> None:
    pulled, tool = analysis.to_dict()["load_cases"]
    assert pulled["wrench_N"][2] == -900.0
    assert tool["wrench_N"][:3] in ([50.0, 0.0, -400.0], [-80.0, 20.0, 0.0])
    directions = [check["direction"] for check in analysis.to_dict()["checks"]]
    assert any("-900) N" in (direction or "") for direction in directions)


def test_the_inside_of_a_box_is_searched() -> None:
    robot = Robot(np.array([[0, 0, 9.0], [9, 0, 9], [4, 8, 9]]), Platform(50.0))
    ends = np.array([[-40.0, 0, -90, 0, 0, 0], [60.0, 0, 10, 0, 0, 0]])
    case = LoadCase("box", wrench_set=WrenchSet.between(*ends))
    peak = np.array([23.0, 0, -31, 0, 0, 0])

    def severity_of(loaded: Loaded) -> float:
        assert loaded.wrench_N is not None
        return -float(np.linalg.norm(loaded.wrench_N - peak))

    first = next(iter(case.on(robot, CABLE)))
    found, _ = worst_load_direction(first, severity_of(first), severity_of)
    assert found.wrench_N is not None
    np.testing.assert_allclose(found.wrench_N, peak, atol=1e-3)


def test_a_list_has_nothing_between() -> None:
    robot = Robot(np.array([[0, 0, 9.0], [9, 0, 9], [4, 8, 9]]), Platform(50.0))
    listed = LoadCase("list", wrench_set=WrenchSet(np.eye(6)[:3]))
    assert not any(one.is_direction_searched for one in listed.on(robot, CABLE))
    with pytest.raises(ValueError, match="1 to 64 wrenches"):
        WrenchSet(np.zeros((65, 6)))
    with pytest.raises(ValueError, match="exclude each other"):
        LoadCase("both", wrench_N=np.zeros(6), wrench_set=WrenchSet(np.eye(6)))
