"""Closed pipes, full disks, poor terminals and requests to end, each in a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

DESIGNER = (sys.executable, "-m", "designer")
posix = pytest.mark.skipif(os.name != "posix", reason="pipes and signals of POSIX")
LIST = ("catalog", "list", "--maker", "unirope", "--no-plugins")


def into_closed_pipe(*arguments: str) -> subprocess.CompletedProcess[bytes]:
    read_end, write_end = os.pipe()
    os.close(read_end)
    try:
        return subprocess.run(
            [*DESIGNER, *arguments],
            stdout=write_end,
            stderr=subprocess.PIPE,
            timeout=900,
            check=False,
        )
    finally:
        os.close(write_end)


# With its streams buffered, and without: what waits in a buffer fails later, as Python ends.
buffered = pytest.mark.parametrize("unbuffered", ["", "1"], ids=["buffered", "unbuffered"])


@pytest.mark.cases_by_default(1)
@posix
@buffered
@pytest.mark.parametrize(
    "command", [("init", "--list"), LIST, ("--help",), ("--version",), ("size", "--help")],
    ids=["plain", "table", "help", "version", "help of a command"],
)  # fmt: skip
def test_a_reader_who_goes_away_is_no_negative_answer(
    command: tuple[str, ...], unbuffered: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONUNBUFFERED", unbuffered)
    done = into_closed_pipe(*command)
    assert (done.returncode, done.stderr) == (128 + signal.SIGPIPE, b"")


@pytest.mark.cases_by_default(1)
@posix
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("command", [("init", "--list"), LIST], ids=["plain", "table"])
def test_an_output_that_is_full_is_told_in_one_line(command: tuple[str, ...]) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*DESIGNER, *command], stdout=full, stderr=subprocess.PIPE, timeout=900, check=False
        )
    assert done.returncode == 2
    assert done.stderr.startswith(b"standard output: cannot be written")
    assert done.stderr.count(b"\n") == 1


@pytest.mark.slow
@posix
def test_no_output_at_all() -> None:
    closed = f"exec {' '.join([*DESIGNER, *LIST])} >&-"
    done = subprocess.run(["sh", "-c", closed], capture_output=True, timeout=900, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.slow
def test_letters_that_the_terminal_lacks_become_question_marks() -> None:
    done = subprocess.run(
        [*DESIGNER, *LIST],
        capture_output=True,
        timeout=900,
        check=False,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"unirope-7x19-galvanised" in done.stdout
    assert b"2.381?9.525" in done.stdout


@posix
@pytest.mark.parametrize("request_to_end", [signal.SIGTERM, signal.SIGINT])
def test_a_request_to_end_leaves_nothing_behind(
    tmp_path: Path, request_to_end: signal.Signals
) -> None:
    code = (
        "import signal, time\nfrom pathlib import Path\n"
        # Where the tests run in the background, SIGINT is ignored from the start.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from designer.io.output import output_folder\n"
        "from designer.io.process import settle_in\nsettle_in()\n"
        "with output_folder(Path('deep/report')) as building:\n"
        "    (building / 'half').write_text('')\n"
        "    print('at work', flush=True)\n    time.sleep(60)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"at work\n"
        process.send_signal(request_to_end)
        errors = process.communicate(timeout=900)[1]
    assert process.returncode != 0
    assert errors == b"Interrupted; nothing was written.\n"
    assert list(tmp_path.iterdir()) == []


@posix
def test_an_interruption_reports_what_was_written(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\nfrom pathlib import Path\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from designer.io.output import output_folder, write_new_file\n"
        "from designer.io.process import settle_in\nsettle_in()\n"
        "with output_folder(Path('report')) as building:\n"
        "    (building / 'report.html').write_text('')\n"
        "write_new_file(Path('crane.yaml'), '')\nos.kill(os.getpid(), signal.SIGINT)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, check=False
    )
    assert (done.returncode, done.stderr) == (
        130,
        b"Interrupted; written: report, crane.yaml.\n",
    )


LOADING = """
import os, signal, sys
from pathlib import Path

class Ask:
    # Asks this program to end while a library is half-loaded, and then goes on loading it.
    def find_spec(self, name, path=None, target=None):
        if name == "half_loaded":
            os.kill(os.getpid(), getattr(signal, sys.argv[1]))

sys.meta_path.insert(0, Ask())
signal.signal(signal.SIGINT, signal.default_int_handler)
from designer.io.output import output_folder
from designer.io.process import settle_in
settle_in()
try:
    with output_folder(Path("deep/report")) as building:
        (building / "half").write_text("")
        import half_loaded
finally:
    print("unwound")
"""


@posix
@pytest.mark.parametrize("request_to_end", [signal.SIGTERM, signal.SIGINT])
def test_a_request_to_end_does_not_unwind_a_library_that_is_half_loaded(
    tmp_path: Path, request_to_end: signal.Signals
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOADING, request_to_end.name],
        cwd=tmp_path,
        capture_output=True,
        timeout=900,
        check=False,
    )
    assert (done.returncode, done.stdout) == (128 + request_to_end, b"")
    assert list(tmp_path.iterdir()) == []


NOTE = "from designer.cli.terminal import print_left_out; print_left_out(['a note'])"


@pytest.mark.cases_by_default(3)
@posix
@buffered
@pytest.mark.parametrize(
    "command", [("-c", NOTE), ("-m", "designer", "size", "none.yaml"), ("-m", "designer", "siez")],
    ids=["note", "fault", "usage"],
)  # fmt: skip
def test_notes_that_nobody_reads_are_no_negative_answer(
    command: tuple[str, ...], unbuffered: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONUNBUFFERED", unbuffered)
    read_end, write_end = os.pipe()
    os.close(read_end)
    try:
        done = subprocess.run(
            [sys.executable, *command], stderr=write_end, timeout=900, check=False
        )
    finally:
        os.close(write_end)
    assert done.returncode == 128 + signal.SIGPIPE


FAILING = """
import sys
from designer import __main__
from designer.cli import commands

@commands.app.command("fail")
def fail() -> None:
    raise {error}

sys.argv = ["designer", "fail"]
__main__.main()
"""


@pytest.mark.parametrize("error", ["ValueError('of ours')", "EOFError('of ours')", "MemoryError()"])
def test_a_fault_of_the_program_is_one_line_and_no_answer(tmp_path: Path, error: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FAILING.format(error=error)],
        env={**os.environ, "XDG_STATE_HOME": str(tmp_path), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=900,
        check=False,
    )
    (line,) = done.stderr.splitlines()
    assert done.returncode == 70
    assert error.partition("(")[0] in line
    assert "Please report it as an issue of its repository, with " in line
    kept = Path(line.rpartition(", with ")[2])
    assert kept.is_relative_to(tmp_path)
    assert "Traceback" in kept.read_text()


@pytest.mark.slow
@posix
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("command", [("size", "none.yaml"), ("siez",), ("catalog", "show", "none")])
def test_a_standard_error_that_is_full_is_no_answer(command: tuple[str, ...]) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*DESIGNER, *command], stdout=subprocess.PIPE, stderr=full, timeout=900, check=False
        )
    assert (done.returncode, done.stdout) == (2, b"")


@posix
@pytest.mark.parametrize("library", ["typer", "designer.cli.commands", "designer.errors"])
def test_ctrl_c_while_libraries_are_loaded(library: str) -> None:
    asks = (
        "import os, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "class Ask:\n    def find_spec(self, name, path=None, target=None):\n"
        f"        if name == {library!r}: os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Ask())\n"
        "from designer.__main__ import main; sys.argv = ['designer', '--version']; main()\n"
    )
    done = subprocess.run([sys.executable, "-c", asks], capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (130, b"")
    assert done.stderr == b"Interrupted; nothing was written.\n"


LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
from designer.__main__ import main
sys.argv = ["designer", *sys.argv[1:]]
main()
"""


@posix
@pytest.mark.slow
def test_a_disk_that_is_full_is_told_in_one_line_and_leaves_nothing(tmp_path: Path) -> None:
    """NetCDF has an error of its own for that."""
    (tmp_path / "study.yaml").write_text(
        "robot:\n  anchors: [[0, 0, 10], [20, 0, 10], [10, 17, 10]]\n  platform: {mass: 100 kg}\n"
        "cable: {density: 5290 kg/m^3, youngs_modulus: 60 GPa, allowable_stress: 200 MPa}\n"
        "workspace: {region: {prism: anchors, z: [1 m, 4 m], inset: 2 m}, samples: 2000}\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "report", "study.yaml", "--no-plugins"],
        cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    lines = [line for line in done.stderr.splitlines() if "cannot be written" in line]
    assert done.returncode == 2, done.stderr
    assert len(lines) == 1
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["study.yaml"]
