"""Results appear whole or not at all."""

from __future__ import annotations

import os

import pytest

from designer.errors import OutputError
from designer.output import output_folder, write_new_file


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
        pytest.raises(OutputError, match="cannot be written"),
        output_folder(tmp_path / "file" / "x"),
    ):
        pass


def test_new_file_is_never_overwritten(tmp_path) -> None:
    write_new_file(tmp_path / "a", "1")
    with pytest.raises(OutputError, match="exists already"):
        write_new_file(tmp_path / "a", "2")
    assert (tmp_path / "a").read_text() == "1"
