"""One study of a sweep, from its values to what is kept of it; and many in a row, in a process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from designer.analysis.analyse import Analysis
from designer.analysis.pose import analyse_pose
from designer.analysis.result_json import result_part, size_dict
from designer.documents.document import Document, Key, Node
from designer.documents.plain import Json
from designer.effects.load import load_effects
from designer.effects.registry import KnownEffects
from designer.errors import DesignerError, InputError, described
from designer.grades.registry import Catalogue, kept_catalogue
from designer.io.config.reader import checked, study_of
from designer.model.verdict import Verdict
from designer.plugins import Plugins, find_plugins
from designer.spelling import did_you_mean
from designer.study import Study

Change = tuple[tuple[Key, ...], Node]


@dataclass(frozen=True, slots=True)
class Base:
    """The study that a sweep starts from, and what is kept of those made of it."""

    document: Document
    keep: tuple[str, ...]
    with_plugins: bool = True

    def study(self, changes: Sequence[Change] = ()) -> Study:
        """Return the study with some values put in.

        Raises
        ------
        InputError
            If it is none then.
        """
        root = self.document.root
        for keys, node in changes:
            root = root.with_value(keys, node)
        plugins, effects = _plugins(self.with_plugins)
        document = replace(self.document, root=root)
        path = Path(document.name)
        return study_of(checked(document, effects), document, path, effects, plugins)

    def catalogue(self, study: Study | None = None) -> Catalogue:
        """Return the grades that its studies, or one of them, choose from."""
        return kept_catalogue((study or self.study()).catalogues, _plugins(self.with_plugins)[0])

    def result(self, study: Study) -> Json:
        """Return as much of ``result.json`` as what is kept of it asks for."""
        parts = {name.split(".")[0] for name in self.keep}
        if parts <= {"pose", "name"}:
            return size_dict(study, analyse_pose(study), self.keep)
        # A proof may take its whole budget for each of thousands of studies.
        if "proof" not in parts:
            study = study.unproved
        return result_part(Analysis.begin(study, self.catalogue(study), keep=self.keep))


@cache
def _plugins(with_plugins: bool) -> tuple[Plugins, KnownEffects]:
    plugins = find_plugins(with_plugins)
    return plugins, load_effects(plugins)


def value_at(result: Json, path: str) -> Any:
    """Return what a result holds at a path such as ``selection.chosen.utilisation``.

    None where a part on the way is None: there is no such result.

    Raises
    ------
    KeyError
        If results never have it; carries the names that there are in its place.
    """
    value: Any = result
    for key in path.split("."):
        if value is None:
            return None
        names = list(map(str, range(len(value)))) if isinstance(value, list) else value
        if not isinstance(names, dict | list) or key not in names:
            raise KeyError(key, list(names) if isinstance(names, dict | list) else [])
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


def why_no_value(error: KeyError) -> tuple[str, str]:
    """Return the problem with a path that `value_at` refuses, and what was expected."""
    key, names = error.args
    expected = f"one of {', '.join(names[:20])}{did_you_mean(key, names)}"
    return f"results have no '{key}' there", expected


def solve_points(base: Base, points: Sequence[Sequence[Change]]) -> list[tuple[list[Any], str]]:
    """Return of each point what is kept, and why there is nothing of it where there is not.

    A study that is none, or fails, is a result like others: one of many must not end the rest.
    Runs on one thread: as many processes as processors are at work.
    """
    import numba
    from threadpoolctl import threadpool_limits

    numba.set_num_threads(1)
    with threadpool_limits(1):
        return [_solve(base, changes) for changes in points]


def _solve(base: Base, changes: Sequence[Change]) -> tuple[list[Any], str]:
    try:
        result = base.result(base.study(changes))
    except Exception as error:  # whatever a plugin or a library may raise
        return [None] * len(base.keep), why_not(error)
    values: list[Any] = []
    reasons = [why_negative(result)]
    for name in base.keep:
        try:
            values.append(value_at(result, name))
        except KeyError:  # such as the tension of a fourth cable where there are three
            values.append(None)
            reasons.append(f"there is no {name} here")
    return values, "; ".join(filter(None, reasons))


def why_not(error: Exception) -> str:
    """Return in a line why a study gave no result."""
    if isinstance(error, InputError):
        fault = error.faults[0]
        expected = f" (expected {fault.expected})" if fault.expected else ""
        return f"{fault.field}: {fault.problem}{expected}"
    if isinstance(error, DesignerError):
        return str(error).partition("\n")[0]
    if isinstance(error, KeyError):
        return f"there is no {error.args[0]} in this result"
    return described(error)


def why_negative(result: Json) -> str:
    """Return why a result is no answer, in a line; empty where it is one."""
    pose = result.get("pose")
    if pose is not None and pose["sagging"]["status"] != "solved":
        return f"the configured pose: {Verdict[pose['sagging']['status'].upper()].reason}"
    answer, workspace = result.get("answer"), result.get("workspace")
    if answer is None:  # not evaluated: what is kept does not take it
        is_held = workspace is None or workspace["sagging"] is not None
        return "" if is_held else "no cable of the family holds in all of the workspace"
    unmet = answer["reasons"]
    parts = [
        f"{requirement['id']} in {requirement['load_case']}: {requirement['state']}"
        for requirement in unmet
    ]
    return "; ".join(parts)
