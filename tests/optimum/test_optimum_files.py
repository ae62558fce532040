"""What an optimisation writes, from Python and from the command line."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from optimum_cases import OF_POSE, OF_YARD, STUDY, YARD, optimum, written
from report_parts import pictures

import designer
from designer.analysis.comparison import ComparisonLine
from designer.cli.commands import main
from designer.errors import DesignerError
from designer.optimum.optimise import Optimum
from designer.optimum.report import headline, optimum_report, trust_lines, write_optimum


@pytest.mark.slow
def test_the_optimised_study_is_the_design_wherever_it_lies(tmp_path: Path) -> None:
    found = optimum(tmp_path, OF_YARD, YARD)
    folder = tmp_path / "out"
    folder.mkdir()
    write_optimum(found, folder)
    names = {file.name for file in folder.iterdir()}
    assert {"optimise.html", "optimise.pdf", "optimise.json", "designs.csv"} <= names
    study = designer.read_study(folder / "crane.optimised.yaml", with_plugins=False)
    robot = found.optimised.study.robot
    assert study.robot.exit_points_m.tolist() == robot.exit_points_m.tolist()
    text = (folder / "crane.optimised.yaml").read_text()
    assert text.startswith("# a small crane\n") and "# mast tops" in text
    told = json.loads((folder / "optimise.json").read_text())
    assert told["objective"]["after"] == found.optimised.to_dict()["answer"]["total_mass_kg"]
    assert told["better"] is found.is_better
    rows = (folder / "designs.csv").read_text().splitlines()
    assert len(rows) == 1 + len(found.searched.trials)
    comparison = json.loads((folder / "comparison.json").read_text())
    assert comparison["same"] is False


@pytest.mark.slow
def test_the_page_says_what_is_not_proved(tmp_path: Path) -> None:
    found = optimum(tmp_path, OF_POSE.replace("150", "30"))
    assert "not proved the best" in trust_lines(found)[0]
    assert "−" in headline(found)
    report = optimum_report(found, found.optimised.provenance.created)
    assert [one.id for one in report.sections] == ["answer", "variables", "differences", "trust"]


@pytest.mark.slow
def test_nothing_better_is_no_gain(tmp_path: Path) -> None:
    """The study as it is has the highest masts that may be."""
    plan = OF_POSE.replace("[6 m, 12 m]", "[6 m, 10 m]").replace("[-4 m, 6 m]", "[-1 m, 1 m]")
    found = optimum(tmp_path, plan.replace("150", "40"))
    assert not found.is_better and found.holds
    assert headline(found).startswith("Nothing better was found")


def test_a_gain_that_reads_zero_is_no_better(tmp_path: Path) -> None:
    found = optimum(tmp_path, OF_POSE.replace("150", "10"))
    assert found.before is not None and found.holds
    for gain, is_better in ((5e-5, False), (2e-4, True)):
        same = replace(found, after=found.before * (1.0 - gain))
        assert same.is_better is same.to_dict()["better"] is is_better
        assert headline(same).startswith("Nothing better") is not is_better


def test_a_design_that_asks_for_less_says_so(tmp_path: Path) -> None:
    plan = OF_POSE.replace("robot.anchors[*][2]: [6 m, 12 m]", "robot.platform.mass: [80 kg, 1 t]")
    found = optimum(tmp_path, plan.replace("1 t", "100 kg").replace("150", "10"))
    (line,) = (one for one in trust_lines(found) if "is a requirement of the study" in one)
    assert line.startswith("robot.platform.mass ")
    assert "requires less than the study, " in line and line.endswith("in place of 100 kg.")
    assert [one["asks_for"] for one in found.to_dict()["variables"]] == [None, "less"]


@pytest.mark.slow
def test_the_answer_keeps_the_bounds_even_where_the_robot_as_given_does_not(
    tmp_path: Path,
) -> None:
    plan = OF_POSE.replace("[6 m, 12 m]", "[6 m, 9 m]").replace("[-4 m, 6 m]", "[1 m, 2 m]")
    found = optimum(tmp_path, plan.replace("150", "30"))
    assert found.best.values == (1.0, 9.0)  # the given ones of 0 and 10 m pull with less
    assert not found.is_better and found.holds
    assert "Outside the bounds in the robot as given: shift and" in " ".join(trust_lines(found))
    assert [found._variable(k)["at_bound"] for k in range(2)] == ["lower", "upper"]


@pytest.mark.slow
def test_no_design_that_holds_is_no_flat_optimum(tmp_path: Path) -> None:
    found = optimum(
        tmp_path,
        OF_POSE.replace("150", "10"),
        STUDY.replace("pose: [10, 6, 4]", "pose: [10, 6, 14]"),
    )
    assert not found.holds
    line = next(one for one in trust_lines(found) if one.startswith("No start reached a design"))
    count = len(found.searched.trials) - 1  # without the robot as given
    assert (
        f"of {count}\N{NO-BREAK SPACE}designs: the configured pose: no taut cables hold it." in line
    )
    report = optimum_report(found, found.optimised.provenance.created)
    assert len(pictures(report)) == 1  # the robot: there is nothing to show of an objective


@pytest.mark.slow
def test_no_design_that_is_a_study_is_told_with_its_reason(tmp_path: Path) -> None:
    plan = OF_YARD.replace("width: {fields: {robot.anchors.0.0: -1, robot.anchors.1.0: 1}, ", "")
    plan = plan.replace("offset: [-1 m, 2 m]}", "workspace.region.z.*: [2 m, 3 m]")
    with pytest.raises(DesignerError, match=r"^masts: variables: no design .* is not below the"):
        optimum(tmp_path, plan, YARD)


def test_a_study_with_aliases_is_changed_where_it_was_asked(tmp_path: Path) -> None:
    study = STUDY.replace("[0, 0, 10]", "[0, 0, &z 10]").replace("[10, 17, 10]", "[10, 17, *z]")
    plan = OF_POSE.replace("robot.anchors[*][2]", "robot.anchors[0][2]").replace("150", "10")
    found = optimum(tmp_path, plan, study)
    heights = found.optimised.study.robot.exit_points_m[:, 2].tolist()
    assert heights == [found.best.values[1], 10.0, 10.0] != [10.0] * 3


def test_the_package_offers_it(tmp_path: Path) -> None:
    found = designer.optimise(written(tmp_path, OF_POSE.replace("150", "10")), with_plugins=False)
    assert isinstance(found, designer.Optimum)


@pytest.mark.slow
def test_the_command_writes_all_or_nothing(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    path = written(tmp_path, OF_YARD, YARD)
    monkeypatch.setattr(sys, "argv", ["designer", "optimise", path.name, "--no-plugins"])
    with pytest.raises(SystemExit) as done:
        main()
    assert done.value.code == 0
    assert "Mass of all ropes" in capsys.readouterr().out
    folder = tmp_path / "masts-optimum"
    for name in ("optimise.pdf", "comparison.html", "given/report.pdf", "optimised/report.pdf"):
        assert (folder / name).stat().st_size > 0
    path.write_text(OF_YARD.replace("rope_mass", "rope"))
    monkeypatch.setattr(sys, "argv", ["designer", "optimise", path.name, "-o", "other"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert "masts.yaml:2: objective: 'rope' is not known" in capsys.readouterr().err
    assert not (tmp_path / "other").exists()


@pytest.mark.parametrize(
    ("path", "before", "after", "is_worse"),
    [
        ("workspace.stiffness.largest_displacement_m_per_N", 1e-5, 2e-5, True),
        ("workspace.stiffness.largest_displacement_m_per_N", 2e-5, 1e-5, False),
        ("workspace.interference.min_distance_m", 0.4, 0.2, True),
        ("workspace.interference.min_distance_m", 0.2, 0.4, False),
        ("workspace.interference.min_distance_m", 0.4, 0.39, False),
        ("selection.chosen.total_mass_kg", 4.0, 8.0, False),
    ],
)
def test_what_gets_worse_unasked_is_named(
    path: str, before: float, after: float, is_worse: bool
) -> None:
    line = ComparisonLine(path, "", before, after)
    only_compared = SimpleNamespace(comparison=SimpleNamespace(answers=[line]))
    assert Optimum.worsened.fget(only_compared) == ([line] if is_worse else [])  # type: ignore[attr-defined]
