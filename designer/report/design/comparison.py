"""The configured cable family beside the chosen rope, and what the step to a size costs."""

from __future__ import annotations

import math
from collections.abc import Iterable

from designer.analysis.analyse import Analysis
from designer.model.cable import Material
from designer.report import format as fmt
from designer.report.blocks import Block, Box, Column, Subheading, Table
from designer.selection.candidate import Candidate
from designer.selection.result import GradeOutcome

_OF_CASES = (
    " The best diameter is for the static load of the study, the size is what holds in every load "
    "case; its tension and utilisation are those of the case that governs."
)


def compared(analysis: Analysis, outcome: GradeOutcome) -> tuple[Block, ...]:
    """Return why the rope that is bought is not the cable that was configured.

    Raises
    ------
    ValueError
        If no size of the grade fits.
    """
    best = outcome.best
    if best is None:
        raise ValueError(f"no size of {outcome.grade.id} fits")
    heading = Subheading("comparison", "The configured cable and the rope")
    return (
        Box.of("keep", heading, _table(analysis, outcome, best)),
        *_reasons(analysis, outcome.family, best),
        _snap(outcome, best) + (_OF_CASES if analysis.study.load_cases else ""),
    )


def _table(analysis: Analysis, outcome: GradeOutcome, best: Candidate) -> Table:
    families = (
        analysis.built.material(analysis.study.material),
        outcome.family,
        _material_of(best),
    )
    sagging = analysis.workspace.sagging if analysis.workspace else None
    diameters = (
        sagging.diameter_m if sagging else math.nan,
        outcome.continuous_diameter_m,
        best.size.diameter_m,
    )
    areas = [math.pi * diameter**2 / 4.0 for diameter in diameters]
    masses = [f.density_kg_per_m3 * area for f, area in zip(families, areas, strict=True)]
    # A continuous optimum is at its allowable tension, unless spare cables leave a choice.
    is_free = analysis.built.robot.is_redundant
    tensions = (
        sagging.max_tension_N if sagging else math.nan,
        math.nan if is_free else outcome.family.allowable_stress_Pa * areas[1],
        best.verification.max_tension_N,
    )
    lines: tuple[tuple[str, Iterable[str]], ...] = (
        ("Density", (fmt.kilograms_per_cubic_metre(f.density_kg_per_m3) for f in families)),
        ("Modulus of elasticity", (fmt.pascals(f.youngs_modulus_Pa) for f in families)),
        ("Allowable stress", (fmt.pascals(f.allowable_stress_Pa) for f in families)),
        (
            "Self-supporting length",
            (f"{fmt.count(round(f.strength_length_m))}\u00a0m" for f in families),
        ),
        ("Diameter", (fmt.millimetres(d) for d in diameters)),
        ("Mass per length", (fmt.kilograms_per_metre(mass) for mass in masses)),
        ("Largest tension", fmt.newtons_alike(*tensions)),
    )
    columns = (
        *("Figure", Column("Configured family"), Column("Chosen grade, any diameter")),
        Column(f"Chosen size, {best.size.id}"),
    )
    caption = (
        "The configured cable family beside the chosen rope. Density, modulus and stress refer "
        "to the full circle of the nominal diameter. The allowable stress includes the safety "
        "factor. The self-supporting length is the hanging length whose weight alone would reach "
        "the allowable stress."
    )
    return Table.of(caption, columns, *((name, *cells) for name, cells in lines))


def _material_of(candidate: Candidate) -> Material:
    area_m2 = candidate.size.nominal_area_m2
    return Material(
        density_kg_per_m3=candidate.cable.linear_density_kg_per_m / area_m2,
        youngs_modulus_Pa=candidate.cable.axial_stiffness_N / area_m2,
        allowable_stress_Pa=candidate.cable.allowable_tension_N / area_m2,
    )


def _reasons(analysis: Analysis, real: Material, best: Candidate) -> tuple[str, ...]:
    assert analysis.study.selection is not None
    ideal, family = analysis.built.material(analysis.study.material), analysis.study.family
    stress = real.allowable_stress_Pa / ideal.allowable_stress_Pa
    density = real.density_kg_per_m3 / ideal.density_kg_per_m3
    stiffness = real.youngs_modulus_Pa / ideal.youngs_modulus_Pa
    whose = "The configured family is an assumption about a cable."
    if family is not None:
        whose = (
            f"The configured family is that of the grade {family.grade}, as if it were sold in "
            f"every diameter, at a safety factor of {fmt.trimmed(family.safety_factor)}."
        )
    share = fmt.trimmed(best.efficiency, 3)
    lost = f", times the {share} that end fittings and bending leave of it"
    return (
        f"{whose} The figures of the chosen grade come from its table. "
        "They ask for different diameters.",
        f"On the same circle the rope carries {fmt.factor(stress)} times the allowable stress, "
        f"weighs {fmt.factor(density)} times as much and is {fmt.factor(stiffness)} times as "
        f"stiff. Sag depends on strength over weight, where the rope has "
        f"{fmt.factor(stress / density)} times the configured value.",
        "The allowable stress of the rope is its breaking load over the nominal circle"
        f"{lost if best.efficiency != 1.0 else ''}, divided by the safety factor of "
        f"{fmt.trimmed(analysis.study.selection.safety_factor)}.",
    )


def _snap(outcome: GradeOutcome, best: Candidate) -> str:
    optimum_m, size_m = outcome.continuous_diameter_m, best.size.diameter_m
    lightest = outcome.family.density_kg_per_m3 * math.pi * optimum_m**2 / 4.0
    heavier = best.cable.linear_density_kg_per_m
    return (
        "Ropes come in sizes. The step from the best diameter of the grade, which would be used "
        f"to {fmt.utilisation(1.0)}, to the chosen size changes the diameter by "
        f"{fmt.signed_percent(size_m / optimum_m - 1.0)} and the mass per length by "
        f"{fmt.signed_percent(heavier / lightest - 1.0)}, and leaves "
        f"{fmt.utilisation(best.verification.utilisation)} used at the worst pose."
    )
