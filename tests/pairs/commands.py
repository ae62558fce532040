"""Commands that go on from a study, each checked against the reference or against the study."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pairs.agreement import SAME, is_balanced, ropes_of, with_choices
from pairs.options import GRADES
from pairs.reference import Pose, hang, solve
from pairs.scenario import lines_of, problem_of, random_places

import designer
from designer.analysis.analyse import Analysis
from designer.analysis.comparison import compare
from designer.analysis.lengths import lengths_of
from designer.diagnosis.check import check
from designer.documents.document import read_document
from designer.measured.read import read_measured
from designer.model.robot import Poses
from designer.sweeps.plan import Base, Range, solve_points

HEAVIER = 1.05
ROWS = 24


def lengths(text: Mapping[str, Any], analysis: Analysis, folder: Path) -> Iterator[str]:
    """Compare lengths with those of the reference, at rest under the study's own load."""
    problem = problem_of(text, ropes_of(analysis))
    poses = random_places(with_choices(text, analysis), {}, 3, np.random.default_rng(1))
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
    lines = (*found.inputs, *found.products, *found.remaining)
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
    if not analysis.assignment.has_groups:
        keep = (*keep, "selection.chosen.utilisation")
    mass = _heavier(text)["robot"]["platform"]["mass"]
    base = Base(read_document(_with_catalogue(text, folder)), keep, False)
    ((kept, _),) = solve_points(base, [[(keys, Range(keys, mass, mass, "").node(mass))]])
    study = analysed(_heavier(text), folder)
    told = [study.assignment.total_mass_kg]
    if len(keep) > 1:
        told.append(study.chosen.governing.utilisation)
    for name, one, other in zip(keep, kept, told, strict=True):
        if one != other and not np.isclose(one, other, rtol=SAME):
            yield f"{name} is {one} in a sweep, {other} of the study"


PLAN = {
    "study": "own.yaml",
    "objective": "rope_mass",
    "variables": {"height": {"fields": ["robot.anchors.*.2"], "offset": [-0.3, 0.3]}},
    "budget": {"evaluations": 10},
    "starts": 1,
}


def optimise(text: Mapping[str, Any], analysis: Analysis, folder: Path) -> Iterator[str]:
    """The optimum is a study that says the same of itself, and no worse than the one given."""
    _with_catalogue(text, folder)
    (folder / "plan.yaml").write_text(yaml.safe_dump(PLAN), encoding="utf-8")
    found = designer.optimise(folder / "plan.yaml", with_plugins=False)
    (folder / "best.yaml").write_text(found.text, encoding="utf-8")
    best = Analysis.begin(designer.read_study(folder / "best.yaml", with_plugins=False))
    for ours, study in ((found.optimised, best), (found.given, analysis)):
        if _answer(ours) != _answer(study):
            yield f"optimise: {_answer(ours)}, as a study {_answer(study)}"
    if found.given_holds and not (found.holds and found.after <= found.before * (1.0 + SAME)):
        yield f"optimise: {found.after} kg, given {found.before}"


def _answer(analysis: Analysis) -> list[Any]:
    """Return the verdict and the ropes, without what changes neither."""
    reasons = [(one.id, one.load_case, one.state) for one in analysis.unmet]
    ropes = [rope.ids for rope in analysis.assignment.ropes]
    return [analysis.answer, reasons, ropes, analysis.assignment.total_mass_kg]


def _beside(pose: Pose, text: Mapping[str, Any], rng: np.random.Generator) -> Pose:
    move = 0.2 * rng.uniform(-1.0, 1.0, 3)
    if text["robot"].get("planar"):
        move[1] = 0.0
    return replace(pose, position_m=pose.position_m + move)


def diagnose(text: Mapping[str, Any], analysis: Analysis, folder: Path) -> Iterator[str]:
    """Readings of the reference are those of the declared model: a check leaves nothing."""
    if analysis.assignment.has_groups:  # a machine is measured with one rope on all cables
        return
    _, size = ropes_of(analysis)[0]
    effects = text.get("effects", {})
    problem = problem_of(text, ropes_of(analysis))
    measured = dict(text)
    measured["measurements"] = {
        "file": "log.csv",
        "settled": True,
        "cable": {
            "linear_mass": size["linear_mass"],
            "axial_stiffness": float(problem.stiffness_N[0]),
            "diameter": size["diameter"],
        },
        "noise": {"length": 1e-4, "tension": 1.0},
    }
    line = np.array([own["linear_mass"] if own else 0.0 for own in lines_of(text["robot"])])
    heavier = effects.get("linear_mass", {}).get("scale", 1.0) * size["linear_mass"] + line
    problem = replace(
        problem,
        load_N_per_m=problem.load_N_per_m * (heavier / (size["linear_mass"] + line))[:, None],
        stiffness_N=problem.stiffness_N * effects.get("elastic_modulus", {}).get("scale", 1.0),
    )
    drum = effects.get("drum_scale", {}).get("scale", 1.0)
    rng = np.random.default_rng(2)
    places = random_places(with_choices(text, analysis), {}, ROWS, rng)
    poses = [_beside(places[k % len(places)], text, rng) for k in range(ROWS)]
    states = [state for pose in poses if (state := solve(problem, pose, starts=2)) is not None]
    n = problem.n
    names = ["time_s", "x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"]
    names += [f"length_{k}_m" for k in range(1, n + 1)] + [
        f"tension_{k}_N" for k in range(1, n + 1)
    ]
    rows = [
        [
            *(10.0 * k, *state.pose.position_m, *state.pose.turn_rad),
            *drum * state.total_m,
            *np.linalg.norm(state.exit_pull_N, axis=1),
        ]
        for k, state in enumerate(states)
    ]
    (folder / "log.csv").write_text(
        "\n".join([",".join(names), *(",".join(map(repr, map(float, row))) for row in rows)])
    )
    path = folder / "measured.yaml"
    path.write_text(yaml.safe_dump(measured, sort_keys=False), encoding="utf-8")
    study = designer.read_study(path, with_plugins=False)
    assert study.measurements is not None
    found = check(study, read_measured(study)).declared
    if found.n_not_held or found.length_m is None or found.tension_N is None:
        yield f"diagnose: {found.n_not_held} of {len(rows)} rows are not held"
        return
    for name, left, unit in (("length", found.length_m, 10.0), ("tension", found.tension_N, 1e3)):
        if left.rms.value > SAME * unit:
            yield f"diagnose: {left.rms.value:.3g} is left of each {name}"


COMMANDS: Mapping[str, Callable[[Mapping[str, Any], Analysis, Path], Iterator[str]]] = {
    "lengths": lengths,
    "compare": comparison,
    "sweep": sweep,
    "diagnose": diagnose,
    "optimise": optimise,
}
