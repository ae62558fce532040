"""The diagnosis of measured data, for the window: what was found, and the study with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from designer.diagnosis.diagnose import diagnose_study
from designer.explore.question import Question
from designer.io.diagnosis_files import diagnosed_config
from designer.measured.read import read_measured


@dataclass(frozen=True, slots=True)
class FoundEffect:
    """An effect that the model lacked: its name, its values in words, and its rivals."""

    key: str
    values: str
    rivals: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ErrorChange:
    """Error on rows that no fit has seen, of lengths or tensions, in an SI unit."""

    reading: str
    unit: str
    before: float
    after: float
    noise: float


@dataclass(frozen=True, slots=True, eq=False)
class DiagnosisAnswer:
    """What a diagnosis came to.

    Parameters
    ----------
    title, text, tone : str
        The answer in a few words, in sentences, and ``good``, ``doubt`` or ``bad``.
    effects : tuple of FoundEffect
        What was found.
    errors : tuple of ErrorChange
        Before and after.
    diagnosed_text : str
        The study with what was fitted and found; a text for the session.
    json : mapping
        What ``diagnosis.json`` holds.
    """

    title: str
    text: str
    tone: str
    effects: tuple[FoundEffect, ...]
    errors: tuple[ErrorChange, ...]
    diagnosed_text: str
    json: dict[str, Any]


def diagnosis_answer(question: Question, progress: Callable[[str], None]) -> DiagnosisAnswer:
    """Search for what the model lacks.

    Raises
    ------
    InputError
        If the study has no measurements, or the data are not as they should be.
    """
    from designer.report.diagnosis.first_page import verdict

    study = question.study
    measured = read_measured(study)
    assert study.measurements is not None  # else reading has refused
    found = diagnose_study(study, study.measurements, measured, progress)
    answer = verdict(found)
    stages = found.stages[0], found.final
    kinds = (
        ("length", "m", [stage.length_m for stage in stages], found.noise.length_m),
        ("tension", "N", [stage.tension_N for stage in stages], found.noise.tension_N),
    )
    return DiagnosisAnswer(
        title=answer.title,
        text=answer.text,
        tone=answer.tone,
        effects=tuple(
            FoundEffect(
                one.effect.key,
                ", ".join(f"{k} = {e.value:.4g} ± {e.std:.2g}" for k, e in one.parameters.items()),
                one.rivals,
            )
            for one in found.findings
        ),
        errors=tuple(
            ErrorChange(name, unit, was.heldout.value, now.heldout.value, noise)
            for name, unit, (was, now), noise in kinds
            if was is not None and now is not None
        ),
        diagnosed_text=diagnosed_config(found, question.path.parent, question.text),
        json=found.to_dict(),
    )
