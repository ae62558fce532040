"""How sure a diagnosis is, and what speaks against it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from designer.diagnosis.free_poses import TAKEN_UP
from designer.diagnosis.result import MOST_SCATTER, Diagnosis, Finding, Reason, Withdrawn
from designer.diagnosis.search import EffectTrial
from designer.report import format as fmt
from designer.report.blocks import Statement
from designer.report.diagnosis import words
from designer.report.diagnosis.quantity import quantities

_MUCH = 1.5


def sureness(diagnosis: Diagnosis) -> Iterator[Statement]:
    """Yield statements on significance, rivals, warnings, what was withdrawn, and noise."""
    findings, not_tried = diagnosis.findings, diagnosis.not_tried
    if not_tried:
        text = f"The search ended early. Not tried: {'; '.join(not_tried)}."
        yield Statement("Out of time", text, "bad")
    if not diagnosis.measured.has_poses:
        hidden = [key for key, why in diagnosis.skipped if why.startswith(TAKEN_UP)]
        more = f" They hide {fmt.listing(hidden, 'or')}, if there is any." if hidden else ""
        text = f"No pose was measured; each is estimated from the row's own readings.{more}"
        yield Statement("Poses estimated", text, "doubt")
    for group in words.grouped(findings):
        yield _significance(diagnosis, group)
    alone = [
        f
        for f in findings
        if not f.rivals
        and not any(what.startswith(f"rivals of {f.effect.key}:") for what in not_tried)
    ]
    if alone:
        keys = fmt.listing((words.key_of(group) for group in words.grouped(alone)), "or")
        text = f"No other single effect explains the data as well in place of {keys}."
        yield Statement("No rivals", text, "good")
    for finding in findings:
        if finding.rivals:
            text = (
                f"These data cannot tell {finding.effect.key} from "
                f"{fmt.listing(finding.rivals, 'or')}."
            )
            if diagnosis.proposals:
                text += " Poses that would are proposed below."
            yield Statement("Rivals", text, "doubt")
        for warning in finding.warnings:
            yield Statement("Hard to believe", f"{finding.effect.key}: {warning}.", "bad")
    for gone in diagnosis.withdrawn:
        yield Statement(f"{gone.effect} withdrawn", withdrawal(gone), "doubt")
    for doubt in diagnosis.doubts:
        yield Statement("Not plausible", f"{fmt.capital(doubt)}.", "bad")
    yield _left(diagnosis)
    yield from _lasting(diagnosis)
    yield _noise(diagnosis)


def withdrawal(gone: Withdrawn) -> str:
    """Say why an effect that fits was not kept."""
    if gone.reason is Reason.UNSEEN:
        return (
            f"{fmt.capital(gone.reason.value)}: with it, their mean square changes by "
            f"{fmt.signed_percent(-gone.gain)} ± {fmt.percent(gone.gain_std, 2)}, and a finding "
            "has to lower it by more than twice that doubt."
        )
    if gone.reason is not Reason.DRIFTS:
        return f"{fmt.capital(gone.reason.value)}{': ' if gone.detail else ''}{gone.detail}."
    size = f"{fmt.percent(gone.variation, 2)} of itself"
    if gone.variation > _MUCH:
        size = f"{fmt.number(gone.variation, 2)} times itself"
    what = words.covariate(gone.covariate)
    return (
        f"It fits as a constant, but would have to change with {what} by {size} for each standard "
        f"deviation of {what}."
    )


def _trial_of(diagnosis: Diagnosis, finding: Finding) -> EffectTrial | None:
    """Return the trial in which an effect was found; None where it came by exchange."""
    key = finding.effect.key
    for step in diagnosis.steps:
        if step.added is not None and step.added.key == key:
            return next(t for t in step.trials if t.effect.key == key)
    return None


def _significance(diagnosis: Diagnosis, group: Sequence[Finding]) -> Statement:
    trials = [_trial_of(diagnosis, finding) for finding in group]
    chances = [trial.chance for trial in trials if trial is not None]
    accident = "It took the place of another effect during the search."
    if chances:
        each = "" if len(group) == 1 else " at most"
        accident = f"The chance of such a gain by accident is{each} {words.chance(max(chances))}."
    gain = ""
    gains = [f for f in group if math.isfinite(f.heldout_gain)]
    if gains:
        shares = fmt.listing(
            f"{fmt.percent(f.heldout_gain, 3)} ± {fmt.percent(f.heldout_gain_std, 2)}"
            for f in gains
        )
        takes = "they take, each by itself," if len(gains) > 1 else "it takes"
        gain = f" On held-out rows, {takes} {shares} off the mean square."
    return Statement(f"Significance of {words.key_of(group)}", accident + gain)


def _left(diagnosis: Diagnosis) -> Statement:
    structure = diagnosis.structure_after
    if structure.events:
        named = fmt.listing(event.text for event in structure.events)
        return Statement("Structure is left", f"What is left goes with {named}.", "bad")
    if not structure.carriers:
        return Statement("Not tested", "There is nothing that the residual could go with.", "doubt")
    strongest = structure.carriers[0]
    what, chance = words.covariate(strongest.name), words.chance(strongest.chance)
    if structure.is_present:
        text = f"What is left goes with {what}; the chance of that by accident is {chance}."
        return Statement("Structure is left", text, "bad")
    text = (
        f"The strongest of {fmt.plural(len(structure.carriers), 'covariate')} is {what}, and noise "
        f"alone would look as strong with a chance of {chance}."
    )
    return Statement("No structure is left", text, "good")


def _lasting(diagnosis: Diagnosis) -> Iterator[Statement]:
    lasts = diagnosis.structure_after.lasting
    if lasts.share:
        yield Statement(
            "Rows are alike",
            "What is left of a row is like that of the row before, with a correlation of "
            f"{fmt.number(lasts.share * lasts.decay, 2)}: something drifts, or the sensors' noise "
            f"lasts. {fmt.number(lasts.rows, 2)} rows tell as much as one; deviations and chances "
            "count them so.",
            "doubt",
        )


def _noise(diagnosis: Diagnosis) -> Statement:
    noise = diagnosis.noise
    kinds = list(quantities(diagnosis))
    shown = fmt.listing(f"{q.with_unit(q.noise)} of a {q.name}" for q, _, _ in kinds)
    scatter = max(diagnosis.scatter.values(), default=0.0)
    more = ""
    if scatter > MOST_SCATTER:
        more = f" On held-out rows, what is left is up to {fmt.number(scatter, 2)} times that."
    if noise.source == "declared":
        return Statement("Noise as declared", f"{shown}.{more}", "doubt" if more else "")
    text = f"{shown}: {noise.source}, not declared. Multiples of noise rest on it.{more}"
    return Statement("Noise estimated", text, "doubt")
