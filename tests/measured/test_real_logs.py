"""The walk-throughs of `designer/examples/measured-logs.md`, where the public logs are."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest
from shared_data import needs_shared, shared

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis, Verdict
from designer.io.config import read_study
from designer.measured.read import read_measured

pytestmark = pytest.mark.slow

SCAMPI = ("measured", "scampi-cable-robot", "scampi_rows_0000_0499.csv")
HANGPRINTER = ("measured", "hangprinter-hp4-2022-04-series2", "poses_motor_angles_forces.csv")
GUIDE = Path(__file__).parents[2] / "designer" / "examples" / "measured-logs.md"


def study_in_guide(name: str) -> str:
    """Return the study that the guide prints under this name."""
    blocks = re.findall(r"```yaml\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    return next(block for block in blocks if block.startswith(f"name: {name}"))


def diagnosed(folder: Path, study: str, file: str, rows: list[list[str]]) -> Diagnosis:
    """Write study and table, and diagnose them."""
    with (folder / file).open("w", newline="", encoding="utf-8") as table:
        csv.writer(table).writerows(rows)
    config = folder / "study.yaml"
    config.write_text(study, encoding="utf-8")
    read = read_study(config)
    assert read.measurements is not None
    return diagnose(case_of(read, read.measurements, read_measured(read)))


def table(path: Path) -> list[list[str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


@needs_shared(*SCAMPI)
def test_scampi_names_the_clock_and_halves_the_error(tmp_path: Path) -> None:
    """The first half of the rows, which takes a third of the time."""
    rows = table(shared(*SCAMPI))
    kept = [k for k, name in enumerate(rows[0]) if not name.startswith("pulley")]
    rows = [[row[k] for k in kept] for row in rows[:251]]
    found = diagnosed(tmp_path, study_in_guide("SCAMPI"), "scampi.csv", rows)
    ids = [finding.effect.id for finding in found.findings]
    assert ids[0] == "clock_offset"
    assert set(ids) <= {"clock_offset", "anchor_offset"}
    offset = found.findings[0].parameters["offset_s"]
    assert offset.value == pytest.approx(-0.0345, abs=1e-3)
    assert offset.std < 3e-3  # clustered by blocks of a motion
    assert found.findings[0].rivals == ()
    before, after = found.stages[0].length_m, found.final.length_m
    assert before is not None
    assert after is not None
    assert after.heldout.value < 0.5 * before.heldout.value
    assert after.heldout.high < before.heldout.low
    # Half the rows do not show every moved exit point clearly; what is left is said.
    assert found.verdict in (Verdict.FOUND, Verdict.IN_PART)
    tried = {trial.effect.id for step in found.steps for trial in step.trials}
    assert {"pulley_radius", "drum_scale", "drum_layering", "creep", "elastic_modulus"} <= tried
    skipped = dict(found.skipped)
    assert "thermal_expansion" in skipped
    assert "tension_bias" in skipped


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
