"""Commands that go on from a study, each checked against the reference or against the study."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pairs.agreement import SAME, is_balanced, ropes_of
from pairs.options import GRADES
from pairs.reference import hang, solve
from pairs.scenario import problem_of, random_places

from designer.analysis.analyse import Analysis
from designer.analysis.comparison import compare
from designer.analysis.lengths import lengths_of
from designer.documents.document import read_document
from designer.model.robot import Poses
from designer.sweep.plan import Range
from designer.sweep.point import Base, solve_points

HEAVIER = 1.05
ROWS = 24


def lengths(text: Mapping[str, Any], analysis: Analysis, folder: Path) -> Iterator[str]:
    """Compare lengths with those of the reference, at rest under the study's own load."""
    problem = problem_of(text, ropes_of(analysis))
    poses = random_places(text, {}, 3, np.random.default_rng(1))
    places = [np.concatenate([pose.position_m, pose.turn_rad]) for pose in poses]
    ours = lengths_of(analysis, Poses.at(np.array(places)))
    for pose, length, tension in zip(
        poses, ours.statics.length_m, ours.statics.cable_tension_N, strict=True
    ):
        best = solve(problem, pose)
        if best is None:
            if np.isfinite(length).all():
                yield f"lengths at {pose}, which the reference does not hold"
            continue
        hung = hang(problem, pose, length, near=best)
        if hung is None or not is_balanced(hung):
            yield f"lengths do not hold {pose}"
        elif np.abs(hung.tension_N / tension - 1.0).max() > SAME:
            yield f"tensions {tension} at {pose}, reference {hung.tension_N}"


def comparison(text: Mapping[str, Any], analysis: Analysis, folder: Path) -> Iterator[str]:
    """A study differs from itself in nothing."""
    result = analysis.to_dict()
    found = compare(result, copy.deepcopy(result))
    lines = (*found.inputs, *found.products, *found.others)
    yield from (f"differs from itself: {line.path}" for line in lines)


def _heavier(text: Mapping[str, Any]) -> dict[str, Any]:
    changed = copy.deepcopy(dict(text))
    changed["robot"]["platform"]["mass"] *= HEAVIER
    return changed


def _with_catalogue(text: Mapping[str, Any], folder: Path) -> Path:
    """Write a study that brings its own grades, and return its file."""
    for name, sheet in GRADES.items():
        (folder / f"{name}.yaml").write_text(yaml.safe_dump(sheet), encoding="utf-8")
    named = {**text, "catalogues": [f"{name}.yaml" for name in GRADES]}
    path = folder / "own.yaml"
    path.write_text(yaml.safe_dump(named, sort_keys=False), encoding="utf-8")
    return path


def sweep(text: Mapping[str, Any], analysis: Analysis, folder: Path) -> Iterator[str]:
    """A study of a sweep is the study with the value put in."""
    from pairs.table import analysed

    keys, keep = ("robot", "platform", "mass"), ("answer.total_mass_kg",)
    if not analysis.has_groups:
        keep = (*keep, "selection.chosen.utilisation")
    mass = _heavier(text)["robot"]["platform"]["mass"]
    base = Base(read_document(_with_catalogue(text, folder)), keep, False)
    ((kept, _),) = solve_points(base, [[(keys, Range(keys, mass, mass, "").node(mass))]])
    whole = analysed(_heavier(text), folder).to_dict()
    told = [_at(whole, name) for name in keep]
    for name, one, other in zip(keep, kept, told, strict=True):
        if one != other and not np.isclose(one, other, rtol=SAME):
            yield f"{name} is {one} in a sweep, {other} of the study"


def _at(result: Mapping[str, Any], path: str) -> Any:
    value: Any = result
    for name in path.split("."):
        value = None if value is None else value[name]
    return value


COMMANDS: Mapping[str, Callable[[Mapping[str, Any], Analysis, Path], Iterator[str]]] = {
    "lengths": lengths,
    "compare": comparison,
    "sweep": sweep,
}
