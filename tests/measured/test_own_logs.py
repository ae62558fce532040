"""Logs of our own making, which go the ways of the public ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from twins.logs import (
    CLOCK_OFFSET_S,
    HOMING_M,
    write_hanging,
    write_printer,
)

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.io.config import read_study
from designer.measured.read import read_measured


def diagnosed(config: Path, candidates: set[str]) -> Diagnosis:
    """Diagnose a log with some candidates, which saves most of the time."""
    study = read_study(config)
    assert study.measurements is not None
    case = case_of(study, study.measurements, read_measured(study))
    tried = tuple(effect for effect in case.candidates if effect.id in candidates)
    assert {effect.id for effect in tried} == candidates
    return diagnose(replace(case, candidates=tried))


@pytest.mark.slow
def test_a_swaying_platform_on_four_cables_names_the_clock(tmp_path: Path) -> None:
    candidates = {"clock_offset", "pulley_radius", "drum_scale", "base_tilt"}
    found = diagnosed(write_hanging(tmp_path), candidates)
    assert [finding.effect.id for finding in found.findings] == ["clock_offset"]
    offset = found.findings[0].parameters["offset_s"]
    assert abs(offset.value - CLOCK_OFFSET_S) < 4.0 * offset.std < 0.01
    assert found.findings[0].rivals == ()
    assert not found.is_unexplained
    (homing,) = found.given
    assert list(homing.values.values()) == pytest.approx(HOMING_M, abs=2e-3)
    before, after = found.stages[0].length_m, found.final.length_m
    assert before is not None
    assert after is not None
    assert after.heldout.high < before.heldout.low
    assert after.heldout.value < 1.3e-3
    assert "temperature" in dict(found.skipped)["thermal_expansion"]


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1.03, 1.0])
def test_motor_angles_of_four_lines_tell_whether_drums_are_true(
    scale: float, tmp_path: Path
) -> None:
    candidates = {"drum_scale", "elastic_modulus"}
    found = diagnosed(write_printer(tmp_path, drum_scale=scale), candidates)
    assert found.measured.n_rows == 24
    assert "rows 25 to 26 without a pose left out" in found.measured.notes
    assert "left out, since they hold text: source" in found.measured.notes
    assert {setting.effect.id for setting in found.given} == {"length_offset"}
    assert not found.is_unexplained
    assert found.final.length_m is not None
    assert found.final.length_m.heldout.value < 1.3e-3
    if scale != 1.0:
        assert [finding.effect.id for finding in found.findings] == ["drum_scale"]
        estimate = found.findings[0].parameters["scale"]
        assert abs(estimate.value - scale) < 4.0 * estimate.std < 0.01
        assert found.findings[0].rivals == ()
        assert found.foretold_before is not None
        assert found.foretold_after is not None
        better = found.foretold_after.position_m.value
        assert better < 0.5 * found.foretold_before.position_m.value
    else:
        assert found.findings == ()
