"""What a reviewer would object to stands on the first page; what is long, in the appendix."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable

import pytest
from altered import altered
from report_cases import DEFAULTS, FAST, PRISM, SELECTION, SIX
from report_parts import FirstPage, cells, first_page, said
from test_report_groups import YARD

from designer.analysis.analyse import Analysis
from designer.grades.grade import Limits
from designer.model.robot import Surroundings
from designer.report.design.drawings import Drawings
from designer.report.design.report import design_report, section
from designer.report.figures.charts_selection import pareto_chart
from designer.report.render import render_html

pytestmark = pytest.mark.slow

Solve = Callable[[str], Analysis]


def page_of(analysis: Analysis) -> FirstPage:
    return first_page(Drawings(analysis))


@pytest.fixture(scope="module")
def fibre(solve: Solve) -> Analysis:
    grades = "[gost-6x19s-iwrc-1960, yale-ultrex-hmpe]"
    return solve(FAST.format(**{**DEFAULTS, "grades": grades}))


@pytest.fixture(scope="module")
def grouped(solve: Solve) -> Analysis:
    return solve(YARD.replace("GRADES", "unirope-7x19-galvanised, unirope-6x19-iwrc-eips"))


def test_a_fibre_rope_is_named_beside_the_best_of_steel(fibre: Analysis) -> None:
    assert fibre.selection is not None
    steel = next(o.best for o in fibre.selection.outcomes if o.grade.material_class == "steel")
    assert steel is not None
    text = page_of(fibre).verdict.text
    assert "It is a rope of HMPE fibre." in text
    assert "20.5 mm of gost-6x19s-iwrc-1960" in text
    mass = f"{steel.total_mass_kg:,.0f}".replace(",", "\u202f")
    assert f"{mass}\u00a0kg in all instead of" in text


def test_a_steel_rope_is_not_called_fibre(analyses: dict[str, Analysis]) -> None:
    page = page_of(analyses["positive"])
    assert "fibre" not in page.verdict.text
    assert not any("Creep" in statement.title for statement in page.confidence)


def test_no_steel_rope_holds(solve: Solve) -> None:
    grades = "[unirope-7x19-galvanised, yale-ultrex-hmpe]"
    text = page_of(solve(FAST.format(**{**DEFAULTS, "grades": grades}))).verdict.text
    assert text.endswith("No rope of steel that the study allows holds.")


@pytest.mark.parametrize(
    ("limits", "titles"),
    [
        (Limits("S", creep="high"), {"Creep of yale-ultrex-hmpe"}),
        (None, {"Creep of yale-ultrex-hmpe"}),
        (Limits("S", temperature_C=(-40.0, 70.0)), {"Creep of yale-ultrex-hmpe", "Temperature"}),
    ],
)
def test_limits_of_the_grade_are_cautions(
    limits: Limits | None, titles: set[str], fibre: Analysis
) -> None:
    assert fibre.selection is not None
    chosen = fibre.selection.chosen
    assert chosen is not None
    grade = dataclasses.replace(chosen.grade, limits=limits)
    other = dataclasses.replace(chosen, grade=grade)
    outcomes = tuple(
        dataclasses.replace(o, best=other) if o.best is chosen else o
        for o in fibre.selection.outcomes
    )
    selection = dataclasses.replace(fibre.selection, chosen=other, outcomes=outcomes)
    page = page_of(altered(fibre, selection=selection))
    found = {s.title: s for s in page.confidence}
    assert titles == {t for t in found if t.startswith("Creep") or t == "Temperature"}
    assert all(found[title].tone == "doubt" for title in titles if title != "Temperature")
    said = "Source: high." if limits and limits.creep else "does not state it"
    assert said in found["Creep of yale-ultrex-hmpe"].text
    if "Temperature" in titles:
        assert "from −40 to 70\u00a0°C" in found["Temperature"].text
        assert "the study has 20\u00a0°C" in found["Temperature"].text
        assert found["Temperature"].tone == ""
        hot = dataclasses.replace(fibre.study, surroundings=Surroundings(75.0))
        page = page_of(altered(fibre, selection=selection, study=hot))
        (outside,) = (s for s in page.confidence if s.title == "Temperature")
        assert outside.tone == "bad"
        assert "75\u00a0°C" in outside.text and "which is outside" in outside.text


@pytest.fixture(scope="module")
def far_apart(solve: Solve) -> Analysis:
    return solve(SIX.format(region=PRISM, clearance="2 m", selection=SELECTION))


@pytest.mark.parametrize(
    ("name", "demand"), [("not_kept", "400\u00a0mm"), ("far_apart", "2.00\u00a0m")]
)
def test_a_violated_clearance_is_on_the_first_page(
    name: str, demand: str, request: pytest.FixtureRequest
) -> None:
    """Of cables of the family, and of a chosen rope."""
    page = page_of(request.getfixturevalue(name))
    assert page.verdict.title == "No"
    assert "learance does not hold." in page.verdict.text
    assert [reason.title for reason in page.reasons] == ["Clearance does not hold"]
    assert f"demand {demand}" in page.reasons[0].text
    assert "require less clearance" in page.actions[0]


def test_a_kept_clearance_is_no_objection(kept: Analysis) -> None:
    page = page_of(kept)
    assert page.verdict.title == "Yes, for one static case"
    assert page.reasons == page.actions == ()


def test_ropes_of_groups_and_their_doubts_are_on_the_first_page(grouped: Analysis) -> None:
    assert grouped.assignment.has_groups
    page = page_of(grouped)
    products = grouped.assignment.ropes
    assert page.groups is not None
    assert "less than the best single product" in page.groups.text
    assert page.card is not None
    assert page.card.heading == "Ropes for groups of cables"
    assert [fact.value for fact in page.card.facts[:2]] == [product.label for product in products]
    assert all(f"{product.label} for " in page.verdict.text for product in products)
    assert "cables 1 and 2, " in page.card.facts[0].note
    said = {statement.title: statement.text for statement in page.confidence}
    for product in products:
        words = said[f"Subject to a certificate of breaking load and mass of {product.label}"]
        assert ("The catalogue doubts this size" in words) == bool(product.size.doubt)


def test_the_programme_solver_is_among_the_libraries_where_it_is_used(
    grouped: Analysis, fibre: Analysis
) -> None:
    assert {"cvxpy", "highspy"} <= dict(grouped.provenance.libraries).keys()
    assert {"cvxpy", "highspy"}.isdisjoint(dict(fibre.provenance.libraries))


def test_fields_left_out_stand_in_the_appendix(fibre: Analysis) -> None:
    report = design_report(fibre, draws=False)
    section = report.section("provenance")
    rows = cells(section, "Fields that the configuration file leaves out")
    named = {cell for row in rows for cell in row[::2] if cell}
    html = render_html(report)
    folded = html.split("<details><summary>")[1].split("<p>")[1].split("</p>")[0]
    named |= set(re.findall(r"[a-z_]+(?:\.[a-z_]+)*", folded))
    named.discard("and")
    entries = (e for e in fibre.study.source.entries if e.given == "default")
    expected = [e.field for e in entries if not e.field.startswith("document.")]
    assert named == set(expected)
    assert html.index('id="provenance"') < html.index("workspace.sampling")


def test_one_size_alone_is_said_in_words(fibre: Analysis, analyses: dict[str, Analysis]) -> None:
    assert fibre.selection is not None
    assert len(fibre.selection.front) == 1
    shown = said(section(Drawings(fibre), "selection"))
    assert "3/4 in dominates every other size" in shown
    none = said(section(Drawings(analyses["too_thin"]), "selection"))
    assert "dominates every other size" not in none and "no trade-off" not in none


def test_chart_tells_materials_apart(fibre: Analysis) -> None:
    assert fibre.selection is not None
    svg = pareto_chart(fibre.selection)
    assert svg is not None
    words = svg[svg.index("<desc>") : svg.index("</desc>")]
    assert "steel" in words and "fibre" in words and "chosen" in words
    assert "stainless" not in words
    assert "no other beats it" not in words
