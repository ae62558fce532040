"""Load cases that carry the platform away, against non-negative least squares."""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from designer.analysis.findings import Findings, equilibrium_losses
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Wind
from designer.model.region import Prism
from designer.model.robot import Platform, Robot
from designer.model.workspace import Workspace
from designer.report.templates import environment

EXITS = np.array([[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.0], [2, 24, 12.0]])
WORKSPACE = Workspace(Prism.box((8, 20), (4, 14), (1, 8)), samples=30)
CABLE = Cable(0.005, 0.1, 1e6, 1e4)

SHOWN = environment().from_string(
    '{% from "report/statements.html.j2" import not_in_equilibrium with context %}'
    "{{ not_in_equilibrium(findings) }}"
)


def left_N(place: np.ndarray, load_N: np.ndarray, exits: np.ndarray) -> float:
    """Return what pulls of straight cables leave of a load."""
    chord = exits - place
    return float(nnls((chord / np.linalg.norm(chord, axis=1)[:, None]).T, -load_N)[1])


def test_share_and_direction_are_those_of_pulls_alone() -> None:
    for count in (3, 4):
        robot = Robot(EXITS[:count], Platform(40.0, drag_area_m2=1.2))
        storm = LoadCase("storm", wind=Wind(28.0, 1.2, count=4))
        (loss,) = equilibrium_losses(robot, WORKSPACE, (LoadCase("static"), storm), CABLE)
        assert loss.loaded.wind is not None
        push = 0.5 * 1.25 * 28.0**2 * 1.2 * loss.loaded.wind
        load = np.array([0.0, 0.0, -40.0 * 9.81]) + push
        np.testing.assert_allclose(loss.push_N, np.linalg.norm(push), rtol=1e-12)
        assert left_N(loss.place, load, robot.exit_points_m) > 1.0
        assert left_N(loss.place, load - push, robot.exit_points_m) < 1e-6
        assert 0.1 < loss.share <= 1.0
        text = SHOWN.render(findings=Findings(equilibrium_losses=(loss,)), paged=False)
        assert '<p class="statement bad">' in text
        assert "load case &#39;storm&#39;" in text


def test_a_breeze_carries_nothing_away() -> None:
    robot = Robot(EXITS[:3], Platform(400.0, drag_area_m2=1.2))
    breeze = LoadCase("breeze", wind=Wind(5.0, 1.2)), LoadCase("start", acceleration_m_per_s2=0.2)
    assert not list(equilibrium_losses(robot, WORKSPACE, breeze, CABLE))
