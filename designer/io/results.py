"""Results as files: ``result.json`` and what stands beside it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import Json
from designer.analysis.selection_json import candidates_csv
from designer.documents.formats import RESULT_FORMAT, why_unreadable
from designer.documents.opened import read_input
from designer.errors import Fault, InputError
from designer.io.output import write_whole

_RESULT = "a result.json that `designer report` wrote"


def write_results(analysis: Analysis, folder: Path) -> None:
    """Write ``result.json``, ``candidates.csv`` and ``workspace.nc`` into an existing folder.

    The last two only where the study asks for them.
    """
    write_whole(folder / "result.json", f"{analysis.to_json()}\n".encode())
    if analysis.selection is not None:
        write_whole(folder / "candidates.csv", candidates_csv(analysis.selection).encode())
    samples = analysis.sweep_file
    if samples is not None and samples != folder / "workspace.nc":
        shutil.copyfile(samples, folder / "workspace.nc")


def read_result(path: Path) -> Json:
    """Return what a ``result.json`` holds, of any version of the program up to this one.

    Raises
    ------
    InputError
        If it cannot be read, is no result, or is of a newer format; it names the version needed.
    """
    try:
        values = json.loads(read_input(path))
    except (OSError, ValueError, RecursionError) as error:
        reason = (error.strerror or "").lower() if isinstance(error, OSError) else str(error)
        raise InputError.at(path, f"cannot be read: {reason}", _RESULT) from None
    if not isinstance(values, dict) or "provenance" not in values:
        raise InputError.at(path, "is no result", _RESULT)
    origin = values["provenance"]
    written_by = str(origin.get("version", "")) if isinstance(origin, dict) else ""
    why = why_unreadable(values.get("format"), RESULT_FORMAT, written_by)
    if why is not None:
        raise InputError([Fault(str(path), None, "format", *why)])
    if "workspace" not in values:  # an optimise.json would compare as a result of nothing
        raise InputError.at(path, "is no result", _RESULT)
    return {"format": 1, **values}
