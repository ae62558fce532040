"""What plugins could not bring is told in both reports, as text."""

from __future__ import annotations

import dataclasses
import json

import pytest
from altered import altered
from report_parts import page, said

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.report.design.drawings import Drawings
from designer.report.design.report import section

pytestmark = pytest.mark.slow

EVIL = "plugin acme (<script>alert(1)</script> 1.2) cannot be loaded: KeyError: left out"
LOST = "plugin acme (acme 1.2): effect 'creep' is in 'builtin-effects' already: left out"


def test_both_kinds_of_problem_are_told_once(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["markup"]
    known = dataclasses.replace(analysis.study.known_effects, problems=(EVIL, LOST))
    spoilt = altered(
        analysis,
        study=dataclasses.replace(analysis.study, known_effects=known),
        catalogue=dataclasses.replace(analysis.catalogue, problems=(EVIL,)),
    )
    shown = section(Drawings(spoilt), "left-out")
    assert f"These could not be loaded: {EVIL} {LOST}" in said(shown)
    assert "<script" not in page(shown)
    assert "&lt;script&gt;alert(1)" in page(shown)
    assert result_dict(spoilt)["provenance"]["problems"] == [EVIL, LOST]
    assert json.dumps(result_dict(spoilt))


def test_few_grades_are_named_and_many_are_counted(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    names = [g.id for g in analysis.catalogue.grades]
    few, many = (
        said(section(Drawings(_allowing(analysis, tuple(some))), "left-out"))
        for some in (names[3:], names[:3])
    )
    assert all(name in few for name in names[:3])
    assert f"{len(names) - 3} more grades" in many
    assert not any(name in many for name in names)


def _allowing(analysis: Analysis, grades: tuple[str, ...]) -> Analysis:
    assert analysis.study.selection is not None
    selection = dataclasses.replace(analysis.study.selection, grades=grades)
    return altered(analysis, study=dataclasses.replace(analysis.study, selection=selection))
