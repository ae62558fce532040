"""What the answer covers: orientations, the strength of ropes that counts, the configured pose."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from designer.analysis.analyse import Analysis
from designer.grades.grade import Grade, Size
from designer.model.space import Orientations
from designer.report import format as fmt
from designer.report.blocks import Fact, Statement, Tone
from designer.selection.efficiency import Allowance
from designer.study import Selection, Study

_MOST_LISTED = 6


def describe_orientations(orientations: Orientations) -> str:
    """Return in words how the platform is turned at every position."""
    if orientations.is_level:
        return "level only"
    turns = np.degrees(orientations.turns_rad)
    if orientations.range_rad is None:
        listed = "; ".join(fmt.degrees(turn) for turn in turns[:_MOST_LISTED])
        more = f"; {len(turns) - _MOST_LISTED} more" if len(turns) > _MOST_LISTED else ""
        return f"turned by {listed}{more}" if len(turns) == 1 else f"each of {listed}{more}"
    low, high = np.degrees(orientations.range_rad)
    return f"all between {fmt.degrees(low)} and {fmt.degrees(high)}"


def orientation_fact(study: Study) -> Iterator[Fact]:
    """Yield which orientations were checked, and how; nothing of a point mass, which has none."""
    if study.workspace is None or study.robot.is_point_mass:
        return
    given = study.workspace.orientations
    how = f"{given.count} of them at each sample, the worst searched between"
    if given.is_level:
        how = "the platform was not turned"
    elif given.range_rad is None:
        how = "rotation vectors, the worst of them counts" if given.count > 1 else ""
    yield Fact("Orientation", describe_orientations(given), how)


def orientation_statement(study: Study) -> Iterator[Statement]:
    """Yield the same for the first page."""
    for fact in orientation_fact(study):
        text = f"{fmt.capital(fact.value)}{fact.note and ': '}{fact.note}."
        yield Statement("Orientations checked", text)


def in_first_orientation(study: Study) -> str:
    """Return in which orientation a map over positions is drawn; empty where there is one only."""
    if study.workspace is None or study.workspace.orientations.is_level:
        return ""
    if study.workspace.orientations.range_rad is not None:
        return ", in the middle of the range of orientations"
    return ", in the first of the orientations" if study.workspace.orientations.count > 1 else ""


def strength_statement(
    selection: Selection | None, ropes: Iterable[tuple[Grade, Size]]
) -> Iterator[Statement]:
    """Yield what end fittings and bending are taken to leave of the breaking loads."""
    if selection is None:
        return
    share, sheave_m = selection.termination_efficiency, selection.sheave_diameter_m
    if share == 1.0 and sheave_m is None:
        text = "No loss assumed: end fittings 100\u00a0%, bending 100\u00a0% of the breaking load."
        yield Statement("Losses of strength", text, "doubt")
        return
    ends = f"End fittings {fmt.percent(share)}{' (none assumed)' if share == 1.0 else ''}, bending "
    if sheave_m is None:
        bends = "100\u00a0% (none assumed) of the breaking load"
    else:
        left = Allowance.of(selection).bending_efficiency
        parts = [
            f"{fmt.percent(left(grade, size.diameter_m))} for {size.id} "
            f"(D/d {fmt.trimmed(sheave_m / size.diameter_m, 3)})"
            for grade, size in ropes
        ]
        shares = f" {fmt.listing(parts)} of the breaking load" if parts else ""
        bends = f"over {fmt.millimetres(sheave_m)}{shares}; the smaller share counts"
    is_assumed = share == 1.0 or sheave_m is None
    yield Statement("Losses of strength", f"{ends}{bends}.", "doubt" if is_assumed else "")


def pose_statement(analysis: Analysis) -> Iterator[Statement]:
    """Yield where the configured pose is not one of the workspace, and what holds there."""
    outside, statics, qualities = analysis.study.pose_outside, analysis.outside, analysis.qualities
    if not outside:
        return
    tone: Tone = "doubt"
    text = f"It {outside}."
    if statics is not None and qualities is not None:
        cable, name = qualities.cable.cable, qualities.cable.name
        used, said = np.inf, f"With {name} no equilibrium was found there."
        if statics.is_solved:
            used = float((statics.cable_tension_N / cable.allowable_tension_N).max())
            said = f"There, {name} is used to {fmt.utilisation(used)} of what is allowed."
        tone = "bad" if used > 1.0 else "doubt"
        text += f" {said}"
    yield Statement("The configured pose is not in the workspace", text, tone)
