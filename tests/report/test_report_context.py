"""The context: what it says, and that it is documented and shown in full."""

from __future__ import annotations

import dataclasses
import importlib
import pkgutil
from collections.abc import Callable, Iterator

import pytest
from markupsafe import escape
from report_cases import CASES, DEFAULTS, FAST

from designer.analysis.analyse import Analysis
from designer.report import design
from designer.report import format as fmt
from designer.report.design.candidates import best_table, thin_table
from designer.report.design.context import ReportContext, build_context
from designer.report.design.pose import turns_table
from designer.report.parts import MOST_ROWS, Picture, Table
from designer.report.pictures import Pictures
from designer.report.render import render_html
from designer.sizing.loop import Iterate, LoopSizing

pytestmark = pytest.mark.slow

PICTURE = Picture("What it shows.", "For who cannot see it.", svg="<svg><path d=''/></svg>")
SCENE = Picture(
    "A scene.", "Also a scene.", bitmap="data:image/png;base64,AA==", scene="<p>3-D</p>"
)
PICTURES = Pictures(
    robot=SCENE,
    loop_chart=PICTURE,
    pose_scene=SCENE,
    workspace=(PICTURE, SCENE),
    candidates=PICTURE,
    pareto=PICTURE,
    usable_chart=PICTURE,
    usable_scene=SCENE,
)


def texts(part: object) -> Iterator[str]:
    """Every text in the context, however deep."""
    if isinstance(part, str):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from texts(item)
    elif dataclasses.is_dataclass(part):
        for field in dataclasses.fields(part):
            if not (isinstance(part, Picture) and field.name in ("svg", "bitmap", "alternative")):
                yield from texts(getattr(part, field.name))


def tables(part: object) -> Iterator[Table]:
    """Every table in the context."""
    if isinstance(part, Table):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from tables(item)
    elif dataclasses.is_dataclass(part):
        for field in dataclasses.fields(part):
            yield from tables(getattr(part, field.name))


@pytest.fixture(scope="module")
def contexts(
    analyses: dict[str, Analysis], pose_only: Analysis, yard: Analysis
) -> dict[str, ReportContext]:
    all_of_them = {**analyses, "pose_only": pose_only, "yard": yard}
    return {name: build_context(a, PICTURES) for name, a in all_of_them.items()}


@pytest.mark.parametrize("case", [*CASES, "pose_only", "yard"])
def test_everything_in_the_context_is_shown(contexts: dict[str, ReportContext], case: str) -> None:
    html = render_html(contexts[case])
    missing = [text for text in texts(contexts[case]) if str(escape(text)) not in html]
    assert missing == []


@pytest.mark.parametrize("case", [*CASES, "pose_only", "yard"])
def test_every_row_fills_its_table(contexts: dict[str, ReportContext], case: str) -> None:
    found = list(tables(contexts[case]))
    assert len(found) >= 4
    for table in found:
        widths = {len(row.cells) for group in table.groups for row in group.rows}
        assert widths <= {len(table.columns)}


def test_no_raw_number_reaches_the_page(contexts: dict[str, ReportContext]) -> None:
    words = {word.strip("(),.") for text in texts(contexts["positive"]) for word in text.split()}
    assert words.isdisjoint({"nan", "inf", "None", "array", "np.float64"})


def documented_classes() -> list[type]:
    """ReportContext and the dataclasses that its fields hold."""
    found: list[type] = []

    def add(kind: object) -> None:
        if isinstance(kind, type) and dataclasses.is_dataclass(kind) and kind not in found:
            found.append(kind)

    add(ReportContext)
    for info in pkgutil.iter_modules(design.__path__):
        module = importlib.import_module(f"{design.__name__}.{info.name}")
        for value in vars(module).values():
            add(value)
    return [
        kind for kind in found if kind.__name__.endswith(("Section", "Page", "Context", "Card"))
    ]


@pytest.mark.parametrize("kind", documented_classes())
def test_every_field_is_documented(kind: type) -> None:
    names = {field.name for field in dataclasses.fields(kind)}
    assert {name for name in names if name not in (kind.__doc__ or "")} == set()


def test_first_page_names_the_rope_and_its_margin(contexts: dict[str, ReportContext]) -> None:
    page = contexts["positive"].first_page
    assert page.verdict.tone == "good"
    assert page.card is not None
    facts = {fact.label: fact.value for fact in page.card.facts}
    assert page.card.size == "20.5 mm"
    assert facts["Grade"] == "gost-6x19s-iwrc-1960"
    assert facts["Safety factor there"] == "2.00"
    assert facts["Utilisation"] == "99.8\u00a0%"
    assert page.reasons == ()
    assert page.actions == ()


def test_sag_table_shows_the_papers_workspace_figures(contexts: dict[str, ReportContext]) -> None:
    sag = contexts["positive"].first_page.sag
    assert sag is not None
    rows = [row.cells for row in sag.table.groups[0].rows]
    assert rows[0] == ("Diameter", "29.3\u00a0mm", "51.2\u00a0mm", "1.75")
    assert rows[1] == ("Tension", "121.4\u00a0kN", "371.0\u00a0kN", "3.06")
    assert "19 mm" in sag.consequence
    assert "1.80" in sag.consequence


def test_pose_section_shows_the_papers_loop(contexts: dict[str, ReportContext]) -> None:
    pose = contexts["positive"].pose
    assert pose is not None
    assert pose.turns is not None
    first = [row.cells for row in pose.turns.groups[0].rows[:3]]
    assert first == [
        ("0", "86.39", "24.72"),
        ("1", "123.08", "29.51"),
        ("2", "138.69", "31.32"),
    ]


def test_a_loop_that_diverges_is_said_to(solve: Callable[[str], Analysis]) -> None:
    text = FAST.format(**{**DEFAULTS, "pose": "[250, 200, -1]"})
    section = build_context(solve(text[: text.index("workspace:")]), Pictures()).pose
    assert section is not None and section.turns is not None and section.methods is not None
    assert "It diverges" in section.turns.caption
    cells = [cell for row in section.turns.groups[0].rows for cell in row.cells]
    assert max(map(len, cells)) <= 15
    row = section.methods.groups[0].rows[-1].cells
    assert row[1:3] == (fmt.MISSING, fmt.MISSING)
    assert row[3].startswith("diverges, given up after")


def test_a_loop_that_does_not_settle_is_cut_short() -> None:
    turns_of_400 = tuple(Iterate(1e3 * k, 0.01) for k in range(401))
    table = turns_table(LoopSizing(turns_of_400, has_converged=False))
    turns = [row.cells[0] for row in table.groups[0].rows]
    assert turns[:2] == ["0", "1"]
    assert turns[-4:] == ["…", "398", "399", "400"]
    assert len(turns) == 9


def test_candidates_begin_with_the_chosen_one(contexts: dict[str, ReportContext]) -> None:
    selection = contexts["positive"].selection
    assert selection is not None
    assert selection.pareto is not None
    assert selection.pareto.groups[0].title == "gost-6x19s-iwrc-1960"
    assert "best in mass of all cables" in selection.pareto.groups[0].remark
    assert selection.pareto.groups[0].tone == "good"
    assert selection.best is not None
    assert selection.best.groups[0].rows[0].cells[:3] == (
        "gost-6x19s-iwrc-1960",
        "steel",
        "20.5\u00a0mm",
    )
    assert selection.thin is not None
    assert selection.thin.groups[0].rows[0].cells[:2] == ("unirope-7x19-galvanised", "3/8 in")


def test_every_size_is_accounted_for(analyses, contexts: dict[str, ReportContext]) -> None:
    """Those that no other beats, and those that fell out, are all there are."""
    for case in ("positive", "too_thin", "no_finite_cable"):
        found, section = analyses[case].selection, contexts[case].selection
        assert found is not None
        assert section is not None
        fallen = sum(int(row.cells[1]) for row in section.fallen.groups[0].rows)
        assert fallen + len(found.front) == len(found.candidates)


def test_what_each_size_serves(contexts: dict[str, ReportContext]) -> None:
    selection = contexts["positive"].selection
    assert selection is not None
    assert selection.usable is not None
    shares = [row.cells[2] for row in selection.usable.table.groups[0].rows]
    assert shares[0] == "0\u00a0%"
    assert shares[-1] == "100\u00a0%"
    assert shares.count("100\u00a0%") == 1
    assert "All thicker ones serve all of it" in selection.usable.table.caption


def test_losses_of_strength_are_said(solve) -> None:
    config = FAST.format(**DEFAULTS).replace(
        "safety_factor: 2", "safety_factor: 2, termination_efficiency: 0.9, sheave_diameter: 1 m"
    )
    analysis = solve(config)
    context = build_context(analysis, Pictures())
    assert "the smaller share counts" in context.assumptions.losses
    assert context.first_page.card is not None
    facts = {fact.label: fact for fact in context.first_page.card.facts}
    assert facts["Allowable tension"].note == "breaking load times 0.9 over 2"
    assert context.selection is not None
    assert context.selection.pareto is not None
    columns = [column.title for column in context.selection.pareto.columns]
    row = dict(zip(columns, context.selection.pareto.groups[0].rows[0].cells, strict=True))
    load, allowable = (
        float(row[name].replace("\u202f", "")) for name in ("Breaking load", "Allowable")
    )
    assert row["Efficiency"] == "0.9"
    assert allowable == pytest.approx(0.45 * load, abs=1.0)


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
    context = build_context(dataclasses.replace(analysis, selection=selection), Pictures())
    assert context.selection is not None
    assert context.selection.pareto is not None
    rows = context.selection.pareto.groups[0].rows
    assert [row.note for row in rows] == ["Doubtful figures: looks misprinted"]


def test_numbers_of_sections_count_up(contexts: dict[str, ReportContext]) -> None:
    assert [h.number for h in contexts["pose_only"].headings] == [1, 2, 3, 4, 5, 6]
    assert [h.id for h in contexts["positive"].headings] == [
        "answer",
        "inputs",
        "pose",
        "workspace",
        "selection",
        "stiffness",
        "left-out",
        "assumptions",
        "nomenclature",
        "provenance",
    ]


def test_first_page_says_how_much_is_left_out(contexts: dict[str, ReportContext]) -> None:
    assert "of the volume is left out, as configured" in contexts["exclude"].first_page.verdict.text
    assert "left out" not in contexts["positive"].first_page.verdict.text
    titles = {case: [s.title for s in contexts[case].first_page.confidence] for case in contexts}
    assert "Poses left out" in titles["exclude"]
    assert "Cables below the platform" in titles["positive"]
    assert {"Poses left out", "Cables below the platform"}.isdisjoint(titles["yard"])


def test_long_rankings_show_their_best_rows_and_say_where_the_rest_is(
    analyses: dict[str, Analysis],
) -> None:
    selection = analyses["positive"].selection
    assert selection is not None
    outcome = next(o for o in selection.outcomes if o.best is not None)
    many = dataclasses.replace(selection, outcomes=(outcome,) * (MOST_ROWS + 3))
    table = best_table(many)
    assert len(table.groups[0].rows) == MOST_ROWS
    assert "3\u00a0more grades are in candidates.csv." in table.caption
    thin = thin_table([dataclasses.replace(outcome, outcome="too_thin", best=None)] * 9)
    assert thin is not None
    assert len(thin.groups[0].rows) == MOST_ROWS
    assert "1\u00a0more grade is in candidates.csv." in thin.caption
