"""Measured data beside the model: what is left of every reading, and the search for why."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.diagnosis.case import case_of, first_noise
from designer.diagnosis.diagnose import diagnose_study
from designer.diagnosis.problem import Problem, channel_names
from designer.diagnosis.study import diagnosed_config
from designer.explore.question import Question
from designer.measured.read import read_measured
from designer.model.measurements import Measured


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """What the model, with the declared effects, leaves of each reading."""

    row_numbers: IntArray  #: (n_rows,) of each row in the file, the first below the head being 1
    position_m: FloatArray  #: (n_rows, 3) where the platform was [m]
    channels: tuple[str, ...]  #: Names of the readings, such as ``length 1``, and their SI units
    units: tuple[str, ...]
    #: (n_rows, n_channels) measured less predicted; NaN where nothing was measured or nothing holds
    #: the pose
    residual: FloatArray
    without: FloatArray  #: (n_rows, n_channels) the same without the declared effects
    noise: FloatArray  #: (n_channels,) standard deviation of one reading
    noise_source: str  #: ``declared``, or how the noise was estimated
    #: (n_rows,) what a residual may go with, by its title with unit
    covariates: Mapping[str, FloatArray]
    notes: tuple[str, ...]  #: What is to be known of the data

    def size(self) -> FloatArray:
        """Return the root mean square of each row in units of noise (n_rows,), NaN for none."""
        squares = (self.residual / self.noise) ** 2
        count = np.isfinite(squares).sum(axis=1)
        total = np.nansum(squares, axis=1)
        return np.where(count > 0, np.sqrt(total / np.maximum(count, 1)), np.nan)


def residuals(question: Question) -> Residuals:
    """Compare the data of a study with its model.

    Raises InputError if the study has no measurements, or the data are not as they should be.
    """
    study = question.study
    measured = read_measured(study)
    assert study.measurements is not None  # else reading has refused
    declared = study.measurements.with_nothing_unknown
    case = case_of(study, declared, measured)
    bare = case_of(replace(study, effects=(), session_effects=()), declared, measured)
    predict = case.predictor()
    everywhere = np.ones(measured.n_rows, dtype=np.bool_)
    noise = first_noise(declared, measured, predict, everywhere)
    problem = Problem(measured, predict, noise)
    n_cables = measured.length_m.shape[1]
    return Residuals(
        row_numbers=measured.row_numbers,
        position_m=predict.placed(()).poses.position_m,
        channels=tuple(channel_names(n_cables)),
        units=("m",) * n_cables + ("N",) * n_cables,
        residual=problem.measured.readings - problem.predicted(()).stacked,
        without=problem.measured.readings - bare.predictor()((), noise).stacked,
        noise=problem.sigma,
        noise_source=noise.source,
        covariates=_covariates(measured),
        notes=measured.notes,
    )


def _covariates(measured: Measured) -> dict[str, FloatArray]:
    """Return everything of a row that a residual may be drawn over."""
    covariates = {"row": measured.row_numbers.astype(np.float64)}
    if measured.session is not None:
        covariates["session"] = measured.session.astype(np.float64)
    if measured.time_s is not None:
        covariates["time [s]"] = measured.time_s
    for axis, values in zip("xyz", measured.poses.position_m.T, strict=True):
        covariates[f"{axis} [m]"] = values
    if measured.temperature_C is not None:
        covariates["temperature [°C]"] = measured.temperature_C
    if measured.wind_m_per_s is not None:
        covariates["wind speed [m/s]"] = np.linalg.norm(measured.wind_m_per_s, axis=1)
    for kind, unit, readings in (
        ("length", "m", measured.length_m),
        ("tension", "N", measured.tension_N),
    ):
        for k, values in enumerate(readings.T, start=1):
            if np.isfinite(values).any():
                covariates[f"{kind} {k} [{unit}]"] = values
    return {**covariates, **measured.covariates}


@dataclass(frozen=True, slots=True, eq=False)
class DiagnosisAnswer:
    """What a diagnosis came to."""

    title: str  #: The answer in a few words, and in sentences
    text: str
    effects: tuple[str, ...]  #: What the model lacked, each with its fitted values
    #: On rows that no fit has seen, of lengths and tensions: before, after, and the noise
    errors: tuple[str, ...]
    diagnosed_text: str  #: The study with what was fitted and found; a text for the session


def diagnosis_answer(question: Question, progress: Callable[[str], None]) -> DiagnosisAnswer:
    """Search for what the model lacks.

    Raises InputError if the study has no measurements, or the data are not as they should be.
    """
    from designer.diagnosis.report import verdict
    from designer.diagnosis.words import fitted_values, quantities

    study = question.study
    measured = read_measured(study)
    diagnosis = diagnose_study(study, measured, progress)
    answer = verdict(diagnosis)
    return DiagnosisAnswer(
        title=answer.title,
        text=answer.text,
        effects=tuple(
            f"{finding.effect.key}: {fitted_values(finding.effect, finding.parameters)}"
            for finding in diagnosis.findings
        ),
        errors=tuple(
            f"error of {kind.name}: {kind.with_unit(before.heldout.value)} before, "
            f"{kind.with_unit(after.heldout.value)} after, noise {kind.with_unit(kind.noise)}"
            for kind, before, after in quantities(diagnosis)
        )
        + tuple(f"session {each.session}: {each.in_words}" for each in diagnosis.sessions),
        diagnosed_text=diagnosed_config(diagnosis, question.path.parent, question.text),
    )
