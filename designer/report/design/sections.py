"""What the template of each section of the design report gets, in the order of the report.

Each function takes the analysis and returns a context, or None where the study gives nothing for
the section; nothing is computed that the analysis does not have.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import product, zip_longest
from typing import TYPE_CHECKING, Any, SupportsFloat

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.governing import GoverningPose
from designer.analysis.lengths import FabricatedCable, fabricated_cables
from designer.analysis.pose import PoseAnalysis
from designer.analysis.reactions import Reaction
from designer.analysis.sensitivity import Sensitivities, SensitivityReport
from designer.grades.grade import NOT_NAMED, TRUST_MEANING
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Material
from designer.model.verdict import Verdict
from designer.model.winches import DEAD_TURNS
from designer.proof.prove import Proof
from designer.report import format as fmt
from designer.report.design.first_page import by_title, outside_pose
from designer.report.document import MOST_ROWS
from designer.report.figures.charts_selection import rank
from designer.report.templates import Statement, plain_statement
from designer.selection.candidate import MEANINGS, Candidate
from designer.selection.reeving import Allowance
from designer.selection.result import GradeOutcome, SelectionResult
from designer.sizing.loop import Iterate, LoopSizing
from designer.statics.cable_loss import Fate
from designer.study import Entry, Study, rope_effects
from designer.workspace.effort import COARSE

if TYPE_CHECKING:
    from designer.report.design.drawings import Drawings

Context = Mapping[str, object]

_TRACE = 1e-4
"""Of the largest number of a column: below, a number is what differences leave of nothing."""
_MOST_PROPOSALS = 12
"""As many as a page has room for; result.json has all."""
_NAMES = {
    "payload": "Payload",
    "breaking_load": "Breaking load",
    "efficiency": "End fittings, bending and sheaves keep",
    "modulus": "Stiffness EA",
    "linear_mass": "Mass of the rope",
}
_OF_ALL_GROUPS = ("payload", "breaking_load", "efficiency")
STEP_M = 0.01
"""By how much places are moved: a centimetre, as a surveyor may be off by."""
_PART = 0.01
"""By which part other inputs grow: one per cent."""
_MOST_MOVES = 3
"""As many exit points as a reader compares; result.json has all."""
Change = tuple[str, float]
"""An input, and what it changes of the utilisation."""
_MOST_NAMES = 3
_MOST_ITERATIONS = 8
"""As many as stand beside a figure; of more, the first and the last."""
_LAST_ITERATIONS = 3
_FAR = 100.0
"""Tension over that of the start from where on a diverging iteration has no figures."""


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
    write = fmt.alike((cable.exit_tension_N for cable in pose.cables), 5)
    return {
        **shown,
        "governing_cable": pose.cables[int(pose.equilibrium.cable_tension_N.argmax())].cable,
        "tensions": [write(one.exit_tension_N, one.platform_tension_N) for one in pose.cables],
        "forces": _forces(pose),
    }


def _forces(pose: GoverningPose) -> list[tuple[str, list[str]]]:
    """Return each force on the platform with its components, and their sum."""
    named = [(f"cable {one.cable}", one.pull_N) for one in pose.cables]
    write = fmt.alike((float(x) for _, force in (*named, *pose.loads) for x in force), 5)
    rows = [(fmt.capital(name), [*write(*force)]) for name, force in (*named, *pose.loads)]
    return [*rows, ("Sum", [*write(*(pose.force_sum_N.round(6) + 0.0))])]


def sensitivities(analysis: Analysis) -> Mapping[str, object] | None:
    """What carries the result; None where no rope is chosen."""
    carries, groups = analysis.sensitivity, analysis.group_slopes
    if carries is not None:
        return _of_one_rope(carries)
    return _of_groups(groups) if groups else None


def _of_one_rope(carries: SensitivityReport) -> Mapping[str, object]:
    slopes, utilisation = carries.sensitivities, carries.governing.utilisation
    platform = carries.governing.loaded.bare[0].platform
    values = {
        "payload": fmt.kilograms(platform.mass_kg),
        "breaking_load": fmt.newtons(slopes.of("breaking_load").value),
        "efficiency": fmt.percent(slopes.of("efficiency").value),
        "modulus": fmt.newtons(slopes.of("modulus").value),
        "linear_mass": fmt.kilograms_per_metre(slopes.of("linear_mass").value),
    }
    return {
        "carries": carries,
        "platform": platform,
        "inputs": [
            (name, values[key], _PART * utilisation * slopes.of(key).elasticity)
            for key, name in _NAMES.items()
        ],
        "moves": [(name, STEP_M * slope) for name, slope in slopes_of_moves(carries)],
        "step_m": STEP_M,
        "nearest_why": "" if carries.nearest is None else _reason(carries.nearest.why),
        "failure_heads": [(one.name.replace("-", "−"), "m") for one in carries.failures],
    }


def slopes_of_moves(carries: SensitivityReport) -> list[Change]:
    """Return what moves outward, and the exit points that matter most, with their slopes [1/m]."""
    moves = [("Sides of the region outward", carries.sensitivities.of("region").derivative)]
    slopes = carries.sensitivities.exit_points_per_m
    order = np.argsort(-np.abs(np.nan_to_num(slopes)).ravel(), kind="stable")
    for at in order[:_MOST_MOVES].tolist():
        cable, axis = divmod(at, 3)
        moves.append((f"Exit point {cable + 1} along {'xyz'[axis]}", float(slopes[cable, axis])))
    return [(name, slope) for name, slope in moves if math.isfinite(slope)]


def shares_of_inputs(carries: SensitivityReport) -> list[Change]:
    """Return the elasticity of each input over that of the strength, where it is known."""
    slopes = carries.sensitivities
    utilisation = -slopes.of("efficiency").derivative * slopes.of("efficiency").value
    each = [(name, slopes.of(key).elasticity) for key, name in _NAMES.items()]
    return [(name, utilisation * value) for name, value in each if math.isfinite(value)]


def _reason(name: str) -> str:
    if name == "overloaded":
        return "its utilisation is beyond 100\u00a0%"
    verdict = next((verdict for verdict in Verdict if verdict.label == name), None)
    return name if verdict is None else verdict.clause


def _of_groups(groups: tuple[Sensitivities, ...]) -> Mapping[str, object]:
    names = [group.group.name for group in groups if group.group]
    inputs = [(key, name) for key, name in _NAMES.items() if key in _OF_ALL_GROUPS]
    inputs += [(f"modulus_{name}", f"Stiffness EA of {name}") for name in names]
    inputs += [(f"linear_mass_{name}", f"Mass of the rope of {name}") for name in names]
    return {
        "carries": None,
        "groups": groups,
        "group_heads": [(name, "") for name in names],
        "inputs": [
            (title, [_PART * group.utilisation * group.of(key).elasticity for group in groups])
            for key, title in inputs
        ],
        "moves": [
            (title, [STEP_M * slope for slope in slopes]) for title, slopes in _group_moves(groups)
        ],
        "step_m": STEP_M,
    }


def _group_moves(groups: tuple[Sensitivities, ...]) -> Iterator[tuple[str, list[float]]]:
    """Yield what moves outward, and the exit points that matter most, with the slopes [1/m]."""
    region = [group.of("region").derivative for group in groups]
    if any(region):
        yield "Sides of the region outward", region
    each = np.stack([group.exit_points_per_m for group in groups])
    largest = np.nan_to_num(np.abs(each)).max(axis=0)
    for at in np.argsort(-largest, axis=None, kind="stable")[:_MOST_MOVES].tolist():
        cable, axis = divmod(at, 3)
        yield f"Exit point {cable + 1} along {'xyz'[axis]}", each[:, cable, axis].tolist()


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
        "few_samples": COARSE.settling,
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


def workspace(analysis: Analysis) -> Context | None:
    """What is known of all poses, of the ropes of the answer, else of the configured family.

    None if the study has no workspace.
    """
    ropes = analysis.ropes
    if analysis.workspace is None:
        return None
    if ropes is None:
        return {"ropes": None, **_of_family(analysis)}
    return {"ropes": ropes, "map": analysis.workspace}


def family(analysis: Analysis) -> Context | None:
    """What all poses ask of the configured family, where a rope is the answer."""
    if analysis.workspace is None or analysis.ropes is None:
        return None
    outcome = analysis.findings.chosen_outcome
    beside = None if outcome is None else _comparison(analysis, outcome)
    return {"ropes": analysis.ropes, "comparison": beside, **_of_family(analysis)}


def _of_family(analysis: Analysis) -> Context:
    workspace = analysis.study.workspace
    assert workspace is not None and analysis.workspace is not None
    counts = [(v, analysis.workspace.census.statuses[v.label]) for v in Verdict]
    robot, corners = analysis.built.robot, np.array([*product(*workspace.region.bounds_m.T)])
    up = robot.upright[2]
    return {
        "map": analysis.workspace,
        "other": analysis.findings.other_policy,
        "verdicts": [(verdict, amount) for verdict, amount in counts if amount > 0],
        "other_verdicts": [verdict.label for verdict, amount in counts if amount == 0],
        "from_below": (robot.exit_points_m @ up).min() < (corners @ up).min(),
    }


def _comparison(analysis: Analysis, outcome: GradeOutcome) -> Context:
    """Return why the rope that is bought is not the cable that was configured.

    Of the configured family, of the chosen grade in any diameter, and of the chosen size.

    Raises
    ------
    ValueError
        If no size of the grade fits.
    """
    best, real = outcome.best, outcome.family.averaged
    if best is None:
        raise ValueError(f"no size of {outcome.grade.id} fits")
    ideal = analysis.built.material(analysis.study.material).averaged
    materials = ideal, real, _material_of(best)
    sagging = analysis.workspace.sagging if analysis.workspace else None
    optimum_m, size_m = outcome.continuous_diameter_m, best.size.diameter_m
    diameters = sagging.diameter_m if sagging else math.nan, optimum_m, size_m
    areas = [math.pi * diameter**2 / 4.0 for diameter in diameters]
    masses = [m.density_kg_per_m3 * area for m, area in zip(materials, areas, strict=True)]
    # A continuous optimum is at its allowable tension, unless spare cables leave a choice.
    is_free = analysis.built.robot.is_redundant
    return {
        "best": best,
        "materials": materials,
        "diameters_m": diameters,
        "masses_kg_per_m": masses,
        "tensions_N": (
            sagging.max_tension_N if sagging else math.nan,
            math.nan if is_free else real.allowable_stress_Pa * areas[1],
            best.verification.max_tension_N,
        ),
        "stress": real.allowable_stress_Pa / ideal.allowable_stress_Pa,
        "density": real.density_kg_per_m3 / ideal.density_kg_per_m3,
        "stiffness": real.youngs_modulus_Pa / ideal.youngs_modulus_Pa,
        "thicker": size_m / optimum_m - 1.0,
        "heavier": best.cable.mean_density_kg_per_m / masses[1] - 1.0,
    }


def _material_of(candidate: Candidate) -> Material:
    area_m2 = candidate.size.nominal_area_m2
    return Material(
        density_kg_per_m3=candidate.cable.mean_density_kg_per_m / area_m2,
        youngs_modulus_Pa=candidate.cable.axial_stiffness_N / area_m2,
        allowable_stress_Pa=candidate.cable.allowable_tension_N / area_m2,
    )


def selection(analysis: Analysis) -> Context | None:
    """What was chosen and tried; None if the study asks for no rope."""
    result = analysis.selection
    if result is None:
        return None
    tried, meanings = result.candidates, [MEANINGS[o] for o in result.objectives]
    best, alternatives = _best(result, result.outcomes), _best(result, result.alternatives)
    of_materials = result.best_of_materials(analysis.own_material)
    trusts = {outcome.grade.trust for outcome in result.outcomes}
    return {
        "selection": result,
        "titles": [meaning.title for meaning in meanings],
        "first": meanings[0],
        "less_is_better": not any(meaning.more_is_better for meaning in meanings),
        "fitting": sum(outcome.outcome == "fits" for outcome in result.outcomes),
        "holding": sum(c.verification.holds for c in tried),
        "at_first": max(
            (
                case.sampled.samples
                for c in tried
                for case in c.cases
                if c.verification.holds and not case.sampled.is_complete
            ),
            default=None,
        ),
        "trust_meaning": TRUST_MEANING,
        "trusts": [letter for letter in TRUST_MEANING if letter in trusts],
        "front_form": _form(result.front),
        "has_cases": any(
            len({case.case.name for case in c.cases}) > 1 for c in result.front[:MOST_ROWS]
        ),
        "best": best,
        "best_form": _form(best),
        "of_materials": of_materials,
        "of_materials_form": _form(of_materials),
        "alternatives": alternatives,
        "alternatives_form": _form(alternatives),
        "thin": [outcome for outcome in rank(result.outcomes) if outcome.outcome != "fits"],
        "dominating": Counter(c.dominated_by.label for c in tried if c.dominated_by).most_common(),
        "most_names": _MOST_NAMES,
        "searched": sum(c.verification.is_refined for c in tried),
    }


def _best(result: SelectionResult, outcomes: Sequence[GradeOutcome]) -> list[Candidate]:
    """Return the best size of each grade that holds, the chosen one and then the best first."""
    best = [outcome.best for outcome in outcomes if outcome.best is not None]
    objective = result.objectives[0]
    return sorted(best, key=lambda c: (c.standing != "chosen", c.figures.burden(objective)))


def _form(candidates: Sequence[Candidate]) -> Context:
    """Return the unit of forces and the decimals of numbers in a table of the first of these."""
    shown = candidates[:MOST_ROWS]
    smallest_N = min((c.verification.max_tension_N for c in shown), default=0.0)
    unit, scale = fmt.force_unit(smallest_N)
    return {
        "unit": unit,
        "scale": scale,
        "tension": fmt.decimals([smallest_N / scale], 4),
        "force": fmt.decimals(c.cable.allowable_tension_N / scale for c in shown),
        "mass": fmt.decimals(c.total_mass_kg for c in shown),
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


def pose(analysis: Analysis) -> Context | None:
    """What is known of the configured pose; None if the study has none."""
    found = analysis.pose
    if found is None:
        return None
    statics = found.sizing.statics
    return {
        "pose": found,
        "verdict": Verdict(int(statics.verdict)),
        "pose_outside": outside_pose(analysis),
        "rotation_vector_deg": _rotation_vector_deg(found),
        "balance_residual": float(np.max(np.abs(statics.equilibrium_residual_N())))
        if statics.is_solved
        else math.nan,
        "ways": [*_ways(found)],
        "iterations": iterations(found.loop) if found.loop.iterates else None,
        "weight_effect": weight_effect(found),
        "cables": _cables(found) if statics.is_solved else None,
    }


def weight_effect(found: PoseAnalysis) -> float | None:
    """Return by what share sag changes the largest tension; None where it is not known."""
    start = float(found.massless.largest_tension_N)
    if not found.sizing.statics.is_solved or not math.isfinite(start):
        return None
    return float(found.sizing.statics.largest_tension_N) / start - 1.0


def _rotation_vector_deg(found: PoseAnalysis) -> list[float] | None:
    from scipy.spatial.transform import Rotation

    statics = found.sizing.statics
    if statics.robot.is_point_mass:
        return None
    turn = np.degrees(Rotation.from_matrix(statics.poses.rotation).as_rotvec())
    return [float(component) for component in turn]


def _ways(found: PoseAnalysis) -> Iterator[Context]:
    """Yield the diameter and the tension by each way of sizing."""
    massless, sizing, loop = found.massless, found.sizing, found.loop
    if np.isfinite(massless.largest_tension_N):
        yield _way("massless", sizing.massless_diameter_m, massless.largest_tension_N)
    if loop.iterates:
        last = loop.iterates[-1]
        ends = (math.nan, math.nan) if loop.has_diverged else (last.diameter_m, last.max_tension_N)
        yield _way("loop", *ends)
    if sizing.statics.is_solved:
        yield _way("optimum", sizing.diameter_m, sizing.statics.largest_tension_N)


def _way(name: str, diameter_m: SupportsFloat, tension_N: SupportsFloat) -> Context:
    return {"name": name, "diameter_m": float(diameter_m), "tension_N": float(tension_N)}


def iterations(loop: LoopSizing) -> Context:
    """Return the iterations of the loop; of a long one, the first and the last."""
    numbered = list(enumerate(loop.iterates))
    if len(numbered) > _MOST_ITERATIONS:
        first = numbered[: _MOST_ITERATIONS - _LAST_ITERATIONS]
        numbered = [*first, *numbered[-_LAST_ITERATIONS:]]
    typical = loop.iterates[0 if loop.has_diverged else -1]
    unit, scale = fmt.force_unit(typical.max_tension_N)
    shown: list[tuple[int, Iterate | None, bool]] = []
    for number, iterate in numbered:
        if shown and number > shown[-1][0] + 1:
            shown.append((number - 1, None, False))
        far = iterate.max_tension_N > _FAR * typical.max_tension_N
        shown.append((number, iterate, loop.has_diverged and far))
    return {
        "unit": unit,
        "scale": scale,
        "force_decimals": fmt.decimals([typical.max_tension_N / scale], 5),
        "diameter_decimals": fmt.decimals([1e3 * typical.diameter_m], 4),
        "shown": shown,
    }


def _cables(found: PoseAnalysis) -> Context:
    statics = found.sizing.statics
    largest_N = float(statics.largest_tension_N)
    unit, scale = fmt.force_unit(largest_N)
    lengths_m = zip(statics.geometry().chord_m, statics.length_m, strict=True)
    forces_N = zip(
        statics.force_x_N,
        statics.force_z_N,
        statics.platform_tension_N,
        statics.exit_tension_N,
        found.massless.tension_N,
        strict=True,
    )
    rows = [
        {
            "lengths_m": [float(length) for length in lengths],
            "forces": [float(force) / scale for force in forces],
            "is_most_loaded": max(forces[2:4]) >= largest_N * (1.0 - 1e-9),  # rounding
        }
        for lengths, forces in zip(lengths_m, forces_N, strict=True)
    ]
    return {
        "unit": unit,
        "length_decimals": fmt.decimals([float(statics.length_m.max())], 5),
        "force_decimals": fmt.decimals([largest_N / scale], 4),
        "rows": rows,
    }


def verification(analysis: Analysis) -> Context | None:
    """Ours beside what other methods find; None where nothing was solved."""
    return {"answers": analysis.verification} if analysis.verification else None


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
