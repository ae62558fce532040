"""Sweeps that are solved, ended, and gone on with."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sweep_cases import STUDY, SWEEP, written

import designer
from designer.analysis import analyse as stages
from designer.cli.commands import main
from designer.documents.document import read_document
from designer.errors import InputError, OutputError
from designer.sweeps import run as running
from designer.sweeps.plan import Base, SweepPlan, read_sweep, value_at, why_negative
from designer.sweeps.run import Store, opened, read_store, run

REGION = """workspace: {region: {prism: anchors, inset: 2 m, z: [1, 7]}, samples: 50}
selection: {}
"""


def in_threads() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1)


def swept(path: Path, target: Path, make: running.MakeExecutor = in_threads) -> None:
    plan = read_sweep(path, with_plugins=False)
    with opened(target, plan) as store:
        run(plan, store, make, 1)


def same(a: Path, b: Path) -> bool:
    return bool(read_store(a).identical(read_store(b)))


def test_each_point_is_what_the_study_says(tmp_path: Path) -> None:
    swept(written(tmp_path), tmp_path / "out.zarr")
    found = read_store(tmp_path / "out.zarr")
    assert found.done.all()
    assert found["pose.sagging.status"].values.tolist()[0] == "solved"
    assert found["robot.platform.mass"].units == "kg"
    for point in (0, 2, 8):
        height, mass = float(found["pose[2]"][point]), float(found["robot.platform.mass"][point])
        text = STUDY.replace("[10, 6, 4]", f"[10, 6, {height!r}]").replace("100 kg", f"{mass!r} kg")
        (tmp_path / "one.yaml").write_text(text)
        alone = designer.size(designer.read_study(tmp_path / "one.yaml"))
        assert float(found["pose.optimum.diameter_m"][point]) == float(alone.sizing.diameter_m)
    above = found.isel(point=1)  # above its anchors no cable holds it
    assert np.isnan(above["pose.optimum.diameter_m"])
    assert above["reason"].item() == "the configured pose: no taut cables hold it"


def test_a_result_that_some_points_do_not_have_takes_nothing_else_along(tmp_path: Path) -> None:
    study = STUDY.replace("[10, 17, 10]]", "[10, 17, 10], [10, 9, 12]]")
    sweep = """study: crane.yaml
vary: {robot.anchors: [[[0, 0, 10], [20, 0, 10], [10, 17, 10]],
  [[0, 0, 10], [20, 0, 10], [10, 17, 10], [10, 9, 12]]]}
keep: [pose.optimum.diameter_m, pose.sagging.lengths_m.3]
"""
    swept(written(tmp_path, sweep, study), tmp_path / "out.zarr")
    found = read_store(tmp_path / "out.zarr")
    assert found["pose.optimum.diameter_m"].notnull().all()
    assert found["pose.sagging.lengths_m.3"].isnull().values.tolist() == [True, False]
    assert found.reason.values.tolist() == ["there is no pose.sagging.lengths_m.3 here", ""]


@pytest.mark.parametrize(
    ("keep", "chooses"),
    [
        (("workspace.sagging.diameter_m",), False),
        (("workspace.sagging.diameter_m", "pose.sagging.status"), False),
        (("workspace.stiffness.unstable",), True),
        (("workspace.sagging.diameter_m", "workspace.stiffness.unstable"), True),
        (("workspace.hanging.below_floor.samples", "workspace.samples"), True),
        (("workspace.samples", "answer.total_mass_kg"), True),
    ],
)
def test_a_rope_is_chosen_where_something_that_is_kept_depends_on_it(
    keep: tuple[str, ...], chooses: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class SelectedError(Exception):
        pass

    def select(*_: object, **__: object) -> None:
        raise SelectedError

    monkeypatch.setattr(stages, "select", select)
    (tmp_path / "crane.yaml").write_text(STUDY + REGION)
    base = Base(read_document(tmp_path / "crane.yaml"), keep, with_plugins=False)
    with pytest.raises(SelectedError) if chooses else nullcontext():
        base.result(base.study())


@pytest.mark.parametrize(
    ("keep", "parts"),
    [
        ("name", {"pose"}),
        ("pose.optimum.diameter_m", {"pose"}),
        ("workspace.sagging.diameter_m", {"workspace"}),
        ("answer.verdict", {"pose", "workspace", "answer", "positive"}),
    ],
)
def test_no_more_is_solved_than_what_is_kept_takes(
    keep: str, parts: set[str], tmp_path: Path
) -> None:
    (tmp_path / "crane.yaml").write_text(STUDY + REGION.partition("selection")[0])
    base = Base(read_document(tmp_path / "crane.yaml"), (keep,), with_plugins=False)
    result = base.result(base.study())
    assert parts == result.keys() & {"pose", "workspace", "answer", "positive"}
    assert why_negative(result) == ""


@pytest.mark.slow
def test_what_is_slow_and_changes_no_answer_is_solved_where_it_is_kept(tmp_path: Path) -> None:
    (tmp_path / "crane.yaml").write_text(STUDY + REGION.partition("selection")[0])
    document = read_document(tmp_path / "crane.yaml")
    slow = ("pose.rest.stable", "verification.0.method")
    for keep, solved in (((*slow, "positive"), True), (("positive",), False)):
        base = Base(document, keep, with_plugins=False)
        result = base.result(base.study())
        assert (result["pose"]["rest"] is not None) is bool(result["verification"]) is solved


@pytest.mark.slow
@pytest.mark.parametrize("top", ["7", "10.5"])
def test_what_is_kept_is_what_the_whole_result_holds(top: str, tmp_path: Path) -> None:
    """What is left out because nothing kept takes it changes nothing that is kept."""
    region = REGION.replace("z: [1, 7]", f"z: [1, {top}]")
    region = region.replace("{}", "{grades: [unirope-7x19-galvanised]}")
    (tmp_path / "crane.yaml").write_text(STUDY + region)
    document = read_document(tmp_path / "crane.yaml")
    whole = designer.analyse(designer.read_study(tmp_path / "crane.yaml")).to_dict()
    for kept in (
        ("selection.chosen.utilisation", "answer.verdict", "positive"),
        ("selection.chosen.continuous_diameter_m", "selection.chosen.outcome"),
        ("selection.reason", "selection.grades.0.outcome", "selection.usable.0.fraction"),
        ("workspace.massless.diameter_m", "workspace.stiffness.samples", "checks.1.state"),
    ):
        base = Base(document, kept, with_plugins=False)
        result = base.result(base.study())
        assert [value_at(result, path) for path in kept] == [value_at(whole, path) for path in kept]


def test_a_workspace_that_none_holds_is_why_there_is_nothing() -> None:
    told = why_negative({"workspace": {"sagging": None}})
    assert told == "no cable of the family holds in all of the workspace"


def test_what_a_study_of_one_pose_has_not_is_left_empty(tmp_path: Path) -> None:
    sweep = SWEEP[: SWEEP.index("keep:")] + "keep: [workspace.sagging.diameter_m]\n"
    swept(written(tmp_path, sweep), tmp_path / "out.zarr")
    found = read_store(tmp_path / "out.zarr")
    assert found.done.all()
    assert found["workspace.sagging.diameter_m"].isnull().all()
    assert not found.reason.str.contains("nothing to solve").any()


def test_a_point_that_is_no_study_is_kept_with_its_reason(tmp_path: Path) -> None:
    sweep = SWEEP.replace("from: 100 kg", "from: -100 kg")
    swept(written(tmp_path, sweep), tmp_path / "out.zarr")
    found = read_store(tmp_path / "out.zarr")
    bad = found["robot.platform.mass"].values <= 0.0
    assert bad.any()
    assert found.done.all()
    assert all(
        why.startswith("robot.platform.mass: '-100.0 kg'") for why in found.reason.values[bad]
    )


def test_a_text_where_a_number_was_expected_is_told(tmp_path: Path) -> None:
    study = STUDY.replace("pose: [10, 6, 4]", "pose: [10, 6, 12]")  # nothing to be the thinnest
    sweep = SWEEP.replace("pose.sagging.status", "pose.sagging.thinnest")
    swept(written(tmp_path, sweep, study), tmp_path / "out.zarr")
    found = read_store(tmp_path / "out.zarr")
    assert found["pose.sagging.thinnest"].isnull().all()
    held = found["pose.optimum.diameter_m"].notnull().values
    assert held.sum() == 6
    assert all("pose.sagging.thinnest is a text here" in why for why in found.reason.values[held])


class Dying(Executor):
    """Ends as a pool does whose process is killed, at chosen submissions; else solves."""

    submitted = 0
    deadly: tuple[int, ...] = ()

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        Dying.submitted += 1
        future: Future[Any] = Future()
        if Dying.submitted in Dying.deadly:
            future.set_exception(BrokenProcessPool())
        else:
            future.set_result(fn(*args, **kwargs))
        return future


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("deadly", [(2,), (1, 3, 6)])
def test_a_worker_that_dies_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, deadly: tuple[int, ...]
) -> None:
    path = written(tmp_path)
    swept(path, tmp_path / "alone.zarr")
    monkeypatch.setattr(Dying, "submitted", 0)
    monkeypatch.setattr(Dying, "deadly", deadly)
    swept(path, tmp_path / "out.zarr", Dying)
    assert same(tmp_path / "alone.zarr", tmp_path / "out.zarr")


def test_a_point_that_ends_its_process_each_time_does_not_end_the_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Deadly(ThreadPoolExecutor):
        def submit(self, fn: Any, /, base: Base, changes: Any) -> Future[Any]:  # type: ignore[override]
            future: Future[Any] = Future()
            if "150" in changes[0][0][1].as_written():
                future.set_exception(BrokenProcessPool())
                return future
            return super().submit(fn, base, changes)

    swept(written(tmp_path), tmp_path / "out.zarr", Deadly)
    found = read_store(tmp_path / "out.zarr")
    why = found.reason.values[found["robot.platform.mass"].values == 150.0]
    assert why.tolist() == ["its process ended without an answer"] * 3
    assert np.isfinite(found["pose.optimum.diameter_m"].values).sum() == 4


@pytest.mark.slow
def test_a_sweep_goes_on_after_what_is_stored(tmp_path: Path) -> None:
    path, target = written(tmp_path), tmp_path / "out.zarr"
    swept(path, tmp_path / "alone.zarr")
    solved: list[int] = []

    class Counting(ThreadPoolExecutor):
        def submit(self, fn: Any, /, base: Base, changes: Sequence[Any]) -> Future[Any]:  # type: ignore[override]
            solved.append(len(changes))
            if len(solved) == 5:
                raise KeyboardInterrupt
            return super().submit(fn, base, changes)

    with pytest.raises(KeyboardInterrupt):
        swept(path, target, Counting)
    before = int(read_store(target).done.sum())
    assert 0 < before < 9
    solved.clear()
    swept(path, target, Counting) if before >= 5 else swept(path, target)
    assert same(tmp_path / "alone.zarr", target)


def test_no_pool_is_left_behind(tmp_path: Path) -> None:
    pools: list[ThreadPoolExecutor] = []

    def make() -> ThreadPoolExecutor:
        pools.append(in_threads())
        return pools[-1]

    swept(written(tmp_path), tmp_path / "out.zarr", make)
    (pool,) = pools
    with pytest.raises(RuntimeError, match="after shutdown"):
        pool.submit(print)


def test_the_store_of_another_sweep_is_left_alone(tmp_path: Path) -> None:
    target = tmp_path / "out.zarr"
    swept(written(tmp_path), target)
    before = read_store(target)
    with pytest.raises(InputError, match=r"out\.zarr: is the store of another sweep"):
        swept(written(tmp_path, SWEEP.replace("count: 3", "count: 2")), target)
    assert read_store(target).identical(before)
    (tmp_path / "folder.zarr").mkdir()
    with pytest.raises(InputError, match="is no store of a sweep"):
        swept(written(tmp_path), tmp_path / "folder.zarr")


def test_two_runs_do_not_fill_one_store(tmp_path: Path) -> None:
    path, target = written(tmp_path), tmp_path / "out.zarr"
    plan = read_sweep(path, with_plugins=False)
    with opened(target, plan), pytest.raises(OutputError, match="another run fills this store"):
        swept(path, target)


def test_a_full_disk_is_told_and_what_is_stored_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, target = written(tmp_path), tmp_path / "out.zarr"
    write, written_chunks = Store.write, []

    def until_full(self: Store, points: range, found: Any) -> None:
        if len(written_chunks) == 3:
            raise OSError(errno.ENOSPC, "No space left on device")
        written_chunks.append(points)
        write(self, points, found)

    monkeypatch.setattr(Store, "write", until_full)
    with pytest.raises(OutputError, match=r"out\.zarr: cannot be written \(No space left"):
        swept(path, target)
    monkeypatch.undo()
    assert int(read_store(target).done.sum()) == 3
    swept(path, target)
    assert read_store(target).done.all()


def test_a_store_that_cannot_be_laid_out_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    path = written(tmp_path)
    monkeypatch.setattr("zarr.consolidate_metadata", full)
    with pytest.raises(OutputError, match="No space left"):
        swept(path, tmp_path / "out.zarr")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["crane.yaml", "masses.yaml"]


def test_what_is_in_the_way_of_the_report_shows_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    (tmp_path / "out-report").write_text("a file")
    command = ["designer", "sweep", str(path), "-o", str(tmp_path / "out.zarr"), "--no-plugins"]
    monkeypatch.setattr("sys.argv", command)
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 2
    assert "out-report: is a file" in capsys.readouterr().err
    assert not (tmp_path / "out.zarr").exists()


def test_a_cluster_that_goes_away_is_told(tmp_path: Path) -> None:
    class Gone(ThreadPoolExecutor):
        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            future: Future[Any] = Future()
            future.set_exception(OSError("the scheduler is gone"))
            return future

    with pytest.raises(OutputError, match=r"the workers are gone .*the same command goes on"):
        swept(written(tmp_path), tmp_path / "out.zarr", Gone)


def test_what_a_lost_worker_takes_along_is_solved_again(tmp_path: Path) -> None:
    lost: list[Future[Any]] = []

    class Losing(ThreadPoolExecutor):
        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            if len(lost) == 2:
                return super().submit(fn, *args, **kwargs)
            lost.append(Future())
            lost[-1].set_exception(OSError("its worker is gone"))
            return lost[-1]

    path = written(tmp_path)
    swept(path, tmp_path / "alone.zarr")
    swept(path, tmp_path / "lost.zarr", partial(Losing, 1))
    assert len(lost) == 2
    assert same(tmp_path / "lost.zarr", tmp_path / "alone.zarr")


def test_a_large_sweep_has_few_chunks() -> None:
    chunks = {
        n: max(1, min(running._LARGEST_CHUNK, n // running._CHUNKS)) for n in (9, 10**4, 10**5)
    }
    assert chunks == {9: 1, 10**4: 5, 10**5: 50}


@pytest.mark.slow
def test_killed_and_gone_on_is_bit_for_bit_the_same(tmp_path: Path) -> None:
    path = written(tmp_path, SWEEP.replace("count: 3", "count: 24"))
    swept(path, tmp_path / "alone.zarr")
    program = [sys.executable, "-m", "designer", "sweep", str(path), "--no-plugins"]
    target, rng = tmp_path / "killed.zarr", np.random.default_rng(5)
    counts = []
    for _ in range(3):
        process = subprocess.Popen(
            [*program, "-o", str(target), "--workers", "2"], start_new_session=True
        )
        deadline = time.monotonic() + 900.0
        wanted = (counts[-1] if counts else 0) + int(rng.integers(1, 12))
        while process.poll() is None and time.monotonic() < deadline:
            if target.exists() and int(read_store(target).done.sum()) >= wanted:
                break
            time.sleep(0.05)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        counts.append(int(read_store(target).done.sum()))
    assert counts == sorted(counts)
    subprocess.run([*program, "-o", str(target)], check=True, capture_output=True)
    assert same(tmp_path / "alone.zarr", target)


@pytest.mark.slow
@pytest.mark.parametrize("number", ["SIGINT", "SIGKILL"])
def test_no_worker_outlives_a_sweep(tmp_path: Path, number: str) -> None:
    """A terminal sends Ctrl-C to all; a kill meets the sweep alone."""
    path = written(tmp_path, SWEEP.replace("count: 3", "count: 3000"))
    target = tmp_path / "out.zarr"
    # Where the tests run in the background, SIGINT is ignored from the start, also in a child.
    start = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from designer.cli.commands import main; main()"
    )
    program = [sys.executable, "-c", start, "sweep", str(path), "--no-plugins"]
    process = subprocess.Popen(
        [*program, "-o", str(target), "--workers", "2"],
        start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    deadline = time.monotonic() + 900.0
    while time.monotonic() < deadline and not (target.exists() and read_store(target).done.any()):
        time.sleep(0.05)
    if number == "SIGINT":
        os.killpg(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=900)
        assert process.returncode == 130
        assert "points, which stay; the same command goes on" in told
        assert "Traceback" not in told and "leaked" not in told
    else:
        process.kill()
        process.communicate(timeout=900)  # until nobody holds its streams
    with pytest.raises(ProcessLookupError):
        while time.monotonic() < deadline:
            os.killpg(process.pid, 0)
            time.sleep(0.1)


def test_plans_do_not_share_points(tmp_path: Path) -> None:
    plan: SweepPlan = read_sweep(written(tmp_path), with_plugins=False)
    assert len({str(plan.changes(point)) for point in range(plan.n_points)}) == plan.n_points
