"""`designer import`: a whole study, one with gaps, refusals, and damaged files."""

from __future__ import annotations

import random
import re
import sys

import numpy as np
import pytest
from models import EXITS, FREE, HELD, LIMITS, bodies, cables, link, wirex, write_caspr

from designer.cli.commands import main
from designer.errors import InputError
from designer.foreign.study import ImportAnswers, gaps, read_foreign, study_text
from designer.io.config import read_study
from designer.study import require_enough_cables

GRADE = ("--grade", "unirope-7x19-galvanised")


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["designer", *arguments])
        try:
            main()
            status = 0
        except SystemExit as stop:
            status = int(stop.code or 0)
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return command


def test_a_whole_study(run, tmp_path) -> None:
    joint = FREE.replace("0 0 0", "0.1 0 0.2", 1)
    assert "0.1 0 0.2" in joint
    path = write_caspr(tmp_path, bodies(link(joint=f"{joint} {LIMITS}")), cables())
    status, out, err = run("import", str(path), "--payload", "30 kg", *GRADE)
    assert (status, err) == (0, "")
    assert "designer size rig.yaml" in out
    study = read_study(tmp_path / "rig.yaml")
    require_enough_cables(study)
    assert study.robot.platform.mass_kg == 50.0
    assert study.robot.tension_min_N == 5.0
    assert study.robot.winches.tension_max_N == 900.0
    assert np.allclose(study.robot.exit_points_m, EXITS)
    assert np.allclose(study.robot.attachments_m, HELD)
    assert np.allclose(study.pose.position_m, [0.5, 0, 2])
    a, c = 0.1, 0.2  # turned about x, then about its own z
    turn = [
        [np.cos(c), -np.sin(c), 0],
        [np.cos(a) * np.sin(c), np.cos(a) * np.cos(c), -np.sin(a)],
        [np.sin(a) * np.sin(c), np.sin(a) * np.cos(c), np.cos(a)],
    ]
    assert np.allclose(study.pose.rotation, turn)


def test_gaps_are_told_by_name_and_line_and_refuse_the_study(run, tmp_path) -> None:
    path = tmp_path / "rig.wcrfx"
    path.write_text(wirex("", "", ""), encoding="utf-8")
    status, out, _ = run("import", str(path), "-o", "mine.yaml")
    assert status == 1
    told = re.findall(r"line (\d+): (\S+) \((--\S+)\)", out)
    fields = ["robot.platform.mass", "robot.platform.centre_of_mass", "cable", "pose"]
    assert [field for _, field, _ in told] == fields
    lines = (tmp_path / "mine.yaml").read_text(encoding="utf-8").splitlines()
    for number, field, _ in told:
        assert field.rpartition(".")[2] in lines[int(number) - 1]
    status, _, err = run("size", "mine.yaml")
    assert status == 2
    assert [line.split(": ")[:2] for line in err.splitlines()] == [
        [f"mine.yaml:{number}", field] for number, field, _ in told
    ]
    options = ("--mass", "40 kg", "--centre-of-mass", "0,0,0", "--pose", "0,0,2", *GRADE)
    assert run("import", str(path), *options)[0] == 0
    assert read_study(tmp_path / "rig.yaml").robot.platform.mass_kg == 40.0


def test_a_rope_without_its_safety_factor(run, tmp_path) -> None:
    path = tmp_path / "rig.wcrfx"
    path.write_text(wirex(), encoding="utf-8")
    status, out, _ = run("import", str(path), "--pose", "0,0,2")
    assert status == 1
    assert "cable.allowable_stress (--safety-factor)" in out
    (tmp_path / "rig.yaml").unlink()
    assert run("import", str(path), "--pose", "0,0,2", "--safety-factor", "5")[0] == 0
    study = read_study(tmp_path / "rig.yaml")
    stress = 9000 / (np.pi * 0.002**2)
    assert study.material.allowable_stress_Pa == pytest.approx(stress / 5)
    assert [one.id for one in study.effects] == ["pulley_radius"]


def test_planes(run, tmp_path) -> None:
    flat = 'type="PLANAR_XY" q_initial="0 2 0"'
    exits = [(x, y, 0) for x, y, _ in [(-3, 4, 0), (3, 4, 0), (-3, 0, 0), (3, 0, 0)]]
    held = [(x, y, 0) for x in (-0.2, 0.2) for y in (-0.1, 0.1)]
    text = bodies(link(joint=flat, centre="0 0 0"))
    path = write_caspr(tmp_path, text, cables(exits, held))
    status, _, err = run("import", str(path), *GRADE)
    assert status == 2
    assert "a plane that is not upright" in err
    assert not (tmp_path / "rig.yaml").exists()
    assert run("import", str(path), "--gravity", "0,-1,0", *GRADE)[0] == 0
    study = read_study(tmp_path / "rig.yaml")
    assert study.robot.is_planar
    assert study.robot.degrees_of_freedom == 3


def test_so_few_cables_choose_no_tension(tmp_path) -> None:
    text = cables(EXITS[:6], HELD[:6])
    robot = read_foreign(write_caspr(tmp_path, bodies(), text))
    assert "tension_min:" not in study_text(robot, ImportAnswers())
    assert "asks for 5 N at least" in study_text(robot, ImportAnswers())


def test_largest_tension_waits_for_a_workspace(run, tmp_path) -> None:
    differing = cables().replace("<force_max>900<", "<force_max>700<", 1)
    path = write_caspr(tmp_path, bodies(), differing)
    robot = read_foreign(path)
    assert (robot.tension_max_N, robot.limits_m) == ((700.0, *[900.0] * 7), None)
    text = study_text(robot, ImportAnswers())
    assert f"  # winches: {{tension_max: [700 N{', 900 N' * 7}]}}" in text
    assert run("import", str(path), *GRADE)[0] == 0
    assert read_study(tmp_path / "rig.yaml").robot.winches.tension_max_N is None


def test_remarks_are_printed_and_stand_in_the_study(run, tmp_path) -> None:
    at_one = cables(EXITS, [(0, 0, 0)] * 8).replace("<force_max>900<", "<force_max>1e10<")
    path = write_caspr(tmp_path, bodies(link(joint=f"{FREE} {LIMITS}", centre="0 0 0")), at_one)
    status, out, _ = run("import", str(path), *GRADE)
    assert status == 0
    text = (tmp_path / "rig.yaml").read_text()
    for remark in (
        "All cables hold the platform at one point",
        "The file has a largest tension of",
    ):
        assert f"\n  {remark}" in out
        assert f"\n  # {remark}" in text
    assert "8 cables on a point mass" in out
    study = read_study(tmp_path / "rig.yaml")
    assert study.robot.degrees_of_freedom == 3
    assert study.robot.winches.tension_max_N is None


def test_a_name_that_yaml_takes_for_something_else(run, tmp_path) -> None:
    odd = bodies(link().replace("Test rig", "yes: #1 &quot;fill in&quot;&#10;robot: fill in"))
    path = write_caspr(tmp_path, odd, cables())
    assert run("import", str(path), *GRADE)[0] == 0
    assert read_study(tmp_path / "rig.yaml").name == 'yes: #1 "fill in"\nrobot: fill in'


@pytest.mark.parametrize(
    ("name", "read"), [("A&#x7f;&#x85;&#xFEFF;", "A\x7f\x85\ufeff"), ("", "rig"), (" ", "rig")]
)
def test_names_that_yaml_does_not_take(run, tmp_path, name: str, read: str) -> None:
    path = write_caspr(tmp_path, bodies(link().replace("Test rig", name)), cables())
    assert run("import", str(path), *GRADE)[0] == 0
    assert read_study(tmp_path / "rig.yaml").name == read


@pytest.mark.parametrize(
    "limits",
    [
        'q_min="0 0 1 0 0 0" q_max="0 0 3 0 0 0"',
        'q_min="1 1 3 0 0 0" q_max="-1 -1 1 0 0 0"',
        'q_min="-1 -1" q_max="1 1"',
    ],
)
def test_limits_that_span_no_region_are_told_and_left_out(run, tmp_path, limits: str) -> None:
    path = write_caspr(tmp_path, bodies(link(joint=f"{FREE} {limits}")), cables())
    assert run("import", str(path), *GRADE)[0] == 0
    assert read_study(tmp_path / "rig.yaml").workspace is None
    text = (tmp_path / "rig.yaml").read_text()
    assert "span no region: [" in text
    assert "serve; the file does not tell" not in text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--mass", "heavy"), "--mass: 'heavy' is not a number"),
        (("--mass", "-3 kg"), "robot.platform.mass: "),
        (("--payload", "-1 kg"), "--payload: -1 kg is too small (expected 0 or more)"),
        (("--safety-factor", "0"), "--safety-factor: 0 is too small (expected 1 or more)"),
        (("--pose", "1,2"), "--pose: '1,2' is no point"),
        (("--pose", "1,2,3 kg"), "--pose: '3 kg'"),
        (("--gravity", "0,0,-1e-300"), "robot.gravity: the direction is smaller than any"),
        (("--grade", "no-such-grade"), "no-such-grade"),
        (("--cable-set", "none"), "there is no cable set 'none'"),
    ],
)
def test_options_that_are_wrong(run, tmp_path, options: tuple[str, ...], said: str) -> None:
    path = write_caspr(tmp_path, bodies(), cables())
    given = options if "--grade" in options else (*options, *GRADE)
    status, _, err = run("import", str(path), *given)
    assert status == 2
    assert len(err.splitlines()) == 1
    assert said in err
    assert not (tmp_path / "rig.yaml").exists()


def test_a_robot_that_no_study_can_hold_is_refused_in_its_files_name(run, tmp_path) -> None:
    path = write_caspr(tmp_path, bodies(), cables([(x, 0, z) for x, _, z in EXITS], HELD))
    status, _, err = run("import", str(path), *GRADE)
    assert status == 2
    assert err.startswith(f"{path}: robot.anchors")


def test_nothing_is_overwritten(run, tmp_path) -> None:
    path = write_caspr(tmp_path, bodies(), cables())
    (tmp_path / "rig.yaml").write_text("mine", encoding="utf-8")
    status, _, err = run("import", str(path), *GRADE)
    assert status == 2
    assert "exists already" in err
    assert (tmp_path / "rig.yaml").read_text(encoding="utf-8") == "mine"


def test_the_text_of_gaps_alone_counts(tmp_path) -> None:
    robot = read_foreign(write_caspr(tmp_path, bodies(), cables()))
    assert [gap.field for gap in gaps(study_text(robot, ImportAnswers()))] == ["cable"]
    with pytest.raises(InputError):
        read_foreign(tmp_path / "none.xml")


_SWAPS = [
    ("<", ">"), ("1", "x"), ("2", "1e400"), ("0", "nan"), ("link", "lonk"), ("num", "none"),
    ("cable", "cabel"), ("radius", "radii"), ("3R3T", "1R2T"), ("q_initial", "q_min"),
    ("SPATIAL_EULER_XYZ", "PLANAR_XZ"), ("mass", "mess"), ("5", "-5"), ("location", "place"),
]  # fmt: skip


def spoilt(text: str, rng: random.Random) -> str:
    at = rng.randrange(len(text))
    end = at + rng.randint(1, 60)
    kind = rng.randrange(4)
    if kind == 0:
        return text[:at] + text[end:]
    if kind == 1:
        return text[:end] + text[at:end] + text[end:]
    if kind == 2:
        return text[:at] + chr(rng.choice([0, 9, 34, 38, 48, 60, 955, 0x1F600])) + text[at + 1 :]
    old, new = rng.choice(_SWAPS)
    return text[:at] + text[at:].replace(old, new, 1)


@pytest.mark.slow
def test_damaged_files(tmp_path) -> None:
    rng = random.Random(3)
    whole = bodies(link(joint=f"{FREE} {LIMITS}")), cables(), wirex()
    read = 0
    for number in range(450):
        which = number % 3
        texts = list(whole)
        texts[which] = spoilt(texts[which], rng)
        path = write_caspr(tmp_path, texts[0], texts[1])
        if which == 2:
            path = tmp_path / "rig.wcrfx"
            path.write_text(texts[2], encoding="utf-8")
        try:
            gaps(study_text(read_foreign(path), ImportAnswers()))
            read += 1
        except InputError as error:
            assert len(str(error).splitlines()) == 1
    assert 20 < read < 430


@pytest.mark.parametrize("options", [("--cables", "other.xml"), ("--cable-set", "few")])
def test_options_of_models_in_two_files_are_refused_for_others(run, tmp_path, options) -> None:
    (tmp_path / "rig.wcrfx").write_text(wirex("", "", ""), encoding="utf-8")
    status, _, err = run("import", "rig.wcrfx", *options)
    expected = "no --cables, --bodies or --cable-set"
    assert (status, err) == (2, f"rig.wcrfx: is no model of CASPR (expected {expected})\n")
    assert not (tmp_path / "rig.yaml").exists()
