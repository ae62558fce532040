"""Captions say what follows from a figure, and figures that would show nothing are left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from figures_cases import maps_of
from report_parts import caption, pictures

from designer.analysis.analyse import Analysis
from designer.analysis.maps import CoverageCurve
from designer.report.design.drawings import Drawings
from designer.report.design.report import section

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def crane(yard: Analysis) -> list[str]:
    charts = Drawings(yard, draws=True, missing="no scenes")
    return [picture.caption for picture in pictures(section(charts, "family"))]


def test_where_sag_hardly_matters_one_figure_less_says_so(crane: list[str]) -> None:
    assert len(crane) == 3
    assert crane[0].startswith("Needed diameter and largest tension at the top of the region.")
    change = float(crane[0].split("tension is ")[1].split("\u00a0%")[0])
    assert 1.0 < change < 2.0


def test_figures_that_would_be_flat_are_left_out(yard: Analysis) -> None:
    charts = Drawings(yard, draws=True, missing="no scenes")
    shown = [picture.caption for picture in pictures(section(charts, "family"))]
    assert len(pictures(section(charts, "workspace"))) == 1
    assert len(shown) == 3 and "All samples by verdict." not in shown  # every sample is held
    assert pictures(section(charts, "pose")) == []  # sag adds less than two per cent


def test_where_sag_matters_the_caption_says_how_much() -> None:
    assert "a factor of up to 3.06" in caption("panels", maps_of("served"))


def test_cover_says_how_large_the_region_is_and_what_it_needs() -> None:
    text = caption("cover", maps_of("served"), None)
    assert "464 × 402 × 160 m" in text
    assert text.endswith(" to 51.2 mm.")


def test_edge_says_where_the_region_and_where_all_cables_end() -> None:
    text = caption("edge", maps_of("served").edge)
    assert "10.4 m before that edge" in text
    assert "within 4.75 m" in text


def test_a_region_that_no_cable_serves_promises_no_diameter() -> None:
    maps = maps_of("served")
    text = caption("served", maps.coverage)
    assert "serves nine poses of ten; the last tenth takes 51.2 mm." in text
    none = CoverageCurve(
        diameter_m=np.empty(0),
        share=np.empty(0),
        massless_diameter_m=np.empty(0),
        massless_share=np.empty(0),
        unserved=1.0,
        needed_m=np.nan,
        massless_needed_m=np.nan,
        samples=10,
    )
    assert caption("served", none).endswith("configured family serves.")
    half = replace(maps.coverage, share=0.5 * maps.coverage.share)
    assert caption("served", half).endswith("configured family serves.")


def test_only_a_chosen_size_is_said_to_serve_all(yard: Analysis) -> None:
    selection = yard.selection
    assert selection is not None
    assert selection.usable is not None
    assert selection.chosen is not None
    whole = next(one.size for one in selection.usable.sizes if one.fraction == 1.0)
    picked = replace(selection.chosen, size=whole)
    said = caption("usable", replace(selection, chosen=picked))
    assert f"chosen {whole.id} is the thinnest" in said
    assert "thinnest" not in caption("usable", replace(selection, chosen=None))


def test_where_no_cable_holds_somewhere_the_span_says_so() -> None:
    assert " Where a cable holds, it runs from " in caption("scene", maps_of("partly"))
