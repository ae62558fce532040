"""The search, round by round."""

from __future__ import annotations

from designer.diagnosis.result import Diagnosis, Estimate
from designer.diagnosis.search import EffectTrial, Step
from designer.diagnosis.statistics import SIGNIFICANCE
from designer.report import format as fmt
from designer.report.blocks import Column, Group, Heads, Row, Section, Table
from designer.report.diagnosis import words

_MOST = 6


def section(diagnosis: Diagnosis) -> Section:
    """Return the best candidates of each round, and what was added."""
    groups = (_group(diagnosis, k, step) for k, step in enumerate(diagnosis.steps, start=1))
    columns: Heads = ("Candidate", *map(Column, ("Gain", "Chance", "Gain unseen")), "Its values")
    caption = f"Each round: the {_MOST} best candidates in addition to what was found before."
    return Section.of(
        "search",
        "The search",
        "In each round every candidate is fitted together with what was found before. Its gain is "
        "what it takes off the robust loss, in units of the variance that is left; its chance is "
        "that of such a gain by accident in any candidate of the round. The gain on unseen rows "
        "comes from fits that left these rows out; it is worked out from the best candidate down, "
        "as far as the choice needs it. A candidate earns its place with a chance below "
        f"{words.chance(SIGNIFICANCE)} and a gain on unseen rows.",
        Table.grouped(caption, columns, groups, "candidates long"),
    )


def _group(diagnosis: Diagnosis, number: int, step: Step) -> Group:
    added = step.added.key if step.added else ""
    remark = f"{fmt.plural(len(step.trials), 'candidate')}; "
    none = "nothing earned its place" if step.is_complete else "the time for the search was over"
    remark += f"added {added}{_later(diagnosis, added)}" if added else none
    rows = tuple(_row(trial, trial.effect.key == added) for trial in step.trials[:_MOST])
    return Group(rows, f"Round {number}", remark, "good" if added else "")


def _later(diagnosis: Diagnosis, added: str) -> str:
    """Say what became of an effect that was added and is not among the findings."""
    if added in {finding.effect.key for finding in diagnosis.findings}:
        return ""
    if added in {gone.effect for gone in diagnosis.withdrawn}:
        return ", withdrawn later"
    return ", which others made superfluous later"


def _row(trial: EffectTrial, is_added: bool) -> Row:
    cells = (
        trial.effect.key.replace(" ", words.NO_BREAK),
        fmt.number(trial.gain, 3) if abs(trial.gain) >= 0.1 else "0",
        words.chance(trial.chance),
        fmt.number(trial.heldout_gain, 3),
        _values(trial),
    )
    return Row(cells, "good" if is_added else "" if trial.earns_its_place else "muted")


def _values(trial: EffectTrial) -> str:
    stds = iter(trial.fit.std)  # of all parameters of all settings, in their order
    for setting in trial.fit.settings:
        estimates = {
            name: Estimate(value, float(std))
            for (name, value), std in zip(setting.values.items(), stds, strict=False)
        }
        if setting.effect.key == trial.effect.key:
            return words.values(trial.effect, estimates)
    return ""
