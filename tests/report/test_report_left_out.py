"""What plugins could not bring is told in both reports, as text."""

from __future__ import annotations

import dataclasses
import json

import pytest
from designer.report.design.appendix import left_out_section

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.resources import data_folder

pytestmark = pytest.mark.slow

EVIL = "plugin acme (<script>alert(1)</script> 1.2) cannot be loaded: KeyError: left out"
LOST = "plugin acme (acme 1.2): effect 'creep' is in 'builtin-effects' already: left out"


def test_both_kinds_of_problem_are_told_once(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["markup"]
    known = dataclasses.replace(analysis.study.known_effects, problems=(EVIL, LOST))
    spoilt = dataclasses.replace(
        analysis,
        study=dataclasses.replace(analysis.study, known_effects=known),
        catalogue=dataclasses.replace(analysis.catalogue, problems=(EVIL,)),
    )
    section = left_out_section(spoilt)
    assert section is not None
    assert section.problems == (EVIL, LOST)
    assert result_dict(spoilt)["provenance"]["problems"] == [EVIL, LOST]
    assert json.dumps(result_dict(spoilt))


def test_few_grades_are_named_and_many_are_counted(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["positive"]
    names = [g.id for g in analysis.catalogue.grades if not g.why_only_by_name]
    few, many = (
        left_out_section(_allowing(analysis, tuple(some))) for some in (names[3:], names[:3])
    )
    assert few is not None
    assert many is not None
    assert all(name in few.not_allowed for name in names[:3])
    assert f"{len(names) - 3}\u00a0more grades" in many.not_allowed
    assert not any(name in many.not_allowed for name in names)


def _allowing(analysis: Analysis, grades: tuple[str, ...]) -> Analysis:
    assert analysis.study.selection is not None
    selection = dataclasses.replace(analysis.study.selection, grades=grades)
    return dataclasses.replace(
        analysis, study=dataclasses.replace(analysis.study, selection=selection)
    )


def test_markup_of_a_plugin_stays_text() -> None:
    import jinja2

    # the partial alone: what it shows is the section, whatever else the report has
    loader = jinja2.FileSystemLoader(data_folder("reports"))
    environment = jinja2.Environment(loader=loader, autoescape=True)
    template = environment.get_template("partials/left_out.html.j2")
    html = template.render(report={"left_out": {"not_allowed": "", "problems": (EVIL, LOST)}})
    assert "<script" not in html
    assert "&lt;script&gt;alert(1)" in html
