"""Reads thousands of damaged configs and grade files, and analyses those that are accepted.

    python tests/benchmarks/damaged_inputs.py [CONFIGS] [GRADES] [ANALYSES] [SEED]

A damaged file may be refused with its faults, or be read; then a pose and a handful of samples of
it are solved and written as strict JSON. Anything else is printed with the text that did it, and
the exit status is 1: an exception of another kind, more than `SLOWEST_S`, a number that JSON cannot
hold.
"""

from __future__ import annotations

import json
import random
import re
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import FrameType

from designer.analysis.analyse import analyse
from designer.analysis.pose import analyse_pose
from designer.analysis.result_json import result_dict, size_dict
from designer.documents.plain import json_text
from designer.errors import DesignerError
from designer.grades.registry import Catalogue, load_catalogue, read_grade
from designer.io.config import read_study
from designer.plugins import find_plugins
from designer.progress import Silent
from designer.resources import data_folder, example_file, example_names
from designer.study import Study

SLOWEST_S = 20
"""Processor time for reading; an analysis may take four times as long."""
NUMBERS = (
    *(
        "0",
        "-1",
        "1",
        "-0.0",
        "1e-300",
        "1e300",
        "1e308",
        "-1e308",
        "1e999",
        ".nan",
        ".inf",
        "1e-9",
    ),
    *("9" * 17, "9" * 18, "9" * 19, "9" * 60, "9" * 64, "9" * 65, "9" * 400, "1" * 5000),
    *("0." + "0" * 400 + "1", "1e" + "9" * 300, "1" * 300 + "." + "1" * 300, "7" * 900 + "x"),
    *("0x" + "f" * 400, "1_000", "1e6", "1e9", "-1e9", "1e-6", "12345678", "0.001", "1000", "2.5"),
    *("true", "null", "''", "text", "[]", "{}", "[1, 2]", "[[1]]", "{a: 1}", "!!int 5", "&a 1"),
)
UNITS = ("mm", "km", "m", "kg", "t", "kN", "GPa", "deg", "m^9", "lightyear", "%", "degC", "dB", "°")


def spoilt(text: str, chance: random.Random) -> str:
    """Return the text with one to three of its values, lines or letters changed."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        text = chance.choice(CHANGES)(text, chance)
    return text


def _number(text: str, chance: random.Random) -> str:
    spans = list(_numbers(text))
    if not spans:
        return text
    start, end = chance.choice(spans)
    new = chance.choice(NUMBERS)
    if chance.random() < 0.2:
        new = f"{new} {chance.choice(UNITS)}"
    return text[:start] + new + text[end:]


def _scaled(text: str, chance: random.Random) -> str:
    spans = list(_numbers(text))
    if not spans:
        return text
    start, end = chance.choice(spans)
    factor = chance.choice((-1.0, 1e-9, 1e-6, 1e-3, 0.1, 10.0, 1e3, 1e6, 1e9))
    return f"{text[:start]}{float(text[start:end]) * factor!r}{text[end:]}"


def _line(text: str, chance: random.Random) -> str:
    lines = text.splitlines()
    at = chance.randrange(len(lines))
    change = chance.randrange(4)
    if change == 0:
        del lines[at]
    elif change == 1:
        lines.insert(at, chance.choice(lines))
    elif change == 2:
        lines[at] = " " * chance.randrange(4) + lines[at].lstrip()
    else:
        name = lines[at].split(":")[0]
        lines[at] = f"{name}: {chance.choice(NUMBERS)}"
    return "\n".join(lines) + "\n"


def _letter(text: str, chance: random.Random) -> str:
    at = chance.randrange(len(text))
    letter = chance.choice("0123456789-.,:[]{}'\"#&*!|>%@ \n\te\x00é")
    return text[:at] + letter + text[at + chance.randrange(2) :]


CHANGES: tuple[Callable[[str, random.Random], str], ...] = (
    _number, _number, _number, _scaled, _scaled, _line, _letter,
)  # fmt: skip


def _numbers(text: str) -> Iterator[tuple[int, int]]:
    """Yield where numbers stand, comments left out."""
    at = 0
    for line in text.splitlines(keepends=True):
        for found in re.finditer(r"(?<![\w.])-?\d+\.?\d*(?:e-?\d+)?(?![\w.])", line.split("#")[0]):
            yield at + found.start(), at + found.end()
        at += len(line)


@contextmanager
def no_longer_than(seconds: int) -> Iterator[None]:
    """Raise `TimeoutError` in what takes more processor time."""

    def stop(_: int, __: FrameType | None) -> None:
        raise TimeoutError(f"more than {seconds} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)  # processor time
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def small(study: Study) -> Study:
    """Return the study with a handful of samples and a few grades."""
    if study.workspace is None:
        return study
    workspace = replace(study.workspace, samples=min(study.workspace.samples, 8))
    return replace(study, workspace=workspace)


def solve(study: Study, catalogue: Catalogue, folder: Path) -> None:
    """Solve the pose and some samples, and write both as strict JSON."""
    pose = analyse_pose(study)
    if pose is not None:
        json.loads(json_text(size_dict(study, pose)))
    json.loads(json_text(result_dict(analyse(small(study), catalogue, folder, Silent()))))


def main(configs: int = 2000, grades: int = 2000, analyses: int = 40, seed: int = 0) -> int:
    """Try so many damaged files; return how many did what none should."""
    chance = random.Random(seed)
    plugins = find_plugins(with_plugins=False)
    full = load_catalogue(plugins=plugins)
    catalogue = replace(full, grades=tuple(g for g in full.grades if "7x19" in g.id)[:2])
    studies = [example_file(name) for name in example_names()]
    with tempfile.TemporaryDirectory() as name:
        trial = Trial(Path(name))
        for study in studies[: 8 * bool(analyses)]:  # what is compiled now is not cut off later
            solve(read_study(study), catalogue, trial.folder)
        for _ in range(configs):
            text = spoilt(_text(chance.choice(studies)), chance)
            study = trial.reads("config", text, lambda p: read_study(p, plugins=plugins))
            if isinstance(study, Study) and trial.tally["analysis done"] < analyses:
                trial.does("analysis", text, partial(solve, study, catalogue, trial.folder))
        tables = sorted(data_folder("catalog").glob("*.yaml"))
        for _ in range(grades):
            trial.reads("grade", spoilt(_text(chance.choice(tables)), chance), read_grade)
    for what, count in sorted(trial.tally.items()):
        print(f"{count:6} {what}")
    print(f"slowest to read: {trial.slowest_s:.2f} s")
    return sum(count for what, count in trial.tally.items() if "FAILED" in what)


class Trial:
    """Counts what becomes of damaged files, and keeps those that do what none should."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.tally: Counter[str] = Counter()
        self.slowest_s = 0.0

    def reads(self, kind: str, text: str, read: Callable[[Path], object]) -> object:
        """Return what is read from a text; None where it is refused."""
        path = self.folder / "damaged.yaml"
        path.write_text(text, encoding="utf-8", errors="surrogatepass")
        began = time.process_time()
        found = self.does(kind, text, partial(read, path), SLOWEST_S)
        self.slowest_s = max(self.slowest_s, time.process_time() - began)
        return found

    def does(
        self, kind: str, text: str, action: Callable[[], object], most_s: int = 4 * SLOWEST_S
    ) -> object:
        """Return what an action gives, and count how it ended."""
        found, outcome = None, "done"
        try:
            with no_longer_than(most_s):
                found = action()
        except DesignerError:
            outcome = "refused"
        except Exception as error:  # whatever it is, it should not have been
            outcome = "FAILED"
            _tell(text, error)
        self.tally[f"{kind} {outcome}"] += 1
        return found


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _tell(text: str, error: BaseException) -> None:
    kept = Path(tempfile.mkdtemp(prefix="damaged-")) / "damaged.yaml"
    kept.write_text(text, encoding="utf-8", errors="surrogatepass")
    last = "".join(traceback.format_exception(error)[-3:])
    print(f"{kept}: {type(error).__name__}: {error}\n{last}", flush=True)


if __name__ == "__main__":
    sys.exit(min(main(*map(int, sys.argv[1:])), 1))
