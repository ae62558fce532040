"""The commands as a user meets them: answers, exit status, faults, nothing left behind."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from designer.analysis.analyse import analyse
from designer.cli import commands, terminal
from designer.cli.commands import main
from designer.cli.tables import print_grades
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.report.render import REPORT_FILES
from designer.resources import example_file, example_names

STUDY = """
name: small crane
robot:
  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
  platform: {mass: 4000 kg}
cable: {density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: [250, 200, -50]
"""
WORKSPACE = """
workspace:
  region: {prism: anchors, inset: 30 m, z: [-200, -60]}
  samples: 300
selection: {grades: [unirope-6x36-iwrc-1960], safety_factor: 2}
"""


@dataclass
class Outcome:
    status: int
    out: str
    err: str


@pytest.fixture
def designer(capsys, monkeypatch, tmp_path) -> Callable[..., Outcome]:
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["designer", *arguments])
        try:
            main()
            status = 0
        except SystemExit as stop:
            status = int(stop.code or 0)
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return run


@pytest.mark.slow
def test_help_and_version_import_nothing_heavy() -> None:
    code = (
        "import sys\n"
        "from designer.cli.commands import main\n"
        "sys.argv = ['designer', sys.argv[1]]\n"
        "try:\n    main()\nexcept SystemExit as stop:\n    assert not stop.code\n"
        "heavy = {'vtkmodules', 'pyvista', 'cvxpy', 'numba', 'scipy', 'matplotlib', 'PySide6'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    for option in ("--help", "--version"):
        run = subprocess.run(
            [sys.executable, "-c", code, option], capture_output=True, text=True, check=True
        )
        assert run.stdout.splitlines()[-1] == "[]"


@pytest.mark.slow
def test_the_version_for_a_bug_report(designer) -> None:
    assert len(designer("--version").out.splitlines()) == 1
    told = dict(line.split(maxsplit=1) for line in designer("--version", "-v").out.splitlines())
    assert told["Python"].startswith(".".join(map(str, sys.version_info[:3])))
    assert {"system", "numpy", "numba", "pyvista", "linear", "OpenGL"} <= set(told)
    alone = designer("-v")
    assert (alone.status, alone.out) == (2, "")


def test_size_gives_the_papers_pose(designer) -> None:
    Path("study.yaml").write_text(STUDY)
    told = designer("size", "study.yaml")
    assert told.status == 0
    for figure in ("32.59917", "24.71948", "150236.49", "123081.53"):
        assert figure in told.out


def test_size_as_json(designer) -> None:
    Path("study.yaml").write_text(STUDY)
    told = designer("size", "study.yaml", "--json")
    assert told.status == 0
    pose = json.loads(told.out)["pose"]
    assert pose["sagging"]["status"] == "solved"
    assert pose["sagging"]["diameter_m"] == pytest.approx(0.03259917, abs=1e-8)
    assert pose["optimum"]["diameter_m"] == pytest.approx(0.03259917, abs=1e-8)
    assert pose["loop"]["iterates"][1]["max_tension_N"] == pytest.approx(123082, abs=1)
    assert len(pose["sagging"]["lengths_m"]) == 3


def test_size_of_an_unsolvable_pose_is_a_negative_answer(designer) -> None:
    Path("study.yaml").write_text(STUDY.replace("[250, 200, -50]", "[-10, 0, -50]"))
    told = designer("size", "study.yaml")
    assert told.status == 1
    assert "No tensions of taut cables hold the platform" in told.out
    assert designer("size", "study.yaml", "--json").status == 1


@pytest.mark.parametrize(
    ("wrong", "expected"),
    [
        (STUDY.replace("4000 kg", "-4 kg"), "study.yaml:5: robot.platform.mass: "),
        (STUDY.replace("mass:", "mas:"), "'mass'"),
        (STUDY.replace("200 GPa", "200 kg"), "youngs_modulus"),
        (STUDY.replace("pose", "poses"), "'pose'"),
        ("", "empty"),
        ("a: [1, 2", "study.yaml:"),
    ],
)
def test_a_wrong_file_gets_one_line_and_status_2(designer, wrong, expected) -> None:
    Path("study.yaml").write_text(wrong)
    for command in ("size", "report"):
        told = designer(command, "study.yaml")
        assert told.status == 2
        assert expected in told.err
        assert "Traceback" not in told.err
        assert told.err.startswith("study.yaml")
        assert sorted(path.name for path in Path().iterdir()) == ["study.yaml"]


def test_all_faults_are_told_at_once(designer) -> None:
    Path("study.yaml").write_text(STUDY.replace("4000 kg", "-4 kg").replace("180 MPa", "180 m"))
    told = designer("size", "study.yaml")
    assert len(told.err.splitlines()) == 2


def test_missing_file(designer) -> None:
    told = designer("size", "nothing.yaml")
    assert told.status == 2
    assert "nothing.yaml: there is no such file" in told.err


def test_unknown_grade_names_line_and_neighbours(designer) -> None:
    text = STUDY + WORKSPACE.replace("unirope-6x36-iwrc-1960", "unirope-6x36-iwrc-1996")
    Path("study.yaml").write_text(text)
    told = designer("report", "study.yaml")
    assert told.status == 2
    assert "study.yaml:12: selection.grades[0]:" in told.err
    assert "unirope-6x36-iwrc-1960" in told.err
    assert not Path("study-report").exists()


def test_size_tells_of_a_cable_that_serves_as_a_weight(designer) -> None:
    sideways = "platform: {mass: 4000 kg, wrench: {force: [200 kN, 0, 0]}}"
    Path("study.yaml").write_text(STUDY.replace("platform: {mass: 4000 kg}", sideways))
    outcome = designer("size", "study.yaml")
    assert outcome.status == 0
    assert "hangs below the platform" in outcome.out
    assert "Straight cables cannot hold this pose" in outcome.out
    Path("study.yaml").write_text(STUDY)
    assert "hangs" not in designer("size", "study.yaml").out


def test_size_without_a_pose(designer) -> None:
    Path("study.yaml").write_text(STUDY.replace("pose: [250, 200, -50]", ""))
    told = designer("size", "study.yaml")
    assert told.status == 2
    assert "pose" in told.err


def test_report_with_nothing_to_solve(designer) -> None:
    Path("study.yaml").write_text(STUDY.replace("pose: [250, 200, -50]", ""))
    told = designer("report", "study.yaml")
    assert told.status == 2
    assert "nothing to solve" in told.err


def test_quick_report(designer) -> None:
    Path("crane.yaml").write_text(STUDY + WORKSPACE)
    quick = designer("report", "crane.yaml", "--quick")
    assert (quick.status, quick.out.splitlines()[-1]) == (0, "crane-quick: report.html")
    page = Path("crane-quick/report.html").read_text()
    assert "Page 1 alone: no charts, no proof between the samples, no PDF" in page
    assert page.count("<section") == 1
    targets = set(re.findall(r'href="#([^"]*)"', page))
    assert targets <= set(re.findall(r'id="([^"]*)"', page))
    study = read_study(Path("crane.yaml"))
    (chosen,) = {row for row in quick.out.splitlines() if row.startswith("│ cable ")}
    whole = analyse(study).chosen
    assert whole is not None
    assert whole.size.id in chosen


def test_report_into_a_file(designer) -> None:
    Path("study.yaml").write_text(STUDY)
    Path("out").write_text("mine")
    told = designer("report", "study.yaml", "-o", "out")
    assert told.status == 2
    assert "out: is a file" in told.err
    assert Path("out").read_text() == "mine"


@pytest.mark.parametrize(
    "arguments",
    [("size", ""), ("report", "a.yaml", "-o", ""), ("init", " "), ("catalog", "check", "")],
)
def test_an_empty_path_is_not_this_folder(designer, arguments) -> None:
    outcome = designer(*arguments)
    assert outcome.status == 2
    assert outcome.err == "command line: a path is empty (expected a file or folder)\n"


@pytest.mark.parametrize(
    ("pose", "status", "outcome"),
    [
        ("[250, 200, -1]", 1, "loop: diverges, given up after"),
        ("[250, 4.85, -40]", 0, "loop: not settled after 400 turns"),
    ],
)
def test_a_loop_that_does_not_settle_is_told_in_a_few_rows(designer, pose, status, outcome) -> None:
    Path("a.yaml").write_text(STUDY.replace("pose: [250, 200, -50]", f"pose: {pose}"))
    told = designer("size", "a.yaml")
    assert told.status == status
    assert "nan" not in told.out
    rows = told.out.splitlines()
    assert sum("│ loop" in row for row in rows) <= 13
    assert any(row.startswith(outcome) for row in rows)
    assert max(len(row) for row in rows) < 120
    assert ("…" in told.out) == (status == 0)


def test_units_and_names_in_brackets_are_printed_as_they_are(designer) -> None:
    name = "Crane [red] [/] [mm] :smile: \\\\"
    Path("a.yaml").write_text(STUDY.replace("name: small crane", f"name: '{name}'"))
    told = designer("size", "a.yaml").out
    assert f"{name}: " in told
    assert all(
        heading in told
        for heading in ("diameter [mm]", "largest tension [N]", "length [m]", "tension at exit [N]")
    )
    grades = designer("catalog", "list", "--material", "HMPE").out
    assert "d [mm]" in grades and "MBL [kN]" in grades
    sizes = designer("catalog", "show", "unirope-7x19-galvanised").out
    assert "mass [kg/m]" in sizes


@pytest.mark.slow
def test_only_what_was_written_is_named_and_no_older_answer_stays(designer) -> None:
    Path("a.yaml").write_text(STUDY)
    Path("out").mkdir()
    for name in ("mine.txt", "candidates.csv", "reactions.csv", "workspace.nc"):
        Path("out", name).write_text("older")
    outcome = designer("report", "a.yaml", "-o", "out")
    assert outcome.status == 0, outcome.err
    assert outcome.out.splitlines()[-1] == "out: report.html, report.pdf, result.json"
    found = sorted(path.name for path in Path("out").iterdir())
    assert found == ["mine.txt", "report.html", "report.pdf", "result.json"]


def test_init_writes_a_study_that_reads(designer) -> None:
    assert designer("init", "crane.yaml", "--example", "yard").status == 0
    head = Path("crane.yaml").read_text().splitlines()[0]
    assert head == "# yaml-language-server: $schema=cdpr-designer.schema.json"
    assert designer("schema").out == Path("cdpr-designer.schema.json").read_text()
    assert designer("size", "crane.yaml").status == 0
    again = designer("init", "crane.yaml")
    assert again.status == 2
    assert "exists already" in again.err
    unknown = designer("init", "other.yaml", "--example", "yart")
    assert unknown.status == 2
    assert "yard" in unknown.err


@pytest.mark.parametrize(
    ("answers", "name"), [("\n", "hoist"), ("ten\n0\n1\n", "cogiro"), ("yard\n", "yard")]
)
def test_init_asks_on_a_terminal(designer, monkeypatch, answers: str, name: str) -> None:
    monkeypatch.setattr(commands, "can_ask", lambda: True)
    monkeypatch.setattr("sys.stdin", io.StringIO(answers))
    outcome = designer("init", "crane.yaml")
    assert outcome.status == 0, outcome.err
    assert all(example in outcome.out for example in example_names())
    text = Path("crane.yaml").read_text()
    assert text.endswith(example_file(name).read_text())


def test_init_starts_with_a_hoist_in_a_pipe(designer) -> None:
    assert designer("init").status == 0
    study = read_study(Path("hoist.yaml"))
    selection = study.selection
    assert selection is not None
    assert (selection.safety_factor, selection.termination_efficiency) == (5.0, 0.9)
    assert selection.sheave_diameter_m is not None
    assert all(case.wind is not None for case in study.load_cases)


def test_end_of_input_writes_nothing(designer, monkeypatch) -> None:
    monkeypatch.setattr(commands, "can_ask", lambda: True)
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    outcome = designer("init", "crane.yaml")
    assert outcome.status == 130
    assert outcome.err.endswith("Interrupted; nothing was written.\n")
    assert not Path("crane.yaml").exists()


def test_the_shell_completes_commands_and_names() -> None:
    for typed, wanted in (("designer dia", "diagnose"), ("designer init --example ya", "yard")):
        asked = {"_DESIGNER_COMPLETE": "complete_bash", "COMP_WORDS": typed}
        run = subprocess.run(
            [Path(sys.executable).with_name("designer")],
            env={**os.environ, **asked, "COMP_CWORD": str(len(typed.split()) - 1)},
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        assert run.stdout.split() == [wanted]


def test_catalog_list_show_check(designer) -> None:
    listed = designer("catalog", "list")
    assert listed.status == 0
    assert "unirope" in listed.out
    shown = designer("catalog", "show", "unirope-7x19-galvanised")
    assert shown.status == 0
    assert "31.14" in shown.out
    unknown = designer("catalog", "show", "unirope-7x19-galvanized")
    assert unknown.status == 2
    assert "unirope-7x19-galvanised" in unknown.err
    Path("rope.yaml").write_text("id: x\n")
    checked = designer("catalog", "check", "rope.yaml")
    assert checked.status == 2
    assert checked.err.startswith("rope.yaml:")


def test_catalog_list_as_json(designer) -> None:
    listed = json.loads(designer("catalog", "list", "--json", "--maker", "unirope").out)
    (grade,) = [one for one in listed if one["id"] == "unirope-7x19-galvanised"]
    assert (grade["construction"], grade["origin"]) == ("7x19", "builtin")
    assert grade["diameter_m"] == pytest.approx([0.00238125, 0.009525])
    assert len(grade["sizes"]) > 2
    none = designer("catalog", "list", "--json", "--construction", "none of these")
    assert (none.status, json.loads(none.out)) == (1, [])


def test_a_narrow_terminal_cuts_no_id(capsys, monkeypatch) -> None:
    monkeypatch.setattr(terminal._out, "_width", 80)
    grades = load_catalogue(with_plugins=False).grades
    print_grades(grades)
    words = set(capsys.readouterr().out.split())
    assert len(grades) > 100
    assert [grade.id for grade in grades if grade.id not in words] == []


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (("explore",), "pip install 'cdpr-designer[desktop]'"),
        (("sweep",), "keep: [selection.chosen.utilisation, selection.chosen.total_mass_kg]"),
        (
            ("catalog", "new"),
            "units from heads or a row of units below; on a terminal you are asked",
        ),
    ],
)
def test_help_is_as_wide_as_the_terminal_and_has_no_markup(
    designer, monkeypatch, command, words
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    assert words in designer(*command, "--help").out


@pytest.mark.slow
def test_report_end_to_end(designer) -> None:
    Path("study.yaml").write_text(STUDY + WORKSPACE)
    told = designer("report", "study.yaml")
    assert told.status == 0, told.err
    folder = Path("study-report")
    names = {path.name for path in folder.iterdir()}
    assert names == {*REPORT_FILES} - {"path.csv"}
    result = json.loads((folder / "result.json").read_text())
    assert result["workspace"]["feasible"] is True
    assert result["selection"]["chosen"]["grade"] == "unirope-6x36-iwrc-1960"
    assert (folder / "report.pdf").read_bytes().startswith(b"%PDF")
    assert "small crane" in told.out


@pytest.mark.slow
def test_report_without_a_product_is_a_negative_answer(designer) -> None:
    text = STUDY + WORKSPACE.replace("unirope-6x36-iwrc-1960", "unirope-7x19-galvanised")
    Path("study.yaml").write_text(text)
    told = designer("report", "study.yaml", "-o", "deep/out")
    assert told.status == 1, told.err
    result = json.loads(Path("deep/out/result.json").read_text())
    assert result["selection"]["chosen"] is None
    assert "the largest size sold of every grade is insufficient" in result["selection"]["reason"]


@pytest.mark.slow
def test_a_workspace_that_no_cable_serves(designer) -> None:
    outside = "region: {box: [[900, 910], [900, 910], [-60, -50]]}"
    workspace = WORKSPACE.replace("region: {prism: anchors, inset: 30 m, z: [-200, -60]}", outside)
    Path("a.yaml").write_text(STUDY + workspace)
    outcome = designer("report", "a.yaml")
    assert outcome.status == 1
    assert "none: no cable was found that serves any of it" in outcome.out
    assert outcome.out.index("worst pose") < outcome.out.index("outside hull")


@pytest.mark.slow
def test_a_clearance_that_means_nothing_is_told(designer) -> None:
    workspace = "workspace: {region: {points: [[250, 200, -60]]}, clearance: 1 m}\n"
    Path("a.yaml").write_text(STUDY + workspace)
    outcome = designer("report", "a.yaml")
    assert outcome.status == 0, outcome.err
    assert "nothing to compare: all cables meet at the platform" in outcome.out
