"""One machine measured on several days, by physics that shares nothing with the model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation
from twins.dataset import DataSet, make
from twins.robots import YARD3

from designer.diagnosis.case import with_those_of_sessions
from designer.diagnosis.diagnose import diagnose_study
from designer.diagnosis.report import verdict
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.study import diagnosed_config
from designer.effects.pulleys import PULLEY_RADIUS
from designer.io.config import read_study
from designer.measured.read import read_measured

OWN = ["pose_frame", "length_offset"]
RADIUS_M = 0.12


def frame_and_homing(seed: int) -> dict[str, dict[str, float]]:
    """Draw where the camera of a day stood, and how the winches were homed."""
    rng = np.random.default_rng(seed)
    shift = dict(zip(("x_m", "y_m", "z_m"), rng.uniform(-0.3, 0.3, 3), strict=True))
    turn = dict(zip(("rx_rad", "ry_rad", "rz_rad"), rng.uniform(-0.02, 0.02, 3), strict=True))
    homing = {f"offset_{k}_m": float(rng.uniform(-0.2, 0.2)) for k in (1, 2, 3)}
    return {"pose_frame": {**shift, **turn, "scale": 1.0}, "length_offset": homing}


def in_our_convention(frame: dict[str, float]) -> dict[str, float]:
    """Return a frame that turns about its zero as one that turns about the exit points' middle."""
    turn = Rotation.from_rotvec([frame[f"r{axis}_rad"] for axis in "xyz"])
    middle = np.mean(YARD3.exit_m, axis=0)
    shift = np.array([frame[f"{axis}_m"] for axis in "xyz"])
    shift += frame["scale"] * turn.apply(middle) - middle
    return {**frame, **dict(zip(("x_m", "y_m", "z_m"), shift.tolist(), strict=True))}


def write(folder: Path, days: list[DataSet], unknown: list[str]) -> Path:
    """Write a study of several days; return the path of its config."""
    sessions = []
    for number, day in enumerate(days, start=1):
        day.write(folder / str(number))
        sessions.append({"file": f"{number}/measured.csv", "unknown": unknown})
    config = days[0].config()
    del config["measurements"]["file"]
    config["measurements"] |= {"sessions": sessions}
    path = folder / "config.yaml"
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    return path


def diagnosed(path: Path) -> Diagnosis:
    study = read_study(path)
    return diagnose_study(study, read_measured(study))


def test_an_effect_may_come_between_sessions(tmp_path: Path) -> None:
    study = read_study(write(tmp_path, [make(YARD3, rows=4)] * 2, []))
    assert study.measurements is not None
    changed = replace(PULLEY_RADIUS, id="changed_pulleys", between_sessions=True)
    tried = with_those_of_sessions([PULLEY_RADIUS, changed], study.measurements)
    assert [effect.key for effect in tried] == [
        "pulley_radius",
        "changed_pulleys",
        "changed_pulleys of session 1",
        "changed_pulleys of session 2",
    ]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [71, 72])
def test_shared_effect_is_found_among_days_of_their_own_frame_and_homing(
    tmp_path: Path, seed: int
) -> None:
    shared = {"pulley_radius": {"radius_m": RADIUS_M}}
    own = [frame_and_homing(10 * seed + k) for k in range(2 + seed % 2)]
    days = [
        make(YARD3, {**shared, **each}, rows=48, seed=10 * seed + k) for k, each in enumerate(own)
    ]
    diagnosis = diagnosed(write(tmp_path, days, OWN))
    (finding,) = diagnosis.findings
    assert finding.effect.key == "pulley_radius"
    radius = finding.parameters["radius_m"]
    assert radius.value == pytest.approx(RADIUS_M, abs=3 * radius.std)
    offs = [
        (setting.values[name] - value) / diagnosis.stds_of(setting)[name]
        for number, day in enumerate(own, start=1)
        for effect_id, values in {
            **day,
            "pose_frame": in_our_convention(day["pose_frame"]),
        }.items()
        for name, value in values.items()
        for setting in diagnosis.given
        if setting.effect.key == f"{effect_id} of session {number}"
    ]
    assert len(offs) == 10 * len(days)
    assert np.mean(np.abs(offs) < 2.0) > 0.8
    assert np.abs(offs).max() < 4.0
    assert [each.session for each in diagnosis.sessions] == [*range(1, len(days) + 1)]
    assert all(each.over(diagnosis.noise) < 1.5 for each in diagnosis.sessions)
    assert not diagnosis.strange_sessions
    heldout = np.array(diagnosis.heldout)
    assert all(heldout[diagnosis.measured.session == k].any() for k in (1, 2))


@pytest.mark.slow
def test_diagnosed_study_of_sessions_fits_at_once(tmp_path: Path) -> None:
    own = [frame_and_homing(k) for k in (901, 902)]
    days = [make(YARD3, each, rows=48, seed=k) for k, each in enumerate(own, start=903)]
    path = write(tmp_path, days, OWN)
    text = diagnosed_config(diagnosed(path), tmp_path)
    (tmp_path / "again.yaml").write_text(text, encoding="utf-8")
    study = read_study(tmp_path / "again.yaml")
    declared = [{effect.id for effect in each} for each in study.session_effects]
    assert declared == [set(OWN), set(OWN)]
    assert study.effects == ()


@pytest.mark.slow
def test_exit_point_moved_before_one_session_is_named_for_it(tmp_path: Path) -> None:
    moved = {"anchor_offset": {"cable": 2, "x_m": 0.09, "y_m": -0.12, "z_m": 0.06}}
    days = [
        make(YARD3, {}, rows=48, seed=811),
        make(YARD3, moved, rows=48, seed=812),
        make(YARD3, {}, rows=48, seed=813),
    ]
    diagnosis = diagnosed(write(tmp_path, days, []))
    assert [f.effect.key for f in diagnosis.findings] == ["anchor_offset of cable 2 of session 2"]


@pytest.mark.slow
def test_session_of_another_machine_is_told(tmp_path: Path) -> None:
    factors = {"elastic_modulus": {"scale": 0.5}, "linear_mass": {"scale": 1.6}}
    days = [make(YARD3, {}, rows=48, seed=821), make(YARD3, factors, rows=48, seed=822)]
    diagnosis = diagnosed(write(tmp_path, days, []))
    assert not diagnosis.is_positive
    assert diagnosis.strange_sessions == (2,)
    assert (
        "Session 2 is not explained by the machine that the others fit" in verdict(diagnosis).text
    )
