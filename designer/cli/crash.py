"""The last handler: a fault of the program itself is told in one line, and is no answer."""

from __future__ import annotations

import os
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from designer import __version__
from designer.errors import described, one_line

FAULT_OF_THE_PROGRAM = 70
"""Exit status, as EX_SOFTWARE of sysexits.h."""
_PACKAGE = Path(__file__).parents[1]


def end_by_fault(error: Exception) -> NoReturn:
    """End with a line that says what went wrong, and where to report it."""
    with suppress(Exception):  # standard error may be what fails
        report_text = _kept(error)
        print(
            f"{described(error)}{_place(error)}: a fault of cdpr-designer itself, and no answer. "
            f"Please report it as an issue of its repository{report_text}",
            file=sys.stderr,
            flush=True,
        )
    with suppress(Exception):
        from designer.io.process import silence_broken_output

        silence_broken_output()
    sys.exit(FAULT_OF_THE_PROGRAM)


def _place(error: Exception) -> str:
    """Return the innermost line of ours that had a part in it."""
    frames = reversed(traceback.extract_tb(error.__traceback__))
    ours = (frame for frame in frames if Path(frame.filename).is_relative_to(_PACKAGE))
    for frame in ours:
        return f" ({Path(frame.filename).relative_to(_PACKAGE.parent).as_posix()}:{frame.lineno})"
    return ""


def _kept(error: Exception) -> str:
    """Write what a report needs into a file of the user's; return what to do with it."""
    from platformdirs import user_log_path

    try:
        path = user_log_path("cdpr-designer", appauthor=False) / "fault.txt"
        path.parent.mkdir(parents=True, exist_ok=True)
        trace = "".join(traceback.format_exception(error))
        command = " ".join(map(one_line, sys.argv[1:]))
        system = f"Python {sys.version.split()[0]}, {os.name}, {sys.platform}"
        text = f"cdpr-designer {__version__}, {system}\ndesigner {command}\n\n{trace}"
        path.write_text(text, encoding="utf-8", errors="replace")
    except OSError:
        return ""
    return f", with {path}"
