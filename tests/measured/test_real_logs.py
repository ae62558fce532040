"""The walk-throughs of `designer/examples/measured-logs.md`, where the public logs are."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest

from designer.config import read_study
from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.measured.read import read_measured

LOGS = Path(__file__).parents[3] / "shared" / "measured"
SCAMPI = LOGS / "scampi-cable-robot" / "scampi_rows_0000_0499.csv"
HANGPRINTER = LOGS / "hangprinter-hp4-2022-04-series2" / "poses_motor_angles_forces.csv"
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


@pytest.mark.skipif(not SCAMPI.is_file(), reason="the public log is not here")
def test_scampi_names_the_clock_and_halves_the_error(tmp_path: Path) -> None:
    """The first half of the rows, which takes a third of the time."""
    rows = table(SCAMPI)
    kept = [k for k, name in enumerate(rows[0]) if not name.startswith("pulley")]
    rows = [[row[k] for k in kept] for row in rows[:251]]
    found = diagnosed(tmp_path, study_in_guide("SCAMPI"), "scampi.csv", rows)
    ids = [finding.effect.id for finding in found.findings]
    assert ids[0] == "clock_offset"
    assert set(ids) <= {"clock_offset", "anchor_offset"}
    offset = found.findings[0].parameters["offset_s"]
    assert offset.value == pytest.approx(-0.0345, abs=1e-3)
    assert offset.std < 1e-3
    assert found.findings[0].rivals == ()
    before, after = found.stages[0].length_m, found.final.length_m
    assert before is not None
    assert after is not None
    assert after.heldout.value < 0.5 * before.heldout.value
    assert after.heldout.high < before.heldout.low
    assert not found.is_unexplained
    tried = {trial.effect.id for step in found.steps for trial in step.trials}
    assert {"pulley_radius", "drum_scale", "drum_layering", "creep", "elastic_modulus"} <= tried
    skipped = dict(found.skipped)
    assert "thermal_expansion" in skipped
    assert "tension_bias" in skipped


@pytest.mark.skipif(not HANGPRINTER.is_file(), reason="the public log is not here")
def test_hangprinter_is_not_called_explained(tmp_path: Path) -> None:
    rows = table(HANGPRINTER)
    found = diagnosed(tmp_path, study_in_guide("Hangprinter HP4"), "hp4.csv", rows)
    assert found.is_unexplained
    assert found.measured.n_rows == 41
    assert "rows 42 to 44 without a pose left out" in found.measured.notes
    assert "left out, since they hold text: xyz_source" in found.measured.notes
    assert {setting.effect.id for setting in found.given} == {"anchor_offset", "length_offset"}
    before, after = found.stages[0].length_m, found.final.length_m
    assert before is not None
    assert after is not None
    assert after.heldout.value <= before.heldout.value
