"""Results as files: ``result.json``, and what stands beside it."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from designer.analysis.analyse import Analysis
from designer.analysis.reactions import reactions_csv
from designer.analysis.result_json import candidates_csv
from designer.documents import document
from designer.documents.document import DEEPEST_NESTING, Flaw, Keys
from designer.documents.fields import MOST_FAULTS
from designer.documents.opened import read_input
from designer.documents.plain import RESULT_FORMAT, Json, why_unreadable
from designer.errors import Fault, InputError
from designer.io.output import write_whole
from designer.units import describe

_RESULT = "a result.json that `designer report` wrote"
_LARGEST_RESULT_BYTES = 50_000_000
_HALF_LETTER = re.compile("[\ud800-\udfff]")
_KINDS: dict[str, Any] = {
    "a mapping": dict, "a list": list, "a text": str, "a number": int | float | None,
    "a mapping, or null": dict | None, "a text, or null": str | None,
}  # fmt: skip
_SHAPE = {
    "provenance": "a mapping", "checks": "a list", "checks.*": "a mapping",
    "checks.*.demand": "a number", "checks.*.capacity": "a number",
    "selection": "a mapping, or null", "selection.currency": "a text, or null",
    "selection.chosen": "a mapping, or null", "selection.chosen.cost": "a number",
    "selection.candidates": "a list", "selection.candidates.*": "a mapping",
}  # fmt: skip
"""What a comparison does more with than to show it."""
_TEXTS = {
    "checks.*": ("id", "load_case", "state"),
    "selection.candidates.*": ("grade", "size_id", "standing"),
}  # in each of a list, and never left out


def write_results(analysis: Analysis, folder: Path) -> None:
    """Write ``result.json`` into an existing folder, and the tables that the study asks for.

    Those are ``candidates.csv``, ``path.csv``, ``reactions.csv`` and ``workspace.nc``.
    """
    write_whole(folder / "result.json", f"{analysis.to_json()}\n".encode())
    if analysis.selection is not None:
        write_whole(folder / "candidates.csv", candidates_csv(analysis.selection).encode())
    if analysis.reactions:
        write_whole(folder / "reactions.csv", reactions_csv(analysis.reactions).encode())
    if analysis.path is not None:
        write_whole(folder / "path.csv", analysis.path.to_csv().encode())
    samples = analysis.sweep_file
    if samples is not None and samples != folder / "workspace.nc":
        shutil.copyfile(samples, folder / "workspace.nc")


def read_result(path: Path) -> Json:
    """Return what a ``result.json`` holds, of any version of the program up to this one.

    Raises
    ------
    InputError
        If it cannot be read, is no result, or is of a newer format; it names the version needed.
        With a fault for each value that no result has.
    """
    try:
        if path.stat().st_size > _LARGEST_RESULT_BYTES:
            raise ValueError(f"it has more than {_LARGEST_RESULT_BYTES / 1e6:g} MB")
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
    faults = [
        Fault(str(path), None, document.path_text(keys), problem, expected)
        for keys, problem, expected in _flaws(values)
    ]
    if faults:
        raise InputError(faults[:MOST_FAULTS])
    return {"format": 1, **values}


def _flaws(value: object, keys: Keys = (), expected: str = "") -> Iterator[Flaw]:
    """Yield what no result holds: values of other kinds, depths, halves of letters, no numbers."""
    path = ".".join("*" if isinstance(key, int) else key for key in keys)
    expected = expected or _SHAPE.get(path, "")
    if expected and not isinstance(value, _KINDS[expected]):
        yield Flaw(keys, f"is {describe(value)}", expected)
    elif isinstance(value, dict | list) and len(keys) >= DEEPEST_NESTING:
        yield Flaw(keys, "is nested too deeply", f"at most {DEEPEST_NESTING} levels")
    elif isinstance(value, dict):
        needed = dict.fromkeys(_TEXTS.get(path, ()), "a text")
        for key in {**needed, **value}:
            yield from _flaws(value.get(key), (*keys, key), needed.get(key, ""))
    elif isinstance(value, list):
        for place, part in enumerate(value):
            yield from _flaws(part, (*keys, place))
    elif isinstance(value, int | float) and not abs(value) <= 1e300:
        yield Flaw(keys, "is too large, or no number", "a finite number")
    if any(isinstance(text, str) and _HALF_LETTER.search(text) for text in (value, *keys[-1:])):
        yield Flaw(keys, "holds half a letter", "text in Unicode")
