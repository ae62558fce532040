"""Formats of the files that are read and written, each counted from 1.

A format grows by one where an older program would misread the file; fields and keys that are only
added leave it as it is. A file without a number is of the first.
"""

from __future__ import annotations

from designer import __version__

CONFIG_FORMAT = 1
"""Of studies."""
GRADE_FORMAT = 1
"""Of grade files."""
RESULT_FORMAT = 1
"""Of ``result.json``."""
DIAGNOSIS_FORMAT = 1
"""Of ``diagnosis.json``."""


def why_unreadable(value: object, newest: int, written_by: str = "") -> tuple[str, str] | None:
    """Return why a file of this format cannot be read and what to do; None where it can be.

    Parameters
    ----------
    value : object
        What the file says under ``format``; None where it says nothing.
    newest : int
        The newest format that is read.
    written_by : str
        Version of the program that wrote the file, where the file tells.
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        return "is no format", f"a whole number, 1 to {newest}"
    if value <= newest:
        return None
    needed = f"{written_by} or newer" if written_by else f"newer than {__version__}"
    problem = f"format {value} is newer than this cdpr-designer {__version__} reads"
    return problem, f"format 1 to {newest}; this file needs cdpr-designer {needed}"
