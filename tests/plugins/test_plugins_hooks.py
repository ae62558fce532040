"""Commands, importers, exporters and sections of plugins: faults are named, the rest works."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from plugin_samples import hook, install_plugin
from test_cli import STUDY, designer

__all__ = ["designer"]


def code(hook_name: str, item: str, function: str) -> str:
    """Return the code of a plugin whose hook gives an item that is made of a function ``work``."""
    return textwrap.dedent(function) + "\n\n" + hook(f"return [{item}]", hook_name)


IMPORTER = "__import__('designer.foreign.robot').foreign.robot.Importer('{}', work)"
FORMAT = "__import__('designer.exports.formats').exports.formats.Format('{}', work, '.txt', False)"
CASES = [
    # hook, item, function, arguments, status, words
    ("commands", "work", "def work(): raise KeyError('x')", "work", 2, "command work: KeyError"),
    ("commands", "work", "def work(): raise SystemExit(7)", "work", 7, ""),
    ("commands", "work", "def work(): return False", "work", 1, ""),
    ("commands", "work", "def work(a: 'Nope'): pass", "work", 2, "unusable command work"),
    ("commands", "7", "", "work", 2, "register_commands() gave int (expected function): left out"),
    ("commands", "size", "def size(): pass", "work", 2, "gave 'size', which is there already"),
    ("importers", "7", "", "import a.tab", 2, "gave int (expected Importer): left out"),
    (
        "importers", IMPORTER.format(".xml"), "work = None", "import a.tab", 2,
        "gave '.xml', which is there already: left out",
    ),
    (
        "importers", IMPORTER.format(".tab"), "def work(path): raise OSError('x')", "import a.tab",
        2, "fails in reading a.tab: OSError: x",
    ),
    (
        "importers", IMPORTER.format(".tab"), "def work(path): return 7", "import a.tab", 2,
        "fails in reading a.tab: TypeError: it returned int, not a ForeignRobot",
    ),
    (
        "exporters", FORMAT.format("csv"), "work = None", "export study.yaml --to tab", 2,
        "gave 'csv', which is there already: left out",
    ),
    (
        "exporters", FORMAT.format("tab"), "def work(robot, stem): raise SystemExit(0)",
        "export study.yaml --to tab", 2, "fails in writing tab: SystemExit: 0",
    ),
    (
        "exporters", FORMAT.format("tab"), "def work(robot, stem): pass",
        "export study.yaml --to tab", 2, "it returned NoneType, not an Export",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "item", "function", "arguments", "status", "words"), CASES)
def test_a_fault_at_work_is_one_line_with_the_name_of_the_plugin(
    designer, site, kind, item, function, arguments, status, words
) -> None:
    install_plugin(site, "acme-bad", code(f"register_{kind}", item, function))
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    before = sorted(Path().iterdir())
    done = designer(*arguments.split())
    assert done.status == status
    lines = [line for line in done.err.splitlines() if line.startswith("plugin ")]
    assert len(lines) == bool(words)
    assert all(line.startswith("plugin acme-bad (acme-bad 1.2)") for line in lines)
    assert words in "".join(lines)
    assert sorted(Path().iterdir()) == before


def test_commands_of_ours_load_no_plugin(designer, site) -> None:
    install_plugin(site, "acme-bad", "raise RuntimeError")
    done = designer("catalog", "list", "--no-plugins")
    assert (done.status, done.err) == (0, "")


SECTIONS = """
def works(analysis):
    return "Acme's title", "as text: <b>"

def has_nothing(analysis):
    return None

def fails(analysis):
    raise KeyError("x")

def exits(analysis):
    raise SystemExit(0)

def is_nonsense(analysis):
    return 7

def answer(analysis):
    return "Another answer", ""
"""


def test_sections_that_fail_are_named_in_the_report_and_the_rest_works(designer, site) -> None:
    items = "works, has_nothing, fails, exits, is_nonsense, answer"
    install_plugin(site, "acme-page", code("register_report_sections", items, SECTIONS))
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    done = designer("report", "study.yaml", "-o", "pages")
    assert done.status == 0
    page = Path("pages/report.html").read_text(encoding="utf-8")
    assert '<h2 id="works"' in page
    assert "<p>as text: &lt;b&gt;</p>" in page
    assert page.index('<h2 id="works"') < page.index('<h2 id="provenance"')
    assert 'id="has-nothing"' not in page
    label = "plugin acme-page (acme-page 1.2)"
    for problem in (
        f"{label}: register_report_sections() gave 'answer', which is there already: left out",
        f"{label} fails in the section fails: KeyError: 'x': left out",
        f"{label} fails in the section exits: SystemExit: 0: left out",
        f"{label} fails in the section is-nonsense: TypeError: cannot unpack",
    ):
        assert problem in done.err
        assert problem.replace("'", "&#39;") in page
    without = designer("report", "study.yaml", "-o", "pages", "--no-plugins")
    assert label not in without.err
    assert 'id="works"' not in Path("pages/report.html").read_text(encoding="utf-8")
