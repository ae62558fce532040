"""How sure the answer is: distance from the boundary, sampling, doubts about the figures."""

from __future__ import annotations

from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings
from designer.effects.effect import Effect
from designer.effects.registry import SHIPPED
from designer.grades.grade import TRUST_MEANING, Grade
from designer.report import format as fmt
from designer.report.blocks import Statement
from designer.report.design.assumptions import rope_effects_note
from designer.report.design.load_cases import carried_away, loads_statement
from designer.report.design.proof import proofs
from designer.report.design.scope import (
    orientation_statement,
    pose_statement,
    strength_statement,
)
from designer.report.design.uncertainty import statement
from designer.report.design.verification import verification_statement
from designer.report.material_class import class_of
from designer.selection.candidate import Candidate
from designer.statics.task import LONG
from designer.study import Study
from designer.workspace.hanging import Hanging

_NEAR_BOUNDARY = 0.9


def confidence(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    """Yield what a reviewer should know before relying on the answer."""
    chosen, assigned = analysis.assignment.rope, analysis.assignment.ropes
    ropes = {(rope.grade.id, rope.size.id): (rope.grade, rope.size) for rope in assigned}.values()
    grades = {grade.id: grade for grade, _ in ropes}.values()
    yield from pose_statement(analysis)
    if analysis.study.selection is not None or analysis.study.load_cases:
        yield loads_statement(analysis.study)
    if analysis.is_positive:  # else it is among the reasons
        yield from carried_away(findings)
    yield from _effects(analysis.study)
    if not all(one.agrees for one in analysis.verification):
        yield verification_statement(analysis.verification)
    if analysis.uncertainty is not None and analysis.uncertainty.is_asked:
        yield statement(analysis.uncertainty)
    yield from _margin(analysis, findings)
    yield from _sampling(analysis)
    yield from proofs(analysis)
    yield from orientation_statement(analysis.study)
    yield from _hanging(analysis, findings)
    yield from _slack(analysis)
    yield from strength_statement(analysis.study.selection, ropes)
    if analysis.assignment.has_groups:
        for grade in grades:
            yield _trust(grade, f"Figures of {grade.id}")
        known = (
            f"{g.id}: {g.elasticity.basis}, known to {fmt.plus_minus(g.elasticity.uncertainty)}"
            for g in grades
        )
        yield Statement("Modulus", f"{'; '.join(known)}.")
    elif chosen is not None:
        yield _trust(chosen.grade, "Figures of the rope")
        yield _modulus(chosen, findings)
    for grade in grades:
        yield from _limits(grade)
    for grade, size in ropes:
        if size.doubt:
            title = f"Doubt about {size.id} of {grade.id}"
            yield Statement(title, f"{fmt.sentence(size.doubt)}.", "doubt")


def _effects(study: Study) -> Iterator[Statement]:
    """What was measured on the machine is in the answer."""
    idle = {one.id for one in study.known_effects.effects if _is_of_data(one)}
    ids = dict.fromkeys(effect.id for effect in study.effects)
    acting = [name for name in ids if name not in idle]
    if acting:
        text = "The answer is that of the machine with the effects that the study declares: "
        text += f"{fmt.listing(acting)}. {rope_effects_note(study)}"
        yield Statement("Declared effects", text.rstrip(), "doubt")
    left_out = [name for name in ids if name in idle]
    if left_out:
        text = "These belong to measured data and change no design, so they are not in the answer: "
        yield Statement("Effects not covered", f"{text}{fmt.listing(left_out)}.", "doubt")


def _is_of_data(effect: Effect) -> bool:
    """Tell whether an effect belongs to measured data, and no design is computed with it.

    A plugin need not say of one on the machine whether it reaches the design.
    """
    return not effect.reaches_design and (effect.on_machine is None or effect in SHIPPED.effects)


def _margin(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    rope = None if analysis.assignment.has_groups else findings.chosen_limit_ratio
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
    text = (
        f"At the {place} pose the self-weight ratio of {whose} is {fmt.percent(ratio)}: the "
        "share of the allowable stress that a cable of unlimited thickness spends on its own "
        "weight. At 100\u00a0% no finite cable is left."
    )
    near = ratio > _NEAR_BOUNDARY
    yield Statement("Margin to the boundary", text, "bad" if near else "")


def _sampling(analysis: Analysis) -> Iterator[Statement]:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.sampled is None:
        return
    if analysis.needs:
        text = (
            "Each load case was solved in every sample and searched between them; that a thinner "
            "cable would not do is by trial of diameters 12\u00a0% apart."
        )
        yield Statement("Sampled and searched maximum", text)
        return
    assert analysis.study.workspace is not None
    if analysis.study.workspace.region.is_discrete:
        yield Statement("Positions", "Every point of the list was solved; nothing lies between.")
        return
    chosen = analysis.assignment.rope
    if chosen is not None:
        most = chosen.governing
        text = (
            f"The worst of {fmt.plural(most.sampled.samples, 'sample')} uses the rope to "
            f"{fmt.fixed(100.0 * most.sampled.utilisation, 2)}\u00a0%, a search between them found "
            f"{fmt.fixed(100.0 * most.utilisation, 2)}\u00a0%, which counts."
        )
        yield Statement("Sampled and searched maximum", text)
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
    if analysis.assignment.has_groups:
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
    advice = "make the region smaller, or leave out poses with a cable below the platform."
    if analysis.built.robot.is_redundant:
        advice = (
            "a least tension (robot.tension_min) keeps cables from hanging so, where they can; or "
            f"{advice}"
        )

    def told(title: str, what: str, so: str, where: Hanging, how_far: str) -> Statement:
        text = (
            f"With {whose}, a cable {what} in {fmt.share(where.samples, found.samples)} of the "
            f"samples{so}. Cable {where.cable} at {fmt.position(where.place)} {how_far}. "
            f"{fmt.capital(advice)}"
        )
        return Statement(title, text, "bad")

    if found.long is not None:
        what = f"is longer than {fmt.trimmed(LONG)} times its chord"
        how_far = f"has {fmt.trimmed(found.long.extreme, 3)} times its chord"
        title = "Cables far longer than their chord"
        yield told(title, what, ": it hangs all but slack", found.long, how_far)
    if found.below_floor is not None and workspace is not None and workspace.floor_m is not None:
        what = f"hangs below the floor at {fmt.metres(workspace.floor_m)}"
        how_far = f"reaches down to {fmt.metres(found.below_floor.extreme)}"
        yield told("Cables below the floor", what, "", found.below_floor, how_far)


def _trust(grade: Grade, title: str) -> Statement:
    letter = grade.trust
    text = f"Trust {letter}: {TRUST_MEANING[letter]}. Ask the maker for a certificate."
    return Statement(title, text, "" if letter == "A" else "doubt")


def _modulus(chosen: Candidate, findings: Findings) -> Statement:
    elasticity = chosen.grade.elasticity
    known = fmt.plus_minus(elasticity.uncertainty)
    text = f"The modulus is {elasticity.basis}, known to {known}."
    if chosen.cable.stiffening is not None:
        stiffness = fmt.newtons(chosen.cable.axial_stiffness_N)
        text += (
            f" It depends on the tension: EA is {stiffness}, that at the largest tension of the "
            "load case that governs; each load case has its own. What is computed for the static "
            "load beside the load cases, such as maps and lengths, has that EA too."
        )
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
