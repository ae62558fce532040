"""Figures in their places, and how they get into the page."""

from __future__ import annotations

import io
import math
import re

import pypdf
import pytest
from designer.report.design.context import build_context
from designer.report.design.drawings import draw

from designer.analysis.analyse import Analysis
from designer.report.design.candidates import thin_table
from designer.report.pictures import Pictures
from designer.report.render import render_html, render_pdf

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def pictures(analyses: dict[str, Analysis]) -> Pictures:
    return draw(analyses["positive"])


def test_every_place_is_filled(pictures: Pictures) -> None:
    singles = (
        pictures.robot,
        pictures.loop_chart,
        pictures.pose_scene,
        pictures.verdicts,
        pictures.candidates,
    )
    for picture in (*singles, *pictures.workspace):
        assert picture is not None
        assert picture.caption.endswith(".")
        assert picture.svg.startswith("<svg") or picture.bitmap.startswith("data:image/png;base64,")


def test_the_scene_to_turn_is_in_the_page_once(
    analyses: dict[str, Analysis], pictures: Pictures
) -> None:
    html = render_html(build_context(analyses["positive"], pictures))
    assert html.count("<iframe") == 1
    assert html.count('sandbox="allow-scripts"') == 1


def test_pose_alone_has_no_workspace_pictures(pose_only: Analysis) -> None:
    pictures = draw(pose_only)
    assert pictures.workspace == ()
    assert pictures.verdicts is None
    assert pictures.candidates is None
    assert pictures.robot == pictures.pose_scene


def test_charts_stay_vector_graphics_in_the_pdf(
    analyses: dict[str, Analysis], pictures: Pictures
) -> None:
    charts = Pictures(
        loop_chart=pictures.loop_chart,
        verdicts=pictures.verdicts,
        workspace=tuple(p for p in pictures.workspace if p.svg),
        candidates=pictures.candidates,
    )
    assert len(charts.workspace) == 4
    html = render_html(build_context(analyses["positive"], charts), paged=True)
    reader = pypdf.PdfReader(io.BytesIO(render_pdf(html)))
    assert [len(page.images) for page in reader.pages] == [0] * len(reader.pages)


def test_ids_in_the_page_are_unique(analyses: dict[str, Analysis], pictures: Pictures) -> None:
    html = render_html(build_context(analyses["positive"], pictures), paged=True)
    ids = re.findall(r'\bid="([^"]+)"', html)
    assert len(ids) == len(set(ids))


def test_grades_that_all_cannot_hold_have_no_chart(analyses: dict[str, Analysis]) -> None:
    selection = analyses["no_finite_cable"].selection
    assert selection is not None
    needs = [o.continuous_diameter_m for o in selection.outcomes]
    assert all(math.isnan(need) for need in needs)
    assert draw(analyses["no_finite_cable"]).candidates is None
    assert thin_table(selection.outcomes) is not None
