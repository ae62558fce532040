"""The worker: the newest request wins, nothing is lost, and it ends whenever it is told to."""

from __future__ import annotations

import importlib
import os
import pkgutil
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from designer import kernel
from designer.explore import worker as worker_module
from designer.explore.answers import PoseAnswer, Ropes, full_ropes
from designer.explore.export import rope_table
from designer.explore.question import Long, Question, Quick, Request, Rope, failure_text
from designer.explore.session import Session
from designer.explore.worker import Helper
from designer.model.robot import Poses
from designer.plugins import Plugins, find_plugins
from designer.progress import checkpoint, interrupted_by
from designer.resources import example_file
from designer.statics.inverse import solve_sagging


class Work:
    """Stands in for an answer: goes on until it is let go, and looks up now and then."""

    def __init__(self) -> None:
        self.began, self.may_end = threading.Event(), threading.Event()

    def __call__(self, *_: Any, **__: Any) -> str:
        self.began.set()
        while not self.may_end.is_set():
            checkpoint()
            time.sleep(0.001)
        return "worked"


@pytest.fixture
def work(monkeypatch: pytest.MonkeyPatch) -> Work:
    """In place of the search for the worst pose."""
    one = Work()
    monkeypatch.setattr(worker_module, "worst_answer", one)
    return one


def question_of(session: Session) -> Question:
    question = session.question()
    assert question is not None
    return question


def other(session: Session) -> Question:
    """The same with another load."""
    session.edit("robot.platform.mass", "181 kg")
    return question_of(session)


def test_the_pose_is_answered_in_the_middle_of_longer_work(
    work: Work, asker: Any, yard: Session
) -> None:
    long = asker.ask("worst", yard.question())
    assert work.began.wait(10.0)
    found = asker.end_of(asker.ask("pose", yard.question()))
    assert found.status == "done"
    assert isinstance(found.answer, PoseAnswer)
    work.may_end.set()
    end = asker.end_of(long)
    assert (end.status, end.answer) == ("done", "worked")


def test_work_for_an_older_study_is_given_up(work: Work, asker: Any, yard: Session) -> None:
    long = asker.ask("worst", yard.question())
    assert work.began.wait(10.0)
    asker.ask("pose", other(yard))
    assert asker.end_of(long).status == "cancelled"


def test_a_newer_request_of_its_kind_takes_the_place(work: Work, asker: Any, yard: Session) -> None:
    first = asker.ask("worst", yard.question())
    assert work.began.wait(10.0)
    work.began.clear()
    second = asker.ask("worst", yard.question())
    assert asker.end_of(first).status == "cancelled"
    assert work.began.wait(10.0)
    work.may_end.set()
    assert asker.end_of(second).status == "done"


def test_of_many_that_wait_the_newest_is_answered(work: Work, asker: Any, yard: Session) -> None:
    long = asker.ask("fine", yard.question())
    asker.end_of(long)
    asker.ask("worst", yard.question())
    assert work.began.wait(10.0)
    with asker.worker._changed:  # nothing is taken up meanwhile
        places = [[15.0, 9.0, 2.0 + k] for k in range(5)]
        numbers = []
        for place in places:
            yard.move(place)
            numbers.append(asker.ask("pose", yard.question()))
    ends = [asker.end_of(number) for number in numbers]
    assert [end.status for end in ends] == ["cancelled"] * 4 + ["done"]
    assert np.allclose(ends[-1].question.place[:3], places[-1])


def test_cancelled_on_request(work: Work, asker: Any, yard: Session) -> None:
    long = asker.ask("worst", yard.question())
    assert work.began.wait(10.0)
    asker.worker.cancel("worst")
    assert asker.end_of(long).status == "cancelled"
    asker.worker.cancel("worst")  # nothing to cancel
    work.may_end.set()
    assert asker.end_of(asker.ask("worst", yard.question())).status == "done"


def test_each_request_comes_to_one_end(asker: Any, yard: Session) -> None:
    rng = np.random.default_rng(7)
    numbers = []
    for _ in range(60):
        kind = rng.choice(["pose", "coarse", "fine", "ropes", "worst"])
        if rng.random() < 0.2:
            yard.edit("robot.platform.mass", f"{180 + rng.random():.6f} kg")
        numbers.append(asker.ask(str(kind), yard.question()))
        if rng.random() < 0.1:
            asker.worker.cancel(str(kind))
        time.sleep(0.01 * rng.random())
    for number in numbers:
        asker.end_of(number)
    ends = [one.number for one in asker.seen if one.is_end]
    assert sorted(ends) == numbers
    last = {one.kind: one for one in asker.seen if one.is_end}
    assert all(one.status == "done" for one in last.values() if one.kind == "pose")


def test_a_failure_is_told_and_the_next_request_answered(asker: Any, yard: Session) -> None:
    yard.choose(Rope("unirope-7x19-galvanised", "1 parsec"))
    end = asker.end_of(asker.ask("pose", yard.question()))
    assert end.status == "failed"
    assert end.text == "the grade unirope-7x19-galvanised has no size 1 parsec"
    yard.undo()
    assert asker.end_of(asker.ask("pose", yard.question())).status == "done"


def test_an_unexpected_failure_is_told_too(
    asker: Any, yard: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(*_: Any, **__: Any) -> None:
        raise ZeroDivisionError("by\nzero")

    monkeypatch.setattr(worker_module, "quick_ropes", breaks)
    end = asker.end_of(asker.ask("ropes", yard.question()))
    assert end.status == "failed"
    assert end.text == "unexpected ZeroDivisionError: by zero"
    assert failure_text(KeyboardInterrupt()) == "unexpected KeyboardInterrupt"


def test_too_few_cables_are_told(asker: Any, tmp_path: Path, no_plugins: Plugins) -> None:
    study = tmp_path / "two.yaml"
    study.write_text(
        "robot: {anchors: [[0, 0, 5], [9, 0, 5], [0, 9, 5], [9, 9, 5]],\n"
        "  platform: {mass: 9, attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1]]}}\n"
        "cable: {density: 7800, youngs_modulus: 2e11, allowable_stress: 1e8}\npose: [4, 4, 2]\n",
        encoding="utf-8",
    )
    session = Session.open(study, no_plugins)
    end = asker.end_of(asker.ask("pose", session.question()))
    assert end.status == "failed"
    assert "fewer than its 6 degrees of freedom" in end.text


@pytest.mark.slow
def test_an_effect_of_a_plugin_that_fails_is_told(asker: Any, tmp_path: Path, site: Path) -> None:
    from designer.plugins import find_plugins

    (site / "frail.py").write_text(
        "from designer.effects.effect import Effect, Parameter, Size\n"
        "from designer.plugins import hookimpl\n"
        "from designer.units import NUMBER\n"
        "def change(machine, values):\n"
        "    if values['amount'] > 1.5: raise RuntimeError('too much')\n"
        "    return machine\n"
        "@hookimpl\n"
        "def register_effects():\n"
        "    return [Effect('frail', 'it is frail', 'none', 'none',\n"
        "        (Parameter('amount', NUMBER, Size(1.0, (0.0, 9.0), (0.0, 9.0))),), change)]\n",
        encoding="utf-8",
    )
    dist = site / "frail-1.0.dist-info"
    dist.mkdir()
    (dist / "METADATA").write_text("Metadata-Version: 2.1\nName: frail\nVersion: 1.0\n", "utf-8")
    (dist / "entry_points.txt").write_text("[designer.plugins]\nfrail = frail\n", "utf-8")
    plugins = find_plugins()
    study = tmp_path / "study.yaml"
    yard = Session.open(example_file("yard"), plugins)
    study.write_text(yard.text + "effects: {frail: {amount: 1}}\n", encoding="utf-8")
    session = Session.open(study, plugins)
    assert session.faults == ()
    assert asker.end_of(asker.ask("pose", session.question())).status == "done"
    session.edit("effects.frail.amount", "2")
    end = asker.end_of(asker.ask("pose", session.question()))
    assert end.status == "failed"
    assert "frail" in end.text
    assert "too much" in end.text
    session.undo()
    assert asker.end_of(asker.ask("pose", session.question())).status == "done"


def test_closed_in_the_middle_of_work(work: Work, yard: Session) -> None:
    got: list[Any] = []
    worker = worker_module.Worker(got.append)
    worker.ask("worst", question_of(yard))
    assert work.began.wait(10.0)
    worker.ask("ropes", question_of(yard))
    worker.close(timeout_s=30.0)
    assert not worker._thread.is_alive()
    assert {one.status for one in got} == {"cancelled"}
    assert len(got) == 2


def test_a_listener_that_is_gone_does_no_harm(work: Work, yard: Session) -> None:
    def gone(_: Any) -> None:
        raise RuntimeError("already deleted")

    worker = worker_module.Worker(gone)
    worker.ask("worst", question_of(yard))
    assert work.began.wait(10.0)
    worker.close(timeout_s=30.0)
    assert not worker._thread.is_alive()


def test_solving_looks_up_between_batches(yard: Session) -> None:
    question, calls = question_of(yard), []
    with interrupted_by(lambda: calls.append(1)):
        cable = question.material.cable(4e-3)
        solve_sagging(question.robot, Poses.at([[15.0, 9.0, 4.0]]), cable)
    assert calls
    before = len(calls)
    solve_sagging(question.robot, Poses.at([[15.0, 9.0, 4.0]]), cable)
    assert len(calls) == before


def test_every_kernel_releases_the_interpreter_lock() -> None:
    found = []
    for info in pkgutil.iter_modules(kernel.__path__):
        module = importlib.import_module(f"{kernel.__name__}.{info.name}")
        for one in vars(module).values():
            options = getattr(one, "targetoptions", {})
            if options and not options.get("no_cpython_wrapper"):  # called from Python
                found.append(options.get("nogil", False))
    assert len(found) > 5
    assert all(found)


def test_what_a_plugin_fails_at_is_told(asker: Any, site: Path, tmp_path: Path) -> None:
    (site / "broken.py").write_text("raise RuntimeError('no licence')\n", encoding="utf-8")
    dist = site / "broken-1.0.dist-info"
    dist.mkdir()
    (dist / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1.0\n", "utf-8")
    (dist / "entry_points.txt").write_text("[designer.plugins]\nbroken = broken\n", "utf-8")
    session = Session.open(example_file("yard"), find_plugins())
    assert any("broken" in line and "no licence" in line for line in session.problems)
    session.edit("workspace.samples", "50")
    end = asker.end_of(asker.ask("ropes", session.question()))
    assert end.status == "done"
    assert any("no licence" in line for line in end.answer.problems)


@pytest.mark.slow
def test_the_full_selection_in_a_process(asker: Any, yard: Session) -> None:
    yard.edit("workspace.samples", "300")
    end = asker.end_of(asker.ask("select", yard.question()))
    assert end.status == "done"
    ropes, own = end.answer, full_ropes(question_of(yard))
    assert isinstance(ropes, Ropes)
    assert own is not None
    assert (ropes.best, rope_table(ropes)) == (own.best, rope_table(own))
    tasks = {one.text for one in asker.seen if not one.is_end}
    assert tasks
    yard.choose(Rope("none", "such"))  # the process stays for the next
    yard.edit("workspace.samples", "200")
    second = asker.end_of(asker.ask("select", yard.question()))
    assert second.status == "done"


@pytest.mark.slow
def test_a_failure_in_a_process_is_told(asker: Any, yard: Session, tmp_path: Path) -> None:
    wrong = asker.ask("export", yard.question(), content="vtk", target=tmp_path / "map.txt")
    end = asker.end_of(wrong)
    assert end.status == "failed"
    assert "ends in .vtu" in end.text


def breaks(_: object) -> None:
    os._exit(7)


def goes_on(_: object) -> None:
    time.sleep(600.0)


def helper_with(
    work: Callable[[object], None], monkeypatch: pytest.MonkeyPatch
) -> tuple[Helper, list[Any], threading.Event]:
    """A helper whose process does this, what it delivers, and when it has."""
    monkeypatch.setattr(worker_module, "work", work)
    got: list[Any] = []
    told = threading.Event()

    def deliver(one: Any) -> None:
        got.append(one)
        told.set()

    return Helper("select", deliver), got, told


@pytest.mark.slow
def test_a_process_that_breaks_is_told(yard: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    helper, got, told = helper_with(breaks, monkeypatch)
    helper.ask(Request(1, "select", question_of(yard)))
    assert told.wait(30.0)
    helper.close()
    assert got[0].status == "failed"
    assert "status 7" in got[0].text


@pytest.mark.parametrize("ends", ["cancel", "close", "ask"])
def test_a_process_at_work_ends_at_once(
    ends: str, yard: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    helper, got, told = helper_with(goes_on, monkeypatch)
    helper.ask(Request(1, "select", question_of(yard)))
    while helper._process is None:
        time.sleep(0.01)
    process = helper._process
    if ends == "ask":
        helper.ask(Request(2, "select", question_of(yard)))
    else:
        getattr(helper, ends)()
    assert told.wait(30.0)
    assert [one.status for one in got[:1]] == ["cancelled"]
    assert got[0].number == 1
    process.join(10.0)
    assert process.exitcode not in (None, 0)
    helper.close()


def test_long_work_of_the_window_is_that_of_the_helper() -> None:
    live_session = pytest.importorskip("designer.explore.desktop.live_session")
    assert get_args(Long) == live_session.LONG
    assert set(get_args(Quick)) | set(get_args(Long)) == set(live_session.NAMES)
