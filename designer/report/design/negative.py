"""Why the answer is no, where, and what could be done."""

from __future__ import annotations

from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, Unserved
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.blocks import Statement
from designer.report.design.clearance import clearance_statement
from designer.report.design.groups import groups_statement
from designer.report.design.load_cases import carried_away
from designer.report.design.stiffness import stiffness_statement
from designer.workspace.result import WorkspaceMap

_MOST_NAMES = 4
_STRIP = 0.5  # of the inradius: what reaches deeper is no strip along the sides
_LAYER = 0.1  # of the height: what reaches lower is no layer at the top


def reasons(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    """Yield why the answer is no, one statement for each part of it; nothing if it is yes."""
    pose, workspace, selection = analysis.pose, analysis.workspace, analysis.selection
    if pose is not None and not pose.sizing.statics.is_solved:
        statics = pose.sizing.statics
        where, why = fmt.position(statics.poses.position_m), Verdict(int(statics.verdict)).clause
        yield Statement("The configured pose", f"At {where} {why}.", "bad")
    if workspace is not None and not workspace.is_feasible:
        parts = _not_served(analysis, workspace, findings.unserved)
        yield Statement("The workspace", " ".join(parts), "bad")
    for need in analysis.needs:
        if not need.is_held:
            where = fmt.position(need.found.verification.worst_position_m)
            words = f", {fmt.printed(need.found.loaded.words)}" if need.found.loaded.words else ""
            text = f"At {where}{words}, no diameter of the configured family holds the platform."
            yield Statement(f"The load case '{need.found.case.name}'", text, "bad")
    if selection is not None and not analysis.has_products:
        if analysis.groups is not None:
            yield groups_statement(analysis.groups)
        if selection.reason:
            yield Statement("The ropes", f"{fmt.capital(selection.reason)}.", "bad")
    if not analysis.has_cable:
        yield from carried_away(findings)
    yield from _quality_reasons(analysis)


def objections(analysis: Analysis) -> Iterator[str]:
    """Yield what speaks against a rope that holds, such as ``the clearance is not kept``."""
    for reason in _quality_reasons(analysis):
        yield f"{reason.title[0].lower()}{reason.title[1:]}"


def _quality_reasons(analysis: Analysis) -> Iterator[Statement]:
    """Yield what the cables of the design make of the robot, where it is bad."""
    found = analysis.qualities
    if found is not None and found.interference is not None and found.interference.is_violated:
        yield clearance_statement(found.interference)
    if found is not None and found.stiffness is not None and found.stiffness.unstable:
        yield stiffness_statement(found.stiffness)


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
    """Yield what could be done about a no, the most direct first; nothing if the answer is yes."""
    advice = [*_advice(analysis, findings)]
    if not advice and not analysis.is_positive:
        advice = ["Add a grade with thicker sizes to the catalogue, or carry less mass."]
    yield from advice


def _advice(analysis: Analysis, findings: Findings) -> Iterator[str]:
    pose, workspace, found = analysis.pose, analysis.workspace, analysis.qualities
    yield from _other_grades(analysis) if not findings.adrift else ()
    if pose is not None and not pose.sizing.statics.is_solved:
        yield Verdict(int(pose.sizing.statics.verdict)).advice
    if workspace is not None and not workspace.is_feasible:
        yield from _real_figures(findings)
        yield from _change_region(analysis, findings.unserved)
        yield from _leave_out_hanging(findings)
        yield "Raise the exit points (higher masts), or lower the top of the region."
        yield "Use a cable with more strength for its weight."
    if found is not None and found.interference is not None and found.interference.is_violated:
        assert found.interference.worst is not None
        yield (
            f"Move exit points or attachments of {fmt.listing(found.interference.worst.names)} "
            "apart, make the region smaller, or ask for less clearance."
        )


def _other_grades(analysis: Analysis) -> Iterator[str]:
    selection = analysis.selection
    if selection is None or analysis.has_products:
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
