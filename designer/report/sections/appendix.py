"""What lies behind the answer: grades left out, assumptions, names of quantities, provenance."""

from __future__ import annotations

from dataclasses import dataclass

from designer.analysis import Analysis
from designer.cable import STANDARD_GRAVITY_M_PER_S2
from designer.report import format as fmt
from designer.report.parts import Column, Fact, Row, Table


@dataclass(frozen=True, slots=True)
class LeftOutSection:
    """Grades that were not considered.

    Parameters
    ----------
    not_allowed : tuple of str
        Ids of grades in the catalogue that the study does not allow.
    problems : tuple of str
        What the catalogue could not load, and why.
    """

    not_allowed: tuple[str, ...]
    problems: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AssumptionsSection:
    """Figures within the text of the assumptions.

    Parameters
    ----------
    gravity : str
        Gravitational acceleration.
    safety : str
        What the safety factor is and what it is applied to; empty without a selection.
    platform : str
        A point mass, or a platform that can turn.
    exits : str
        Whether the cables leave from points or over pulleys.
    effects : str
        Ids of the declared effects, which all results include; empty without any.
    """

    gravity: str
    safety: str
    platform: str
    exits: str
    effects: str


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
    names = [g.id for g in catalogue.grades if allowed is not None and g.id not in allowed]
    return LeftOutSection(tuple(sorted(names)), catalogue.problems)


def assumptions_section(analysis: Analysis) -> AssumptionsSection:
    """Return the figures within the text of the assumptions."""
    study = analysis.study
    robot, selection = analysis.built.robot, study.selection
    safety = ""
    if selection is not None:
        factor = fmt.trimmed(selection.safety_factor)
        safety = f"The safety factor of {factor} applies to the minimum breaking load."
    kind = "point mass" if robot.is_point_mass else "rigid platform that can turn"
    return AssumptionsSection(
        gravity=f"{fmt.number(STANDARD_GRAVITY_M_PER_S2, 3)}\u00a0m/s²",
        safety=safety,
        exits=_exits(robot.pulley_radius_m),
        effects=", ".join(dict.fromkeys(effect.id for effect in study.effects)),
        platform=f"{kind} of {fmt.kilograms(robot.platform.mass_kg)} on {robot.n_cables} cables",
    )


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
    if analysis.sweep_file is not None:
        facts.append(Fact("Every sample", analysis.sweep_file.name, "NetCDF, beside this report"))
    return tuple(facts)


def created(analysis: Analysis) -> str:
    """Return date and time of the analysis."""
    return analysis.provenance.created.strftime("%Y-%m-%d %H:%M %z").strip()
