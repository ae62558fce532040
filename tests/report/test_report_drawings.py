"""Figures in their places, and how they get into the page."""

from __future__ import annotations

import io
import math
import re

import pypdf
import pytest
from report_parts import pictures, table

from designer.analysis.analyse import Analysis
from designer.report.design.drawings import Drawings
from designer.report.design.report import design_report, report_from, section
from designer.report.document import Report
from designer.report.render import render_html, render_pdf

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def report(analyses: dict[str, Analysis]) -> Report:
    return design_report(analyses["positive"])


def test_every_place_is_filled(report: Report) -> None:
    numbers = {"checks": 1, "carries": 1, "workspace": 1, "selection": 2, "stiffness": 1}
    numbers |= {"answer": 1, "modes": 4, "pose": 2, "family": 5}
    for part in report.sections:
        assert len(pictures(part)) == numbers.get(part.id, 0), part.id
    for picture in pictures(report):
        assert picture.caption.endswith(".")
        assert picture.svg.startswith("<svg") or picture.bitmap.startswith("data:image/png;base64,")


def test_the_governing_pose_is_drawn_and_what_carries_it(report: Report) -> None:
    (there,) = pictures(report.section("checks"))
    assert "which governs, is marked" in there.caption
    assert there.bitmap
    (bars,) = pictures(report.section("carries"))
    assert "Payload" in bars.svg


def test_the_scene_to_turn_is_in_the_page_once(report: Report) -> None:
    html = render_html(report)
    assert html.count("<iframe") == 1
    assert html.count('sandbox="allow-scripts"') == 1


def test_pose_alone_has_no_workspace_pictures(pose_only: Analysis) -> None:
    drawn = design_report(pose_only)
    filled = [section.id for section in drawn.sections if pictures(section)]
    assert filled == ["answer", "modes", "pose"]
    bitmaps = {picture.bitmap for picture in pictures(drawn.section("pose")) if picture.bitmap}
    assert bitmaps == {picture.bitmap for picture in pictures(drawn.section("answer"))}


def test_charts_stay_vector_graphics_in_the_pdf(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    charts = report_from(Drawings(analysis, draws=True, missing="no scenes"))
    assert len(pictures(charts.section("workspace"))) == 1
    assert len(pictures(charts.section("family"))) == 4
    reader = pypdf.PdfReader(io.BytesIO(render_pdf(render_html(charts, paged=True))))
    assert [len(page.images) for page in reader.pages] == [0] * len(reader.pages)


def test_ids_in_the_page_are_unique(report: Report) -> None:
    ids = re.findall(r'\bid="([^"]+)"', render_html(report, paged=True))
    assert len(ids) == len(set(ids))


def test_grades_that_all_cannot_hold_have_no_chart(analyses: dict[str, Analysis]) -> None:
    selection = analyses["no_finite_cable"].selection
    assert selection is not None
    needs = [o.continuous_diameter_m for o in selection.outcomes]
    assert all(math.isnan(need) for need in needs)
    source = Drawings(analyses["no_finite_cable"], draws=True, missing="no scenes")
    shown = section(source, "selection")
    assert not any("A row for each" in p.alternative for p in pictures(shown))
    assert table(shown, "Grades of which no size meets every requirement").groups
