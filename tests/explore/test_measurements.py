"""Measured data beside the model."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designer.errors import InputError
from designer.explore.measurements import diagnosis_answer, residuals
from designer.explore.question import Question
from designer.explore.session import Session
from designer.model.cable import Cable
from designer.model.robot import Poses
from designer.plugins import Plugins
from designer.statics.inverse import solve_sagging

OFFSET_M = (0.02, -0.03, 0.05)
NOISE_M, NOISE_N = 1e-3, 2.0


@pytest.fixture
def measured(tmp_path: Path, no_plugins: Plugins, yard: Session) -> Session:
    """The yard crane, winches homed wrong, measured in sixty poses."""
    question = yard.question()
    assert question is not None
    rng = np.random.default_rng(11)
    region = question.study.workspace.region  # type: ignore[union-attr]
    position = region.inside_m(rng, 60)
    statics = solve_sagging(question.robot, Poses.at(position), Cable(0.006, 0.142, 1.6e6, 5e3))
    length = statics.length_m + OFFSET_M + rng.normal(0.0, NOISE_M, (60, 3))
    tension = statics.exit_tension_N + rng.normal(0.0, NOISE_N, (60, 3))
    time = 30.0 * np.arange(60)
    names = ["time_s", "x_m", "y_m", "z_m"]
    names += [f"{kind}" for kind in ("length_1_m", "length_2_m", "length_3_m")]
    names += ["tension_1_N", "tension_2_N", "tension_3_N", "humidity"]
    table = np.column_stack([time, position, length, tension, rng.uniform(size=60)])
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=",".join(names), comments="")
    file = tmp_path / "built.yaml"
    file.write_text(
        yard.text + "measurements:\n  file: log.csv\n"
        "  cable: {linear_mass: 0.142 kg/m, axial_stiffness: 1.6 MN}\n"
        f"  noise: {{length: {NOISE_M} m, tension: {NOISE_N} N}}   # by the maker\n",
        encoding="utf-8",
    )
    return Session.open(file, no_plugins)


def question_of(session: Session) -> Question:
    question = session.question()
    assert question is not None
    return question


def test_what_is_left_of_each_reading(measured: Session) -> None:
    found = residuals(question_of(measured))
    assert found.residual.shape == (60, 6)
    assert found.channels[:4] == ("length 1", "length 2", "length 3", "tension 1")
    assert found.units == ("m", "m", "m", "N", "N", "N")
    assert np.allclose(found.residual.mean(axis=0)[:3], OFFSET_M, atol=5 * NOISE_M / 60**0.5)
    assert np.std(found.residual[:, 3:]) == pytest.approx(NOISE_N, rel=0.2)
    assert found.size().min() > 5.0
    assert found.noise.tolist() == [NOISE_M] * 3 + [NOISE_N] * 3
    for values in found.covariates.values():
        assert values.shape == (60,)
    assert {"row", "time [s]", "z [m]", "length 2 [m]", "humidity"} <= set(found.covariates)
    assert np.array_equal(found.residual, found.without)


def test_declared_effects_are_in_the_model(measured: Session) -> None:
    offsets = ", ".join(f"offset_{k}_m: {value}" for k, value in enumerate(OFFSET_M, start=1))
    measured.set_text(f"{measured.text}effects: {{length_offset: {{{offsets}}}}}\n")
    assert measured.faults == ()
    found = residuals(question_of(measured))
    assert np.abs(found.residual[:, :3]).max() < 5 * NOISE_M
    assert np.allclose(found.without[:, :3].mean(axis=0), OFFSET_M, atol=1e-3)
    assert measured.edit("effects.length_offset.offset_1_m", "0") == ()


def test_rows_stand_in_the_frame_of_the_robot(measured: Session) -> None:
    logged_m = residuals(question_of(measured)).position_m
    measured.set_text(f"{measured.text}effects: {{pose_shift: {{z_m: 0.25}}}}\n")
    assert measured.faults == ()
    shift_m = logged_m - residuals(question_of(measured)).position_m
    assert np.allclose(shift_m, [0.0, 0.0, 0.25])


def test_without_data_there_is_nothing_to_compare(yard: Session) -> None:
    with pytest.raises(InputError, match="measurements: is missing"):
        residuals(question_of(yard))


def test_data_that_are_gone_are_told(measured: Session) -> None:
    (measured.path.parent / "log.csv").unlink()
    with pytest.raises(InputError, match=r"log\.csv"):
        residuals(question_of(measured))


@pytest.mark.slow
def test_the_diagnosis_finds_what_is_wrong_and_writes_it_into_the_text(measured: Session) -> None:
    measured.edit("robot.platform.mass", "180.0 kg")  # not what the file says
    told: list[str] = []
    found = diagnosis_answer(question_of(measured), told.append)
    assert told
    (effect,) = found.effects
    assert effect.startswith("length_offset: ")
    (length,) = [error for error in found.errors if error.startswith("error of length: ")]
    before, after = (float(figure) for figure in re.findall(r"([\d.]+)\xa0mm", length)[:2])
    assert after < 0.2 * before
    assert "180.0 kg" in found.diagnosed_text
    assert "# by the maker" in found.diagnosed_text
    assert measured.set_text(found.diagnosed_text) == ()
    assert np.abs(residuals(question_of(measured)).residual[:, :3]).max() < 6 * NOISE_M
    measured.undo()
    assert "length_offset" not in measured.text


@pytest.mark.slow
def test_the_diagnosis_in_a_process(measured: Session, asker: Any) -> None:
    own = diagnosis_answer(question_of(measured), lambda _: None)
    end = asker.end_of(asker.ask("diagnose", measured.question()))
    assert end.status == "done"
    assert end.answer.effects == own.effects
    assert end.answer.diagnosed_text == own.diagnosed_text
    told = [one for one in asker.seen if not one.is_end]
    assert told
    assert all(one.text and one.total == 0 for one in told)
