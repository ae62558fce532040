"""The walk-throughs of the guide to measured logs, as it prints them."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.resources import example_file

GUIDE = example_file("fast").with_name("measured-logs.md")


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
