"""How far a force moves the platform."""

from __future__ import annotations

import math
from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.parts import Fact, Picture, Statement
from designer.workspace.stiffness import StiffnessSurvey


@dataclass(frozen=True, slots=True)
class StiffnessSection:
    """Displacement under a force, with cables of fixed length.

    Parameters
    ----------
    verdict : Statement
        Whether the platform stays where it is put, and how far a force moves it at most.
    facts : tuple of Fact
        Which cable, the softest and the stiffest pose.
    map : Picture or None
        Over a section at the middle height.
    """

    verdict: Statement
    facts: tuple[Fact, ...]
    map: Picture | None


def stiffness_section(analysis: Analysis, picture: Picture | None) -> StiffnessSection | None:
    """Return the section on stiffness; None if the study has no workspace, or no cable holds."""
    found = analysis.qualities
    if found is None or found.stiffness is None:
        return None
    facts = _facts(found.stiffness, found.cable.name)
    return StiffnessSection(stiffness_statement(found.stiffness), facts, picture)


def displacement(value_m_per_N: float) -> str:
    """Return a displacement under a unit force such as ``7 700 mm/kN``."""
    return f"{fmt.number(1e6 * value_m_per_N, 3)}\u00a0mm/kN"


def stiffness_statement(found: StiffnessSurvey) -> Statement:
    """Return whether the platform stays where it is put, and how far a force moves it."""
    farthest = displacement(found.softest_m_per_N)
    text = (
        f"A force moves the platform by at most {farthest}, "
        "if the cables are held at their lengths: the force in its worst direction, the platform "
        "at its softest pose, searched for between the samples as well, and the displacement taken "
        "as proportional to it."
    )
    if math.isfinite(found.softest_m_per_N):
        return Statement("No pose was found that is not stable", text)
    share = (
        f"in {fmt.share(found.unstable, found.samples)} of the samples"
        if found.unstable
        else "between the samples"
    )
    return Statement(
        "Some poses are not stable",
        f"The platform would not stay where it is put {share}, "
        f"such as at {fmt.position(found.softest_place[:3])}.",
        "bad",
    )


def _facts(found: StiffnessSurvey, cable: str) -> tuple[Fact, ...]:
    is_finite = math.isfinite(found.softest_m_per_N)
    return (
        Fact("Cable", cable),
        Fact(
            "Softest pose",
            displacement(found.softest_m_per_N) if is_finite else "not stable",
            f"at {fmt.position(found.softest_place[:3])}",
        ),
        Fact(
            "Stiffest pose",
            displacement(found.stiffest_m_per_N),
            f"at {fmt.position(found.stiffest_place[:3])}",
        ),
        Fact("Samples", fmt.count(found.samples)),
    )
