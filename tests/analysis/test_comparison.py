"""`designer compare`: what differs between two designs, and nothing that does not."""

from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path

import pytest
from pypdf import PdfReader
from test_cli import STUDY, WORKSPACE, designer

import designer as door
from designer.analysis.comparison import compare
from designer.report.comparison import comparison_report
from designer.report.render import render_html

__all__ = ["designer"]


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> tuple[dict, dict]:
    """The same crane with 4000 and 5000 kg."""
    folder = tmp_path_factory.mktemp("crane")
    found = []
    for mass in ("4000 kg", "5000 kg"):
        path = folder / f"{mass[:4]}.yaml"
        path.write_text((STUDY + WORKSPACE).replace("4000 kg", mass))
        found.append(door.analyse(door.read_study(path)).to_dict())
    return found[0], found[1]


@pytest.mark.slow
def test_the_field_that_differs_and_what_follows_from_it(results) -> None:
    found = compare(*results)
    assert [(one.path, one.a, one.b) for one in found.inputs] == [
        ("robot.platform.mass", "4000 kg", "5000 kg")
    ]
    assert found.inputs[0].relative == pytest.approx(0.25)
    lines = {line.path: line for line in found.answers}
    tension = lines["pose.sagging.max_tension_N"]
    assert tension.relative == pytest.approx(0.25, rel=1e-9)  # of a family: in proportion
    assert lines["pose.sagging.diameter_m"].relative == pytest.approx(1.25**0.5 - 1.0, rel=1e-9)
    assert not found.is_same
    assert not any("created" in line.path for line in found.remaining)


@pytest.mark.slow
def test_a_result_with_itself_is_the_same(results) -> None:
    later = deepcopy(results[0])
    later["provenance"]["created"] = "2030-01-01T00:00:00+00:00"
    found = compare(results[0], later)
    assert found.is_same
    assert (found.inputs, found.products, found.remaining) == ((), (), ())
    assert found.to_dict()["same"] is True


@pytest.mark.slow
@pytest.mark.parametrize("path", ["workspace.limit_ratio", "selection.chosen.longest_m"])
def test_a_change_beyond_rounding_is_told_and_rounding_is_not(results, path) -> None:
    for factor, told in ((1.0 + 1e-8, True), (1.0 + 1e-10, False)):
        other = deepcopy(results[0])
        *way, key = path.split(".")
        place = other
        for step in way:
            place = place[step]
        value = place[key]
        place[key] = [v * factor for v in value] if isinstance(value, list) else value * factor
        assert compare(results[0], other).is_same is not told


@pytest.mark.slow
def test_the_verdict_and_what_is_not_met_stand_side_by_side(results) -> None:
    assert compare(*results).unmet == ()
    worse = deepcopy(results[1])
    worse["answer"]["verdict"] = "no"
    check = worse["checks"][-1]
    check |= {"state": "fails", "demand": 28.0, "capacity": 25.2, "unit": "N"}
    found = compare(results[0], worse)
    (line,) = found.unmet
    assert line.path == f"{check['id']} in {check['load_case']}"
    assert line.a.startswith("holds")
    assert line.b == "fails: demand 28 N, capacity 25.2 N"
    verdict = next(line for line in found.answers if line.path == "answer.verdict")
    assert (verdict.a, verdict.b) == (results[0]["answer"]["verdict"], "no")
    assert found.to_dict()["unmet"][0]["b"] == line.b
    created = moment()
    assert line.b in render_html(comparison_report(found, ("a", "b"), created))


@pytest.mark.slow
def test_sizes_that_hold_in_one_only(results) -> None:
    found = compare(*results)
    for line in found.products:
        assert {line.a, line.b} == {"holds", "does not hold"}
    held = [
        {f"{c['grade']}, {c['size_id']}" for c in one["selection"]["candidates"] if c["verified"]}
        for one in results
    ]
    assert held[0] - held[1] <= {line.path for line in found.products}


@pytest.mark.slow
def test_a_result_without_inputs_says_so(results) -> None:
    old = {key: value for key, value in results[0].items() if key != "inputs"}
    found = compare(old, results[1])
    assert found.to_dict()["inputs"] is None
    html = render_html(comparison_report(found, ("a.json", "b.yaml"), moment()))
    assert "did not write down its inputs" in html


def priced(cost: float | None, currency: str | None, estimate: bool = False) -> dict:
    """Return what a result has of a price."""
    borrowed = {"year": 2024, "low": 0.5} if estimate else None
    selection = {"currency": currency, "price_estimate": borrowed, "chosen": {"cost": cost}}
    return {"selection": selection, "provenance": {}}


@pytest.mark.parametrize(
    ("a", "b", "label", "values", "relative"),
    [
        (priced(8.0, "EUR"), priced(10.0, "EUR"), "cost [EUR]", (8.0, 10.0), 0.25),
        (
            priced(8.0, "USD", estimate=True),
            priced(10.0, "USD"),
            "cost [USD], a borrowed estimate in A",
            (8.0, 10.0),
            0.25,
        ),
        (
            priced(8.0, "USD", estimate=True),
            priced(10.0, "EUR"),
            "cost, a borrowed estimate in A",
            ("8 USD", "10 EUR"),
            None,
        ),
        (
            priced(8.0, "USD", estimate=True),
            priced(4.0, "USD", estimate=True),
            "cost [USD], a borrowed estimate in A and B",
            (8.0, 4.0),
            -0.5,
        ),
        (priced(None, None), priced(4.0, "EUR"), "cost [EUR]", (None, 4.0), None),
        (priced(8.0, None), priced(4.0, None), "cost", (8.0, 4.0), -0.5),
        (priced(8.0, None), priced(4.0, "EUR"), "cost", ("8 without a currency", "4 EUR"), None),
        (priced(0.0, None), priced(0.0, None), "cost", (0.0, 0.0), None),
    ],
)
def test_costs_have_a_currency_and_say_what_is_borrowed(a, b, label, values, relative) -> None:
    (line,) = (one for one in compare(a, b).answers if one.path == "selection.chosen.cost")
    assert (line.label, (line.a, line.b), line.relative) == (label, values, relative)


def test_results_with_hardly_anything_in_them() -> None:
    found = compare({"provenance": {}}, {"provenance": {}, "selection": [], "pose": None})
    assert found.to_dict()["names"] == [None, None]
    render_html(comparison_report(found, ("a.json", "b.json"), moment()))


def moment():
    from datetime import UTC, datetime

    return datetime(2026, 1, 1, tzinfo=UTC)


@pytest.mark.slow
def test_a_study_and_a_result_file(tmp_path, designer, results) -> None:
    (tmp_path / "crane.yaml").write_text(STUDY)
    (tmp_path / "result.json").write_text(json.dumps(results[1]))
    found = designer("compare", "crane.yaml", "result.json", "-o", "both")
    assert found.status == 0, found.err
    assert "robot.platform.mass" in found.out
    assert sorted(p.name for p in Path("both").iterdir()) == [
        "comparison.html", "comparison.json", "comparison.pdf",
    ]  # fmt: skip
    pages = "".join(page.extract_text() for page in PdfReader("both/comparison.pdf").pages)
    assert "1 Differences" in pages
    assert "5000 kg" in pages
    assert "<h1" in Path("both/comparison.html").read_text()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[1, 2]", "is no result (expected a result.json that `designer report` wrote)"),
        ("{", "cannot be read"),
        ('{"format": 99, "provenance": {"version": "9.0"}}', "needs cdpr-designer 9.0 or newer"),
    ],
)
def test_what_is_no_result(tmp_path, designer, text, words) -> None:
    (tmp_path / "crane.yaml").write_text(STUDY)
    (tmp_path / "other.json").write_text(text)
    found = designer("compare", "crane.yaml", "other.json")
    assert found.status == 2
    assert words in found.err
    assert not (tmp_path / "crane-other-comparison").exists()
