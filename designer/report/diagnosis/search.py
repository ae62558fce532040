"""The search, round by round."""

from __future__ import annotations

from dataclasses import dataclass

from designer.diagnosis.result import Diagnosis, Estimate
from designer.diagnosis.search import SIGNIFICANCE, Step, Trial
from designer.report import format as fmt
from designer.report.diagnosis import words
from designer.report.parts import Column, Group, Row, Table

_MOST = 6


@dataclass(frozen=True, slots=True)
class SearchSection:
    """The search.

    Parameters
    ----------
    table : Table
        The best candidates of each round, and what was added.
    significance : str
        Chance below which a gain is no accident.
    """

    table: Table
    significance: str


def search_section(diagnosis: Diagnosis) -> SearchSection:
    """Return the search, round by round."""
    groups = tuple(_group(diagnosis, k, step) for k, step in enumerate(diagnosis.steps, start=1))
    columns = (
        Column("Candidate", is_number=False),
        Column("Gain"),
        Column("Chance"),
        Column("Gain unseen"),
        Column("Its values", is_number=False),
    )
    caption = f"Each round: the {_MOST} best candidates in addition to what was found before."
    return SearchSection(Table(caption, columns, groups), words.chance(SIGNIFICANCE))


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


def _row(trial: Trial, is_added: bool) -> Row:
    cells = (
        trial.effect.key.replace(" ", words.NO_BREAK),
        fmt.number(trial.gain, 3) if abs(trial.gain) >= 0.1 else "0",
        words.chance(trial.chance),
        fmt.number(trial.heldout_gain, 3),
        _values(trial),
    )
    return Row(cells, "good" if is_added else "" if trial.earns_its_place else "muted")


def _values(trial: Trial) -> str:
    at = 0
    for setting in trial.fit.settings:
        names = list(setting.values)
        if setting.effect.key == trial.effect.key:
            std = trial.fit.std[at : at + len(names)]
            estimates = {
                name: Estimate(setting.values[name], float(s))
                for name, s in zip(names, std, strict=True)
            }
            return words.values(trial.effect, estimates)
        at += len(names)
    return ""
