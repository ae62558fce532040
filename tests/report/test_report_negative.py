"""When the answer is no: the reason, the place, and what could be done."""

from __future__ import annotations

import pytest
from report_parts import FirstPage, first_page, table

from designer.analysis.analyse import Analysis
from designer.model.verdict import Verdict
from designer.report.design.drawings import Drawings
from designer.report.design.report import section

pytestmark = pytest.mark.slow


def page_of(analysis: Analysis) -> FirstPage:
    return first_page(Drawings(analysis))


def said(page: FirstPage) -> str:
    """All reasons and actions as one plain text."""
    texts = [page.verdict.text, *(r.text for r in page.reasons), *page.actions]
    return " ".join(texts).replace("\u00a0", " ")


def test_no_finite_cable(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["no_finite_cable"]
    page = page_of(analysis)
    assert page.verdict.tone == "bad"
    assert page.card is None
    text = said(page)
    assert analysis.workspace is not None
    share = 100 * analysis.workspace.census.fraction("no_finite_cable")
    assert f"In {share:#.3g} % of its volume {Verdict.NO_FINITE_CABLE.clause}" in text
    assert "One such position is (" in text
    assert "larger inset" in text
    assert "hangs_below: exclude" in text
    assert "40.4 mm" in text
    assert "230.9 kN" in text


def test_boundary_met_by_the_search_alone(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["only_found_by_search"]
    assert analysis.workspace is not None
    assert analysis.workspace.census.fraction("solved") == 1.0
    page = page_of(analysis)
    assert not analysis.is_positive
    assert "the search between the samples met poses" in said(page)


def test_real_rope_holds_where_the_configured_family_does_not(
    analyses: dict[str, Analysis],
) -> None:
    analysis = analyses["only_found_by_search"]
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    page = page_of(analysis)
    assert page.verdict.title == "No"
    assert page.card is not None
    assert f"Configure the cable as a real rope. {analysis.selection.chosen.grade.id}" in said(page)


def test_pose_outside_the_hull(analyses: dict[str, Analysis]) -> None:
    page = page_of(analyses["pose_outside"])
    assert page.verdict.title == "No"
    text = said(page)
    assert "At (250.00, −60.00, −50.00) m no tensions of taut cables hold the platform" in text
    assert "inside their outline" in text
    assert "stronger" not in text


def test_grade_ends_too_thin(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["too_thin"]
    page = page_of(analysis)
    assert page.verdict.title == "No"
    assert page.card is not None
    assert page.card.size == "51.2\u00a0mm"
    text = said(page)
    assert "unirope-7x19-galvanised, which is insufficient in its largest size sold, 3/8 in" in text
    assert analysis.selection is not None
    fitting = [outcome.best for outcome in analysis.selection.alternatives]
    lightest = min((c for c in fitting if c is not None), key=lambda c: c.total_mass_kg)
    assert f"the lightest first: {lightest.grade.id} ({lightest.size.id})" in text
    shown = section(Drawings(analysis), "selection")
    assert table(shown, "Grades that the study does not allow").groups[0].rows


@pytest.mark.parametrize("case", ["positive", "exclude"])
def test_a_yes_needs_no_advice(analyses: dict[str, Analysis], case: str) -> None:
    page = page_of(analyses[case])
    assert page.verdict.title.startswith("Yes, ")
    assert page.reasons == ()
    assert page.actions == ()


def test_every_no_has_a_reason_and_an_advice(analyses: dict[str, Analysis]) -> None:
    for analysis in analyses.values():
        page = page_of(analysis)
        assert bool(page.reasons) == bool(page.actions) == (not analysis.is_positive)
