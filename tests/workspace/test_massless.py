"""The worst pose of straight weightless cables: of the poses that count, and none without bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from report_parts import paragraphs

from designer.analysis.analyse import analyse
from designer.arrays import frozen_array
from designer.cli.tables import summary_rows
from designer.io.config import read_study
from designer.model.prism import Prism
from designer.model.robot import Poses
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.resources import example_file
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_massless
from designer.study import Study
from designer.workspace.demand import is_left_out
from designer.workspace.sweep import map_workspace


def ipanema(region: Prism) -> Study:
    """IPAnema, where each cable keeps 30 N and the platform is turned a little."""
    study = read_study(example_file("ipanema"))
    turn = frozen_array([[0.04, -0.056, 0.073]])
    workspace = Workspace(region, samples=500, orientations=Orientations(turn))
    return replace(study, workspace=workspace, pose=None, selection=None)


INSIDE = Prism.box((-0.4, 0.2), (-0.2, 0.2), (0.4, 0.8))
ACROSS = Prism.box((-0.918, -0.159), (-0.382, 0.664), (1.018, 1.24))


def test_toward_a_pose_that_straight_cables_do_not_hold_their_tension_has_no_bound() -> None:
    study = ipanema(ACROSS)
    assert study.workspace is not None
    places = next(iter(study.workspace.places()))

    def tension(place: np.ndarray) -> float:
        return float(solve_massless(study.robot, Poses.at(place)).largest_tension_N)

    held = [place for place in places if np.isfinite(tension(place))]
    inside, outside = held[0], next(place for place in places if np.isnan(tension(place)))
    start = tension(inside)
    for _ in range(40):
        middle = 0.5 * (inside + outside)
        if np.isnan(tension(middle)):
            outside = middle
        else:
            inside = middle
    assert tension(inside) > 1e3 * start
    assert map_workspace(study.robot, study.workspace, study.material).massless is None


def test_where_straight_cables_hold_everything_their_worst_pose_is_told() -> None:
    study = ipanema(INSIDE)
    assert study.workspace is not None
    found = map_workspace(study.robot, study.workspace, study.material).massless
    assert found is not None
    tensions = solve_massless(study.robot, Poses.at(next(iter(study.workspace.places()))))
    assert found.max_tension_N >= np.max(tensions.largest_tension_N)
    again = solve_massless(study.robot, found.pose).largest_tension_N
    assert found.max_tension_N == pytest.approx(float(again))


@pytest.mark.slow
def test_it_is_of_the_poses_that_count(fast_robot, steel) -> None:
    triangle = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
    region = Prism.over(triangle, 0.0, (-200.0, -40.0))
    workspace = Workspace(region, samples=2000, hangs_below="exclude")
    found = map_workspace(fast_robot, workspace, steel).massless
    assert found is not None
    sizing = size_poses(fast_robot, found.pose, steel)
    assert not is_left_out(sizing.statics, "exclude")
    places = next(iter(workspace.places()))
    sizing = size_poses(fast_robot, Poses.at(places), steel)
    counts = ~is_left_out(sizing.statics, "exclude")
    assert np.isfinite(sizing.massless_tension_N[counts]).all()
    assert found.max_tension_N > sizing.massless_tension_N[counts].max()
    assert found.max_tension_N < sizing.massless_tension_N[~counts].max()


def test_sag_may_hold_what_straight_cables_do_not() -> None:
    study = read_study(example_file("robocrane"))
    region = Prism.box((-0.997, 0.601), (1.143, 1.159), (-0.473, 0.964))
    workspace = Workspace(region, samples=2000)
    found = map_workspace(study.robot, workspace, study.material)
    assert found.is_feasible
    assert found.massless is None


def test_terminal_and_report_say_that_there_is_none(tmp_path) -> None:
    analysis = analyse(ipanema(ACROSS), folder=tmp_path)
    said = dict(summary_rows(analysis))
    assert said["  massless"] == "none: straight cables do not hold every pose"
    page = section(Drawings(analysis, draws=False, missing="pictures"), "workspace")
    start = "Straight weightless cables do not hold every"
    assert any(text.startswith(start) for text in paragraphs(page))
