"""Results appear whole or not at all."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from designer.errors import OutputError
from designer.io.output import output_folder, require_file, write_file, write_new_file


def test_files_appear_when_all_is_done(tmp_path) -> None:
    target = tmp_path / "deep" / "report"
    with output_folder(target) as building:
        (building / "a.txt").write_text("a")
        assert not (target / "a.txt").exists()
    assert (target / "a.txt").read_text() == "a"
    assert [path.name for path in target.iterdir()] == ["a.txt"]


def test_failure_leaves_nothing_and_keeps_the_old(tmp_path) -> None:
    target = tmp_path / "report"
    target.mkdir()
    (target / "a.txt").write_text("old")
    with pytest.raises(RuntimeError), output_folder(target) as building:
        (building / "a.txt").write_text("new")
        raise RuntimeError
    assert (target / "a.txt").read_text() == "old"
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["a.txt"]


def test_new_report_replaces_the_old(tmp_path) -> None:
    for text in ("old", "new"):
        with output_folder(tmp_path / "report") as building:
            (building / "a.txt").write_text(text)
    assert (tmp_path / "report" / "a.txt").read_text() == "new"


def test_a_file_in_the_way(tmp_path) -> None:
    (tmp_path / "report").write_text("")
    with pytest.raises(OutputError, match="is a file"), output_folder(tmp_path / "report"):
        pass


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write all")
def test_read_only_folder(tmp_path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="cannot be written"), output_folder(tmp_path / "x"):
            pass
    finally:
        tmp_path.chmod(0o700)


def test_parent_that_is_a_file(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(OutputError, match=r"cannot be written \(.*file is a file\)"),
        output_folder(tmp_path / "file" / "x"),
    ):
        pass


def test_new_file_is_never_overwritten(tmp_path) -> None:
    write_new_file(tmp_path / "a", "1")
    with pytest.raises(OutputError, match="exists already"):
        write_new_file(tmp_path / "a", "2")
    assert (tmp_path / "a").read_text() == "1"


def everything(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


def test_failure_leaves_no_folder_that_was_made_for_it(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), output_folder(tmp_path / "deep" / "report"):
        raise RuntimeError
    assert everything(tmp_path) == []


def test_a_folder_where_a_file_is_to_go(tmp_path: Path) -> None:
    (tmp_path / "report" / "b.txt").mkdir(parents=True)
    (tmp_path / "report" / "a.txt").write_text("old")
    with (
        pytest.raises(OutputError, match=r"b\.txt: is a folder"),
        output_folder(tmp_path / "report") as building,
    ):
        for name in ("a.txt", "b.txt", "c.txt"):
            (building / name).write_text("new")
    assert (tmp_path / "report" / "a.txt").read_text() == "old"
    assert everything(tmp_path / "report") == ["a.txt", "b.txt"]


@pytest.mark.parametrize("stop", [OSError(errno.EACCES, "Permission denied"), KeyboardInterrupt()])
def test_old_files_come_back_where_the_move_breaks_off(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stop: BaseException
) -> None:
    report = tmp_path / "report"
    with output_folder(report) as building:
        for name in ("a.txt", "b.txt"):
            (building / name).write_text("old")
    replace, moved = Path.replace, []

    def break_off(source: Path, target: Path) -> None:
        if target.parent == report and source.parent.name == "new":
            moved.append(target.name)
            if len(moved) == 2:
                raise stop
        replace(source, target)

    monkeypatch.setattr(Path, "replace", break_off)
    expected = KeyboardInterrupt if isinstance(stop, KeyboardInterrupt) else OutputError
    with pytest.raises(expected), output_folder(report) as building:
        for name in ("a.txt", "b.txt", "c.txt"):
            (building / name).write_text("new")
    assert len(moved) > 1
    assert everything(report) == ["a.txt", "b.txt"]
    assert {path.read_text() for path in report.iterdir()} == {"old"}


def test_what_is_outdated_goes_and_what_is_not_ours_stays(tmp_path: Path) -> None:
    for name in ("a.txt", "b.txt", "mine.txt"):
        (tmp_path / name).write_text("old")
    with output_folder(tmp_path, outdated=["a.txt", "b.txt", "never.txt"]) as building:
        (building / "a.txt").write_text("new")
    assert everything(tmp_path) == ["a.txt", "mine.txt"]
    assert (tmp_path / "a.txt").read_text() == "new"


def test_a_name_that_no_file_system_takes(tmp_path: Path) -> None:
    with (
        pytest.raises(OutputError, match="cannot be written"),
        output_folder(tmp_path / ("a" * 300)),
    ):
        pass


def test_a_full_disk_is_told_and_other_failures_are_not_disguised(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No space"), output_folder(tmp_path / "x"):
        raise OSError(errno.ENOSPC, "No space left on device")
    with pytest.raises(FileNotFoundError), output_folder(tmp_path / "x"):
        raise FileNotFoundError(errno.ENOENT, "No such file", "a template of ours")


def test_a_link_that_leads_nowhere_shows_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "report").symlink_to(tmp_path / "gone")
    with pytest.raises(OutputError, match="leads nowhere"), output_folder(tmp_path / "report"):
        pytest.fail("the work has begun")


def test_a_new_file_that_breaks_off_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UnicodeEncodeError):
        write_new_file(tmp_path / "a", "half \ud800")
    assert everything(tmp_path) == []


HALTING = """
import pathlib, sys, time
from designer.io.output import output_folder

def halt():
    print("there", flush=True)
    time.sleep(60)

def replace(source, target, do=pathlib.Path.replace):
    if target.name == "b.txt" and source.parent.name == "new":
        halt()
    return do(source, target)

pathlib.Path.replace = replace
with output_folder(pathlib.Path(sys.argv[1])) as building:
    for name in ("a.txt", "b.txt"):
        (building / name).write_text("new")
    if sys.argv[2] == "at work":
        halt()
"""


@contextmanager
def another_run(folder: Path, where: str) -> Iterator[subprocess.Popen[bytes]]:
    """Begin in another process, which halts at work or while files are moved; kill it."""
    with subprocess.Popen(
        [sys.executable, "-c", HALTING, str(folder), where], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"there\n"
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize("where", ["at work", "moving"])
def test_left_overs_of_a_killed_run_are_cleared_by_the_next(tmp_path: Path, where: str) -> None:
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text("old")
    with another_run(tmp_path, where):
        pass
    assert len(list(tmp_path.glob(".designer-*"))) == 1
    with pytest.raises(RuntimeError), output_folder(tmp_path):
        raise RuntimeError
    assert everything(tmp_path) == ["a.txt", "b.txt"]
    assert {path.read_text() for path in tmp_path.iterdir()} == {"old"}


def test_a_run_that_lives_is_left_alone(tmp_path: Path) -> None:
    with another_run(tmp_path, "at work"):
        before = everything(tmp_path)
        with output_folder(tmp_path) as building:
            (building / "c.txt").write_text("new")
        assert everything(tmp_path) == sorted([*before, "c.txt"])


def test_a_hidden_folder_whose_lock_a_kill_prevented_is_cleared(tmp_path: Path) -> None:
    hidden = tmp_path / ".designer-0123abcd"
    (hidden / "new").mkdir(parents=True)
    with output_folder(tmp_path):
        pass
    assert hidden.exists()  # of a run that may be about to lock it
    os.utime(hidden, (0.0, 0.0))
    with output_folder(tmp_path):
        pass
    assert everything(tmp_path) == []


def test_a_new_file_is_whole_where_a_kill_comes_between(tmp_path: Path) -> None:
    code = (
        "import os, pathlib, sys\n"
        "pathlib.Path.hardlink_to = lambda *_: os._exit(9)\n"
        "from designer.io.output import write_new_file\n"
        "write_new_file(pathlib.Path('a'), 'text')\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=False)
    assert not (tmp_path / "a").exists()
    write_new_file(tmp_path / "a", "text")
    assert everything(tmp_path) == ["a"]


def test_a_new_file_on_a_file_system_without_links(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(Path, "hardlink_to", refuse)
    write_new_file(tmp_path / "a", "1")
    with pytest.raises(OutputError, match="exists already"):
        write_new_file(tmp_path / "a", "2")
    assert (tmp_path / "a").read_text() == "1"
    assert everything(tmp_path) == ["a"]


INIT_WITH_LITTLE_ROOM = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv.pop(1)),) * 2)
from designer.__main__ import main
main()
"""


@pytest.mark.cases_by_default(1)
@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
@pytest.mark.parametrize("room", [0, 4000, 30_000], ids=["none", "half a study", "no schema"])
def test_init_on_a_full_disk_leaves_no_file(tmp_path: Path, room: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", INIT_WITH_LITTLE_ROOM, str(room), "init", "a.yaml"],
        cwd=tmp_path, capture_output=True, text=True, timeout=900, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "cannot be written (File too large)" in done.stderr
    assert everything(tmp_path) == []


posix = pytest.mark.skipif(os.name != "posix", reason="pipes and links of POSIX")
KINDS = {"pipe": os.mkfifo, "folder": os.mkdir} if os.name == "posix" else {}


@posix
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("write", [require_file, lambda path: write_file(path, "new")])
def test_what_is_no_file_is_not_replaced(tmp_path: Path, write, kind: str) -> None:
    path = tmp_path / "a"
    KINDS[kind](path)
    (tmp_path / "link").symlink_to("a")
    before = path.stat()
    for name in ("a", "link"):
        with pytest.raises(OutputError, match=f"{name}: is a {kind}"):
            write(tmp_path / name)
    assert path.stat().st_ino == before.st_ino
    assert everything(tmp_path) == ["a", "link"]


@posix
def test_a_file_is_written_through_a_link(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    for name in ("elsewhere/there", "elsewhere/not_yet"):
        link = tmp_path / Path(name).name
        link.symlink_to(name)
        (tmp_path / "elsewhere" / "there").write_text("old")
        require_file(link)
        assert (tmp_path / "elsewhere" / "there").read_text() == "old"
        write_file(link, "new")
        assert link.is_symlink()
        assert (tmp_path / name).read_text() == "new"


@posix
def test_a_folder_keeps_its_links_and_pipes(tmp_path: Path) -> None:
    (tmp_path / "target.txt").write_text("old")
    (tmp_path / "a.txt").symlink_to("target.txt")
    with pytest.raises(RuntimeError), output_folder(tmp_path, ["a.txt"]) as building:
        (building / "a.txt").write_text("new")
        raise RuntimeError
    with output_folder(tmp_path, ["a.txt"]) as building:
        (building / "a.txt").write_text("new")
    assert (tmp_path / "a.txt").is_symlink()
    assert (tmp_path / "target.txt").read_text() == "new"
    os.mkfifo(tmp_path / "b.txt")
    worked = False
    with pytest.raises(OutputError, match=r"b\.txt: is a pipe"), output_folder(tmp_path, ["b.txt"]):
        worked = True
    assert not worked
    with (
        pytest.raises(OutputError, match=r"b\.txt: is a pipe"),
        output_folder(tmp_path) as building,
    ):
        for name in ("a.txt", "b.txt"):
            (building / name).write_text("newer")
    assert (tmp_path / "target.txt").read_text() == "new"
    assert everything(tmp_path) == ["a.txt", "b.txt", "target.txt"]


@pytest.mark.parametrize("n_letters", [255, 256])
def test_the_longest_name(tmp_path: Path, n_letters: int) -> None:
    path = tmp_path / ("é" * 127 + "x" * (n_letters - 254))
    if n_letters == 255:
        write_file(path, "a")
        path.unlink()
        write_new_file(path, "a")
        assert path.read_text() == "a"
        return
    for write in (require_file, lambda path: write_file(path, "a")):
        with pytest.raises(OutputError, match="cannot be written"):
            write(path)
    with pytest.raises(OutputError, match="cannot be written"), output_folder(tmp_path) as building:
        (building / path.name).write_text("a")


def test_a_new_file_at_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match="exists already"):
        write_new_file(Path(), "a")
    assert everything(tmp_path) == []
