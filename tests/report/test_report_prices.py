"""Prices that are borrowed, in a report."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_cli import STUDY, WORKSPACE

from designer.api import analyse, read_study
from designer.report.design.report import design_report
from designer.report.render import rendered

GRADE = "unirope-6x36-iwrc-1960"


def page_of(folder: Path, selection: str) -> tuple[str, dict]:
    """Return the page of a study that has this in its selection, and the choice in its result."""
    study = folder / "crane.yaml"
    study.write_text(STUDY + WORKSPACE.replace("safety_factor", f"{selection}, safety_factor"))
    analysis = analyse(read_study(study))
    report = design_report(analysis)
    page = "".join(str(rendered(section, report).body) for section in report.sections)
    return " ".join(page.replace("\u202f", "").split()), analysis.to_dict()["selection"]


@pytest.mark.slow
@pytest.mark.parametrize("objectives", ["[cost, mass]", "[mass, drum_diameter]"])
def test_estimated_prices_are_said_to_be(tmp_path: Path, objectives: str) -> None:
    page, selection = page_of(tmp_path, f"objectives: {objectives}")
    is_priced = "cost" in objectives
    assert ("Prices are a borrowed estimate" in page) is is_priced
    assert ("Estimated price" in page) is is_priced
    assert ("Its price, the least of those that are known, is a borrowed" in page) is is_priced
    assert ("may be 0.5 to 2.0 times as much" in page) is is_priced
    assert (selection["currency"], selection["price_estimate"] is not None) == (
        ("USD", True) if is_priced else (None, False)
    )


@pytest.mark.slow
def test_page_1_of_groups_says_that_prices_are_estimated(tmp_path: Path) -> None:
    groups = "groups: {west: [1], others: [2, 3]}"
    page, _ = page_of(tmp_path, f"objectives: [cost, mass], {groups}")
    assert "Their price, the least of those that are known, is a borrowed estimate." in page
    assert "Estimated price of all cables" in page


@pytest.mark.slow
def test_a_price_list_stands_with_currency_and_dates_on_page_1(tmp_path: Path) -> None:
    rows = [f"{GRADE},{d} mm,{d / 10},EUR,2026-0{1 + d % 3}" for d in (16, 18, 20, 24, 26, 28)]
    table = "\n".join(["grade,size,price_per_m,currency,date", *rows])
    (tmp_path / "prices.csv").write_text(table)
    page, selection = page_of(tmp_path, "objectives: [cost, mass], prices: prices.csv")
    cost = selection["chosen"]["cost"]
    assert cost == pytest.approx(
        sum(selection["chosen"]["longest_m"]) * selection["chosen"]["diameter_m"] * 100
    )
    assert "Price of all cables" in page
    assert "by prices.csv, of 2026-01 to 2026-03" in page
    assert "Prices are those of prices.csv: 6 sizes in EUR, of 2026-01 to 2026-03." in page
    assert "estimate" not in page.split("Nomenclature")[0].split("Price of all cables")[1][:200]
    assert selection["price_list"] == {
        "file": "prices.csv",
        "currency": "EUR",
        "dates": ["2026-01", "2026-03"],
        "prices": 6,
    }
