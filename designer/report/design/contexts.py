"""What the templates of plain sections get: numbers and domain objects; None for no section.

Beside it every template of a design report gets `shared`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import zip_longest
from typing import Any

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.fabrication import FabricatedCable, fabricated_cables
from designer.analysis.governing import GoverningPose
from designer.analysis.reactions import Reaction
from designer.grades.grade import NOT_NAMED
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.drum import DEAD_TURNS
from designer.model.verdict import Verdict
from designer.proof.prove import Proof
from designer.report import format as fmt
from designer.report.design.drawings import Drawings
from designer.report.design.first_page import by_title
from designer.report.document import MOST_ROWS
from designer.report.templates import Statement, plain_statement
from designer.selection.candidate import Candidate
from designer.selection.efficiency import Allowance
from designer.selection.samples import FEW_SAMPLES
from designer.statics.cable_loss import Fate
from designer.study import Entry, Study, rope_effects

Context = Mapping[str, object]

_TRACE = 1e-4
"""Of the largest number of a column: below, a number is what differences leave of nothing."""
_MOST_PROPOSALS = 12
"""As many as a page has room for; result.json has all."""


def shared(drawings: Drawings) -> Context:
    """Return what every template gets: the results, and the figures, each drawn when it is read."""
    analysis = drawings.analysis
    return {
        "analysis": analysis,
        "study": analysis.study,
        "assignment": analysis.assignment,
        "findings": analysis.findings,
        "drawings": drawings,
        "most_rows": MOST_ROWS,
        "Verdict": Verdict,
    }


def requirements(analysis: Analysis) -> Context:
    """All that the study requires, and whether it holds."""
    pose = analysis.governing
    shown = {"requirements": by_title(analysis.requirements), "pose": pose}
    if pose is None:
        return shown
    write = _alike(cable.exit_tension_N for cable in pose.cables)
    return {
        **shown,
        "governing_cable": pose.cables[int(pose.alone.cable_tension_N.argmax())].cable,
        "tensions": [write(one.exit_tension_N, one.platform_tension_N) for one in pose.cables],
        "forces": _forces(pose),
    }


def _forces(pose: GoverningPose) -> list[tuple[str, list[str]]]:
    """Return each force on the platform with its components, and their sum."""
    named = [(f"cable {one.cable}", one.pull_N) for one in pose.cables]
    write = _alike(float(x) for _, force in (*named, *pose.loads) for x in force)
    rows = [(fmt.capital(name), [*write(*force)]) for name, force in (*named, *pose.loads)]
    return [*rows, ("Sum", [*write(*(pose.force_sum_N.round(6) + 0.0))])]


def _alike(forces_N: Iterable[float]) -> Callable[..., tuple[str, ...]]:
    """Return what writes forces in one unit, the largest of these with five digits."""
    largest_N = max((abs(float(x)) for x in forces_N), default=0.0)
    unit, scale = fmt.force_unit(largest_N)
    places = max(4 - math.floor(math.log10(max(largest_N / scale, 1.0))), 0)
    return lambda *values: tuple(
        f"{fmt.fixed(float(x) / scale, places)}\u00a0{unit}" for x in values
    )


def load_cases(analysis: Analysis) -> Context | None:
    """What the chosen rope meets in each load case; None where the study has none."""
    study, selection = analysis.study, analysis.selection
    needs = analysis.needs
    if not needs and (not study.load_cases or selection is None):
        return None
    chosen = None if selection is None or needs else selection.chosen
    return {
        "needs": needs,
        "chosen": chosen,
        "leaves_out": study.workspace is not None and study.workspace.hangs_below == "exclude",
        "losses": [] if chosen is None else [*_losses(chosen)],
        "few_samples": FEW_SAMPLES,
        "temperature_change_K": _largest_change_K(study),
        "expansion": None if chosen is None else _expansion(study, chosen),
    }


def _largest_change_K(study: Study) -> float:
    return max((abs(case.temperature_change_K or 0.0) for case in study.load_cases), default=0.0)


def _losses(chosen: Candidate) -> Iterator[Context]:
    """Yield what becomes of the platform at the worst pose of each case that keeps lengths."""
    for found in chosen.cases:
        loss = found.loss
        if loss is None:
            continue
        fate, is_lost = Fate(int(loss.fate[0])), found.loaded.lost_cable is not None
        moves = fate is Fate.RESTS_ELSEWHERE or (fate is Fate.HOLDS and not is_lost)
        yield {
            "case": found.case.name,
            "cable": found.loaded.lost_cable,
            "change_K": found.case.temperature_change_K,
            "fate": (Fate.RESTS_ELSEWHERE if moves else fate).words,
            "moved_m": float(loss.moved_m[0]) if moves else None,
            "rest_m": loss.rest.position_m[0],
        }


def _expansion(study: Study, chosen: Candidate) -> Context | None:
    """Return how the cables grow, by which source; None where no temperature changes."""
    cases = [case for case in study.load_cases if case.temperature_change_K]
    if not cases:
        return None
    cable, given = chosen.cable, cases[0].expansion_per_K
    per_K = cable.expansion_per_K if given is None else given
    source = "steel" if chosen.grade.thermal_expansion is None else "table"
    longest_m = float(chosen.verification.longest_m.max())
    return {
        "per_K": per_K,
        "source": source if given is None else "study",
        "is_fibre": chosen.grade.material_class == "fibre",
        "paid_out_m": abs(per_K) * _largest_change_K(study) * longest_m,
    }


def groups(analysis: Analysis) -> Context | None:
    """What each group of cables gets; None if the study has no groups."""
    choice = analysis.groups
    if choice is None:
        return None
    return {
        "choice": choice,
        "decimals_kN": fmt.decimals(p.cable.allowable_tension_N / 1e3 for p in choice.chosen.ropes),
        "most_proposals": _MOST_PROPOSALS,
        "is_estimated": analysis.selection is not None
        and analysis.selection.price_estimate is not None,
    }


def stiffness(analysis: Analysis) -> Context | None:
    """Displacements under a force; None without a workspace, or where no cable holds."""
    qualities = analysis.qualities
    if qualities is None or qualities.stiffness is None:
        return None
    return {"survey": qualities.stiffness, "cable": qualities.cable.name}


def modes(analysis: Analysis) -> Context | None:
    """Natural frequencies and shapes; None where none are known."""
    found = analysis.modes
    if found is None:
        return None
    qualities = analysis.qualities
    survey = None if qualities is None else qualities.stiffness
    rows = [(m, m.shape[:3].tolist(), np.degrees(m.shape[3:]).tolist()) for m in found.modes]
    return {"found": found, "rows": rows, "survey": survey}


def clearance(analysis: Analysis) -> Context | None:
    """How near things come; None if the study asks for no clearance, or no cable holds."""
    qualities = analysis.qualities
    if qualities is None or qualities.interference is None:
        return None
    survey = qualities.interference
    pairs = (
        ("Two cables", survey.among_cables),
        ("A cable and the platform", survey.to_platform),
    )
    return {
        "survey": survey,
        "cable": qualities.cable.name,
        "pairs": [pair for pair in pairs if pair[1] is not None],
    }


def fabrication(analysis: Analysis) -> Context | None:
    """Lengths of each cable, and what its rope asks of drums; None without a product."""
    cables = fabricated_cables(analysis)
    if not cables:
        return None
    assert analysis.study.selection is not None
    ropes: dict[tuple[str, str], list[FabricatedCable]] = {}
    for cable in cables:
        ropes.setdefault((cable.grade.id, cable.size.id), []).append(cable)
    return {
        "cables": cables,
        "ropes": [*ropes.values()],
        "allowance": Allowance.of(analysis.study.selection, analysis.study.robot.winches),
        "drum": cables[0].drum,
        "dead_turns": DEAD_TURNS,
    }


def path(analysis: Analysis) -> Context | None:
    """What the winches do along the path; None without one, or where an instant is not held."""
    path, qualities = analysis.path, analysis.qualities
    if path is None or qualities is None or not path.is_held:
        return None
    summary = path.to_dict()
    energies = [[energy.sum() for energy in case.energy_J] for case in path.of_largest_energy]
    return {
        "path": path,
        "is_redundant": analysis.study.robot.is_redundant,
        "summary": summary,
        "shown": path.shown,
        "rows": _without_traces(summary["winches"]),
        "totals": [(case.name, *both) for case, both in zip(path.cases, energies, strict=True)],
        "energy": ("kJ", 1e3) if max(map(sum, energies)) >= 1e3 else ("J", 1.0),
        "inertia_share": max(case.cable_share for case in path.cases),
        "winches": analysis.built.robot.winches,
        "cable": qualities.cable.name,
        "bending": list(zip(path.cases, path.bending, strict=True)),
    }


def _without_traces(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return rows with zeros for numbers that are nothing beside the largest of their column."""
    largest = {
        name: max(abs(row[name]) for row in rows)
        for name, value in rows[0].items()
        if isinstance(value, float)
    }
    return [
        {k: 0.0 if k in largest and abs(v) < _TRACE * largest[k] else v for k, v in row.items()}
        for row in rows
    ]


def reactions(analysis: Analysis) -> Context | None:
    """What each support bears in each load case; None where no cable holds."""
    if not analysis.reactions or analysis.qualities is None:
        return None
    supports: dict[tuple[int, str], dict[str, Reaction]] = {}
    for reaction in analysis.reactions:
        supports.setdefault((reaction.mast, reaction.load_case), {})[reaction.extreme] = reaction
    return {
        "supports": supports,
        "cable": analysis.qualities.cable.name,
        "has_winch_branch": analysis.reactions[0].winch_branch_N is not None,
    }


def proof_statement(proved: Proof) -> Statement:
    """Return what is proved, in a sentence or two."""
    return plain_statement("report/proved.html.j2", {"proved": proved})


def proof(analysis: Analysis) -> Context | None:
    """What was proved of the chosen rope, and how; None where nothing was to be."""
    selection = analysis.selection
    proved = None if selection is None else selection.proof
    return None if proved is None or proved.status == "off" else {"proved": proved}


def assumptions(analysis: Analysis) -> Context:
    """What the results rest on."""
    robot = analysis.built.robot
    force, moment = np.split(robot.platform.wrench_N, [3])
    down = robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    qualities = analysis.qualities
    return {
        "robot": robot,
        "checks_crossing": qualities is not None and qualities.interference is not None,
        "effects": list(dict.fromkeys(effect.id for effect in analysis.study.effects)),
        "rope_effects": rope_effects(analysis.study),
        "force_N": force if force.any() else None,
        "moment_Nm": moment if moment.any() else None,
        "down": None if np.array_equal(down, [0.0, 0.0, -1.0]) else down,
        "gravity_m_per_s2": STANDARD_GRAVITY_M_PER_S2,
    }


def nomenclature(_: Analysis) -> Context:
    """The names of quantities, which stand in the template."""
    return {}


def verification(analysis: Analysis) -> Context | None:
    """Ours beside what other methods find; None where nothing was solved."""
    return {"answers": analysis.verification} if analysis.verification else None


def uncertainty(analysis: Analysis) -> Context | None:
    """Probabilities and shares; None where nobody asked and no modulus is borrowed."""
    from designer.analysis.uncertainty import SCRAMBLES

    survey = analysis.uncertainty
    if survey is None:
        asks = analysis.study.uncertainty is not None
        return {"uncertainty": None} if asks else None
    sizes = [
        {"odds": odds, "median": middle, "highest": high}
        for odds in survey.sizes
        for middle, high in [np.percentile(odds.utilisation, [50.0, 95.0], method="higher")]
    ]
    return {"uncertainty": survey, "sizes": sizes, "scrambles": SCRAMBLES}


def left_out(analysis: Analysis) -> Context | None:
    """The grades that were not considered; None without a selection."""
    selection = analysis.study.selection
    if selection is None:
        return None
    excluded: dict[str, list[str]] = {}
    for grade in analysis.catalogue.grades:
        if why := grade.why_excluded(selection):
            excluded.setdefault(why, []).append(grade.id)
    return {
        "not_allowed": excluded.pop(NOT_NAMED, []),
        "excluded": excluded,
        "rejected": analysis.left_out,
    }


def inputs(analysis: Analysis) -> Context:
    """The fields that the file gives."""
    entries = analysis.study.source.entries
    given = [(entry.field, _as_given(entry)) for entry in entries if entry.given != "default"]
    return {"given": _halves(given), "has_defaults": bool(_defaults(analysis))}


def provenance(analysis: Analysis) -> Context:
    """Program, libraries, config, time, settings, sources of grades, defaults."""
    from designer.kernel.answer import TOLERANCE

    files = ["every candidate in candidates.csv"] if analysis.selection is not None else []
    if analysis.reactions:
        files.append("the extremes of every reaction in reactions.csv")
    if analysis.path is not None:
        files.append("every instant of the path in path.csv")
    if analysis.sweep_file is not None:
        files.append(f"every sample in {analysis.sweep_file.name}")
    left = _left_at_default(analysis)
    return {
        "tolerance": TOLERANCE,
        "files": files,
        "defaults": _halves(_defaults(analysis)),
        "not_given": [entry.field for entry in left if entry.value_SI == "none"],
    }


def _left_at_default(analysis: Analysis) -> list[Entry]:
    """Return the fields left out, but those that a drawing office writes on a document."""
    entries = analysis.study.source.entries
    return [e for e in entries if e.given == "default" and not e.field.startswith("document.")]


def _defaults(analysis: Analysis) -> list[tuple[str, str]]:
    """Return the fields left out that have a value all the same."""
    return [(e.field, e.value_SI) for e in _left_at_default(analysis) if e.value_SI != "none"]


def _as_given(entry: Entry) -> str:
    """Return a value as the file gives it, where that has its unit, else in SI units."""
    has_unit = entry.given[:1] not in "[{" and any(c.isalpha() for c in entry.given)
    return entry.given if has_unit else fmt.shorter(entry.value_SI)


def _halves(cells: list[tuple[str, str]]) -> list[tuple[str, str, str, str]]:
    """Return fields and values, the first half on the left."""
    half = (len(cells) + 1) // 2
    pairs = zip_longest(cells[:half], cells[half:], fillvalue=("", ""))
    return [(*left, *right) for left, right in pairs]
