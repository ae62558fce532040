"""Random changes of the code, one at a time: which of them does no quick test see?

    python tests/benchmarks/mutants.py [--count 200] [--seed 0] [--jobs 2] [--rooms ROOM ...]
        [--most 60] [--seconds 300] [--log mutants.jsonl] [--again mutants.jsonl [--tests FILE ...]]
        [--slow]

A mutant is the code with one comparison, sign, operation, bound, constant, quantifier or connective
changed. Places are drawn by seed from all rooms alike. First the quick tests run once, on a copy of
the checkout that notes which test reaches which place; then each mutant gets a copy, where the
tests that reach it run, those of its room first, until one fails. For compiled code, where nothing
can be noted, those are the tests in `COMPILED`. A survivor is printed with its line, to be killed
by a test or understood as equivalent; ``--again`` tries the survivors of a log on other tests,
``--slow`` on the slow ones too. Ends with status 1 if any survives.

Left alone is what no result follows from: texts, errors' messages, annotations, decorators,
assertions, sizes in pictures; and tolerances (below 1e-4). So is the window, whose tests need a
screen. mutmut and Cosmic Ray draw no sample by seed, and have one test command for all rooms.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import partial
from itertools import accumulate, pairwise
from pathlib import Path
from threading import current_thread
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "designer"
WINDOW = "designer/explore/desktop/"
PICTURES = "designer/report/figures/"
COMPILED = {
    "designer/physics/": ("tests/physics", "tests/statics"),
    "designer/kernel/": (
        "tests/kernel",
        "tests/physics",
        "tests/statics",
        "tests/sizing",
        "tests/workspace",
    ),
    "designer/proof/enclosure/": ("tests/proof",),
}
"""Folders of compiled code and what it is compiled again for, and their tests."""
SMALLEST = 1e-4
MEMORY = 8 * 2**30

COMPARISONS = {
    ast.Lt: ">=", ast.LtE: ">", ast.Gt: "<=", ast.GtE: "<", ast.Eq: "!=", ast.NotEq: "==",
    ast.Is: "is not", ast.IsNot: "is", ast.In: "not in", ast.NotIn: "in",
}  # fmt: skip
BOUNDS = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">"}
OPERATIONS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*"}
NAMES = {
    "any": "all", "all": "any", "min": "max", "max": "min", "minimum": "maximum",
    "maximum": "minimum", "argmin": "argmax", "argmax": "argmin", "floor": "ceil",
    "ceil": "floor", "sin": "cos", "cos": "sin", "isposinf": "isneginf", "isneginf": "isposinf",
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change: what stands at an offset of a file, and what is put there."""

    file: str
    line: int
    start: int  # In bytes
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.old} -> {self.new}"

    @property
    def room(self) -> str:
        """The room that it is in."""
        return Path(self.file).parts[1].removesuffix(".py")

    @property
    def compiled(self) -> str | None:
        """The folder of compiled code that it is in."""
        return next((folder for folder in COMPILED if self.file.startswith(folder)), None)

    def put_into(self, folder: Path) -> None:
        """Change the file of a copy."""
        path = folder / self.file
        text, old = path.read_bytes(), self.old.encode()
        end = self.start + len(old)
        if text[self.start : end] != old:
            raise ValueError(f"{self}: the file has changed")
        path.write_bytes(text[: self.start] + self.new.encode() + text[end:])


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Yield every mutant of a file."""
    source, name = path.read_bytes(), path.relative_to(ROOT).as_posix()
    starts = list(accumulate(map(len, source.splitlines(keepends=True)), initial=0))
    for node in _seen(ast.parse(source)):
        if isinstance(node, ast.Constant) and name.startswith(PICTURES):
            continue
        for change in _changes(node, source, starts):
            yield Mutant(name, 1 + source[: change.start].count(b"\n"), *change)


class Change(NamedTuple):
    """What stands at an offset, and what is put there."""

    start: int
    old: str
    new: str


def _changes(node: ast.AST, source: bytes, starts: list[int]) -> Iterator[Change]:
    """Yield the changes of a node; ``starts`` are the offsets of all lines."""

    def place(node: ast.expr) -> tuple[int, int]:
        return (
            starts[node.lineno - 1] + node.col_offset,
            starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0),
        )

    def put(first: int, end: int, new: str) -> Change:
        return Change(first, source[first:end].decode(), new)

    for left, right, old, new in _operators(node):
        first, end = place(left)[1], place(right)[0]
        at = source[first:end].find(old.encode())
        if at >= 0 and b"#" not in source[first:end]:
            yield put(first + at, first + at + len(old), new)
    match node:
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield put(*place(node), f"({ast.unparse(node.operand)})")
        case ast.IfExp():
            first, end = place(node.test)
            yield put(first, end, f"not ({source[first:end].decode()})")
        case ast.Call():
            first, end = place(node.func)
            called = _called(node)
            if called in NAMES:
                yield put(end - len(called), end, NAMES[called])
            elif called in {"abs", "fabs", "absolute"}:
                yield put(first, end, "")
        case ast.Constant(value=int() | float() as value):
            if not (isinstance(value, bool) or 0.0 < value < SMALLEST):
                new = value + 1 if isinstance(value, int) else 2.0 * value or 1.0
                yield put(*place(node), repr(new))


def _operators(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr, str, str]]:
    """Yield the operands of a node's operators, each operator, and what may stand for it."""
    match node:
        case ast.Compare():
            operands = [node.left, *node.comparators]
            for (left, right), kind in zip(pairwise(operands), map(type, node.ops), strict=True):
                yield left, right, SYMBOLS[kind], COMPARISONS[kind]
                if kind in BOUNDS and (_is_whole(left) or _is_whole(right)):
                    yield left, right, SYMBOLS[kind], BOUNDS[kind]
        case ast.BoolOp():
            old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
            for left, right in pairwise(node.values):
                yield left, right, old, new
        case ast.BinOp() if type(node.op) in OPERATIONS and not _is_text(node):
            yield node.left, node.right, SYMBOLS[type(node.op)], OPERATIONS[type(node.op)]


SYMBOLS: dict[type, str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.Is: "is", ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
}  # fmt: skip


def _seen(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes from which results follow."""
    if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        return
    if isinstance(node, ast.FunctionDef) and node.name in {"__repr__", "__str__"}:
        return
    yield node
    passed = {"decorator_list", "annotation", "returns", "bases", "type_params"}
    for name, value in ast.iter_fields(node):
        if name not in passed:
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from _seen(child)


def _called(node: ast.Call) -> str:
    return getattr(node.func, "attr", "") or getattr(node.func, "id", "")


def _is_whole(node: ast.expr) -> bool:
    """Tell whether an operand is a whole number for certain, so that equality happens."""
    if isinstance(node, ast.Call):
        return _called(node) in {"len", "sum", "count"}
    return isinstance(node, ast.Constant) and type(node.value) is int


def _is_text(node: ast.BinOp) -> bool:
    return any(
        isinstance(side, ast.JoinedStr | ast.Constant)
        and not isinstance(getattr(side, "value", ""), int | float)
        for side in (node.left, node.right)
    )


NOTES = """
import os, pathlib
_seen = set()

def hit(number):
    test = os.environ.get("PYTEST_CURRENT_TEST", "")
    if test and (number, test) not in _seen:
        _seen.add((number, test))
        with open(pathlib.Path(__file__).with_name("reached.txt"), "a") as file:
            file.write(f"{number} {test}\\n")
"""


def with_notes(source: bytes, places: dict[int, int]) -> bytes:
    """Return a source that notes when a test reaches one of these offsets, by their numbers.

    What runs when the module is imported is taken as reached by all that calls its functions.
    """
    tree, lines = ast.parse(source), source.splitlines(keepends=True)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    notes: dict[int, list[int]] = {}
    for number, offset in places.items():
        line = 1 + source[:offset].count(b"\n")
        inside = [f for f in functions if f.body[0].lineno <= line <= (f.end_lineno or 0)]
        near = inside[-1:] or functions
        for statement in (f.body[ast.get_docstring(f) is not None :][:1] for f in near):
            for first in statement:
                at = min([first.lineno, *(d.lineno for d in getattr(first, "decorator_list", []))])
                notes.setdefault(at, []).append(number)
    for at, numbers in notes.items():
        code = lines[at - 1]
        indent = code[: len(code) - len(code.lstrip())]
        calls = b"".join(b'%s__import__("notes").hit(%d)\n' % (indent, n) for n in numbers)
        lines[at - 1] = calls + code
    return b"".join(lines)


def reached(chosen: list[Mutant], jobs: int, most: int, marked: str) -> list[list[str]]:
    """Return of each mutant the tests that reach it, the likeliest to see it first."""
    tests: list[set[str]] = [set() for _ in chosen]
    with tempfile.TemporaryDirectory(prefix="reached-") as name:
        folder = copied(Path(name))
        (folder / "notes.py").write_text(NOTES)
        for file in {each.file for each in chosen if not each.compiled}:
            places = {k: each.start for k, each in enumerate(chosen) if each.file == file}
            (folder / file).write_bytes(with_notes((ROOT / file).read_bytes(), places))
        run_tests(folder, ["-n", str(jobs), "-m", marked, "tests"], 3600.0)
        for row in (folder / "reached.txt").read_text(encoding="utf-8").splitlines():
            number, test = row.split(" ", 1)
            test, phase = test.rsplit(" ", 1)
            # What a fixture of many tests reaches is noted for the first of them.
            tests[int(number)].add(test if phase == "(call)" else test.split("::")[0])
    breadth = Counter(test for some in tests for test in some)

    def nearest(k: int) -> list[str]:
        if chosen[k].compiled:
            return list(COMPILED[chosen[k].compiled or ""])
        room = f"tests/{chosen[k].room}/"
        return sorted(tests[k], key=lambda test: (not test.startswith(room), breadth[test], test))

    return [nearest(k)[:most] for k in range(len(chosen))]


@dataclass(frozen=True)
class Outcome:
    """What the tests said of a mutant."""

    mutant: Mutant
    ended: str  # survived, killed, timed out
    by: str  # Test that killed it, or how many did not
    elapsed_s: float


def tried(mutant: Mutant, tests: list[str], seconds: float, marked: str) -> Outcome:
    """Run the tests of these marks on a copy of the checkout with the mutant in it."""
    if not tests:
        return Outcome(mutant, "survived", "reached by no test", 0.0)
    folder = copied(Path(tempfile.gettempdir()) / f"mutants-{os.getpid()}" / current_thread().name)
    mutant.put_into(folder)
    began = time.monotonic()
    status, said = run_tests(folder, ["-x", "-n0", "--tb=no", "-m", marked, *tests], seconds)
    elapsed_s = round(time.monotonic() - began, 1)
    if status == 4 and "unrecognized arguments" in said:
        raise RuntimeError(f"{mutant}: {said}")
    if status == 0:
        return Outcome(mutant, "survived", f"{len(tests)} tests", elapsed_s)
    if status < 0:
        return Outcome(mutant, "timed out", "", elapsed_s)
    lines = [row for row in said.splitlines() if row.startswith(("FAILED", "ERROR"))]
    return Outcome(mutant, "killed", (lines or said.splitlines()[-1:] or [""])[0], elapsed_s)


def copied(folder: Path) -> Path:
    """Return a copy of the checkout in place of an earlier one: compiled code is kept by path."""
    shutil.rmtree(folder / "checkout", ignore_errors=True)
    hidden = shutil.ignore_patterns(".*", "build", "dist", "*-report")
    return Path(shutil.copytree(ROOT, folder / "checkout", ignore=hidden))


def run_tests(folder: Path, options: list[str], seconds: float) -> tuple[int, str]:
    """Return the status of pytest in a copy, negative if it took too long, and what it said."""
    fixed = ["-q", "-p", "no:cacheprovider", "--hypothesis-seed=0"]
    limits = f'ulimit -t {seconds:.0f}; ulimit -d {MEMORY // 1024}; exec "$@"'
    run = subprocess.Popen(
        ["sh", "-c", limits, "sh", sys.executable, "-m", "pytest", *fixed, *options],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        process_group=0,
    )
    try:
        said, _ = run.communicate(timeout=10 * seconds)
    except subprocess.TimeoutExpired:
        said = ""
    finally:
        with suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
        run.wait()
    return run.returncode, said


def drawn(count: int, seed: int, rooms: list[str]) -> list[Mutant]:
    """Return mutants at random, each room as often as it has places for them."""
    files = [p for p in sorted(PACKAGE.rglob("*.py")) if not p.is_relative_to(ROOT / WINDOW)]
    every = [each for path in files for each in mutants_of(path)]
    chosen = [each for each in every if not rooms or each.room in rooms]
    return random.Random(seed).sample(chosen, min(count, len(chosen)))


def survivors(log: Path) -> list[Mutant]:
    """Return the mutants that an earlier run left."""
    outcomes = [json.loads(row) for row in log.read_text(encoding="utf-8").splitlines()]
    return [Mutant(**one["mutant"]) for one in outcomes if one["ended"] == "survived"]


def main() -> int:
    """Try mutants; return how many survived."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rooms", nargs="*", default=[])
    parser.add_argument("--most", type=int, default=60, help="tests tried on each")
    parser.add_argument("--seconds", type=float, default=300.0, help="processor time of each")
    parser.add_argument("--log", type=Path, default=Path("mutants.jsonl"))
    parser.add_argument("--again", type=Path)
    parser.add_argument("--tests", nargs="*", default=[])
    parser.add_argument("--slow", action="store_true", help="slow tests too")
    asked = parser.parse_args()
    chosen = survivors(asked.again) if asked.again else drawn(asked.count, asked.seed, asked.rooms)
    given = [asked.tests] * len(chosen) if asked.tests else None
    marked = "" if asked.slow else "not slow"
    tests = given or reached(chosen, asked.jobs, asked.most, marked)
    tally: Counter[str] = Counter()
    attempt = partial(tried, seconds=asked.seconds, marked=marked)
    with ThreadPoolExecutor(asked.jobs) as pool, asked.log.open("a", encoding="utf-8") as log:
        for outcome in pool.map(attempt, chosen, tests):
            tally[outcome.ended] += 1
            log.write(json.dumps(asdict(outcome)) + "\n")
            log.flush()
            print(f"{outcome.ended:9} {outcome.elapsed_s:6.1f} s  {outcome.mutant}", flush=True)
    shutil.rmtree(Path(tempfile.gettempdir()) / f"mutants-{os.getpid()}", ignore_errors=True)
    print(", ".join(f"{count} {ended}" for ended, count in sorted(tally.items())))
    return tally["survived"]


if __name__ == "__main__":
    sys.exit(min(main(), 1))
