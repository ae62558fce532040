"""Why the answer is no or open, where, and what could be done."""

from __future__ import annotations

from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, Unserved
from designer.model.requirement import Requirement, State
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.blocks import Statement, Tone
from designer.report.design.checks import unmet_by_title, unmet_statement
from designer.report.design.groups import groups_statement
from designer.report.design.load_cases import carried_away
from designer.workspace.result import WorkspaceMap

_MOST_NAMES = 4
_STRIP = 0.5  # of the inradius: what reaches deeper is no strip along the sides
_LAYER = 0.1  # of the height: what reaches lower is no layer at the top


def reasons(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    """Yield why the answer is not yes, one statement for each part; nothing if it is."""
    for same in unmet_by_title(analysis.unmet):
        requirement = same[0]
        if requirement.id == "pose" and requirement.place is not None:
            where = fmt.position(requirement.place[:3])
            text = f"At {where} {requirement.remark}."
            yield Statement("The configured pose", text, _tone(requirement))
        elif requirement.id == "workspace":
            for each in same:
                yield _workspace_statement(analysis, findings, each)
        elif requirement.id == "rope":
            yield from _rope_statements(analysis, requirement)
        else:
            yield unmet_statement(same)
    if not analysis.is_positive:
        yield from carried_away(findings)


def _tone(requirement: Requirement) -> Tone:
    return "doubt" if requirement.state is State.OPEN else "bad"


def _workspace_statement(
    analysis: Analysis, findings: Findings, requirement: Requirement
) -> Statement:
    if analysis.workspace is not None and not analysis.needs:
        parts = _not_served(analysis, analysis.workspace, findings.unserved)
        return Statement("The workspace", " ".join(parts), _tone(requirement))
    assert requirement.place is not None
    words = f", {fmt.printed(requirement.direction)}" if requirement.direction else ""
    text = f"At {fmt.position(requirement.place[:3])}{words}: {requirement.remark}."
    return Statement(f"The load case '{requirement.load_case}'", text, _tone(requirement))


def _rope_statements(analysis: Analysis, requirement: Requirement) -> Iterator[Statement]:
    if analysis.groups is not None:
        yield groups_statement(analysis.groups)
    selection = analysis.selection
    if selection is not None and selection.reason:
        yield Statement("The ropes", f"{fmt.capital(selection.reason)}.", _tone(requirement))


def _not_served(
    analysis: Analysis, workspace: WorkspaceMap, unserved: Unserved | None
) -> Iterator[str]:
    """Yield which share of the workspace is not served and why, an example, and where it lies."""
    assert analysis.study.workspace is not None
    census, fine = workspace.census, [Verdict.SOLVED]
    if analysis.study.workspace.hangs_below == "exclude":
        fine.append(Verdict.NO_FINITE_CABLE)
    bad = [v for v in Verdict if v not in fine and census.statuses[v.label] > 0]
    for verdict in bad:
        share = fmt.share(census.statuses[verdict.label], census.samples)
        yield f"In {share} of its volume {verdict.clause}."
    if not bad:
        yield (
            "Every sample is served, but the search between the samples met poses that no cable "
            "of the configured family can hold."
        )
    if workspace.infeasible_example_m is not None:
        yield f"One such position is {fmt.position(workspace.infeasible_example_m)}."
    if unserved is not None:
        above = f" above z = {fmt.metres(unserved.lowest_z_m)} and"
        yield (
            f"All samples that are not served lie{above if _is_layer(analysis, unserved) else ''} "
            f"within {fmt.metres(unserved.depth_m)} of the sides."
        )


def _is_layer(analysis: Analysis, unserved: Unserved) -> bool:
    assert analysis.study.workspace is not None
    low, high = analysis.study.workspace.region.bounds_m[:, 2]
    return bool(unserved.lowest_z_m > low + _LAYER * (high - low))


def actions(analysis: Analysis, findings: Findings) -> Iterator[str]:
    """Yield what could be done where the answer is not yes, the most direct first."""
    advice = [*_advice(analysis, findings)]
    if not advice and not analysis.is_positive:
        advice = ["Add a grade with thicker sizes to the catalogue, or carry less mass."]
    yield from advice


_ADVICE = {
    "sheave_ratio": "Use a larger sheave, or allow grades that may be bent more sharply.",
    "stiffness": "Use stiffer ropes or more cables, or make the region smaller.",
    "excitation": "Change the mass or the tension of the cables, or keep the excitation away.",
    "drum_capacity": "Use larger drums, or make the region smaller.",
    "floor": "Lower the floor, raise the exit points, or make the region smaller.",
    "sag": "Make the region smaller or the platform heavier, or allow more sag (workspace.sag).",
    "stability": "Make the region smaller, or move attachments above the centre of mass.",
    "least_tension": "Make the region smaller, or require less tension (robot.tension_min).",
}
"""What could be done about a requirement, by its id."""


def _advice(analysis: Analysis, findings: Findings) -> Iterator[str]:
    pose, workspace = analysis.pose, analysis.workspace
    yield from _other_grades(analysis) if not findings.adrift else ()
    if pose is not None and not pose.sizing.statics.is_solved:
        yield Verdict(int(pose.sizing.statics.verdict)).advice
    if workspace is not None and not workspace.is_feasible:
        yield from _real_figures(findings)
        yield from _change_region(analysis, findings.unserved)
        yield from _leave_out_hanging(findings)
        yield "Raise the exit points (higher masts), or lower the top of the region."
        yield "Use a cable with more strength for its weight."
    for requirement in {requirement.id: requirement for requirement in analysis.unmet}.values():
        if requirement.id == "clearance":
            yield (
                f"Move exit points or attachments of {requirement.remark} apart, make the region "
                "smaller, or require less clearance."
            )
        elif requirement.id in _ADVICE:
            yield _ADVICE[requirement.id]


def _other_grades(analysis: Analysis) -> Iterator[str]:
    selection = analysis.selection
    if selection is None or analysis.assignment.is_found:
        return
    fitting = [o.best for o in selection.alternatives if o.best is not None]
    fitting.sort(key=lambda candidate: candidate.total_mass_kg)
    names = [f"{c.grade.id} ({c.size.id})" for c in fitting[:_MOST_NAMES]]
    more = len(fitting) - _MOST_NAMES
    if more > 0:
        names.append(fmt.plural(more, "other"))
    if names:
        yield (
            "Allow other grades. These hold the whole workspace, the lightest first: "
            f"{fmt.listing(names)}."
        )


def _real_figures(findings: Findings) -> Iterator[str]:
    outcome = findings.chosen_outcome
    if outcome is not None:
        yield (
            f"Configure the cable as a real rope. {outcome.grade.id} holds where the configured "
            "family does not; on the nominal circle it has "
            f"{fmt.kilograms_per_cubic_metre(outcome.family.density_kg_per_m3)}, "
            f"{fmt.pascals(outcome.family.youngs_modulus_Pa)} and an allowable stress of "
            f"{fmt.pascals(outcome.family.allowable_stress_Pa)}."
        )


def _change_region(analysis: Analysis, unserved: Unserved | None) -> Iterator[str]:
    if unserved is None:
        yield "Make the region smaller where poses are not served."
        return
    if unserved.depth_m < _STRIP * unserved.inradius_m:
        yield (
            f"Move the sides of the region inward (a larger inset) by clearly more than "
            f"{fmt.metres(unserved.depth_m)}: toward the poses that are not served the needed "
            "diameter grows without bound."
        )
    if _is_layer(analysis, unserved):
        yield f"Keep the top of the region below z = {fmt.metres(unserved.lowest_z_m)}."


def _leave_out_hanging(findings: Findings) -> Iterator[str]:
    other = findings.other_policy
    if other is None or other.hangs_below != "exclude" or other.map.sagging is None:
        return
    worst, census = other.map.sagging, other.map.census
    yield (
        "Leave out poses in which a cable hangs below the platform (hangs_below: exclude). The "
        f"worst of the others needs {fmt.millimetres(worst.diameter_m)} of the configured family "
        f"and meets {fmt.newtons(worst.max_tension_N)}. That gives up "
        f"{fmt.share(census.excluded, census.samples)} of the volume."
    )
