"""Lengths to order, drums and end fittings, as the workshop needs them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from report_parts import Grid
from report_parts import tables as tables_of

import designer
from designer.report.design.drawings import Drawings
from designer.report.design.report import design_report, section

STUDY = """
robot:
  anchors: [[0, 0, 9], [30, 0, 9], [15, 26, 9]]
  platform: {mass: 180 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
workspace: {region: {prism: anchors, inset: 5 m, z: [1, 6]}, samples: 100}
"""
SELECTION = "selection: {grades: [unirope-7x19-galvanised], termination_efficiency: 0.9}\n"
GROUPS = "selection: {grades: [unirope-7x19-galvanised], groups: {near: [1, 2], far: [3]}}\n"


def analysis_of(tmp_path: Path, text: str) -> designer.Analysis:
    path = tmp_path / "study.yaml"
    path.write_text(STUDY + text)
    return designer.analyse(designer.read_study(path))


def tables(analysis: designer.Analysis) -> list[Grid]:
    return tables_of(section(Drawings(analysis), "workshop"))


@pytest.mark.slow
def test_the_lengths_are_those_of_the_chosen_rope(tmp_path) -> None:
    analysis = analysis_of(tmp_path, SELECTION)
    assert analysis.selection is not None
    chosen = analysis.selection.chosen
    assert chosen is not None
    lengths, ropes = tables(analysis)
    ratio = chosen.grade.sheave_ratio
    assert ratio is not None
    turn_m = math.pi * (ratio.suggested + 1.0) * chosen.size.diameter_m
    orders = []
    for k, row in enumerate(lengths.groups[0].rows):
        cable, size, shortest, longest, stroke, turns, order = row.cells
        assert (cable, size) == (str(k + 1), chosen.size.id)
        met = chosen.verification
        assert float(longest) == pytest.approx(met.longest_m[k], abs=0.005)
        assert float(shortest) == pytest.approx(met.shortest_m[k], abs=0.005)
        assert float(stroke) == pytest.approx(met.longest_m[k] - met.shortest_m[k], abs=0.005)
        assert float(turns) == pytest.approx(float(stroke) / turn_m, abs=0.1)
        assert 0.0 <= float(order) - met.longest_m[k] - 3.0 * turn_m <= 0.1
        orders.append(float(order))
    ((rope, total, ends, share, *_, drum, least),) = [r.cells for r in ropes.groups[0].rows]
    assert rope == chosen.name
    assert float(total) == pytest.approx(sum(orders), abs=0.05)
    assert (ends, share) == ("6", "90.0\N{NO-BREAK SPACE}%")
    assert float(drum) == pytest.approx(1e3 * ratio.suggested * chosen.size.diameter_m, abs=0.5)
    assert float(least) == pytest.approx(1e3 * ratio.minimum * chosen.size.diameter_m, abs=0.5)


@pytest.mark.slow
def test_groups_have_a_rope_each(tmp_path) -> None:
    analysis = analysis_of(tmp_path, GROUPS)
    assert analysis.groups is not None
    assert analysis.assignment.has_groups
    lengths, ropes = tables(analysis)
    sizes = [row.cells[1] for row in lengths.groups[0].rows]
    near, far = (product.size.id for product in analysis.assignment.ropes)
    assert sizes == [near, near, far]
    assert sum(int(row.cells[2]) for row in ropes.groups[0].rows) == 6


@pytest.mark.slow
def test_without_a_product_there_is_no_such_section(tmp_path) -> None:
    report = design_report(analysis_of(tmp_path, ""), draws=False)
    assert "workshop" not in [one.id for one in report.sections]
