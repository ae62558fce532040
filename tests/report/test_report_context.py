"""The context: what it says, and that it is documented and shown in full."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable
from typing import Any

import pytest
from altered import altered
from report_cases import CASES, DEFAULTS, FAST
from report_parts import cells, facts, first_page, said, table, tables, texts

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.design import sections
from designer.report.design.drawings import Drawings
from designer.report.design.report import design_report
from designer.report.design.report import section as section_of
from designer.report.document import MOST_ROWS, Drawing, Report, Section
from designer.report.render import render_html
from designer.report.templates import environment
from designer.selection.result import SelectionResult
from designer.sizing.loop import Iterate, LoopSizing

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def reports(
    analyses: dict[str, Analysis], pose_only: Analysis, yard: Analysis
) -> dict[str, Report]:
    all_of_them = {**analyses, "pose_only": pose_only, "yard": yard}
    return {name: design_report(a, draws=False) for name, a in all_of_them.items()}


BLOCKS = """
{%- from "blocks.html.j2" import box, bullets, fact, facts, picture, row with context -%}
{%- from "blocks.html.j2" import statement, subheading, table with context -%}
{% call facts() %}
{{ fact("Length", text, "paid out") }}
{{ fact("Source", "a table", "https://x.y", "#every") }}
{% endcall %}
{{ statement("Title", "bad", "Text of it.") }}
{{ bullets(["one thing", text]) }}
{{ subheading("below", "A heading below") }}
{% set heads = ["Words", ("Number", "mm")] %}
{% call table("Caption.", heads) %}
{{ row(heads, ["a cell", "1"], group=("Ours", "remark", "good")) }}
{{ row(heads, [text, "2"], "bad", "a note") }}
{% endcall %}
{% call box("keep") %}{% call picture(drawing, "Also a scene.") %}A scene.{% endcall %}{% endcall %}
"""
SCENE = Drawing(bitmap="data:image/png;base64,AA==", scene="<p>3-D</p>")


@pytest.mark.parametrize("paged", [False, True])
def test_every_macro_escapes_and_is_shown(paged: bool) -> None:
    template = environment().from_string(BLOCKS)
    html = template.render(paged=paged, text="With <i>.", drawing=SCENE)
    assert html.count("With &lt;i&gt;.") == 3
    assert '<a href="#every">https://x.y</a>' in html
    assert '<p class="statement bad"><strong>Title.</strong> Text of it.</p>' in html
    assert re.search(r'<div class="keep">\s*<figure class="picture ">', html)
    assert '<h3 id="below">' in html
    assert ("&lt;p&gt;3-D&lt;/p&gt;" in html) != paged
    assert ('<tr class="group good">' in html) != paged
    assert ('<tr class=" carries">' in html) == ('<span class="lifted good">' in html) == paged
    assert [len(grid.groups[-1].rows) for grid in tables(html)] == [2]


@pytest.mark.parametrize("case", [*CASES, "pose_only", "yard"])
def test_every_row_fills_its_table(reports: dict[str, Report], case: str) -> None:
    found = tables(reports[case])
    assert len(found) >= 4
    for one in found:
        widths = {len(row.cells) for group in one.groups for row in group.rows}
        assert widths <= {len(one.columns)}


def test_no_raw_number_reaches_the_page(reports: dict[str, Report]) -> None:
    words = {word.strip("(),.") for text in texts(reports["positive"]) for word in text.split()}
    assert words.isdisjoint({"nan", "inf", "None", "array", "np.float64"})


@pytest.mark.parametrize("kind", [Report, Drawing])
def test_every_field_is_documented(kind: type) -> None:
    source = inspect.getsource(kind)
    for field in dataclasses.fields(kind):
        documented = (
            rf"#: [^\n]+\n    {field.name}:|\n    {field.name}:[^\n]*#: |\n    {field.name} :"
        )
        assert re.search(documented, source), field.name


def test_first_page_names_the_rope_and_its_margin(reports: dict[str, Report]) -> None:
    page = first_page(reports["positive"])
    assert page.verdict.tone == "doubt"  # no maker is named
    assert page.card is not None
    found = {fact.label: fact.value for fact in page.card.facts}
    assert page.card.size == "20.5 mm"
    assert found["Grade"] == "gost-6x19s-iwrc-1960"
    assert found["Safety factor there"] == "2.00"
    assert found["Utilisation"] == "99.8\u00a0%"
    assert page.reasons == ()
    assert page.actions == ()


def test_sag_table_shows_the_papers_workspace_figures(
    reports: dict[str, Report],
) -> None:
    family = reports["positive"].section("family")
    worst, _, massless = (row[-2:] for row in cells(family, "The thinnest diameter"))
    assert worst == ("51.2\u00a0mm", "371.0\u00a0kN")
    assert massless == ("29.3\u00a0mm", "121.4\u00a0kN")
    assert "a factor of 1.75 in diameter and of 3.06 in tension" in said(family)


def test_sag_table_is_of_the_chosen_rope(reports: dict[str, Report]) -> None:
    answer = reports["positive"].section("answer")
    rows = cells(answer, "gost-6x19s-iwrc-1960")
    assert [row[0] for row in rows] == ["Tension", "Utilisation"]
    assert rows[1][2] == "99.8\u00a0%"
    assert "would select 19 mm of the chosen grade" in said(answer)
    assert "Its true safety factor would be 1.80" in said(answer)


def test_pose_section_shows_the_papers_loop(reports: dict[str, Report]) -> None:
    assert cells(reports["positive"].section("pose"), "Iterations; 0 is")[:3] == [
        ("0", "86.39", "24.72"),
        ("1", "123.08", "29.51"),
        ("2", "138.69", "31.32"),
    ]


def test_a_loop_that_diverges_is_said_to(solve: Callable[[str], Analysis]) -> None:
    text = FAST.format(**{**DEFAULTS, "pose": "[250, 200, -1]"})
    section = section_of(Drawings(solve(text[: text.index("workspace:")])), "pose")
    assert "It diverges" in table(section, "Iterations; 0 is").caption
    turns = cells(section, "Iterations; 0 is")
    assert max(len(cell) for row in turns for cell in row) <= 15
    row = cells(section, "Diameter of this pose by each method")[-1]
    assert row[1:3] == (fmt.MISSING, fmt.MISSING)
    assert row[3].startswith("diverges, given up after")


def test_a_loop_that_does_not_settle_is_cut_short() -> None:
    turns_of_400 = tuple(Iterate(1e3 * k, 0.01) for k in range(401))
    shown: Any = sections.iterations(LoopSizing(turns_of_400, has_converged=False))["shown"]
    numbers = [number for number, iterate, _ in shown if iterate is not None]
    assert numbers == [0, 1, 2, 3, 4, 398, 399, 400]
    assert len(shown) == 9  # with a row for what is between


def test_candidates_begin_with_the_chosen_one(reports: dict[str, Report]) -> None:
    section = reports["positive"].section("selection")
    first = table(section, "Sizes that hold everywhere").groups[0]
    assert first.title == "gost-6x19s-iwrc-1960"
    assert "best in mass of all cables" in first.remark
    assert first.tone == "good"
    best = ("gost-6x19s-iwrc-1960", "steel", "20.5\u00a0mm")
    assert cells(section, "The best size of each grade")[0][:3] == best
    thin = ("unirope-7x19-galvanised", "3/8 in")
    assert cells(section, "Grades of which no size meets every requirement")[0][:2] == thin


def test_every_size_is_accounted_for(analyses, reports: dict[str, Report]) -> None:
    """The chosen one and those that were not chosen are all there are."""
    for case in ("positive", "too_thin", "no_finite_cable"):
        found, section = analyses[case].selection, reports[case].section("selection")
        assert found is not None
        excluded = sum(int(row[1]) for row in cells(section, "Why the other sizes were not chosen"))
        assert excluded + (found.chosen is not None) == len(found.candidates)


def test_what_each_size_serves(reports: dict[str, Report]) -> None:
    section, start = reports["positive"].section("selection"), "How much of the workspace"
    shares = [row[2] for row in cells(section, start)]
    assert shares[0] == "0\u00a0%"
    assert shares[-1] == "100\u00a0%"
    assert shares.count("100\u00a0%") == 1
    assert "All thicker ones serve all of it" in table(section, start).caption


def test_losses_of_strength_are_said(solve) -> None:
    config = FAST.format(**DEFAULTS).replace(
        "safety_factor: 2", "safety_factor: 2, termination_efficiency: 0.9, sheave_diameter: 1 m"
    )
    analysis = solve(config)
    report = design_report(analysis, draws=False)
    assert "the smaller share counts" in said(report.section("assumptions"))
    assert (
        facts(report.section("answer"))["Allowable tension"].note
        == "breaking load times 0.9 over 2"
    )
    pareto = table(report.section("selection"), "Sizes that hold everywhere")
    columns = [column.title for column in pareto.columns]
    row = dict(zip(columns, pareto.groups[0].rows[0].cells, strict=True))
    load, allowed = (
        float(row[name].replace("\u202f", "")) for name in ("Breaking load", "Allowable")
    )
    assert row["Efficiency"] == "0.9"
    assert allowed == pytest.approx(0.45 * load, abs=1.0)


def test_doubtful_figures_carry_their_doubt(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    assert analysis.selection is not None
    outcome = analysis.selection.outcomes[0]
    assert outcome.best is not None
    doubtful = dataclasses.replace(outcome.best.size, doubt="looks misprinted")
    changed = dataclasses.replace(outcome.best, size=doubtful)
    candidates = [changed if c is outcome.best else c for c in outcome.candidates]
    selection = dataclasses.replace(
        analysis.selection,
        chosen=changed,
        outcomes=(dataclasses.replace(outcome, candidates=tuple(candidates), best=changed),),
    )
    report = design_report(altered(analysis, selection=selection), draws=False)
    (row,) = table(report.section("selection"), "Sizes that hold everywhere").groups[0].rows
    assert row.note == "Doubtful figures: looks misprinted"


def test_numbers_of_sections_count_up(reports: dict[str, Report]) -> None:
    numbers = re.findall(r'<h2 .*?<span class="number">(\d+)', render_html(reports["pose_only"]))
    assert numbers == [str(k) for k in range(1, 10)]
    assert [section.id for section in reports["positive"].sections] == [
        "answer",
        "inputs",
        "checks",
        "carries",
        "uncertainty",
        "workspace",
        "selection",
        "stiffness",
        "modes",
        "workshop",
        "reactions",
        "pose",
        "family",
        "verification",
        "left-out",
        "assumptions",
        "nomenclature",
        "provenance",
    ]


def test_first_page_says_how_much_is_left_out(reports: dict[str, Report]) -> None:
    pages = {case: first_page(report) for case, report in reports.items()}
    assert "of the volume is excluded, as configured" in pages["exclude"].verdict.text
    assert "excluded" not in pages["positive"].verdict.text
    titles = {case: [s.title for s in page.confidence] for case, page in pages.items()}
    assert "Poses excluded" in titles["exclude"]
    assert "Cables below the platform" in titles["positive"]
    assert {"Poses excluded", "Cables below the platform"}.isdisjoint(titles["yard"])


def selection_page(analyses: dict[str, Analysis], selection: SelectionResult) -> Section | None:
    analysis = altered(analyses["positive"], selection=selection)
    return section_of(Drawings(analysis), "selection")


def test_long_rankings_show_their_best_rows_and_say_where_the_rest_is(
    analyses: dict[str, Analysis],
) -> None:
    selection = analyses["positive"].selection
    assert selection is not None
    outcome = next(o for o in selection.outcomes if o.best is not None)
    many = dataclasses.replace(selection, outcomes=(outcome,) * (MOST_ROWS + 3))
    best = table(selection_page(analyses, many), "The best size of each grade")
    assert len(best.groups[0].rows) == MOST_ROWS
    assert "3\u00a0more grades are in candidates.csv." in best.caption
    failing = dataclasses.replace(outcome, outcome="too_thin", best=None)
    few = dataclasses.replace(selection, outcomes=(outcome, *[failing] * 9))
    thin = table(selection_page(analyses, few), "Grades of which no size meets every requirement")
    assert len(thin.groups[0].rows) == MOST_ROWS
    assert "1\u00a0more grade is in candidates.csv." in thin.caption
