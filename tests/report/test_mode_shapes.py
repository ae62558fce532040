"""Drawings of the platform's modes, against rigid motions by SciPy, and hulls that they draw."""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from pairs.options import BASES
from scipy.spatial.transform import Rotation

from designer.analysis.analyse import Analysis
from designer.analysis.governing import PlatformModes, modes_of
from designer.io.config import read_study
from designer.report import format as fmt
from designer.report.design.drawings import Drawings
from designer.report.figures.mode_shapes import mode_shapes
from designer.report.figures.parts import hull_edges, hull_faces

HULL = [[-1.0, 1.0], [-0.6, 0.6], [-0.5, 0.5]]


def analysis_of(folder: Path, base: str, **platform: object) -> Analysis:
    study = {name: BASES[base][name] for name in ("robot", "cable")}
    study["robot"] = study["robot"] | {"platform": study["robot"]["platform"] | platform}
    study["pose"] = BASES[base]["workspace"]["region"]["points"][0]
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(study), encoding="utf-8")
    return Analysis.begin(read_study(path))


def found_of(analysis: Analysis) -> PlatformModes:
    found = modes_of(analysis)
    assert found is not None
    return found


def lines(path: str) -> np.ndarray:
    """Return the ends (n, 2, 2) of the lines of a path."""
    return np.array(re.findall(r"-?\d+\.?\d*", path), dtype=float).reshape(-1, 2, 2)


def test_platform_moves_as_a_rigid_body(tmp_path: Path) -> None:
    found = found_of(analysis_of(tmp_path, "six", inertia=[90.0, 110.0, 150.0], hull=HULL))
    robot, turn = found.statics.robot, found.statics.poses.rotation
    corners = np.array([*product(*HULL)])
    for mode, svg in zip(found.modes, mode_shapes(found), strict=True):
        root = ElementTree.fromstring(svg)
        rest, still, moving = (lines(path.get("d", "")) for path in root.iter("path"))
        assert np.array_equal(still, moving)
        (animation,) = root.iter("animate")
        first, other, last = map(lines, animation.get("values", "").split(";"))
        assert np.array_equal(first, still) and np.array_equal(last, still)
        assert np.allclose(other + still, 2.0 * rest, atol=0.21)  # tenths on the sheet
        # A small rigid motion, seen along one direction: the sheet is an affine map of space.
        before, small = corners @ turn.T, 1e-6
        after = Rotation.from_rotvec(small * mode.shape[3:]).apply(before) + small * mode.shape[:3]
        moved = (after - before) / small
        edges = len(still) - robot.n_cables
        sheet, shifts = rest[:edges].reshape(-1, 2), (still - rest)[:edges].reshape(-1, 2)
        view = np.linalg.lstsq(_with_one(before), _nearest(before, sheet, sheet), rcond=None)[0]
        drawn = _nearest(before, sheet, shifts)
        scale = np.linalg.lstsq((moved @ view[:3]).reshape(-1, 1), drawn.reshape(-1), rcond=None)
        assert np.allclose(scale[0] * (moved @ view[:3]), drawn, atol=0.3)
        assert 0.0 < scale[0][0] < 1.0


def _with_one(points: np.ndarray) -> np.ndarray:
    return np.column_stack([points, np.ones(len(points))])


def _nearest(corners: np.ndarray, sheet: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return what stands on the sheet for each corner, by how far right and up the corner is."""
    flat = corners @ np.array([[0.82, -0.57, 0.0], [0.24, 0.35, 0.905]]).T * [1.0, -1.0]
    shares = (flat - flat.min(axis=0)) / np.ptp(flat, axis=0)
    where = sheet.min(axis=0) + shares * np.ptp(sheet, axis=0)
    return values[np.linalg.norm(sheet[None] - where[:, None], axis=-1).argmin(axis=1)]


@pytest.mark.parametrize(("base", "platform"), [("crane", {}), ("plane", {"inertia": [9, 12, 9]})])
def test_points_and_bodies_in_a_plane(
    tmp_path: Path, base: str, platform: dict[str, object]
) -> None:
    found = found_of(analysis_of(tmp_path, base, **platform))
    drawn = mode_shapes(found)
    assert len(drawn) == 3
    for mode, svg in zip(found.modes, drawn, strict=True):
        rest, still, _ = (lines(p.get("d", "")) for p in ElementTree.fromstring(svg).iter("path"))
        assert np.abs(still - rest).max() > 5.0
        assert f"{fmt.number(mode.frequency_Hz, 3)} Hz" in svg
        assert rest.min() >= 0.0
        assert np.all(rest.max(axis=(0, 1)) <= [160.0, 120.0])


def test_nothing_is_drawn_where_figures_are_not(tmp_path: Path) -> None:
    analysis = analysis_of(tmp_path, "crane")
    assert Drawings(analysis).mode_shapes == ()
    assert len(Drawings(analysis, draws=True).mode_shapes) == 3


def test_box_has_twelve_edges_and_faces_seen_from_outside() -> None:
    corners = np.array([*product(*HULL)])
    faces = hull_faces(corners)
    edges = hull_edges(corners, faces)
    assert len(edges) == 12
    assert np.allclose(np.sum(corners[edges[:, 0]] == corners[edges[:, 1]], axis=1), 2)
    first, second, third = corners[faces.T]
    normals = np.cross(second - first, third - first)
    assert np.all(np.einsum("ij,ij->i", normals, first + second + third) > 0.0)
