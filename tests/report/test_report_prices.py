"""Prices that are borrowed, in a report."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_cli import STUDY, WORKSPACE

from designer.api import analyse, read_study
from designer.report.design.report import design_report
from designer.report.render import rendered


@pytest.mark.slow
@pytest.mark.parametrize("objectives", ["[cost, mass]", "[mass, drum_diameter]"])
def test_estimated_prices_are_said_to_be(tmp_path: Path, objectives: str) -> None:
    study = tmp_path / "crane.yaml"
    asked = WORKSPACE.replace("safety_factor", f"objectives: {objectives}, safety_factor")
    study.write_text(STUDY + asked)
    analysis = analyse(read_study(study))
    report = design_report(analysis)
    page = "".join(str(rendered(section, report).body) for section in report.sections)
    is_priced = "cost" in objectives
    assert ("Prices are a borrowed estimate" in page) is is_priced
    assert ("Estimated price" in page) is is_priced
    assert ("is a borrowed estimate." in page) is is_priced
    selection = analysis.to_dict()["selection"]
    assert (selection["currency"], selection["price_estimate"] is not None) == (
        ("USD", True) if is_priced else (None, False)
    )
