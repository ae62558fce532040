"""How likely a rope is enough, as the report shows it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from report_parts import Statement, cells, paragraphs, pictures, statements, tables

from designer.analysis.uncertainty import Checked, Share, SizeOdds, UncertaintyAnalysis
from designer.model.uncertainty import Normal, Uncertainty, Uniform
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.document import Section
from designer.report.phrases import in_a_sentence, probability

SPREADS: Any = {"payload": Normal(0.05), "modulus": Uniform(-0.15, 0.15)}
SHARES = (
    Share("payload", 0.61, (0.58, 0.64), 0.62, (0.6, 0.64)),
    Share("modulus", 0.38, (0.36, 0.4), 0.39, (0.37, 0.41)),
)


def size_of(name: str, used: np.ndarray) -> SizeOdds:
    met = SimpleNamespace(utilisation=float(np.median(used)))
    candidate: Any = SimpleNamespace(size=SimpleNamespace(id=name), verification=met)
    return SizeOdds(candidate, used)


def found_of(used: np.ndarray, *, is_asked: bool = True, **other: Any) -> UncertaintyAnalysis:
    own = size_of("5 mm", used)
    beside = (size_of("4 mm", 1.4 * used), own, size_of("6 mm", 0.7 * used))
    rest: dict[str, Any] = {
        "spreads": SPREADS,
        "is_modulus_of_grade": True,
        "shares": SHARES,
        "why_no_shares": "",
        "points": 128,
        "checked": Checked(6, 2, 0.0),
    } | other
    return UncertaintyAnalysis(is_asked=is_asked, chosen=own, sizes=beside, seed=0, poses=3, **rest)


def shown(found: UncertaintyAnalysis | None, *, draws: bool = True, **more: Any) -> Section | None:
    study = SimpleNamespace(uncertainty=more.get("asked"))
    assignment = SimpleNamespace(rope=more.get("chosen"))
    analysis: Any = SimpleNamespace(
        uncertainty=found, study=study, findings=None, assignment=assignment, sensitivity=None
    )
    return section(Drawings(analysis, draws), "uncertainty")


def said_first(found: UncertaintyAnalysis) -> Statement:
    return statements(shown(found, draws=False))["With the uncertainty stated"]


@pytest.mark.parametrize(
    ("chosen", "why"),
    [(None, "no rope was chosen"), ("5 mm", "the study states no uncertainty")],
)
def test_what_was_asked_for_and_not_drawn_is_said(chosen: str | None, why: str) -> None:
    asked = shown(None, chosen=chosen, asked=Uncertainty(payload=Uniform(0.0, 0.0)))
    assert asked is not None
    assert paragraphs(asked) == [f"Not computed: {why}."]
    assert shown(None) is None


@pytest.fixture(scope="module")
def used() -> np.ndarray:
    return 0.9 + 0.04 * np.random.default_rng(0).normal(size=4096)


def test_the_first_page_has_one_line(used: np.ndarray) -> None:
    text = said_first(found_of(used)).text.replace("\u00a0", " ")
    assert text.startswith("Strong enough with 99.")
    assert "(95 % confidence: 99." in text
    assert "payload carries 61 % of the spread; " in text
    assert text.endswith("; this is strength alone, without the other requirements.")
    assert said_first(found_of(used)).tone == "good"
    assert said_first(found_of(1.05 * used)).tone == "doubt"
    assert said_first(found_of(1.2 * used)).tone == "bad"


def test_an_estimate_of_more_than_all_is_shown_as_all(used: np.ndarray) -> None:
    over = (replace(SHARES[0], first_order=1.014), replace(SHARES[1], first_order=-0.003))
    found = found_of(used, shares=over)
    assert said_first(found).text.replace("\u00a0", " ").count("carries 100 % of the spread;") == 1
    whole = shown(found, draws=False)
    assert whole is not None
    assert [row[1] for row in cells(whole, "Share of each")] == ["100\u00a0%", "0.0\u00a0%"]


@pytest.mark.slow
def test_what_is_not_held_is_said(used: np.ndarray) -> None:
    some = used.copy()
    some[:41] = np.inf
    found = found_of(some, shares=(), why_no_shares="in 1 % of the draws a pose is not held")
    assert "1.00\u00a0% of the draws a pose is not held" in said_first(found).text
    blocks = shown(found)
    assert blocks is not None
    assert "No shares: in 1 % of the draws a pose is not held." in paragraphs(blocks)
    assert len(pictures(blocks)) == 1


def test_the_section_has_inputs_sizes_shares_and_how(used: np.ndarray) -> None:
    whole = shown(found_of(used))
    assert whole is not None
    inputs, sizes, shares = tables(whole)
    rows = [row.cells for row in inputs.groups[0].rows]
    assert rows[0][:3] == ("Payload", "normal, standard deviation 5\u00a0%", "the study")
    assert rows[1][:3] == ("Modulus of the rope", "±\u00a015\u00a0%, uniform", "the rope's grade")
    assert [row.cells[0] for row in sizes.groups[0].rows] == ["4 mm", "5 mm", "6 mm"]
    assert [row.tone for row in sizes.groups[0].rows] == ["", "good", ""]
    assert shares.groups[0].rows[0].cells[1:3] == ("61\u00a0%", "58.0 to 64.0\u00a0%")
    drawn = pictures(whole)
    assert all(one.svg.startswith("<svg") for one in drawn)
    assert "5 mm, chosen" in drawn[0].svg
    assert "alone (first order)" in drawn[1].svg
    assert "In the last of 2\u00a0rounds nothing was worse." in paragraphs(whole)[-1]
    bare = shown(found_of(used), draws=False)
    assert bare is not None
    assert pictures(bare) == []


def test_what_the_search_missed_is_said(used: np.ndarray) -> None:
    whole = shown(found_of(used, checked=Checked(6, 3, 0.0012)), draws=False)
    assert whole is not None
    assert "a pose was worse by 0.12 percentage points" in paragraphs(whole)[-1]


def test_a_borrowed_modulus_alone_takes_a_paragraph(used: np.ndarray) -> None:
    alone = {"spreads": {"modulus": Uniform(-0.15, 0.15)}, "shares": SHARES[:1], "points": 0}
    whole = shown(found_of(0.9 + 0 * used, is_asked=False, checked=Checked(), **alone))
    assert whole is not None
    first, (how,) = statements(whole)["Borrowed modulus"], paragraphs(whole)
    assert "90.0\u00a0% throughout, at most 100\u00a0% in every draw" in first.text
    assert "This is no probability that the rope holds" in first.text
    assert first.tone == ""
    assert "not searched again" in how


def test_nothing_where_all_is_certain() -> None:
    assert shown(None) is None


@pytest.mark.parametrize(
    ("enough", "text"),
    [(4096, "100\u00a0%"), (0, "0\u00a0%"), (4095, "99.98\u00a0%"), (4060, "99.1\u00a0%")],
)
def test_only_all_is_a_hundred_percent(enough: int, text: str) -> None:
    used = np.where(np.arange(4096) < enough, 0.5, 1.5)
    assert probability(size_of("a", used)) == text


def test_one_input_alone_carries_nothing_that_is_worth_a_word() -> None:
    used = np.linspace(0.7, 0.9, 64)
    assert "payload carries" in in_a_sentence(found_of(used)).replace("\u00a0", " ")
    assert "carries" not in in_a_sentence(found_of(used, shares=SHARES[:1]))
