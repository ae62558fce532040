"""What lies behind the answer: grades left out, assumptions, names of quantities, provenance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.analysis.analyse import Analysis
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.robot import Robot
from designer.report import format as fmt
from designer.report.parts import MOST_ROWS, Column, Fact, Row, Table
from designer.study import Selection


@dataclass(frozen=True, slots=True)
class LeftOutSection:
    """Grades that were not considered.

    Parameters
    ----------
    not_allowed : str
        How many grades of the catalogue the study does not allow, and which if they are few;
        empty where it allows all.
    by_name_only : tuple of str
        Kinds of grades that a study must name, each with why; empty where none is left out.
    problems : tuple of str
        Plugins, grades and effects that could not be loaded, and why.
    """

    not_allowed: str
    by_name_only: tuple[str, ...]
    problems: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AssumptionsSection:
    """Figures within the text of the assumptions.

    Parameters
    ----------
    gravity : str
        Gravitational acceleration.
    loads : str
        What acts beside the weight, another direction of gravity, the least tension; empty
        without any.
    safety : str
        What the safety factor is and what it is applied to; empty without a selection.
    platform : str
        A point mass, or a platform that can turn.
    exits : str
        Whether the cables leave from points or over pulleys.
    losses : str
        Which losses of strength are counted.
    effects : str
        Ids of the declared effects, which all results include; empty without any.
    section : str
        What stands for the configured family where the effects do not leave it one; else empty.
    surroundings : str
        What the laws of effects are given; empty without any.
    thinnest : str
        How surely a needed diameter is the thinnest.
    """

    gravity: str
    loads: str
    safety: str
    platform: str
    exits: str
    losses: str
    effects: str
    section: str
    surroundings: str
    thinnest: str


@dataclass(frozen=True, slots=True)
class ProvenanceSection:
    """Where the numbers come from.

    Parameters
    ----------
    facts : tuple of Fact
        Program, libraries, config, time, settings.
    catalogues : Table
        Where grades came from.
    """

    facts: tuple[Fact, ...]
    catalogues: Table


def left_out_section(analysis: Analysis) -> LeftOutSection | None:
    """Return the grades that were not considered; None without a selection."""
    selection, catalogue = analysis.study.selection, analysis.catalogue
    if selection is None:
        return None
    allowed = selection.grades
    names = [
        g.id
        for g in catalogue.grades
        if allowed is not None and g.id not in allowed and not g.why_only_by_name
    ]
    return LeftOutSection(_not_allowed(sorted(names)), _by_name_only(analysis), analysis.left_out)


def _not_allowed(names: Sequence[str]) -> str:
    if not names:
        return ""
    if len(names) <= MOST_ROWS:
        return f"The study does not allow these grades of the catalogue: {fmt.listing(names)}."
    return (
        f"The catalogue has {fmt.plural(len(names), 'more grade')}, which the study does not allow "
        "in selection.grades. The command designer catalog list shows all."
    )


def _by_name_only(analysis: Analysis) -> tuple[str, ...]:
    wanted = analysis.study.selection and analysis.study.selection.grades
    kinds: dict[str, list[str]] = {}
    for grade in analysis.catalogue.grades:
        if grade.why_only_by_name and grade.id not in (wanted or ()):
            kinds.setdefault(grade.why_only_by_name, []).append(grade.id)
    return tuple(
        f"{fmt.plural(len(names), 'grade')} such as {names[0]}: {why}."
        for why, names in kinds.items()
    )


def assumptions_section(analysis: Analysis) -> AssumptionsSection:
    """Return the figures within the text of the assumptions."""
    study = analysis.study
    robot, selection = analysis.built.robot, study.selection
    safety = ""
    if selection is not None:
        factor = fmt.trimmed(selection.safety_factor)
        safety = f"The safety factor of {factor} applies to the minimum breaking load."
    effects = ", ".join(dict.fromkeys(effect.id for effect in study.effects))
    return AssumptionsSection(
        gravity=f"{fmt.number(STANDARD_GRAVITY_M_PER_S2, 3)}\u00a0m/s²",
        safety=safety,
        exits=_exits(robot.pulley_radius_m),
        losses=_losses(selection),
        effects=effects,
        section=_section(analysis.section_m),
        surroundings=f"{fmt.trimmed(study.surroundings.temperature_C)}\u00a0°C" if effects else "",
        platform=_platform(robot),
        loads=_loads(robot),
        thinnest=_thinnest(robot),
    )


def _thinnest(robot: Robot) -> str:
    if robot.has_one_branch:
        return (
            "A point mass on as many cables as it has degrees of freedom has one equilibrium for "
            "each cable, so a needed diameter is the thinnest there is."
        )
    return (
        "The cables may run in more than one way: one may hang as a counterweight, or be pulled "
        "tight. At each pose the multipliers of the way found tell what a cable could gain by "
        "hanging or by more pull; where that is above 0.05 % of the weight, other ways are tried: "
        "each cable hanging in turn, all cables with half their pull, and random pulls. A needed "
        "diameter is the thinnest that was found; it is not proved that there is no thinner one."
    )


def _section(section_m: float | None) -> str:
    if section_m is None:
        return ""
    return (
        "They do not act alike on all sections. The configured family is computed with what they "
        f"make of its member of {fmt.millimetres(section_m)}, which is right for the worst pose; "
        "poses that need less are mapped a little too thin."
    )


def _platform(robot: Robot) -> str:
    kind = "point mass" if robot.is_point_mass else "rigid platform that can turn"
    where = ", guided in a vertical plane" if robot.is_planar else ""
    return f"{kind} of {fmt.kilograms(robot.platform.mass_kg)} on {robot.n_cables} cables{where}"


def _loads(robot: Robot) -> str:
    """Return what acts on the platform beside its weight, and where the weight points."""
    parts = []
    force, moment = robot.platform.wrench_N[:3], robot.platform.wrench_N[3:]
    if force.any():
        row = ", ".join(fmt.trimmed(float(x)) for x in force)
        parts.append(f"A constant force of ({row})\u00a0N acts on the platform beside its weight.")
    if moment.any():
        row = ", ".join(fmt.trimmed(float(x)) for x in moment)
        parts.append(f"A constant moment of ({row})\u00a0N·m acts on the platform.")
    down = robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    if not np.array_equal(down, [0.0, 0.0, -1.0]):
        row = ", ".join(fmt.trimmed(float(x), 3) for x in down)
        parts.append(f"Things fall along ({row}).")
    if robot.tension_min_N > 0.0:
        least = fmt.newtons(robot.tension_min_N)
        parts.append(f"No cable has less than {least} anywhere along it.")
    return " ".join(parts)


def _losses(selection: Selection | None) -> str:
    bends = selection is not None and selection.sheave_diameter_m is not None
    ends = selection is not None and selection.termination_efficiency < 1.0
    if selection is None or not (bends or ends):
        return (
            "Loss of strength by bending over a drum or a sheave (D/d) is not counted, nor are "
            "terminations."
        )
    parts = []
    if ends:
        share = fmt.trimmed(selection.termination_efficiency, 3)
        parts.append(f"the end fittings leave {share} of the breaking load")
    if selection.sheave_diameter_m is not None:
        sheave = fmt.millimetres(selection.sheave_diameter_m)
        parts.append(
            f"bending over {sheave} leaves a wire rope 1 − 0.5/√(D/d) of it, a fibre rope all, "
            "down to the least D/d of its maker (Noble Denton 0027/ND, 7.8)"
        )
    text = f"{' and '.join(parts)}{'; the smaller share counts' if len(parts) > 1 else ''}"
    return f"{text[0].upper()}{text[1:]}. Fatigue of a rope that runs over sheaves is not counted."


def _exits(pulley_radius_m: float) -> str:
    if pulley_radius_m == 0.0:
        return "Exit points are fixed points, without pulleys."
    radius = fmt.trimmed(1e3 * pulley_radius_m)
    return (
        f"The cables leave over swivelling pulleys of {radius}\u00a0mm radius at the exit points."
    )


def provenance_section(analysis: Analysis) -> ProvenanceSection:
    """Return where the numbers come from."""
    sources = (
        Row((source.name, source.source, fmt.count(source.n_grades)))
        for source in analysis.catalogue.sources
    )
    name, where = (Column(title, is_number=False) for title in ("Name", "Where from"))
    return ProvenanceSection(
        facts=_facts(analysis),
        catalogues=Table.of("Sources of grades.", (name, where, Column("Grades")), *sources),
    )


def _facts(analysis: Analysis) -> tuple[Fact, ...]:
    from designer.kernel.answer import TOLERANCE

    provenance, study = analysis.provenance, analysis.study
    libraries = ", ".join(f"{name} {version}" for name, version in provenance.libraries)
    facts = [
        Fact("Program", f"cdpr-designer {provenance.version}"),
        Fact("Libraries", libraries),
        Fact("Configuration", study.source.path.name),
        Fact("SHA-256 of the configuration", study.source.sha256),
        Fact("Computed", created(analysis)),
        Fact("On", provenance.system),
        Fact("Solver tolerance", fmt.power_of_ten(TOLERANCE), "relative residual of a solved pose"),
    ]
    if study.workspace is not None and analysis.workspace is not None:
        spread = study.workspace.sampling.replace("_", " ")
        facts.append(Fact("Samples", fmt.count(analysis.workspace.census.samples), spread))
        facts.append(Fact("Seed", str(study.workspace.seed)))
    if analysis.selection is not None:
        facts.append(Fact("Every candidate", "candidates.csv", "table, beside this report"))
    if analysis.sweep_file is not None:
        facts.append(Fact("Every sample", analysis.sweep_file.name, "NetCDF, beside this report"))
    return tuple(facts)


def created(analysis: Analysis) -> str:
    """Return date and time of the analysis."""
    return analysis.provenance.created.strftime("%Y-%m-%d %H:%M %z").strip()
