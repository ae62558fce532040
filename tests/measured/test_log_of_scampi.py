"""SCAMPI's log as the guide tells it, where the public logs are."""

from __future__ import annotations

from pathlib import Path

import pytest
from guide import diagnosed, study_in_guide, table
from shared_data import needs_shared, shared

from designer.diagnosis.result import DiagnosisVerdict

pytestmark = pytest.mark.slow

SCAMPI = ("measured", "scampi-cable-robot", "scampi_rows_0000_0499.csv")


@needs_shared(*SCAMPI)
def test_scampi_names_the_clock_and_the_frame(tmp_path: Path) -> None:
    """The first half of the rows, which has the same causes as the whole."""
    rows = table(shared(*SCAMPI))
    kept = [k for k, name in enumerate(rows[0]) if not name.startswith("pulley")]
    rows = [[row[k] for k in kept] for row in rows[:251]]
    found = diagnosed(tmp_path, study_in_guide("SCAMPI"), "scampi.csv", rows)
    ids = [finding.effect.id for finding in found.findings]
    assert ids[:2] == ["clock_offset", "pose_frame"]
    assert ids[2:] == ["tool_point"]  # as soft cables would do as well
    assert "stiffening" in found.findings[2].rivals
    lower = found.findings[1].parameters["z_m"]
    assert lower.value == pytest.approx(-0.042, abs=0.01)
    offset = found.findings[0].parameters["offset_s"]
    assert offset.value == pytest.approx(-0.0345, abs=1e-3)
    assert offset.std < 3e-3  # clustered by blocks of a motion
    assert found.findings[0].rivals == ()
    before, after = found.stages[0].length_m, found.final.length_m
    assert before is not None
    assert after is not None
    assert after.heldout.value < 0.2 * before.heldout.value
    assert after.heldout.high < before.heldout.low
    assert found.verdict in (DiagnosisVerdict.FOUND, DiagnosisVerdict.IN_PART)
    keys = [t.effect.key for step in found.steps for t in step.trials]
    keys += [key for step in found.steps for key in step.passed_over]
    tried = {key.split(" of ")[0] for key in keys}
    assert {"pulley_radius", "drum_scale", "drum_layering", "creep", "elastic_modulus"} <= tried
    skipped = dict(found.skipped)
    assert "thermal_expansion" in skipped
    assert "tension_bias" in skipped
