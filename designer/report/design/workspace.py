"""All poses: what the templates get of the ropes of the answer, and of the configured family."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product

import numpy as np

from designer.analysis.analyse import Analysis
from designer.model.cable import Material
from designer.model.verdict import Verdict
from designer.selection.candidate import Candidate
from designer.selection.result import GradeOutcome

Context = Mapping[str, object]


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
