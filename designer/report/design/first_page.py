"""The first page: the answer, what it rests on, and what to do where it is no."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings
from designer.arrays import FloatArray
from designer.model.load_case import STATIC
from designer.model.requirement import Answer
from designer.report import format as fmt
from designer.report.blocks import Block, Fact, Facts, Picture, Statement
from designer.report.design.checks import UNMET, unmet_by_title
from designer.report.design.confidence import confidence
from designer.report.design.groups import groups_hold, groups_statement
from designer.report.design.negative import actions, reasons
from designer.report.design.sag_cost import sag_cost
from designer.report.design.selection import product_name
from designer.report.design.source import Source
from designer.report.design.workspace_figures import cover_picture
from designer.report.material_class import class_of
from designer.selection.assignment import Assignment
from designer.selection.candidate import Candidate
from designer.selection.family_need import CaseNeed
from designer.selection.objectives import MEANINGS
from designer.selection.result import SelectionResult
from designer.study import CableGroup

_MOST_SIZES = 2
_TIGHT = 0.97


@dataclass(frozen=True, slots=True)
class Card:
    """The answer at a glance: what it is about, the size set large, and what else is looked for.

    ``metric`` is the diameter in millimetres where the size is not; it may be empty. ``product``
    is name and maker, or what the size refers to.
    """

    heading: str
    size: str
    product: str
    facts: Facts
    metric: str = ""


@dataclass(frozen=True, slots=True)
class FirstPage:
    """The first page.

    Parameters
    ----------
    verdict : Statement
        The answer in one or two sentences.
    card : Card or None
        The chosen rope, or the diameter that is needed; None where there is neither.
    reasons : tuple of Statement
        Why the answer is no, and where; empty if it is yes.
    actions : tuple of str
        What could be done about it.
    sag : tuple of Block
        The effect of rope weight; empty where there is nothing to compare.
    groups : Statement or None
        What ropes for groups of cables save; None if the study has no groups.
    confidence : tuple of Statement
        How sure the answer is.
    picture : Picture or None
        The robot.
    """

    verdict: Statement
    card: Card | None
    reasons: tuple[Statement, ...]
    actions: tuple[str, ...]
    sag: tuple[Block, ...]
    groups: Statement | None
    confidence: tuple[Statement, ...]
    picture: Picture | None


def first_page(source: Source) -> FirstPage:
    """Return the first page."""
    analysis, findings = source.analysis, source.analysis.findings
    return FirstPage(
        verdict=_verdict(analysis, findings),
        card=_card(analysis),
        reasons=tuple(reasons(analysis, findings)),
        actions=tuple(actions(analysis, findings)),
        sag=sag_cost(source),
        groups=groups_statement(analysis.groups) if analysis.groups else None,
        confidence=tuple(confidence(analysis, findings)),
        picture=_picture(source),
    )


def _picture(source: Source) -> Picture | None:
    if source.draws_scenes and source.maps is not None:
        return cover_picture(source.rope_maps or source.maps, source.analysis.ropes)
    return replace(source.robot, kind="robot") if source.robot else None


def _verdict(analysis: Analysis, findings: Findings) -> Statement:
    text = _summary(analysis)
    workspace = analysis.study.workspace
    if workspace is not None and workspace.hangs_below == "exclude" and findings.hanging:
        text += f" {fmt.percent(findings.hanging)} of the volume is left out, as configured."
    if analysis.answer is Answer.YES:
        return Statement("Yes", text, "good")
    if analysis.assignment.is_found:
        text += f" But {_unmet_words(analysis)}."
    is_no = analysis.answer is Answer.NO
    return Statement("No", text, "bad") if is_no else Statement("Open", text, "doubt")


def _unmet_words(analysis: Analysis) -> str:
    """Return what does not hold, each requirement once with its load cases."""
    parts = []
    for same in unmet_by_title(analysis.unmet):
        first = same[0]
        named = dict.fromkeys(f"'{each.load_case}'" for each in same)
        is_alone = named.keys() <= {"'all'", f"'{STATIC.name}'"}
        cases = "" if is_alone else f" in {fmt.listing(named)}"
        parts.append(f"{first.title[0].lower()}{first.title[1:]} {UNMET[first.state]}{cases}")
    return fmt.listing(parts)


def _summary(analysis: Analysis) -> str:
    """Return what was chosen and what it meets, or that nothing was."""
    assignment = analysis.assignment
    if assignment.has_groups:
        return groups_hold(assignment)
    if not assignment.is_found and not analysis.is_positive:
        return _negative(analysis)
    text = _positive(analysis, assignment.rope)
    return f"{text}{_of_metal(analysis.selection, assignment.rope)}"


def _of_metal(selection: SelectionResult | None, chosen: Candidate | None) -> str:
    """Name the best rope of steel beside a chosen one of fibre."""
    if selection is None or chosen is None or class_of(chosen.grade) != "fibre":
        return ""
    solved = [o for o in selection.outcomes if class_of(o.grade) in ("steel", "stainless steel")]
    if not solved:
        return ""
    text = f" It is a rope of {chosen.grade.material} fibre."
    holding = [o.best for o in solved if o.best is not None]
    if not holding:
        return f"{text} No rope of steel that the study allows holds."
    first = selection.objectives[0]
    best = min(holding, key=lambda candidate: candidate.figures.burden(first))
    kind = "stainless steel" if class_of(best.grade) == "stainless steel" else "steel"
    most = "largest" if MEANINGS[first].more_is_better else "least"
    return (
        f"{text} The rope of {kind} that holds with the {most} {MEANINGS[first].word} is "
        f"{best.size.id} of {best.grade.id}: {fmt.kilograms(best.total_mass_kg)} in all instead of "
        f"{fmt.kilograms(chosen.total_mass_kg)}."
    )


def _positive(analysis: Analysis, chosen: Candidate | None) -> str:
    if chosen is not None:
        found = chosen.verification
        if not found.holds:
            return _holds(chosen)
        tight = " There is hardly any reserve beyond it." if found.utilisation > _TIGHT else ""
        return (
            f"{_holds(chosen)} Its largest tension is {fmt.newtons(found.max_tension_N)}, "
            f"{fmt.utilisation(found.utilisation)} of what the safety factor allows.{tight}"
        )
    workspace, pose, need = analysis.workspace, analysis.pose, analysis.most_needed
    if need is not None:
        what = (
            f"every pose of the workspace in every load case; '{need.governing.case.name}' governs"
        )
        diameter_m, tension_N = need.diameter_m, need.governing.verification.max_tension_N
    elif workspace is not None and workspace.sagging is not None:
        worst, what = workspace.sagging, "every pose of the workspace"
        diameter_m, tension_N = worst.diameter_m, worst.max_tension_N
    else:
        assert pose is not None
        sizing, what = pose.sizing, "the configured pose"
        diameter_m, tension_N = float(sizing.diameter_m), float(sizing.statics.largest_tension_N)
    return (
        f"A cable of {fmt.millimetres(diameter_m)} of the configured family holds {what}. "
        f"Its largest tension is {fmt.newtons(tension_N)}."
    )


def _holds(chosen: Candidate) -> str:
    name = f"{chosen.grade.product} ({chosen.grade.id})"
    return f"The {chosen.size.id} size of {name} holds every pose of the workspace."


def _negative(analysis: Analysis) -> str:
    """Return what is not held where no rope was chosen, and no more than is known of it."""
    first = analysis.unmet[0]
    if analysis.answer is Answer.OPEN:
        return f"It was not found out: {first.formula}. What is known: {first.remark}."
    if first.id == "pose" and analysis.workspace is None:
        return "The configured pose cannot be held by any cable of the configured family."
    return _no_rope(analysis) if analysis.study.selection is not None else _no_family(analysis)


def _no_rope(analysis: Analysis) -> str:
    workspace = analysis.workspace
    if workspace is not None and not workspace.is_feasible:
        return (
            "The workspace is not served as it is: neither a cable of the configured "
            "family nor a rope of the allowed grades was found to hold every pose."
        )
    if analysis.groups is not None:
        return "No ropes that the study allows were found that hold every pose of the workspace."
    need = ""
    if not analysis.study.load_cases and workspace is not None and workspace.sagging is not None:
        diameter = fmt.millimetres(workspace.sagging.diameter_m)
        need = f" A cable of the configured family would need {diameter}."
    return f"None of the ropes that the study allows holds every pose of the workspace.{need}"


def _no_family(analysis: Analysis) -> str:
    workspace, need = analysis.workspace, analysis.most_needed
    if need is not None and not need.is_held:
        name = need.governing.case.name
        return f"No cable of the configured family holds every pose in the load case '{name}'."
    if workspace is not None and not workspace.is_feasible:
        return "The workspace is not served: no cable of the configured family holds every pose."
    unmet = _unmet_words(analysis)
    if workspace is None or workspace.sagging is None:
        return f"{fmt.capital(unmet)}."
    diameter = fmt.millimetres(workspace.sagging.diameter_m)
    return f"A cable of {diameter} of the configured family is strong enough. But {unmet}."


def _card(analysis: Analysis) -> Card | None:
    assignment = analysis.assignment
    if assignment.has_groups:
        return _groups_card(analysis, assignment)
    if assignment.rope is not None:
        return _rope_card(analysis, assignment.rope)
    workspace, pose = analysis.workspace, analysis.pose
    if analysis.most_needed is not None:
        return _needs_card(analysis.most_needed)
    if workspace is not None:
        worst = workspace.sagging
        if worst is None:
            return None
        found = ("workspace", worst.diameter_m, worst.max_tension_N, fmt.position(worst.place))
    elif pose is not None and pose.sizing.statics.is_solved:
        statics = pose.sizing.statics
        where = fmt.position(statics.poses.position_m)
        found = ("pose", float(pose.sizing.diameter_m), float(statics.largest_tension_N), where)
    else:
        return None
    what, diameter_m, tension_N, where = found
    facts = Fact("Largest tension", fmt.newtons(tension_N)), Fact("At the position", where)
    heading, size = diameter_heading(analysis, what), fmt.millimetres(diameter_m)
    heading += " at rest" if analysis.study.load_cases else ""
    return Card(heading, size, "of the configured cable family", Facts(facts))


def _needs_card(need: CaseNeed) -> Card | None:
    """Return what the load cases need of the family; None where one of them is not held."""
    if not need.is_held:
        return None
    met = need.governing.verification
    facts = (
        Fact("Load case", need.governing.case.name, fmt.printed(need.governing.loaded.words)),
        Fact("Largest tension", fmt.newtons(met.max_tension_N)),
        Fact("At the position", fmt.position(met.worst_place)),
    )
    heading, size = "Thinnest diameter found for the load cases", fmt.millimetres(need.diameter_m)
    return Card(heading, size, "of the configured cable family", Facts(facts))


def diameter_heading(analysis: Analysis, what: str) -> str:
    """Return ``Diameter that the pose needs`` only where no thinner cable is proved to hold it."""
    sizing = analysis.pose.sizing if analysis.pose is not None else None
    if what == "workspace" and analysis.worst_sizing is not None:
        sizing = analysis.worst_sizing
    if sizing is not None and sizing.is_thinnest:
        return f"Diameter that the {what} needs"
    return f"Thinnest diameter found for the {what}"


def _rope_card(analysis: Analysis, chosen: Candidate) -> Card:
    assert analysis.study.selection is not None
    size, found = chosen.size, chosen.verification
    most = chosen.governing
    factor = most.case.safety_factor or analysis.study.selection.safety_factor
    required, allowable_N = fmt.trimmed(factor), most.loaded.cable.allowable_tension_N
    kept = chosen.efficiency
    if most.case.termination_efficiency is not None:
        kept = allowable_N * factor / size.minimum_breaking_load_N
    actual = kept * size.minimum_breaking_load_N / found.max_tension_N
    breaking, allowable, largest = fmt.newtons_alike(
        size.minimum_breaking_load_N, allowable_N, found.max_tension_N
    )
    share = f" times {fmt.trimmed(kept, 3)}" if kept != 1.0 else ", no loss,"
    longest, shortest = _lengths(found.longest_m), _lengths(found.shortest_m)
    facts = (
        Fact("Grade", chosen.grade.id),
        Fact("Minimum breaking load", breaking),
        Fact("Allowable tension", allowable, f"breaking load{share} over {required}"),
        Fact("Largest tension", largest),
        Fact("At the position", fmt.position(found.worst_place)),
        Fact("Safety factor there", fmt.fixed(actual, 2), f"required {required}"),
        Fact("Utilisation", fmt.utilisation(found.utilisation)),
        *_reserve(analysis),
        *([Fact("Load case", most.case.name)] if analysis.study.load_cases else []),
        _mass(chosen),
        Fact("Longest, each cable", longest, "unstrained, no spare"),
        Fact("Shortest", shortest, "unstrained"),
        Fact("Mass of all cables", fmt.kilograms(chosen.total_mass_kg)),
    )
    metric = "" if size.id.endswith("mm") else fmt.millimetres(size.diameter_m)
    return Card("Chosen rope", size.id, product_name(chosen.grade), Facts(facts), metric)


def _reserve(analysis: Analysis) -> Iterator[Fact]:
    """Yield how much more payload there may be."""
    found = analysis.carries
    if found is not None and found.payload is not None:
        more = fmt.percent(found.payload.value - 1.0)
        end = "until 100\u00a0% are used" if found.payload.is_held else "until a pose is not held"
        yield Fact("Reserve in payload", more, end)


def _mass(chosen: Candidate) -> Fact:
    """Return the mass per length on this machine, and that of the table where it differs."""
    built, table = chosen.cable.linear_density_kg_per_m, chosen.size.linear_density_kg_per_m
    is_same = math.isclose(built, table, rel_tol=1e-9)
    note = "" if is_same else f"with the declared effects; {fmt.kilograms_per_metre(table)} bare"
    return Fact("Mass", fmt.kilograms_per_metre(built), note)


def _lengths(length_m: FloatArray) -> str:
    """Return lengths as the fabrication data give them."""
    each = [fmt.fixed(float(x), 2) for x in length_m]
    return f"{fmt.listing(each if len({*each}) > 1 else each[:1])}\u00a0m"


def _groups_card(analysis: Analysis, assignment: Assignment) -> Card:
    assert analysis.study.selection is not None
    required = fmt.trimmed(analysis.study.selection.safety_factor)
    sizes = [*dict.fromkeys(rope.size.id for rope in assignment.ropes)]
    distinct = fmt.plural(len(assignment.products), "product")
    used = assignment.verification.utilisation
    groups = zip(assignment.groups, assignment.ropes, used, strict=True)
    facts = (
        *(
            Fact(group.name, rope.label, _of_group(group, assignment, float(share)))
            for group, rope, share in groups
        ),
        Fact("Safety factor required", required, "on the breaking load"),
        Fact("Mass of all cables", fmt.kilograms(assignment.total_mass_kg)),
    )
    return Card(
        "Ropes for groups of cables",
        fmt.listing(sizes) if len(sizes) <= _MOST_SIZES else distinct,
        f"{distinct} for {fmt.plural(len(assignment.groups), 'group')}",
        Facts(facts),
    )


def _of_group(group: CableGroup, assignment: Assignment, used: float) -> str:
    """Return which cables a group has, how much of what is allowed it uses, and its lengths."""
    noun = "cable" if len(group.cables) == 1 else "cables"
    longest = assignment.verification.longest_m[[cable - 1 for cable in group.cables]]
    cables = fmt.listing(str(cable) for cable in group.cables)
    at_most = _lengths(longest)
    return f"{noun} {cables}, {fmt.utilisation(used)} used, at most {at_most} long"
