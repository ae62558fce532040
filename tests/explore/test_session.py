"""A study that is edited, and where the platform is put."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from pairs.agreement import Situation
from pairs.options import BY_ID, GRADES, PATHS, POSES, file_text, files_of, study_of
from pairs.reference import Pose, solve
from pairs.scenario import turn_at
from scipy.spatial.transform import Rotation

from designer.errors import InputError, OutputError
from designer.explore.answers import full_ropes, values_at, worst_answer
from designer.explore.fields import Field
from designer.explore.question import Question, Rope
from designer.explore.session import Session
from designer.plugins import Plugins
from designer.resources import data_folder, example_file, example_names

MASS = "robot.platform.mass"
LOW, HIGH = "workspace.region.z[0]", "workspace.region.z[1]"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A study of one's own."""
    path = tmp_path / "crane.yaml"
    path.write_bytes(example_file("yard").read_bytes())
    return path


def other_value(one: Field, rng: random.Random) -> str:
    """Return a value that a field does not have, though perhaps one that is refused."""
    if one.kind == "choice":
        return next(word for word in one.choices if word != one.text)
    if one.kind == "count":
        return str(int(one.value_SI or 1) + 1)
    low, high = one.low, one.high
    if low is None or high is None:
        value = one.value_SI or 0.0
        return one.text_of(value + (0.1 if abs(value) < 1e4 else 0.1 * value))
    return one.text_of(low + rng.uniform(0.2, 0.8) * (high - low))


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", example_names())
def test_random_steps_are_undone_to_the_letter(name: str, example: Any) -> None:
    rng, session = random.Random(name), example(name)
    texts = [session.text]
    for _ in range(12):
        one = rng.choice(session.fields())
        if session.edit(one.path, other_value(one, rng)) == () and session.text != texts[-1]:
            texts.append(session.text)
        assert session.faults == ()
        session.rejected.clear()
    assert len(texts) > 4
    for text in reversed(texts[:-1]):
        session.undo()
        assert session.text == text
    assert not session.undo_label
    for text in texts[1:]:
        session.redo()
        assert session.text == text
    assert not session.redo_label


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", example_names())
def test_each_field_is_put_back_alone(name: str, example: Any) -> None:
    rng, session = random.Random(name), example(name)
    original = session.text
    session.edit(MASS, "77 kg")
    changed = session.text
    fields = [one for one in session.fields() if one.path != MASS]
    for one in rng.sample(fields, 14):
        if session.edit(one.path, other_value(one, rng)):
            session.rejected.clear()
            continue
        assert session.differing == {MASS, one.path}
        assert session.put_back(one.path) == ()
        assert session.text == changed
    session.put_back(MASS)
    assert session.text == original
    assert not session.is_modified


@pytest.mark.parametrize("name", example_names())
def test_own_texts_change_nothing(name: str, example: Any) -> None:
    session: Session = example(name)
    for one in session.fields():
        assert session.edit(one.path, one.text) == ()
    assert not session.undo_label


def test_comments_and_layout_are_kept(yard: Session) -> None:
    before = yard.text.splitlines()
    yard.edit(MASS, "0.2 t")
    yard.edit("robot.anchors[1][2]", "12 m")
    changed = [line for line in yard.text.splitlines() if line not in before]
    assert changed == [
        "  anchors: [[0, 0, 11.5], [30, 0, 12 m], [15, 26, 11.5]]    # sheaves near the mast tops",
        "    mass: 0.2 t",
    ]
    assert len(yard.text.splitlines()) == len(before)


def test_a_wrong_entry_is_told_and_the_last_study_lives_on(yard: Session) -> None:
    study = yard.study
    (fault,) = yard.edit(MASS, "180 m")
    assert (fault.field, fault.problem) == (MASS, "'180 m' has the unit meter")
    assert yard.rejected[MASS].text == "180 m"
    assert yard.study is study
    assert yard.faults == ()
    assert not yard.undo_label
    assert yard.edit(MASS, "181 kg") == ()
    assert yard.rejected == {}


@pytest.mark.parametrize(
    "typed", ["", "[1, 2]", "{a: 1}", "*x", "180 kg # heavy", "'", "nan", "\n"]
)
def test_an_entry_never_breaks_the_text(yard: Session, typed: str) -> None:
    before = yard.text
    assert yard.edit(MASS, typed) != ()
    assert yard.text == before


def test_two_entries_that_go_together_are_taken_together(yard: Session) -> None:
    assert yard.edit(LOW, "9 m") != ()  # above the upper end
    assert yard.edit(HIGH, "10 m") == ()
    assert yard.rejected == {}
    assert "z: [9 m, 10 m]" in yard.text


def test_an_entry_of_its_own_is_not_held_up_by_a_wrong_one(yard: Session) -> None:
    assert yard.edit(LOW, "9 m") != ()
    assert yard.edit(MASS, "190 kg") == ()
    assert set(yard.rejected) == {LOW}


def test_optional_values_come_and_go(yard: Session) -> None:
    before = yard.text
    assert yard.edit("workspace.floor", "0 m") == ()
    assert yard.study is not None
    assert yard.study.workspace is not None
    assert yard.study.workspace.floor_m == 0.0
    assert yard.edit("workspace.floor", "") == ()
    assert yard.text == before


def test_a_short_pose_is_written_out_for_a_turn(example: Any) -> None:
    session = example("ipanema")
    before = session.text
    assert session.edit("pose.rotation_vector[2]", "10 deg") == ()
    assert (
        "pose: {position: [0.2, 0.1, 1], rotation_vector: [0 rad, 0 rad, 10 deg]}" in session.text
    )
    assert np.allclose(session.state.place, [0.2, 0.1, 1, 0, 0, np.radians(10)])
    assert session.edit("pose.position[0]", "0.3") == ()
    assert "position: [0.3, 0.1, 1]" in session.text
    session.undo()
    session.undo()
    assert session.text == before


def test_what_goes_on_is_one_step(yard: Session) -> None:
    for k in range(20):
        yard.edit(MASS, f"{181 + k} kg", continuous=True)
    yard.settle()
    yard.edit(MASS, "300 kg", continuous=True)
    for k in range(20):
        yard.move([15.0, 9.0, 4.0 + 0.1 * (k + 1)], continuous=True)
    assert (yard.undo_label, yard.state.place[2]) == ("Move the platform", pytest.approx(6.0))
    yard.undo()
    assert yard.state.place[2] == pytest.approx(4.0)
    yard.undo()
    assert "mass: 200 kg" in yard.text
    yard.undo()
    assert not yard.undo_label
    assert "mass: 180 kg" in yard.text


def test_rope_pin_and_place_are_undone_too(yard: Session) -> None:
    rope, pin = Rope("unirope-7x19-galvanised", "7/32 in"), object()
    yard.choose(rope)
    yard.set_pin(pin)
    yard.move([1.0, 2.0, 3.0])
    state = yard.state
    assert (state.rope, state.pin) == (rope, pin)
    yard.undo()
    yard.undo()
    assert (yard.state.rope, yard.state.pin) == (rope, None)
    yard.undo()
    assert yard.state.rope is None
    assert not yard.is_modified  # none of these is part of the study
    for _ in range(3):
        yard.redo()
    assert yard.state is state


def test_the_place_is_kept_as_the_pose(example: Any) -> None:
    yard = [14.0, 8.5 / 3.0, 3.25, 0, 0, 0]
    for name, place in (("yard", yard), ("cogiro", [0.5, 0, 1, 0, 0, 0.1])):
        session: Session = example(name)
        session.move(place)
        assert session.keep_pose() == ()
        assert session.study is not None
        assert session.study.pose is not None
        assert np.allclose(session.study.pose.place, place)
        assert np.array_equal(session.study.pose.place, session.state.place)
        assert any(path.startswith("pose") for path in session.differing)


def test_saved_with_comments_and_taken_up_again(file: Path, no_plugins: Plugins) -> None:
    session = Session.open(file, no_plugins)
    session.edit(MASS, "250 kg")
    assert session.is_modified
    session.save()
    assert not session.is_modified
    assert session.differing == frozenset()
    assert file.read_text(encoding="utf-8") == session.text
    assert "# sheaves near the mast tops" in file.read_text(encoding="utf-8")
    session.undo()
    assert session.is_modified
    assert session.differing == {MASS}
    assert [one.name for one in file.parent.iterdir()] == [file.name]


def test_a_shipped_study_is_saved_elsewhere(yard: Session, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="another name"):
        yard.save()
    assert yard.disk() == "never saved"
    yard.edit(MASS, "250 kg")
    yard.save_as(tmp_path / "mine.yaml")
    assert yard.file == tmp_path / "mine.yaml"
    assert (yard.disk(), yard.is_modified) == ("same", False)
    yard.undo()
    assert yard.is_modified
    assert yard.study is not None
    assert yard.study.source.path == tmp_path / "mine.yaml"


def test_a_file_that_cannot_be_written_is_told(yard: Session, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        yard.save_as(tmp_path / "no" / "such" / "folder.yaml")
    assert yard.file is None


def test_relative_paths_go_along(file: Path, no_plugins: Plugins, tmp_path: Path) -> None:
    one = min(data_folder("catalog").glob("*.yaml"))
    (tmp_path / "ropes").mkdir()
    (tmp_path / "ropes" / "own.yaml").write_bytes(
        one.read_bytes().replace(b"\nid: ", b"\nid: own-").replace(b"id: own-own-", b"id: own-")
    )
    file.write_text(
        file.read_text(encoding="utf-8") + "catalogues: [ropes/own.yaml]\n"
        "measurements:\n  file: log.csv   # by hand\n"
        "  cable: {linear_mass: 0.1 kg/m, axial_stiffness: 1 MN}\n",
        encoding="utf-8",
    )
    session = Session.open(file, no_plugins)
    assert session.faults == ()
    (tmp_path / "later").mkdir()
    session.save_as(tmp_path / "later" / "crane.yaml")
    assert "catalogues: [../ropes/own.yaml]" in session.text
    assert "file: ../log.csv   # by hand" in session.text
    assert session.study is not None
    assert session.study.catalogues[0].exists()


@pytest.mark.parametrize("empty", ["document:", "measurements:", "document: {logo: }"])
def test_a_field_that_is_empty_stays_so_elsewhere(
    file: Path, no_plugins: Plugins, tmp_path: Path, empty: str
) -> None:
    file.write_text(f"{file.read_text(encoding='utf-8')}{empty}\n", encoding="utf-8")
    session = Session.open(file, no_plugins)
    text = session.text
    (tmp_path / "later").mkdir()
    session.save_as(tmp_path / "later" / "crane.yaml")
    assert (session.faults, session.text) == ((), text)


def test_a_file_that_changes_or_vanishes(file: Path, no_plugins: Plugins) -> None:
    session = Session.open(file, no_plugins)
    session.edit(MASS, "250 kg")
    ours = session.text
    theirs = session.saved_text.replace("180 kg", "99 kg")
    file.write_text(theirs, encoding="utf-8")
    assert session.disk() == "changed"
    session.reload()
    assert (session.text, session.disk(), session.is_modified) == (theirs, "same", False)
    session.undo()  # what was ours is not lost
    assert session.text == ours
    file.unlink()
    assert session.disk() == "gone"
    with pytest.raises(InputError, match="no such file"):
        session.reload()
    assert session.text == ours
    session.save()
    assert session.disk() == "same"


def test_a_faulty_study_is_open_to_be_mended(file: Path, no_plugins: Plugins) -> None:
    good = file.read_text(encoding="utf-8")
    file.write_text(good.replace("180 kg", "180 m").replace("samples:", "sample:"), "utf-8")
    session = Session.open(file, no_plugins)
    assert [fault.line for fault in session.faults] == [9, 24]
    assert (session.study, session.fields(), session.question()) == (None, (), None)
    assert session.name == "crane"
    assert session.edit(MASS, "1 kg") != ()
    assert session.set_text(good) == ()
    assert session.study is not None
    assert session.faults == ()
    assert session.state.place[0] == 15.0
    assert session.set_text("robot: [") != ()
    assert session.study is not None  # the last that was sound
    session.undo()
    assert session.faults == ()


@pytest.mark.parametrize("content", ["", "a: [1", "just words", "- 1\n- 2\n", "\ta: 1"])
def test_any_text_opens(content: str, tmp_path: Path, no_plugins: Plugins) -> None:
    file = tmp_path / "odd.yaml"
    file.write_text(content, encoding="utf-8")
    session = Session.open(file, no_plugins)
    assert len(session.faults) >= 1
    assert session.text == content


def test_what_is_no_text_does_not_open(tmp_path: Path, no_plugins: Plugins) -> None:
    (tmp_path / "odd.yaml").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "large.yaml").write_bytes(b"# large\n" * 200_000)
    for path in (*tmp_path.iterdir(), tmp_path / "none.yaml", tmp_path):
        with pytest.raises(InputError):
            Session.open(path, no_plugins)


def test_turns_add_up_about_axes_of_the_frame_in_one_step(no_plugins: Plugins) -> None:
    session = Session.open(example_file("cogiro"), no_plugins)
    start = session.state.place
    session.turn(np.array([0.0, 0.0, 0.1]))
    session.turn(np.array([0.2, 0.0, 0.0]))
    second, first = Rotation.from_rotvec([0.2, 0.0, 0.0]), Rotation.from_rotvec([0.0, 0.0, 0.1])
    expected = second * first * Rotation.from_rotvec(start[3:].copy())
    assert np.allclose(session.state.place[3:], expected.as_rotvec(), atol=1e-14)
    assert np.array_equal(session.state.place[:3], start[:3])
    session.undo()
    assert np.array_equal(session.state.place, start)


def test_exit_point_keeps_units_and_is_one_step(yard: Session) -> None:
    yard.edit("robot.anchors[0][0]", "250 mm")
    text = yard.text
    points = yard.study.robot.exit_points_m
    for x_m in (0.4, 0.75):
        assert yard.move_exit_point(0, [x_m, *points[0, 1:]]) == ()
    yard.settle()
    assert yard.state.live.by_path["robot.anchors[0][0]"].text == "750 mm"
    assert yard.study.robot.exit_points_m[0].tolist() == [0.75, *points[0, 1:]]
    assert yard.undo_label == "Move exit point 1"
    yard.undo()
    assert yard.text == text
    faults = yard.move_exit_point(0, points[1])
    assert "is the same point as" in faults[0].problem
    assert yard.text == text


WIRE = "pairs-wire"


def asked(option: str, folder: Path, plugins: Plugins) -> tuple[dict, Question]:
    """Return a study with an option, on six cables, and what the window is asked, with its rope."""
    text = study_of("six", BY_ID[option]) | {"catalogues": ["wire.yaml"]}
    for name in files_of(text):
        (folder / name).write_text(file_text(name), encoding="utf-8")
    (folder / "wire.yaml").write_text(yaml.safe_dump(GRADES[WIRE]), encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(text), encoding="utf-8")
    question = Session.open(path, plugins).question()
    assert question is not None
    ropes = full_ropes(question)
    assert ropes is not None and ropes.best is not None
    return text, replace(question, rope=ropes.best)


def situation(text: dict, rope: Rope) -> Situation:
    (size,) = [size for size in GRADES[WIRE]["sizes"] if str(size["id"]) == rope.size_id]
    return Situation(text, [(GRADES[WIRE], size)] * 6, {})


@pytest.mark.slow
@pytest.mark.parametrize("option", ["poses", "path", "toward", "table"])
def test_worst_pose_is_that_of_the_reference(
    option: str, tmp_path: Path, no_plugins: Plugins
) -> None:
    text, question = asked(option, tmp_path, no_plugins)
    assert isinstance(question.rope, Rope)
    worst = worst_answer(question)
    assert worst is not None and worst.rope is not None
    there, pose = situation(text, question.rope), Pose.of(worst.place)
    state = solve(there.problem_at(pose), pose)
    assert state is not None
    assert worst.rope.utilisation == pytest.approx(state.utilisation, rel=1e-6)
    if option == "path":
        first, last = np.array(PATHS[text["workspace"]["path"]])
        along = (worst.place[:3] - first) @ (last - first) / ((last - first) @ (last - first))
        assert worst.place[:3] == pytest.approx(first + along * (last - first), abs=1e-6)
        return
    rows = POSES[text["workspace"]["poses"]] if option == "poses" else []
    poses = [Pose(np.array(at), np.array(turn)) for at, turn, _ in rows]
    for at in text["workspace"].get("region", {}).get("points", ()):
        turn = turn_at(text, np.array(at))
        assert turn is not None
        poses.append(Pose(np.array(at), turn))
    states = [solve(there.problem, each) for each in poses]
    used = [np.inf if state is None else state.utilisation for state in states]
    assert worst.rope.utilisation == pytest.approx(max(used), rel=1e-6)
    assert question.workspace is not None
    if option != "poses":  # of which several may be at one position
        positions = np.array([each.position_m for each in poses])
        values = values_at(question, question.workspace, positions, frozenset({"utilisation"}))
        assert values["utilisation"] == pytest.approx(used, rel=1e-6)
