"""Effects that the config declares."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest

from designer.arrays import frozen_array
from designer.effects.registry import SHIPPED
from designer.errors import Fault
from designer.io.config.effects import read_effects
from designer.model.cable import Cable
from designer.model.robot import Machine, Platform, Robot
from designer.study import DeclaredEffect, Entry, Study

FaultsOf = Callable[[str], list[Fault]]
StudyOf = Callable[[str], Study]
EFFECTS = SHIPPED.by_id


def effects(text: str) -> str:
    return f"effects:\n  {text}\n"


def test_effects_are_SI_and_in_the_order_of_the_file(valid: str, study_of: StudyOf) -> None:
    text = effects(
        "creep: {strain_per_decade: 2e-4, onset_s: 2 min}\n  platform_mass: {offset_kg: -1 t}"
    )
    study = study_of(valid.replace("180 kg", "1800 kg") + text)
    assert study.effects == (
        DeclaredEffect("creep", None, {"strain_per_decade": 2e-4, "onset_s": 120.0}),
        DeclaredEffect("platform_mass", None, {"offset_kg": -1000.0}),
    )


def test_no_effects(valid: str, study_of: StudyOf) -> None:
    assert study_of(valid).effects == ()
    assert study_of(valid + "effects: {}\n").effects == ()
    assert study_of(valid + "effects:\n").effects == ()


def test_what_has_a_neutral_value_may_be_left_out(valid: str, study_of: StudyOf) -> None:
    (offset,) = study_of(valid + effects("length_offset: {offset_2_m: -3 mm}")).effects
    assert offset.parameters == {"offset_1_m": 0.0, "offset_2_m": -0.003, "offset_3_m": 0.0}
    (tilt,) = study_of(valid + effects("base_tilt: {ry_rad: 2 deg}")).effects
    assert tilt.parameters["rx_rad"] == 0.0
    assert tilt.parameters["ry_rad"] == pytest.approx(0.0349066, rel=1e-6)


def test_an_effect_of_one_cable_may_stand_once_or_in_a_list(valid: str, study_of: StudyOf) -> None:
    (once,) = study_of(valid + effects("tension_gain: {cable: 3, gain: 0.98}")).effects
    assert once == DeclaredEffect("tension_gain", 3, {"gain": 0.98})
    listed = effects("anchor_offset: [{cable: 2, z_m: 20 mm}, {cable: 1, x_m: -0.1, y_m: 0.2}]")
    assert study_of(valid + listed).effects == (
        DeclaredEffect("anchor_offset", 2, {"x_m": 0.0, "y_m": 0.0, "z_m": 0.02}),
        DeclaredEffect("anchor_offset", 1, {"x_m": -0.1, "y_m": 0.2, "z_m": 0.0}),
    )


def test_every_effect_can_be_declared() -> None:
    for effect in EFFECTS.values():
        given = {
            one.name: 1e-3 if one.dimension.unit == "1/K" else 1.5
            for one in effect.parameters_for(4)
        }
        if effect.takes_cable:
            given["cable"] = 4
        found = read_effects({effect.id: dict(given)}, 4, EFFECTS)
        assert not found.flaws
        ((place, declared),) = found.effects
        assert place == ("effects", effect.id)
        assert declared.cable == given.pop("cable", None)
        assert declared.parameters == given


def test_entries_show_effects_as_given_and_in_SI(valid: str, study_of: StudyOf) -> None:
    text = effects("pulley_radius: {radius_m: 90 mm}\n  anchor_offset: [{cable: 2, z_m: 2 cm}]")
    assert study_of(valid + text).source.entries[-5:] == (
        Entry("effects.pulley_radius.radius_m", "90 mm", "0.09 m"),
        Entry("effects.anchor_offset[0].cable", "2", "2"),
        Entry("effects.anchor_offset[0].x_m", "default", "0 m"),
        Entry("effects.anchor_offset[0].y_m", "default", "0 m"),
        Entry("effects.anchor_offset[0].z_m", "2 cm", "0.02 m"),
    )


# what the section holds, and the fault: field, problem, expected
MISTAKES = [
    ("creap: {}", "creap", "unknown effect 'creap'", "did you mean 'creep'?"),
    ("pulley: {}", "pulley", "unknown effect", "one of pose_shift, pose_scale"),
    ("Creep: {}", "Creep", "unknown effect", "did you mean 'creep'?"),
    ("pulley_radius: 0.1", "pulley_radius", "0.1 is not a mapping", "a mapping with radius_m"),
    ("pulley_radius:", "pulley_radius", "an empty value is not", "a mapping with radius_m"),
    ("pulley_radius: {}", "pulley_radius", "an empty mapping is not", "with radius_m"),
    ("pulley_radius: [{radius_m: 1}]", "pulley_radius", "a list is not", "with radius_m"),
    ("pulley_radius: {radius: 1}", "pulley_radius.radius", "unknown parameter", "'radius_m'?"),
    ("pulley_radius: {radius_m: 1 kg}", "pulley_radius.radius_m", "unit kilogram", "a length"),
    ("pulley_radius: {radius_m: -1}", "pulley_radius.radius_m", "out of range", "at least 0 m"),
    ("pulley_radius: {radius_m: }", "pulley_radius.radius_m", "an empty value", "a length"),
    ("drum_scale: {scale: 0}", "drum_scale.scale", "is out of range", "more than 0"),
    ("drum_scale: {scale: .nan}", "drum_scale.scale", "not a finite", "a plain number"),
    ("creep: {onset_s: 9}", "creep.strain_per_decade", "is missing", "a plain number"),
    ("wind_drag: {drag_area_m2: 1 m}", "wind_drag.drag_area_m2", "unit meter", "an area"),
    ("length_offset: {offset_4_m: 1}", "length_offset.offset_4_m", "unknown", "offset_3_m"),
    ("tension_gain: {gain: 1}", "tension_gain.cable", "is missing", "1 to 3"),
    ("tension_gain: {gain: 1, cable: 4}", "tension_gain.cable", "4 is out of", "from 1 to 3"),
    ("tension_gain: {gain: 1, cable: 1.5}", "tension_gain.cable", "1.5 is not a whole", "1 to 3"),
    ("tension_gain: {gain: 1, cabel: 1}", "tension_gain.cabel", "unknown", "'cable'?"),
    ("tension_gain: []", "tension_gain", "an empty list", "for each cable"),
    ("tension_gain: [3]", "tension_gain[0]", "3 is not a mapping", "with cable, gain"),
    (
        "anchor_offset: [{cable: 2, x_m: 1}, {cable: 2, y_m: 1}]",
        "anchor_offset[1].cable",
        "cable 2 has this effect already",
        "once",
    ),
    ("platform_mass: {offset_kg: -180}", "platform_mass.offset_kg", "leaves no mass", "-180 kg"),
]


@pytest.mark.parametrize(("text", "field", "problem", "expected"), MISTAKES)
def test_one_mistake_is_one_line(
    valid: str, faults_of: FaultsOf, text: str, field: str, problem: str, expected: str
) -> None:
    (fault,) = faults_of(valid + effects(text))
    assert fault.field == f"effects.{field}"
    assert fault.line == len(valid.splitlines()) + 2
    assert problem in fault.problem
    assert expected in fault.expected


def test_all_mistakes_come_out_together_with_their_lines(valid: str, faults_of: FaultsOf) -> None:
    text = effects(
        "creep:\n    onset_s: 0\n    colour: red\n  drum: {}\n  drum_scale: {scale: 1 m}"
    )
    first = len(valid.splitlines()) + 1
    assert [(fault.line, fault.field) for fault in faults_of(valid + text)] == [
        (first + 1, "effects.creep.strain_per_decade"),
        (first + 2, "effects.creep.onset_s"),
        (first + 3, "effects.creep.colour"),
        (first + 4, "effects.drum"),
        (first + 5, "effects.drum_scale.scale"),
    ]


def test_a_robot_with_faulty_anchors_does_not_hide_the_effects_faults(
    valid: str, faults_of: FaultsOf
) -> None:
    text = valid.replace("[15, 2600 cm, 12]", "east") + effects("tension_bias: {offset_3_kN: 1}")
    assert [fault.field for fault in faults_of(text)] == [
        "robot.anchors[2]",
        "effects.tension_bias.offset_3_kN",
    ]


def test_exit_points_that_are_moved_onto_one_line(valid: str, faults_of: FaultsOf) -> None:
    for moved in ("{cable: 3, y_m: -26}", "[{cable: 2, x_m: -15, y_m: 26}, {cable: 1, x_m: 15}]"):
        (fault,) = faults_of(valid + effects(f"anchor_offset: {moved}"))
        assert fault.field == "effects.anchor_offset"
        assert fault.problem == "moves the anchors onto one line, seen from above"


def test_names_carry_the_unit_that_a_bare_number_has() -> None:
    for effect in EFFECTS.values():
        for parameter in effect.parameters_for(2):
            unit = parameter.dimension.unit.replace("*", "_").replace("^", "")
            ending = f"_{unit}".replace("_1/", "_per_").replace("/", "_per_")
            assert not unit or re.search(f"{ending}$", parameter.name)


def test_what_may_be_left_out_is_neutral_on_any_machine() -> None:
    body = Platform(100.0, frozen_array(np.eye(3)))
    machine = Machine(Robot(frozen_array(9.0 * np.eye(3)), body), Cable(0.01, 0.1, 1e6, 1e4))
    built = {(one.id, one.cable is not None): one for one in SHIPPED.of(machine)}
    assert set(built) == {(effect.id, effect.takes_cable) for effect in EFFECTS.values()}
    for (effect_id, _), effect in built.items():
        known = EFFECTS[effect_id].parameters_for(3)
        assert [one.name for one in known] == [one.name for one in effect.parameters]
        for declared, parameter in zip(known, effect.parameters, strict=True):
            assert not declared.is_optional or declared.neutral == parameter.neutral
