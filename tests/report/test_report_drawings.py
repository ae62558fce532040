"""Figures in their places, and how they get into the page."""

from __future__ import annotations

import io
import math
import re

import pypdf
import pytest
from report_parts import pictures

from designer.analysis.analyse import Analysis
from designer.report.blocks import Report
from designer.report.design import selection as choice
from designer.report.design.candidates import thin_table
from designer.report.design.report import design_report, report_from
from designer.report.design.source import Source
from designer.report.render import render_html, render_pdf

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def report(analyses: dict[str, Analysis]) -> Report[None]:
    return design_report(analyses["positive"])


def test_every_place_is_filled(report: Report[None]) -> None:
    numbers = {"checks": 1, "carries": 1, "workspace": 1, "selection": 2, "stiffness": 1}
    numbers |= {"answer": 1, "pose": 2, "family": 5}
    for section in report.sections:
        assert len(pictures(section)) == numbers.get(section.id, 0), section.id
    for picture in pictures(report):
        assert picture.caption.endswith(".")
        assert picture.svg.startswith("<svg") or picture.bitmap.startswith("data:image/png;base64,")


def test_the_governing_pose_is_drawn_and_what_carries_it(report: Report[None]) -> None:
    (there,) = pictures(report.section("checks"))
    assert "which governs, is marked" in there.caption
    assert there.bitmap
    (bars,) = pictures(report.section("carries"))
    assert "Payload" in bars.svg


def test_the_scene_to_turn_is_in_the_page_once(report: Report[None]) -> None:
    html = render_html(report)
    assert html.count("<iframe") == 1
    assert html.count('sandbox="allow-scripts"') == 1


def test_pose_alone_has_no_workspace_pictures(pose_only: Analysis) -> None:
    drawn = design_report(pose_only)
    assert [section.id for section in drawn.sections if pictures(section)] == ["answer", "pose"]
    bitmaps = {picture.bitmap for picture in pictures(drawn.section("pose")) if picture.bitmap}
    assert bitmaps == {picture.bitmap for picture in pictures(drawn.section("answer"))}


def test_charts_stay_vector_graphics_in_the_pdf(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    charts = report_from(Source(analysis, draws=True, missing="no scenes"))
    assert len(pictures(charts.section("workspace"))) == 1
    assert len(pictures(charts.section("family"))) == 4
    reader = pypdf.PdfReader(io.BytesIO(render_pdf(render_html(charts, paged=True))))
    assert [len(page.images) for page in reader.pages] == [0] * len(reader.pages)


def test_ids_in_the_page_are_unique(report: Report[None]) -> None:
    ids = re.findall(r'\bid="([^"]+)"', render_html(report, paged=True))
    assert len(ids) == len(set(ids))


def test_grades_that_all_cannot_hold_have_no_chart(analyses: dict[str, Analysis]) -> None:
    selection = analyses["no_finite_cable"].selection
    assert selection is not None
    needs = [o.continuous_diameter_m for o in selection.outcomes]
    assert all(math.isnan(need) for need in needs)
    source = Source(analyses["no_finite_cable"], draws=True, missing="no scenes")
    assert not any("A row for each" in p.alternative for p in pictures(choice.section(source)))
    assert thin_table(selection.outcomes) is not None
