"""How far a force moves the platform."""

from __future__ import annotations

import math

from designer.report import format as fmt
from designer.report.blocks import Box, Fact, Facts, Picture, Section, Statement
from designer.report.design.scope import in_first_orientation
from designer.report.design.source import Source
from designer.report.pictures import chart
from designer.workspace.stiffness import StiffnessSurvey


def section(source: Source) -> Section | None:
    """Return displacements under a force; None without a workspace, or where no cable holds."""
    found = source.analysis.qualities
    if found is None or found.stiffness is None:
        return None
    drawn = _map(source) if source.draws else None
    facts = _facts(found.stiffness, found.cable.name)
    return Section.of(
        "stiffness",
        "Stiffness",
        stiffness_statement(found.stiffness),
        Box.of("lead keep", drawn, facts) if drawn is not None else facts,
        "Each cable answers with the tangent of its catenary at fixed unstrained length, so sag "
        "counts as well as stretch; the forces in the cables and the weight add their own part as "
        "the platform turns. Winches, frame and platform are taken as rigid.",
    )


def stiffness_statement(found: StiffnessSurvey) -> Statement:
    """Return whether the platform stays where it is put, and how far a force moves it."""
    if math.isfinite(found.softest_m_per_N):
        text = (
            f"A force moves the platform by at most {_displacement(found.softest_m_per_N)}, "
            "if the cables are held at their lengths: the force in its worst direction, the "
            "platform at its softest pose, searched for between the samples as well, and the "
            "displacement taken as proportional to it."
        )
        return Statement("No pose was found that is not stable", text)
    share = f"in {fmt.share(found.unstable, found.samples)} of the samples"
    return Statement(
        "Some poses are not stable",
        f"The platform would not stay where it is put "
        f"{share if found.unstable else 'between the samples'}, "
        f"such as at {fmt.position(found.softest_place[:3])}.",
        "bad",
    )


def _displacement(value_m_per_N: float) -> str:
    if not math.isfinite(value_m_per_N):
        return "not stable"
    return f"{fmt.number(1e6 * value_m_per_N, 3)}\u00a0mm/kN"


def _facts(found: StiffnessSurvey, cable: str) -> Facts:
    extremes = (
        ("Softest pose", found.softest_m_per_N, found.softest_place),
        ("Stiffest pose", found.stiffest_m_per_N, found.stiffest_place),
    )
    poses = (
        Fact(name, _displacement(size), f"at {fmt.position(place[:3])}")
        for name, size, place in extremes
    )
    return Facts((Fact("Cable", cable), *poses, Fact("Samples", fmt.count(found.samples))))


def _map(source: Source) -> Picture | None:
    from designer.report.figures.sections import stiffness_map

    return chart(
        "Displacement of the platform under a force in its worst direction, at the middle height "
        f"of the region{in_first_orientation(source.analysis.study)}.",
        "A map in plan",
        stiffness_map(source.analysis),
    )
