"""Hangprinter's log as the guide tells it, where the public logs are."""

from __future__ import annotations

from pathlib import Path

import pytest
from guide import diagnosed, study_in_guide, table
from shared_data import needs_shared, shared

pytestmark = pytest.mark.slow

HANGPRINTER = ("measured", "hangprinter-hp4-2022-04-series2", "poses_motor_angles_forces.csv")


@needs_shared(*HANGPRINTER)
def test_hangprinter_names_the_drums_and_nothing_is_left(tmp_path: Path) -> None:
    """As the guide tells it; that drums grow is what the machine's maker expects, too."""
    rows = table(shared(*HANGPRINTER))
    found = diagnosed(tmp_path, study_in_guide("Hangprinter HP4"), "hp4.csv", rows)
    assert found.measured.n_rows == 41
    assert "rows 42 to 44 without a pose left out" in found.measured.notes
    assert "left out, since they hold text: xyz_source" in found.measured.notes
    assert {setting.effect.id for setting in found.given} == {"anchor_offset", "length_offset"}
    assert [finding.effect.id for finding in found.findings] == ["drum_layering"]
    (drums,) = found.findings
    growth = drums.parameters["radius_gain_per_m"]
    assert growth.value == pytest.approx(0.0145, abs=1e-3)
    assert growth.value > 3.0 * growth.std
    assert drums.heldout_gain > 0.9
    assert drums.rivals == ()
    assert drums.warnings == ()  # plausible
    assert found.steps[0].trials[0].earns_its_place
    before, after = found.stages[0].length_m, found.final.length_m
    assert before is not None
    assert after is not None
    assert after.heldout.high < 0.5 * before.heldout.low
    assert found.structure_before.is_present
    assert not found.is_unexplained
    assert found.structure_after.carriers[0].chance > 0.2
    assert {(outlier.row, outlier.channel) for outlier in found.outliers} == {
        (18, "length 3"),
        (18, "length 4"),
    }
    assert found.foretold_before is not None
    assert found.foretold_after is not None
    assert found.foretold_after.position_m.high < 0.3 * found.foretold_before.position_m.low
