"""Uncertainty in a config: what it becomes, and one clear line for each mistake."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.model.uncertainty import Normal, Uncertainty, Uniform
from designer.study import Study

StudyOf = Callable[[str], Study]
FaultsOf = Callable[[str], list[Fault]]


def test_what_it_becomes(valid: str, study_of: StudyOf) -> None:
    block = """
uncertainty:
  payload: {standard_deviation: 2 %}
  modulus: {uniform: 0.15}
  linear_mass: {uniform: [-1 %, 0.03]}
  exit_points: {standard_deviation: 20 mm}
  samples: 1000
  seed: 7
"""
    assert study_of(valid + block).uncertainty == Uncertainty(
        payload=Normal(0.02),
        modulus=Uniform(-0.15, 0.15),
        linear_mass=Uniform(-0.01, 0.03),
        exit_points_m=Normal(0.02),
        samples=1000,
        seed=7,
    )
    points = study_of(valid + "uncertainty: {exit_points: {uniform: [-1 cm, 2 cm]}}").uncertainty
    assert points == Uncertainty(exit_points_m=Uniform(-0.01, 0.02))


@pytest.mark.parametrize("block", ["", "uncertainty:\n"])
def test_none(valid: str, study_of: StudyOf, block: str) -> None:
    assert study_of(valid + block).uncertainty is None


def test_the_table_of_inputs_has_it(valid: str, study_of: StudyOf) -> None:
    study = study_of(valid + "uncertainty: {payload: {uniform: [-2 %, 5 %]}}\n")
    entries = {one.field: one for one in study.source.entries}
    assert entries["uncertainty.payload.uniform"].given == "[-2 %, 5 %]"
    assert entries["uncertainty.payload.uniform"].value_SI == "[-0.02, 0.05]"
    assert entries["uncertainty.samples"].value_SI == "4096"


@pytest.mark.parametrize(
    ("block", "field", "problem"),
    [
        ("{payload: {standard_deviation: -2 %}}", "payload.standard_deviation", "'-2 %' is out of"),
        ("{payload: {standard_deviation: 2}}", "payload.standard_deviation", "2 is out of range"),
        ("{payload: {standard_deviation: 2 kg}}", "payload.standard_deviation", "unit kilogram"),
        ("{payload: {uniform: .nan}}", "payload.uniform", "not a finite number"),
        ("{payload: {uniform: [5 %, 1 %]}}", "payload.uniform", "not below the upper"),
        ("{payload: {uniform: [1 %, 2 %, 3 %]}}", "payload.uniform", "the list has 3 values"),
        ("{payload: {gauss: 2 %}}", "payload", "the distribution 'gauss' is not known"),
        ("{payload: 2 %}", "payload", "'2 %' is not a distribution"),
        ("{payload: {}}", "payload", "names no distribution"),
        ("{modulus: {standard_deviation: 1 %, uniform: 2 %}}", "modulus", "two distributions"),
        ("{exit_points: {standard_deviation: 2 %}}", "exit_points.standard_deviation", "percent"),
        ("{exit_points: {standard_deviation: 20}}", "exit_points.standard_deviation", "out of"),
        ("{paylod: {uniform: 2 %}}", "paylod", "unknown field"),
        ("{samples: 3}", "samples", "out of range"),
        ("{samples: 0.5}", "samples", "not a whole number"),
        ("{seed: -1}", "seed", "out of range"),
    ],
)
def test_mistakes(valid: str, faults_of: FaultsOf, block: str, field: str, problem: str) -> None:
    (fault,) = faults_of(valid + f"uncertainty: {block}\n")
    assert fault.field == f"uncertainty.{field}"
    assert problem in fault.problem
    assert fault.line == valid.count("\n") + 1


def test_it_needs_one_rope_to_choose(valid: str, faults_of: FaultsOf) -> None:
    block = "uncertainty: {payload: {uniform: 2 %}}\n"
    (fault,) = faults_of(valid[: valid.index("selection:")] + block)
    assert (fault.field, fault.problem) == ("uncertainty", "there is no selection")
    groups = valid + "  groups: {a: [1], b: [2, 3]}\n" + block
    (fault,) = faults_of(groups)
    assert fault.field == "selection.groups"
