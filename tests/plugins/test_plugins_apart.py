"""Plugins are asked in processes of their own: what one does there is told, and the rest works."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from plugin_samples import hook, install_plugin

from designer.effects.load import load_effects
from designer.effects.registry import SHIPPED
from designer.grades.registry import load_catalogue
from designer.plugins import examine, guard
from designer.plugins.find import find_plugins

MADE_IN_PYTHON = """
from designer.grades.grade import Grade, Reference, Size
from designer.grades.parts import Modulus, SheaveRatio

def made(name="7x7"):
    return Grade(
        id="acme-python", manufacturer="Acme", product="Acme", construction=name, core="WSC",
        finish="galvanised", trust="C", source=Reference("Acme", "a sheet"),
        modulus=Modulus(6e10, "nominal", "printed", "the sheet", 0.1),
        sheave_ratio=SheaveRatio(35.0, 25.0, "the sheet"), notes=("a note",),
        sizes=[Size("6 mm", 0.006, 21e3, 0.14), Size("8 mm", 0.008, 37e3, 0.25)],
    )
"""
ENDINGS = [
    ("import os; os._exit(0)", "cannot be loaded: it ended its process"),
    (hook("import os; os._exit(1)"), "fails in register_grades(): it ended its process"),
    (
        hook("import os; os._exit(0)", "register_effects"),
        "fails in register_effects(): it ended its process",
    ),
    (hook("import os, signal; os.kill(os.getpid(), 9)"), "it ended its process"),
    (hook("raise SystemExit(0)"), "fails in register_grades(): SystemExit: 0"),
    (hook("input()"), "fails in register_grades(): EOFError"),
    (
        hook("raise type('Bad\\x1b[31m', (Exception,), {})('red \\x1b[31m text')"),
        "fails in register_grades(): Bad?[31m: red ?[31m text",
    ),
    (
        hook("return [type('Rope\\x1b[31m', (), {})()]"),
        "register_grades() gave Rope?[31m, not a path or a Grade",
    ),
    (hook("return bytearray(1 << 40)"), "fails in register_grades(): MemoryError"),
]


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(("code", "words"), ENDINGS)
def test_it_is_named_and_the_rest_works(site: Path, code: str, words: str) -> None:
    install_plugin(site, "acme-bad", code)
    install_plugin(site, "acme-good", MADE_IN_PYTHON + hook("return [made()]"))
    catalogue = load_catalogue()
    (problem,) = catalogue.problems
    assert problem.startswith("plugin acme-bad (acme-bad 1.2)")
    assert words in problem
    assert problem.endswith(": left out")
    assert problem.isprintable()
    assert catalogue.grade("acme-python").origin == "acme-good"


@pytest.mark.slow
@pytest.mark.parametrize(
    "body",
    ["import re; re.match('(a+)+$', 'a' * 60 + 'b')", "import time; time.sleep(60)"],
    ids=["in C, which holds all threads", "asleep"],
)
def test_one_that_never_ends_is_ended(
    site: Path, monkeypatch: pytest.MonkeyPatch, body: str
) -> None:
    monkeypatch.setattr(guard, "LONGEST_WAIT_S", 0.5)
    monkeypatch.setattr(examine, "_GRACE_S", 1.0)
    install_plugin(site, "acme-endless", hook(body))
    (problem,) = load_catalogue().problems
    assert problem == (
        "plugin acme-endless (acme-endless 1.2) fails in register_grades(): "
        "TimeoutError: no answer within 0.5 s: left out"
    )


def test_effects_of_one_that_ends_its_process_are_never_loaded_here(site: Path) -> None:
    install_plugin(site, "acme-bad", "import os; os._exit(0)")
    known = load_effects(find_plugins())
    assert known.effects == SHIPPED.effects
    assert "acme_bad" not in sys.modules


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("file", ["METADATA", "entry_points.txt"])
def test_metadata_that_is_no_text(site: Path, file: str) -> None:
    install_plugin(site, "acme-bad", hook("return []"))
    install_plugin(site, "acme-good", MADE_IN_PYTHON + hook("return [made()]"))
    (site / "acme_bad-1.2.dist-info" / file).write_bytes(b"\xff\xfe\x1b[31m")
    catalogue = load_catalogue()
    (problem,) = catalogue.problems
    assert "acme" in problem
    assert "its metadata cannot be read: UnicodeDecodeError" in problem
    assert problem.isprintable()
    assert catalogue.grade("acme-python").origin == "acme-good"


def test_a_grade_made_in_python_comes_as_plain_data(site: Path) -> None:
    install_plugin(site, "acme-good", MADE_IN_PYTHON + hook("return [made()]"))
    grade = load_catalogue().grade("acme-python")
    assert "acme_good" not in sys.modules
    assert grade.modulus is not None and grade.modulus.value_Pa == 6e10
    assert [size.id for size in grade.sizes] == ["6 mm", "8 mm"]
    assert grade.notes == ("a note",)


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """The processes that were begun."""
    found: list[object] = []
    start = subprocess.Popen

    def popen(*given: object, **more: object) -> object:
        found.append(given)
        return start(*given, **more)  # type: ignore[call-overload]

    monkeypatch.setattr(examine.subprocess, "Popen", popen)
    return found


@pytest.mark.slow
def test_an_answer_is_kept_until_a_file_changes(site: Path, begun: list[object]) -> None:
    code = MADE_IN_PYTHON + hook("return [made()]")
    install_plugin(site, "acme-good", code)
    first = load_catalogue()
    assert len(begun) == 1
    assert load_catalogue() == first
    assert len(begun) == 1
    (site / "acme_good.py").write_text(code.replace("made()]", "made('7x19')]"))
    assert load_catalogue().grade("acme-python").construction == "7x19"
    assert len(begun) == 2
    (kept,) = examine.kept_folder().iterdir()
    kept.write_text("{")
    assert load_catalogue().grade("acme-python").construction == "7x19"
    assert len(begun) == 3


@pytest.mark.slow
def test_a_failure_is_not_kept(site: Path, begun: list[object]) -> None:
    install_plugin(site, "acme-bad", hook("raise OSError('no licence')"))
    for count in (1, 2):
        assert "no licence" in load_catalogue().problems[0]
        assert len(begun) == count


def test_without_plugins_of_others_no_process_begins(site: Path, begun: list[object]) -> None:
    assert load_catalogue().problems == ()
    assert begun == []


def test_our_own_grades_may_take_their_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "LONGEST_WAIT_S", 0.0)
    catalogue = load_catalogue(with_plugins=False)
    assert catalogue.problems == ()
    assert len(catalogue.grades) > 100
