"""The table of pairs: what becomes of every two options of a study; kept beside this file.

    python tests/pairs/table.py

writes it anew. That what is computed is right is for `test_pairs.py`, and for
`tests/benchmarks/random_studies.py`.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

if __name__ == "__main__":  # started as a script
    sys.path.insert(0, str(Path(__file__).parents[1]))

import yaml
from pairs.agreement import disagreements
from pairs.commands import COMMANDS
from pairs.options import GRADES, OPTIONS, Option, base_of, file_text, files_of, study_of

import designer
from designer.analysis.analyse import Analysis
from designer.errors import InputError
from designer.grades.registry import Catalogue, read_grade
from designer.study import Study

FILE = Path(__file__).with_name("outcomes.csv")
COMPUTED, REFUSED, NOT_COVERED, APART = "computed", "refused", "not covered", "no robot has both"


@dataclass(frozen=True)
class Outcome:
    """What becomes of a pair, and why, in a line, where it is not computed."""

    kind: str
    why: str = ""


@cache
def catalogue() -> Catalogue:
    """Return the grades of the pairs alone."""
    with TemporaryDirectory() as folder:
        grades = []
        for name, sheet in GRADES.items():
            path = Path(folder) / f"{name}.yaml"
            path.write_text(yaml.safe_dump(sheet), encoding="utf-8")
            grades.append(read_grade(path))
    return Catalogue(tuple(grades), (), ())


def study_in(text: dict[str, Any], folder: Path) -> Study:
    """Return the study of a text; `InputError` where it is refused."""
    for name in files_of(text):
        (folder / name).write_text(file_text(name), encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(text, sort_keys=False), encoding="utf-8")
    return designer.read_study(path, with_plugins=False)


def analysed(text: dict[str, Any], folder: Path) -> Analysis:
    """Return the analysis of a study's text; `InputError` where it is refused."""
    return Analysis.begin(study_in(text, folder), catalogue())


def outcome_of(options: Sequence[Option], folder: Path) -> Outcome:
    """Return what becomes of a study with some options, as it is read."""
    base = base_of(*options)
    if base is None:
        return Outcome(APART)
    text = study_of(base, *options)
    try:
        study_in(text, folder)
    except InputError as error:
        lines = {f"{fault.field}: {fault.problem}" for fault in error.faults}
        assert not any("\n" in line for line in lines)
        return Outcome(REFUSED, "; ".join(sorted(lines)))
    reasons = [why for option in options if (why := option.not_covered(text))]
    return Outcome(NOT_COVERED, reasons[0]) if reasons else Outcome(COMPUTED)


def wrong_with(options: Sequence[Option], folder: Path, others: int = 6) -> Iterator[str]:
    """Yield what the reference does not confirm of a study with some options."""
    base = base_of(*options)
    if base is None or outcome_of(options, folder).kind == REFUSED:
        return
    text = study_of(base, *options)
    analysis = analysed(text, folder)
    if not analysis.assignment.is_found:
        yield "no rope holds: the study is too hard for a table"
        return
    yield from disagreements(text, analysis, others)
    for option in options:
        if option.id in COMMANDS:
            yield from COMMANDS[option.id](text, analysis, folder)


def read_table() -> dict[tuple[str, str], Outcome]:
    """Return the table that is kept, by the names of two options."""
    with FILE.open(encoding="utf-8", newline="") as file:
        return {
            (row["first"], row["second"]): Outcome(row["outcome"], row["why"])
            for row in csv.DictReader(file)
        }


def main() -> None:
    with TemporaryDirectory() as folder, FILE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["first", "second", "outcome", "why"])
        for first, second in combinations(OPTIONS, 2):
            found = outcome_of((first, second), Path(folder))
            writer.writerow([first.id, second.id, found.kind, found.why])


if __name__ == "__main__":
    main()
