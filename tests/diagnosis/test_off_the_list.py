"""Machines with effects that were in no list: named, with their rivals, or told as unexplained."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from benchmarks.off_the_list import ROBOTS, data_set, diagnosed
from report_parts import diagnosis_page
from twins.dataset import make
from twins.robots import FAST3, YARD3

from designer.diagnosis.command import _print_diagnosis
from designer.diagnosis.diagnose import _with_one_force
from designer.diagnosis.hold import Reason, RejectedEffect, _unsteady
from designer.diagnosis.result import Diagnosis, DiagnosisVerdict, Finding
from designer.diagnosis.structure import Event, is_one_smooth_error
from designer.effects.registry import SHIPPED


@cache
def found_in(robot: str, kind: str, seed: int) -> Diagnosis:
    return diagnosed(data_set(ROBOTS[robot], kind, seed))


def told(found: Diagnosis) -> dict[str, tuple[str, ...]]:
    return {finding.effect.key: finding.rivals for finding in found.findings}


def first_line(found: Diagnosis, capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    _print_diagnosis(found, Path("folder"), ["diagnosis.json"])
    text = capsys.readouterr().out
    return text.splitlines()[0], text


@pytest.mark.slow
@pytest.mark.parametrize(("robot", "seed"), [("yard3", 0), ("plaza4", 28)])
def test_a_hose_is_a_force_or_the_rival_of_a_tilt_and_a_mass(robot, seed, capsys) -> None:
    found = found_in(robot, "hose", seed)
    names = told(found)
    assert set(names) <= {"platform_force", "base_tilt", "platform_mass"}
    assert "platform_force" in {*names, *(rival for rivals in names.values() for rival in rivals)}
    line, _ = first_line(found, capsys)
    assert line.startswith("found: length error ")
    assert line.endswith(" N on unseen rows")


@pytest.mark.slow
def test_a_hose_beside_the_origin_is_a_moment_and_no_moved_centre_of_mass() -> None:
    names = told(found_in("hall6", "hose at the rim", 2))
    assert "platform_moment" in names
    assert "centre_of_mass_offset" not in names
    assert all("platform_force" in rivals for rivals in names.values())


@pytest.mark.slow
def test_a_wind_whose_gusts_grow_is_no_tilt() -> None:
    found = found_in("plaza4", "gusty", 2)
    assert list(told(found)) == ["platform_force"]
    assert ("base_tilt", Reason.UNSTEADY) in [(g.effect, g.reason) for g in found.withdrawn]
    assert found.verdict is DiagnosisVerdict.IN_PART
    assert found.next_checks == ["wind that nobody read, sway, how well poses are measured"]


def test_a_tilt_gives_way_to_a_force_where_rows_are_unsteady() -> None:
    tilt, force = (SimpleNamespace(key=key, id=key) for key in ("base_tilt", "platform_force"))
    for place, is_withdrawn in (("scatter", True), ("time", False)):
        events = (Event("…", 0.5, 1e-6, place),)
        outcome: Any = SimpleNamespace(
            found=(tilt,),
            structure=SimpleNamespace(events=events),
            searcher=SimpleNamespace(candidates=[tilt, force]),
            withdrawn=(),
        )
        withdrawn = _unsteady(outcome)
        assert (withdrawn is not None) == is_withdrawn
        if withdrawn is not None:
            assert withdrawn.instead == (force,)
        outcome.withdrawn = (RejectedEffect("platform_force", reason=Reason.UNSEEN),)
        assert _unsteady(outcome) is None  # else it would be told as withdrawn and as found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "coefficient", "rivals"),
    [
        ("winch_expansion", 2.3e-5, ()),  # no rope of steel shrinks with heat
        ("thermal_expansion", 1.2e-5, ("winch_expansion",)),
    ],
)
def test_hot_winches_are_told_from_hot_ropes_as_far_as_physics_does(
    effect, coefficient, rivals
) -> None:
    found = diagnosed(make(FAST3, {effect: {"coefficient_per_K": coefficient}}, seed=5))
    assert told(found) == {effect: rivals}
    value = found.findings[0].parameters["coefficient_per_K"]
    assert abs(value.value - coefficient) < 4.0 * value.std


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["yard3", "hall6"])
def test_a_tracker_that_errs_with_the_distance_is_one_cause(robot) -> None:
    assert told(found_in(robot, "refraction", 20)) == {"pose_distortion": ()}


@pytest.mark.slow
def test_a_marker_beside_the_origin_is_named_or_a_rival() -> None:
    assert list(told(found_in("hall6", "beside the point", 26))) == ["tool_point"]
    # A point mass does not turn: a marker beside it is a shift of all poses.
    assert told(found_in("yard3", "beside the point", 53)) == {"pose_shift": ("tool_point",)}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["wrong poses", "stale"])
def test_wrong_poses_are_named_and_are_no_agreement(kind, capsys) -> None:
    blank = make(YARD3, seed=24, rows=72)
    dataset = data_set(YARD3, kind, 24)
    off = np.linalg.norm(dataset.scene.position_m - blank.scene.position_m, axis=1) > 0.1
    found = found_in("yard3", kind, 24)
    assert found.wrong_poses == (1 + np.flatnonzero(off)).tolist()
    assert found.verdict is DiagnosisVerdict.UNEXPLAINED
    assert not found.is_positive
    line, text = first_line(found, capsys)
    assert line.startswith("unexplained: length error ")
    assert "check next" in text
    assert f"{sum(o.channel.startswith('length') for o in found.outliers)} of 216 lengths" in text
    answer = found.to_dict()
    assert answer["rows"]["wrong_poses"] == found.wrong_poses
    assert answer["error"]["length_m"]["left_out"] > 10
    assert "rows with wrong poses" in diagnosis_page(found).verdict.text


@pytest.mark.slow
def test_a_few_wrong_poses_are_named_and_leave_the_verdict() -> None:
    blank = make(YARD3, seed=3, rows=120)
    position = blank.scene.position_m.copy()
    position[[17, 71]] += [1.0, -0.7, 0.4]
    found = diagnosed(replace(blank, scene=replace(blank.scene, position_m=position)))
    assert found.verdict is DiagnosisVerdict.NOTHING
    assert found.wrong_poses == [18, 72]
    assert found.left_out.endswith("all cables of rows 18, 72, whose poses are wrong")
    assert found.next_checks == []


@pytest.mark.slow
def test_plugs_exchanged_from_the_middle_on_are_told_alone(capsys) -> None:
    found = found_in("yard3", "exchanged", 0)
    (event,) = found.structure_after.events
    assert "exchanged with each other from row 37 on" in event.text
    assert "plugs" in first_line(found, capsys)[1]


@pytest.mark.slow
def test_zeros_of_all_cells_that_are_alike_have_a_force_as_rival() -> None:
    (finding,) = found_in("plaza4", "spring", 1).findings
    assert finding.effect.id == "tension_bias"
    assert "platform_force" in finding.rivals
    assert "all cells are off alike" in finding.warnings[0]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [15, 433])
def test_three_effects_bent_to_one_force_have_it_as_rival(seed, capsys) -> None:
    found = found_in("plaza4", "tether", seed)
    assert len(found.findings) == 3
    assert all("platform_force" in rivals for rivals in told(found).values())
    assert "one cause that varies smoothly with position" in first_line(found, capsys)[1]


@pytest.mark.parametrize(
    ("third", "is_one"), [("linear_mass", True), ("drum_scale", False), ("anchor_offset", False)]
)
def test_a_force_and_heavier_ropes_may_be_a_force_that_changes_with_the_place(
    third, is_one
) -> None:
    findings = tuple(
        Finding(SHIPPED.by_id[key], {}, rivals, 0.5, 0.1, ())
        for key, rivals in (
            ("base_tilt", ("platform_force",)),
            ("tension_bias", ("platform_force",)),
            (third, ()),
        )
    )
    assert _with_one_force(findings)[2].rivals == (("platform_force",) if is_one else ())
    assert _with_one_force(findings[1:])[1].rivals == ()  # two are two


def test_one_smooth_error_is_told_from_one_that_goes_with_nothing() -> None:
    rng = np.random.default_rng(4)
    position = rng.uniform(-5.0, 5.0, (80, 3))
    heldout = np.arange(80) % 4 == 3
    after = rng.normal(size=(80, 6))
    after[:, 3:] = np.nan
    bend = 0.4 * np.sum(position**2, axis=1, keepdims=True) - 3.0 * position[:, :1]
    assert is_one_smooth_error(after + bend, after, position, heldout)
    rough = 5.0 * np.sin(3.0 * position[:, :1])
    assert not is_one_smooth_error(after + rough, after, position, heldout)
