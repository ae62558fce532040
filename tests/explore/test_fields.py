"""Every number of a study is a field with a name, a meaning and a sensible slider."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designer.explore.fields import Field, count_slider, keys_of
from designer.explore.session import Session
from designer.plugins import Plugins
from designer.resources import example_names
from designer.units import read_quantity


@pytest.mark.parametrize("name", example_names())
def test_fields_of_the_shipped_studies(name: str, example: Any) -> None:
    session: Session = example(name)
    fields = session.fields()
    assert len({one.path for one in fields}) == len(fields) > 30
    assert len({(one.group, one.label) for one in fields}) == len(fields)
    for one in fields:
        assert one.definition
        assert one.label
        assert one.group
        if one.low is not None and one.high is not None and one.value_SI is not None:
            assert one.low <= one.value_SI <= one.high
        if one.kind == "choice":
            assert one.text in one.choices
        elif one.value_SI is not None:
            assert read_quantity(_plain(one), one.dimension) == pytest.approx(one.value_SI)
    assert session.differing == frozenset()
    paths = {one.path for one in fields}
    assert {"robot.platform.mass", "pose.position[0]", "workspace.samples"} <= paths


def _plain(one: Field) -> float | str:
    """A bare number as a number, as YAML has it."""
    try:
        return float(one.text)
    except ValueError:
        return one.text


@pytest.mark.parametrize(
    ("text", "value_SI", "becomes"),
    [
        ("180 kg", 212.3456, "212.3 kg"),
        ("0.18 t", 212.3456, "0.2123 t"),
        ("180", 212.3456, "212.3"),
        ("396.8 lb", 200.0, "440.9 lb"),
    ],
)
def test_a_slider_keeps_the_unit(text: str, value_SI: float, becomes: str, yard: Session) -> None:
    yard.edit("robot.platform.mass", text)
    assert _of(yard, "robot.platform.mass").text_of(value_SI) == becomes


def test_a_slider_goes_from_a_quarter_of_a_modulus_to_four_times(yard: Session) -> None:
    modulus = _of(yard, "cable.youngs_modulus")
    assert (modulus.low, modulus.high) == pytest.approx((62.7e9 / 4.0, 4.0 * 62.7e9))


def test_a_temperature_has_its_own_zero(yard: Session) -> None:
    yard.edit("surroundings.temperature", "50 degF")
    one = _of(yard, "surroundings.temperature")
    assert one.value_SI == pytest.approx(10.0)
    assert one.text_of(20.0) == "68 degF"


def test_a_slider_stays_where_it_is_while_it_moves(yard: Session) -> None:
    before = _of(yard, "robot.platform.mass")
    yard.edit("robot.platform.mass", "300 kg")
    after = _of(yard, "robot.platform.mass")
    assert (after.low, after.high) == (before.low, before.high)
    yard.edit("robot.platform.mass", "90 t")  # beyond its end
    beyond = _of(yard, "robot.platform.mass")
    assert beyond.high is not None
    assert beyond.high > 90e3


def test_a_point_mass_has_no_turns_and_a_body_has(yard: Session, example: Any) -> None:
    paths = {one.path for one in yard.fields()}
    assert not any("rotation" in path or "moment" in path for path in paths)
    paths = {one.path for one in example("ipanema").fields()}
    assert {"pose.rotation_vector[2]", "robot.platform.wrench.moment[0]"} <= paths
    assert "robot.tension_min" in paths


def test_declared_effects_are_fields(tmp_path: Path, no_plugins: Plugins, yard: Session) -> None:
    study = tmp_path / "study.yaml"
    effects = (
        "effects:\n  pulley_radius: {radius_m: 90 mm}\n  anchor_offset: [{cable: 2, z_m: 1}]\n"
    )
    study.write_text(yard.text + effects, encoding="utf-8")
    session = Session.open(study, no_plugins)
    assert session.faults == ()
    radius = _of(session, "effects.pulley_radius.radius_m")
    assert (radius.label, radius.value_SI) == ("Pulley radius, radius", pytest.approx(0.09))
    offset = _of(session, "effects.anchor_offset[0].z_m")
    assert offset.label == "Anchor offset of cable 2, z"
    assert "cable 2 is not where the drawing has it" in offset.definition
    assert session.edit("effects.anchor_offset[0].z_m", "20 mm") == ()
    assert session.edit("effects.anchor_offset[0].x_m", "5 mm") == ()
    assert "[{cable: 2, z_m: 20 mm, x_m: 5 mm}]" in session.text
    assert session.study is not None
    assert dict(session.study.effects[1].parameters) == {"x_m": 0.005, "y_m": 0.0, "z_m": 0.02}


def test_paths_and_their_steps() -> None:
    assert keys_of("robot.anchors[0][12]") == ("robot", "anchors", 0, 12)


def test_angles_go_to_either_side(example: Any) -> None:
    one = _of(example("ipanema"), "pose.rotation_vector[0]")
    assert np.allclose([one.low, one.high], [-math.pi / 4, math.pi / 4])


def _of(session: Session, path: str) -> Field:
    return next(one for one in session.fields() if one.path == path)


def test_the_largest_sag_is_a_field(yard: Session) -> None:
    assert _of(yard, "workspace.sag").value_SI == pytest.approx(0.2)
    assert yard.edit("workspace.sag", "10 %") == ()
    assert yard.study is not None
    assert yard.study.workspace is not None
    assert yard.study.workspace.sag_max == pytest.approx(0.1)
    (fault,) = yard.edit("workspace.sag", "none")
    assert "'none' is not" in fault.problem
    assert yard.differing == {"workspace.sag"}


@pytest.mark.parametrize(
    ("value", "low", "high", "ends"),
    [(7, 1, 30, (1, 12)), (20, 1, 30, (1, 20)), (50, 1, 10**6, (50, 200_000)),
     (10**6, 1, 10**6, (100, 10**6))],
)  # fmt: skip
def test_a_slider_of_a_count_reaches_its_value(value: int, low: int, high: int, ends) -> None:
    slider = count_slider(value, low, high, "workspace.samples")
    assert (slider["low"], slider["high"]) == ends
    assert slider["is_log"] == (high > 1000)


SETS = """
name: Crane
robot:
  anchors: [[0, 0, 12], [14, 0, 12], [6, 11, 12]]
  platform: {mass: 60 kg}
cable: {grade: unirope-6x36-iwrc-1960}
workspace: {region: {points: [[5, 4, 5]]}}
load_cases:
  - {name: a, wrench_set: {force: [[-60, 90], [0, 0], [-900, 250]]}}
  - {name: b, wrench_set: [{force: [50, 0, -400]}, {force: [-80, 20, 0]}]}
  - {name: c, region: {points: [[5, 4, 5], [6, 4, 5]]}}
"""


def test_fields_of_lists_in_load_cases_have_names_of_their_own(
    tmp_path: Path, no_plugins: Plugins
) -> None:
    path = tmp_path / "sets.yaml"
    path.write_text(SETS, encoding="utf-8")
    session = Session.open(path, no_plugins)
    label_of = {one.path: one.label for one in session.fields()}
    title = "Force of the set in load case"
    assert label_of["load_cases[0].wrench_set.force[2][1]"] == f"{title} 1, z to"
    assert label_of["load_cases[1].wrench_set[1].force[0]"] == f"{title} 2.2, x"
    assert label_of["load_cases[2].region.points[1][0]"].endswith(" 3.2, x")
    assert len(set(label_of.values())) == len(label_of)
    assert session.edit("load_cases[0].wrench_set.force[2][0]", "-1 kN") == ()
    (fault,) = session.edit("load_cases[0].wrench_set.force[2][0]", "1 kN")
    assert "above the upper 250 N" in fault.problem
