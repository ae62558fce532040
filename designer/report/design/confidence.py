"""How sure the answer is: distance from the boundary, sampling, doubts about the figures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings
from designer.grades.grade import TRUST_MEANING, Grade, Size
from designer.model.region import PointList
from designer.report import format as fmt
from designer.report.blocks import Statement
from designer.report.design.scope import (
    orientation_statement,
    pose_statement,
    strength_statement,
)
from designer.report.material_class import class_of
from designer.selection.result import Candidate
from designer.statics.task import LONG
from designer.workspace.hanging import Hanging

_NEAR_BOUNDARY = 0.9


def confidence(analysis: Analysis, findings: Findings) -> tuple[Statement, ...]:
    """Return what a reviewer should know before relying on the answer."""
    chosen = analysis.selection.chosen if analysis.selection else None
    ropes = [*_ropes(analysis)]
    statements = [
        *pose_statement(analysis),
        *_margin(analysis, findings),
        *_sampling(analysis),
        *orientation_statement(analysis.study),
        *_hanging(analysis, findings),
        *_slack(analysis),
        *strength_statement(analysis.study.selection, ropes),
    ]
    if analysis.has_groups:
        statements += _trust_of_groups(ropes)
    elif chosen is not None:
        statements += [_trust(chosen.grade), _modulus(chosen, findings)]
    for grade in {grade.id: grade for grade, _ in ropes}.values():
        statements += _limits(grade)
    for grade, size in ropes:
        if size.doubt:
            title = f"Doubt about {size.id} of {grade.id}"
            statements.append(Statement(title, f"{fmt.sentence(size.doubt)}.", "doubt"))
    return tuple(statements)


def _ropes(analysis: Analysis) -> Iterator[tuple[Grade, Size]]:
    """Yield the ropes of the groups, else the chosen one, each grade and size once."""
    chosen = analysis.selection.chosen if analysis.selection else None
    found = analysis.groups.chosen if analysis.groups else None
    if found is not None:
        ropes = [(one.grade, one.size) for one in found.products]
    else:
        ropes = [] if chosen is None else [(chosen.grade, chosen.size)]
    yield from {(grade.id, size.id): (grade, size) for grade, size in ropes}.values()


def _margin(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    rope = None if analysis.has_groups else findings.chosen_limit_ratio
    workspace, pose = analysis.workspace, analysis.pose
    place, whose = "worst", "the configured family"
    if rope is not None:
        ratio, whose = rope, "the chosen grade"
    elif workspace is not None and workspace.sagging is not None:
        ratio = workspace.limit_ratio
    elif workspace is None and pose is not None and pose.sizing.statics.is_solved:
        ratio, place = pose.limit_ratio, "configured"
    else:
        return
    other = ""
    if rope is not None and workspace is not None and workspace.sagging is not None:
        other = f" (configured family {fmt.percent(workspace.limit_ratio)})"
    text = (
        f"At the {place} pose the limit ratio of {whose} is {fmt.percent(ratio)}{other}: the "
        "share of the allowable stress that a cable of unlimited thickness spends on its own "
        "weight. At 100\u00a0% no finite cable is left."
    )
    near = ratio > _NEAR_BOUNDARY
    yield Statement("Margin to the boundary", text, "bad" if near else "")


def _sampling(analysis: Analysis) -> Iterator[Statement]:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.sampled is None:
        return
    assert analysis.study.workspace is not None
    if isinstance(analysis.study.workspace.region, PointList):
        yield Statement("Positions", "Every point of the list was solved; nothing lies between.")
        return
    best = f"the worst of {fmt.count(workspace.census.samples)} samples"
    sampled, searched = fmt.newtons_alike(
        workspace.sampled.max_tension_N, workspace.sagging.max_tension_N
    )
    text = (
        f"In the configured family {best} meets {sampled}. A search between them found {searched}. "
        "Searched values count, here and for the ropes."
    )
    yield Statement("Sampled and searched maximum", text)


def _hanging(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    workspace, share = analysis.study.workspace, findings.hanging
    if workspace is None or not share:
        return
    has_choice = analysis.selection is not None and analysis.selection.chosen is not None
    whose = "the chosen rope" if has_choice else "the configured family"
    if analysis.has_groups:
        whose = "the ropes of the groups"
    text = f"With {whose} a cable hangs below the platform in {fmt.percent(share)} of the samples. "
    if workspace.hangs_below == "include":
        yield Statement("Cables below the platform", f"{text}These poses count.")
        return
    text += "These poses do not count, as configured. Which poses they are depends on the rope."
    yield Statement("Poses left out", text, "doubt")


def _slack(analysis: Analysis) -> Iterator[Statement]:
    """Yield in how many samples cables hang as none should, where, and what could be done."""
    found, workspace = analysis.hanging, analysis.study.workspace
    whose = "the design" if analysis.qualities is not None else "what each sample needs"
    if found.long is not None:
        text = (
            f"With {whose}, a cable is longer than {fmt.trimmed(LONG)} times its chord in "
            f"{fmt.share(found.long.samples, found.samples)} of the samples: it hangs all but "
            f"slack. {_worst(found.long)} has {fmt.trimmed(found.long.extreme, 3)} times its chord."
        )
        yield Statement("Cables far longer than their chord", f"{text} {_advice(analysis)}", "bad")
    if found.below_floor is not None and workspace is not None and workspace.floor_m is not None:
        below = found.below_floor
        text = (
            f"With {whose}, a cable hangs below the floor at {fmt.metres(workspace.floor_m)} in "
            f"{fmt.share(below.samples, found.samples)} of the samples. {_worst(below)} reaches "
            f"down to {fmt.metres(below.extreme)}."
        )
        yield Statement("Cables below the floor", f"{text} {_advice(analysis)}", "bad")


def _worst(found: Hanging) -> str:
    return f"Cable {found.cable} at {fmt.position(found.place)}"


def _advice(analysis: Analysis) -> str:
    robot = analysis.built.robot
    least = (
        "A least tension (robot.tension_min) keeps cables from hanging so, where they can; or "
        if robot.is_redundant
        else ""
    )
    advice = f"{least}make the region smaller, or leave out poses with a cable below the platform."
    return fmt.capital(advice)


def _trust(grade: Grade, title: str = "Figures of the rope") -> Statement:
    letter = grade.trust
    text = f"Trust {letter}: {TRUST_MEANING[letter]}. Ask the maker for a certificate."
    return Statement(title, text, "" if letter == "A" else "doubt")


def _trust_of_groups(ropes: Iterable[tuple[Grade, Size]]) -> Iterator[Statement]:
    grades = {grade.id: grade for grade, _ in ropes}
    for grade in grades.values():
        yield _trust(grade, f"Figures of {grade.id}")
    known = [
        f"{grade.id}: {grade.elasticity.basis}, known to "
        f"{fmt.plus_minus(grade.elasticity.uncertainty)}"
        for grade in grades.values()
    ]
    yield Statement("Modulus", f"{'; '.join(known)}.")


def _modulus(chosen: Candidate, findings: Findings) -> Statement:
    elasticity = chosen.grade.elasticity
    known = fmt.plus_minus(elasticity.uncertainty)
    text = f"The modulus is {elasticity.basis}, known to {known}."
    if findings.modulus_utilisation is not None:
        low, high = sorted(findings.modulus_utilisation)
        ends = dict.fromkeys((fmt.utilisation(low), fmt.utilisation(high)))
        shown = " to ".join(ends) if len(ends) > 1 else f"{fmt.utilisation(low)} throughout"
        text += f" Over that range the utilisation at the worst pose is {shown}."
        if high > 1.0 >= chosen.verification.utilisation:
            return Statement("Modulus", f"{text} So it may exceed what is allowed.", "bad")
    return Statement("Modulus", text)


def _limits(grade: Grade) -> Iterator[Statement]:
    """Yield what the rope bears badly beside load, which nothing here computes."""
    limits = grade.limits
    creep = limits.creep if limits is not None else None
    if creep is not None or class_of(grade) == "fibre":
        known = f"Known of it: {creep}" if creep else "The source of its table says nothing of it"
        text = (
            f"Rope of {grade.material} may creep, which is to grow longer under lasting load. "
            f"{known}. Creep is not computed here: where the rope does creep, its lengths must be "
            "homed again."
        )
        yield Statement(f"Creep of {grade.id}", text, "doubt")
    if limits is not None and limits.temperature_C is not None:
        lowest, highest = (fmt.trimmed(limit) for limit in limits.temperature_C)
        text = (
            f"{grade.id} may be used from {lowest} to {highest}\u00a0°C. The temperature on site "
            "is not part of the study."
        )
        yield Statement("Temperature", text, "doubt")
