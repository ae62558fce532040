"""What is no regular file is refused at once, whatever command is to read or to write it."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from designer.cli.commands import main
from designer.documents.opened import open_input

pytestmark = pytest.mark.skipif(os.name != "posix", reason="pipes and devices of POSIX")
STUDY = """robot:
  anchors: [[0, 0, 10], [20, 0, 10], [10, 17, 10]]
  platform: {mass: 100 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 60 GPa, allowable_stress: 200 MPa}
pose: [10, 6, 4]
"""
LOG = """measurements:
  file: pipe.csv
  cable: {linear_mass: 0.4 kg/m, axial_stiffness: 6 MN}
  noise: {length: 1 mm, tension: 5 N}
"""
GRADES = """catalogues: [pipe.yaml]
workspace: {region: {prism: anchors, z: [1 m, 4 m], inset: 2 m}, samples: 50}
selection: {grades: all}
"""
COMMANDS = {
    "size": "size pipe.yaml",
    "report": "report pipe.yaml",
    "logo": "report logo.yaml",
    "grades": "report grades.yaml",
    "template": "report study.yaml --template templates",
    "diagnose": "diagnose log.yaml",
    "data": "diagnose log.yaml --data pipe.csv",
    "check": "catalog check pipe.yaml",
    "sweep": "sweep pipe.yaml",
    "study of a sweep": "sweep sweep.yaml",
    "optimise": "optimise pipe.yaml",
    "compare": "compare pipe.json study.yaml",
    "import": "import pipe.xml",
    "poses": "lengths study.yaml --poses pipe.csv",
}


@pytest.mark.parametrize("kind", ["pipe", "device"])
@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)
def test_only_regular_files_are_opened(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: str,
    kind: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "templates").mkdir()
    (tmp_path / "templates" / "report.css").write_text("")
    names = ("pipe.yaml", "pipe.csv", "pipe.json", "pipe.xml", "pipe.svg", "templates/more.j2")
    for name in names:
        os.mkfifo(name) if kind == "pipe" else Path(name).symlink_to("/dev/zero")
    Path("study.yaml").write_text(STUDY)
    Path("logo.yaml").write_text(f"{STUDY}document: {{logo: pipe.svg}}\n")
    Path("grades.yaml").write_text(STUDY + GRADES)
    Path("log.yaml").write_text(STUDY + LOG)
    vary = "vary: {robot.platform.mass: [1, 2]}\nkeep: [name]\n"
    Path("sweep.yaml").write_text(f"study: pipe.yaml\n{vary}")
    before = sorted(path.name for path in tmp_path.iterdir())
    monkeypatch.setattr("sys.argv", ["designer", *command.split(), "--no-plugins"])
    with pytest.raises(SystemExit) as stopped:
        main()
    told = capsys.readouterr().err
    assert stopped.value.code == 2
    assert len(told.splitlines()) == 1
    assert "pipe" in told or "more.j2" in told
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_a_file_that_is_exchanged_for_a_pipe_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a"
    path.write_text("")
    os.mkfifo(tmp_path / "pipe")
    state = path.stat()
    shutil.move(tmp_path / "pipe", path)
    monkeypatch.setattr(Path, "stat", lambda self: state)
    with pytest.raises(OSError, match="it is a pipe, not a file"):
        open_input(path)


REGION = "workspace: {region: {prism: anchors, z: [1 m, 4 m], inset: 2 m}, samples: 50}\n"
WRITING = {
    "schema": "schema -o {}",
    "lengths": "lengths study.yaml --poses poses.csv -o {}.csv",
    "export": "export study.yaml --to caspr -o {}_bodies.xml",
    "verify": "verify -o {}",
    "plan": "diagnose --plan region.yaml --unknown anchors --length-noise 1mm -o {}.csv",
    "report": "report study.yaml -o {}",
    "compare": "compare study.yaml study.yaml -o {}",
    "init": "init {}",
}


@pytest.mark.parametrize("name", ["pipe", "x" * 256])
@pytest.mark.parametrize("command", WRITING.values(), ids=WRITING)
def test_an_output_that_is_no_file_is_refused_before_the_work(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: str,
    name: str,
) -> None:
    def work(*_: object, **__: object) -> None:
        raise AssertionError

    for place in (
        "designer.analysis.analyse.Analysis.begin",
        "designer.reference.page.compute",
        "designer.exports.robot.ExportedRobot.of",
        "designer.diagnosis.plan.plan",
    ):
        monkeypatch.setattr(place, work)
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    Path("region.yaml").write_text(STUDY + REGION)
    Path("poses.csv").write_text("x_m,y_m,z_m\n10,6,4\n")
    if name == "pipe":
        for ending in ("", ".csv", "_bodies.xml"):
            os.mkfifo(f"pipe{ending}")
    before = sorted(path.name for path in tmp_path.iterdir())
    monkeypatch.setattr("sys.argv", ["designer", *command.format(name).split()])
    with pytest.raises(SystemExit) as stopped:
        main()
    told = capsys.readouterr().err
    assert stopped.value.code == 2
    assert len(told.splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == before
    assert not any(path.is_file() for path in tmp_path.glob("pipe*"))
