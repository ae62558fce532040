"""A kind of region that no report knows is searched, drawn and described all the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest

import designer
from designer.arrays import FloatArray
from designer.model.border import Border
from designer.model.region import Region
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


@pytest.mark.slow
def test_a_line_is_a_region() -> None:
    study = designer.read_study(designer.example_file("yard"))
    assert study.workspace is not None
    line = Segment(np.array([[8.0, 5.0, 1.0], [22.0, 7.0, 8.0]]))
    workspace = replace(study.workspace, region=line, samples=100)
    analysis = designer.analyse(replace(study, workspace=workspace))
    assert analysis.workspace is not None
    assert analysis.workspace.sagging is not None
    # Nothing on the line, far more densely than the samples, needs more.
    from designer.sizing.newton import size_poses

    dense = size_poses(study.robot, designer.Poses.at(line.at(np.linspace(0, 1, 5001))),
                       study.material)  # fmt: skip
    told = analysis.workspace.sagging.diameter_m
    assert dense.diameter_m.max() <= told * (1 + 1e-9)
    html = render_html(design_report(analysis))
    assert "line from (8.00" in html
    assert "15.78" in html
    assert html.count("<figure") > 5
