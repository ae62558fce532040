"""Numbers as an engineer writes them, in the text of whole reports and in each filter."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

from designer import spelling
from designer.analysis.analyse import Analysis
from designer.model.verdict import Requirement, State
from designer.report import format as fmt
from designer.report import phrases
from designer.report.design.drawings import Drawings
from designer.report.design.report import design_report
from designer.report.figures import canvas
from designer.report.figures.sections import slice_panels
from designer.report.render import render_html
from designer.report.templates import environment

PATTERNS = {
    "exponent": r"(?<![\w/])\d+(?:\.\d+)?[eE][-+]?\d+\b",
    "minus zero": r"(?<![\w.])[-−]0(?:\.0+)?(?![\d.])",
    "digits": r"(?<![\w.,-])\d[\d\u202f]*\.\d+(?![\w.])",
    "word": r"\b(?:None|nan|NaN|inf|True|False)\b",
    "not stated": r"not stated[, ]+not stated",
}
REDUNDANT = """
name: Facade
robot:
  anchors: [[-9, 0, 15], [9, 0, 15], [9, 0, 0], [-9, 0, 0]]
  planar: true
  tension_min: 100 N
  platform:
    mass: 60 kg
    attachments: [[-0.5, 0, 0.3], [0.5, 0, 0.3], [0.5, 0, -0.3], [-0.5, 0, -0.3]]
cable: {density: 5290, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
workspace: {region: {rectangle: [[-6, 0], [6, 0]], z: [3, 12]}, samples: 40, proof: 0 s}
selection: {grades: [lg-7x19-wsc-galvanised-2070]}
"""


def faults(html: str) -> Iterator[tuple[str, str]]:
    """Yield what no engineer writes, with what stands around it; what a study gives stays."""
    body = re.sub(r"<(style|script|svg|iframe|math|a)\b.*?</\1>", " ", html, flags=re.DOTALL)
    sections = re.split(r"<section", body)
    kept = [s for s in sections if not re.search(r'<h2 id="(inputs|provenance)"', s)]
    text = unescape(re.sub(r"<[^>]*>", " ", " ".join(kept)))
    for name, pattern in PATTERNS.items():
        for found in re.finditer(pattern, text):
            is_short = len(re.sub(r"\D", "", found[0]).lstrip("0")) <= 6
            if not (name == "digits" and is_short):
                yield name, text[max(found.start() - 40, 0) : found.end() + 20]


def page(analysis: Analysis) -> str:
    return render_html(design_report(analysis, draws=False))


@pytest.fixture(scope="session")
def redundant(solve) -> Analysis:
    return solve(REDUNDANT)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", ["yard", "kept", "pose_only", "redundant"])
def test_numbers_of_a_report_are_plain(name: str, request: pytest.FixtureRequest) -> None:
    assert [*faults(page(request.getfixturevalue(name)))] == []


def test_patterns_find_what_they_name() -> None:
    text = "<p>(3.71e-07, 34) m, −0°, 2.125e+04 kg, 48.84818523 m, None; not stated, not stated</p>"
    assert {name for name, _ in faults(text)} == PATTERNS.keys()


def test_spare_cables_at_a_limit_are_no_near_failure(redundant: Analysis) -> None:
    html = page(redundant)
    assert "No near-failure: a robot with more cables" in html
    assert html.count("No near-failure") < len(redundant.requirements)


def test_fields_that_are_not_given_are_counted(yard: Analysis) -> None:
    report = design_report(yard, draws=False)
    screen, paper = (render_html(report, paged=paged) for paged in (False, True))
    assert re.search(r"<summary>\d+\u00a0more fields are neither given nor", screen)
    assert "selection.rope_life" in screen
    assert "selection.rope_life" not in paper


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ([3.71e-7, 34.0, 20.0], "(0, 34, 20)"),
        ([-1e-9, 12345.678, -0.0], "(0, 12350, 0)"),
        ([0.0, 0.0, 0.0], "(0, 0, 0)"),
    ],
)
def test_a_row_of_numbers_has_no_exponent(values: list[float], text: str) -> None:
    assert spelling.vector(values) == text


def test_digits() -> None:
    numbers = (21249.6, 48.84818523, -0.0, 1e-5)
    assert [spelling.digits(x) for x in numbers] == ["21250", "48.85", "0", "0.00001"]


def test_a_far_place_has_no_exponent() -> None:
    assert phrases.short_position(np.array([21250.0, -0.001, -3.0])) == "(21250, 0, −3)"


def test_alike_lengths_stand_once() -> None:
    alike = phrases.lengths(np.full(6, 338.2))
    assert alike == "6\u00a0×\u00a0338.20\u00a0m"
    assert phrases.lengths(np.array([3.0, 1.0, 2.0, 4.5])) == "1.00 to 4.50\u00a0m"
    assert phrases.lengths(np.array([1.0, 2.0, 1.004])) == "2\u00a0×\u00a01.00 and 2.00\u00a0m"


def test_forces_of_a_column_have_one_unit() -> None:
    write = fmt.alike([12.0, 124_160.0, np.nan])
    assert write(12.0, 124_160.0, np.nan) == ("0.0\u00a0kN", "124.2\u00a0kN", "–")


def test_what_a_source_does_not_state_is_left_out() -> None:
    unknown = SimpleNamespace(construction="6x36 WS", core="not stated", finish="not stated")
    assert phrases.construction(unknown) == "6x36 WS"
    unknown.construction = "not stated"
    assert phrases.construction(unknown) == "not stated"


def test_powers_of_sources_are_typeset() -> None:
    assert fmt.printed("G = 1.40e-5 of d31e9e5") == "G = 1.40\u202f×\u202f10⁻⁵ of d31e9e5"


def test_sag_is_a_share() -> None:
    sag = Requirement("sag", "Sag", "", "", State.HOLDS, "all", 0.1999, 0.2)
    assert phrases.of_requirement(sag.demand, sag) == "20.0\u00a0%"


def test_sizes_that_serve_nothing_are_one_row() -> None:
    shares = [0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    runs = phrases.runs_that_serve_none([SimpleNamespace(fraction=share) for share in shares])
    assert [len(run) for run in runs] == [3, 1, 1, 1, 1, 4]


def test_columns_of_statements_are_equally_long() -> None:
    left, right = phrases.two_columns(["a" * 550, "b" * 110, "c" * 110, "d" * 110, "e" * 110])
    assert [*map(len, left)] == [550]
    assert [*map(len, right)] == [110] * 4


def test_worst_pose_of_a_map_stands_in_its_title(redundant: Analysis) -> None:
    maps = Drawings(redundant, draws=True).maps
    assert maps is not None
    with canvas.kept_figures() as figures:
        slice_panels(maps)
        (figure,) = figures
        *panels, _, _ = figure.axes
        for axes in panels:
            assert "○ worst pose, " in axes.get_title(loc="left")
            assert all(text.get_text()[0] == "A" for text in axes.texts if text.get_text()[0] > "9")


@pytest.mark.parametrize(("value", "is_given"), [(95.0, True), (30.9, False)])
def test_an_estimate_far_off_is_no_figure(value: float, is_given: bool) -> None:
    objective = SimpleNamespace(dimension=SimpleNamespace(unit="kg"), path="total_mass_kg")
    optimum = SimpleNamespace(
        plan=SimpleNamespace(objective=objective, variables=[], samples=40),
        searched=SimpleNamespace(trials=[0, 1], elapsed_s=3.0, ended="settled"),
        best=SimpleNamespace(value=value, values=[]),
        given=SimpleNamespace(study=SimpleNamespace(workspace=None)),
        after=100.0,
        off=(100.0 - value) / value,
        rejected=[],
        unverified=0,
        worsened=[],
        reasons=[],
        starts=[1],
        agreeing=1,
        out_of_bounds=[],
        at_bounds=[],
    )
    sentences = environment().get_template("optimise/sentences.html.j2")
    text = str(sentences.make_module({"optimum": optimum}).reliability())
    assert (fmt.kilograms(value) in text) == is_given
    assert ("too far off to be given as a figure" in text) != is_given
