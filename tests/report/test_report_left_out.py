"""What plugins could not bring is told in both reports, as text."""

from __future__ import annotations

import dataclasses
import json

import pytest
from altered import altered
from report_parts import said

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.report.blocks import Bullets, Report, Section
from designer.report.design import left_out
from designer.report.design.source import Source
from designer.report.render import render_html

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
    section = left_out.section(Source(spoilt))
    assert section is not None
    assert str(section.blocks[-2]).endswith("These could not be loaded:")
    assert section.blocks[-1] == Bullets((EVIL, LOST))
    assert result_dict(spoilt)["provenance"]["problems"] == [EVIL, LOST]
    assert json.dumps(result_dict(spoilt))


def test_few_grades_are_named_and_many_are_counted(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    names = [g.id for g in analysis.catalogue.grades if not g.why_only_by_name]
    few, many = (
        said(left_out.section(Source(_allowing(analysis, tuple(some)))))
        for some in (names[3:], names[:3])
    )
    assert all(name in few for name in names[:3])
    assert f"{len(names) - 3} more grades" in many
    assert not any(name in many for name in names)


def _allowing(analysis: Analysis, grades: tuple[str, ...]) -> Analysis:
    assert analysis.study.selection is not None
    selection = dataclasses.replace(analysis.study.selection, grades=grades)
    return altered(analysis, study=dataclasses.replace(analysis.study, selection=selection))


def test_markup_of_a_plugin_stays_text() -> None:
    section = Section.of("left-out", "Grades left out", Bullets((EVIL, LOST)))
    answer = Section("x", "Another section")
    html = render_html(Report("report", "A", "Report", "us 1.0", "", "", None, (answer, section)))
    assert "<script" not in html
    assert "&lt;script&gt;alert(1)" in html
