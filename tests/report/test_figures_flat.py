"""Figures of robots and regions that lie in a vertical plane, and of turned platforms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report_parts import pictures

from designer.analysis.analyse import Analysis
from designer.analysis.maps import WorkspaceMaps, workspace_maps
from designer.analysis.provenance import Provenance
from designer.arrays import frozen_array
from designer.grades.registry import Catalogue
from designer.io.config import read_study
from designer.model.region import PointList
from designer.model.robot import Poses
from designer.model.space import Orientations
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.figures.scenes import edges_m
from designer.report.phrases import described_orientations, described_region
from designer.resources import example_file
from designer.sizing.newton import size_poses
from designer.study import Study

pytestmark = pytest.mark.slow


def analysed(study: Study, folder: Path) -> Analysis:
    return Analysis(study, Catalogue((), (), ()), Provenance.now(), folder)


@pytest.fixture(scope="module")
def facade() -> Study:
    study = read_study(example_file("facade"))
    assert study.workspace is not None
    return replace(study, workspace=replace(study.workspace, samples=200), selection=None)


@pytest.fixture(scope="module")
def flat(facade: Study, tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    return analysed(facade, tmp_path_factory.mktemp("facade"))


@pytest.fixture(scope="module")
def maps(flat: Analysis) -> WorkspaceMaps:
    return workspace_maps(flat)


def test_the_section_is_the_rectangle(maps: WorkspaceMaps) -> None:
    position = maps.section.position_m
    assert np.ptp(position[..., 1]) == 0.0
    assert (position[..., 0].min(), position[..., 0].max()) == pytest.approx((-13, 13))
    assert (position[..., 2].min(), position[..., 2].max()) == pytest.approx((3, 24))
    np.testing.assert_allclose(maps.flat_m(position), position[..., [0, 2]])
    assert maps.axis_labels == ("x [m]", "z [m]")
    assert maps.edge is None
    (outline,) = edges_m(maps)
    np.testing.assert_array_equal(outline, position[-1])


def test_maps_show_the_worst_orientation(maps: WorkspaceMaps, facade: Study) -> None:
    assert facade.workspace is not None
    position = maps.section.position_m[::30, ::60]
    each = np.stack(
        [
            size_poses(
                facade.robot,
                Poses.at(position, np.broadcast_to(t, position.shape)),
                facade.material,
            ).diameter_m
            for t in facade.workspace.orientations.turns_rad
        ]
    )
    np.testing.assert_allclose(maps.section.diameter_m[::30, ::60], each.max(axis=0), rtol=1e-9)
    assert (each.argmax(axis=0) != 0).any()


def test_the_marked_pose_is_turned(maps: WorkspaceMaps, flat: Analysis) -> None:
    assert flat.workspace is not None
    assert flat.workspace.sagging is not None
    assert maps.focus.statics is not None
    needed = float(maps.focus.field.diameter_m)
    assert needed == pytest.approx(flat.workspace.sagging.diameter_m, rel=1e-9)
    assert not np.array_equal(maps.focus.statics.poses.rotation, np.eye(3))


def test_all_pictures_are_drawn(flat: Analysis, facade: Study, tmp_path: Path) -> None:
    assert facade.workspace is not None
    points = PointList(frozen_array([[-5.0, 0, 10], [0, 0, 12], [5, 0, 10]]))
    listed = analysed(replace(facade, workspace=replace(facade.workspace, region=points)), tmp_path)
    for analysis in (flat, listed):
        drawings = Drawings(analysis, draws=True)
        assert drawings.robot is not None
        shown = pictures(section(drawings, "workspace"))
        assert any("z [m]" in picture.svg for picture in shown)
        assert not any("above" in picture.caption for picture in shown)


def test_words(facade: Study) -> None:
    assert facade.workspace is not None
    assert "upright rectangle from" in described_region(facade.workspace.region)
    assert described_orientations(facade.workspace.orientations).startswith("each of (0.00,")
    between = Orientations.within([-0.1, 0.0, 0.0], [0.1, 0.0, 0.0])
    assert described_orientations(between).startswith("all between (−5.73,")
