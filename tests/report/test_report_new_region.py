"""A kind of region that nobody knows is searched, drawn and described; the rest is declined."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest

import designer
from designer.arrays import FloatArray
from designer.explore.answers import map_grids
from designer.model.region import Border, Prism, Region
from designer.model.space import Orientations, Space
from designer.proof.encloser import unsupported_reason
from designer.report.design.report import design_report
from designer.report.render import render_html


@dataclass(frozen=True, slots=True, eq=False)
class Segment(Region):
    """A straight line, as `CONTRIBUTING.md` tells to write a region."""

    ends_m: FloatArray

    @property
    def bounds_m(self) -> FloatArray:
        return np.array([self.ends_m.min(axis=0), self.ends_m.max(axis=0)])

    @property
    def sizes(self):
        return (("Length", float(np.linalg.norm(self.ends_m[1] - self.ends_m[0])), "m"),)

    def words(self, position, plural) -> str:
        return f"line from {position(self.ends_m[0])} to {position(self.ends_m[1])}"

    def at(self, share: FloatArray) -> FloatArray:
        return self.ends_m[0] + share[..., None] * (self.ends_m[1] - self.ends_m[0])

    def nearest(self, points_m: FloatArray) -> FloatArray:
        along = self.ends_m[1] - self.ends_m[0]
        return self.at(np.clip((points_m - self.ends_m[0]) @ along / (along @ along), 0.0, 1.0))

    def contains(self, points_m: FloatArray):
        return np.linalg.norm(self.nearest(points_m) - points_m, axis=-1) < 1e-9

    def samples_m(self, count: int, sampling, seed: int) -> Iterator[FloatArray]:
        yield self.at(np.linspace(0.0, 1.0, count))

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.at(rng.random(count))

    def border(self) -> Border:
        return Border(self.ends_m, self.ends_m[None], [])


LINE = Segment(np.array([[8.0, 5.0, 1.0], [22.0, 7.0, 8.0]]))


def test_what_a_region_does_not_say_is_declined(fast_robot: designer.Robot) -> None:
    assert "not covered by boxes" in unsupported_reason(fast_robot, Space(LINE, Orientations()))
    assert not LINE.has_sides
    assert not LINE.outward(LINE.ends_m[0]).any()
    assert LINE.section_m() is None
    assert (LINE.cutaway_m(LINE.ends_m[0]), LINE.opening_azimuth_rad(LINE.ends_m[0])) == ({}, None)
    assert np.allclose(LINE.centre_m, [15.0, 6.0])
    grids = map_grids(LINE, 0.5, fine=False)  # as the window asks
    assert list(grids) == ["points"]
    assert LINE.contains(grids["points"]).all()


def test_a_box_has_all_of_it(fast_robot: designer.Robot) -> None:
    box = Prism.box((0.0, 4.0), (0.0, 3.0), (1.0, 2.0))
    assert unsupported_reason(fast_robot, Space(box, Orientations())) == ""
    assert box.outward(np.array([4.0, 3.0, 1.5])) == pytest.approx([1.0, 1.0, 0.0])
    assert box.grown(0.5).bounds_m == pytest.approx(np.array([[-0.5, -0.5, 1], [4.5, 3.5, 2]]))
    grids = map_grids(box, 0.25, fine=True)
    assert set(grids) == {"top", "bottom", "wall", "slice"}
    assert all(box.contains(grid).all() for grid in grids.values())
    assert grids["slice"][..., 2] == pytest.approx(1.25)


@pytest.mark.slow
def test_a_line_is_a_region() -> None:
    study = designer.read_study(designer.example_file("yard"))
    assert study.workspace is not None
    workspace = replace(study.workspace, region=LINE, samples=100)
    analysis = designer.analyse(replace(study, workspace=workspace))
    assert analysis.workspace is not None
    assert analysis.workspace.sagging is not None
    # Nothing on the line, far more densely than the samples, needs more.
    from designer.sizing.newton import size_poses

    dense = size_poses(study.robot, designer.Poses.at(LINE.at(np.linspace(0, 1, 5001))),
                       study.material)  # fmt: skip
    told = analysis.workspace.sagging.diameter_m
    assert dense.diameter_m.max() <= told * (1 + 1e-9)
    html = render_html(design_report(analysis))
    assert "line from (8.00" in html
    assert "15.78" in html
    assert html.count("<figure") > 5
