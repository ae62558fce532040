"""The declared model on measured data: what is left without and with its effects, no search."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis import result
from designer.diagnosis.accuracy import (
    ForwardError,
    Interval,
    Outlier,
    bootstrap,
    forward_error,
    outliers_of,
)
from designer.diagnosis.case import case_of, first_noise
from designer.diagnosis.fit import fit
from designer.diagnosis.problem import Problem
from designer.diagnosis.statistics import block_of
from designer.diagnosis.structure import Structure, structure_left, with_gross_errors
from designer.documents.plain import Json, json_text, record
from designer.effects.effect import Setting
from designer.model.measurements import KINDS, Measured, Noise
from designer.study import Study

CARRIED = "as estimated when diagnosed"


@dataclass(frozen=True, slots=True)
class RemainingError:
    """What a model leaves of one kind of reading, nothing left out, in SI units."""

    rms: Interval = field(metadata={"json": record})  #: root mean square
    median: float  #: of the size of each error


@dataclass(frozen=True, slots=True, eq=False)
class ModelErrors:
    """One model on the data."""

    settings: tuple[Setting, ...]  #: its effects
    #: (n_rows, 2 n_cables): measured less predicted lengths [m], then tensions [N]; NaN where there
    #: is none
    residual: FloatArray
    n_not_held: int  #: rows that this machine could not hold
    #: over the rows that every model holds; None where nothing of the kind was measured
    length_m: RemainingError | None
    tension_N: RemainingError | None
    foretold: ForwardError | None  #: pose and tensions by the lengths alone


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """The declared model on data."""

    study: Study  #: the problem
    measured: Measured
    noise: Noise
    without: ModelErrors  #: without any effect, and with those that the config declares
    declared: ModelErrors
    #: without any, but what the config calls unknown fitted to these very rows: the best that can
    #: be said without the effects. None where nothing is unknown, or the rows are too few.
    fitted: ModelErrors | None
    idle: tuple[tuple[str, str], ...]  #: declared effects for which these data lack something
    n_compared: int  #: rows that every model holds
    structure: Structure  #: test of what the declared model leaves
    #: readings that stand off from the declared model; they are not left out
    outliers: tuple[Outlier, ...]

    @property
    def helps(self) -> bool:
        """Whether less is left, in units of noise, than by any model without the effects.

        Where nothing is declared but what is unknown, fitting that to these very rows is no rival.
        """
        fitted = {} if self.fitted is None else {s.effect.key for s in self.fitted.settings}
        is_more = any(s.effect.key not in fitted for s in self.declared.settings)
        alternatives = [self.without, *([self.fitted] if self.fitted and is_more else [])]
        return all(self._betters(alternative) for alternative in alternatives)

    @property
    def is_positive(self) -> bool:
        """Whether the declared model stands: it holds all rows, helps, and leaves no structure."""
        holds = self.declared.n_not_held <= self.without.n_not_held
        helps = self.helps or not self.declared.settings
        return holds and helps and not self.structure.is_present

    def _betters(self, alternative: ModelErrors) -> bool:
        return self._size(self.declared) < self._size(alternative)

    def _size(self, model: ModelErrors) -> float:
        remaining = [(kind.of(model), kind.of(self.noise)) for kind in KINDS if kind.of(model)]
        return float(sum((deviation.rms.value / noise) ** 2 for deviation, noise in remaining))

    @property
    def models(self) -> list[tuple[str, ModelErrors]]:
        """Each model with what to call it."""
        models = [("without effects", self.without)]
        if self.fitted is not None:
            unknown = ", ".join(dict.fromkeys(s.effect.id for s in self.fitted.settings))
            models.append((f"without, {unknown} fitted to these rows", self.fitted))
        return [*models, ("with the effects, nothing fitted", self.declared)]

    def remarks(self) -> Iterator[str]:
        """Yield what to make of it, in sentences."""
        yield f"{self.n_compared} of {self.measured.n_rows} rows compared, outliers and all."
        if self.measured.thinned:
            yield f"{self.measured.thinned}."
        if origin := self.measured.origin_of_poses:
            yield origin
        if not self.study.effects and not any(self.study.session_effects):
            yield "The config declares no effects."
        elif not self._betters(self.without):
            yield "The declared effects do not help on these data."
        elif not self.helps:
            yield "The declared effects leave no less than what is unknown, fitted to these rows."
        for key, reason in self.idle:
            yield f"{key} is declared and does not act here: {reason}."
        if self.declared.n_not_held:
            yield f"With the effects the robot cannot hold {self.declared.n_not_held} rows."
        carriers = self.structure.carriers
        if self.structure.events:
            yield f"What is left goes with {', '.join(e.text for e in self.structure.events)}."
        if self.structure.present:
            share = f"{carriers[0].fraction_of_variance:.0%} of its variance"
            yield f"What is left goes with {carriers[0].name}, {share}."
        elif carriers and not self.structure.events:
            yield "What is left goes with nothing that was recorded."
        if self.outliers:
            yield f"{len(self.outliers)} readings stand off by more than five times the spread."

    def to_dict(self) -> dict[str, Any]:
        """Return what ``diagnosis.json`` holds; a missing number is None."""
        names = {"without": self.without, "with": self.declared, "unknowns_fitted": self.fitted}
        models = {name: model for name, model in names.items() if model is not None}

        def of_each(attribute: str) -> Json | None:
            values = {name: getattr(model, attribute) for name, model in models.items()}
            return values if any(value is not None for value in values.values()) else None

        answer = {
            "rows": {
                "all": self.measured.n_rows,
                "compared": self.n_compared,
                "not_held": of_each("n_not_held"),
                **result.rows_dict(self.outliers, self.measured),
            },
            "check": {
                "length_m": of_each("length_m"),
                "tension_N": of_each("tension_N"),
                "forward": of_each("foretold"),
                "helps": self.helps,
                "stands": self.is_positive,
            },
            "effects": result.effects_table(self.study.effects),
            "session_effects": [
                result.effects_table(effects) for effects in self.study.session_effects
            ],
            "idle": result.reasons(self.idle),
            "unexplained": result.structure_dict(self.structure),
            "noise": self.noise,
        }
        return result.framed(answer, self.study, self.measured)

    def to_json(self) -> str:
        """Return the text of ``diagnosis.json``."""
        return json_text(self.to_dict())


def check(
    study: Study, measured: Measured, progress: Callable[[str], None] = lambda _: None
) -> Check:
    """Compare the data with the model as declared; only the baseline's unknowns are ever fitted.

    Raises
    ------
    InputError
        If the robot as declared cannot hold most of the poses.
    EffectError
        If an effect of a plugin fails.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):  # as in a diagnosis
        return _check(study, measured, progress)


def _check(study: Study, measured: Measured, progress: Callable[[str], None]) -> Check:
    measurements = study.measurements
    assert measurements is not None
    case = case_of(study, measurements.with_nothing_unknown, measured)
    measured = case.measured  # with poses, where they are estimated
    bare = case_of(replace(study, effects=(), session_effects=()), measurements, measured)
    everywhere = np.ones(measured.n_rows, dtype=np.bool_)
    predict = case.predictor()
    case.check_held(predict)
    noise = first_noise(measurements, measured, predict, everywhere)
    if noise.source == "declared" and measurements.estimated_noise:
        noise = replace(noise, source=CARRIED)
    declared = Problem(measured, predict, noise)
    without = Problem(measured, bare.predictor(), noise)
    problems: dict[str, tuple[Problem, tuple[Setting, ...]]] = {
        "declared": (declared, ()),
        "without": (without, ()),
    }
    unknown = sum(len(effect.parameters) for effect in bare.given)
    # A check holds no rows out: as many readings as unknowns are enough.
    if unknown and without.free_readings(np.isfinite(without.measured.readings)) > unknown:
        progress("what is unknown, fitted without the effects")
        problems["fitted"] = (without, fit(without, bare.given, everywhere).settings)
    held_rows = {
        name: np.asarray(np.isfinite(problem.predicted(settings).length_m).all(axis=1))
        for name, (problem, settings) in problems.items()
    }
    compared = np.asarray(np.all([*held_rows.values()], axis=0))
    models = {}
    for name, (problem, settings) in problems.items():
        progress(f"poses by the lengths alone, {name}")
        models[name] = _model(problem, settings, held_rows[name], compared)
    progress("what is left")
    residual = declared.residual(())
    return Check(
        study=study,
        measured=measured,
        noise=noise,
        without=models["without"],
        declared=replace(models["declared"], settings=case.fixed),
        fitted=models.get("fitted"),
        idle=case.idle,
        n_compared=int(compared.sum()),
        structure=with_gross_errors(
            structure_left(declared, (), everywhere), residual, residual, measured.row_numbers
        ),
        outliers=outliers_of(residual, measured.row_numbers),
    )


def _model(
    problem: Problem, settings: tuple[Setting, ...], mask: BoolArray, compared: BoolArray
) -> ModelErrors:
    residual = problem.measured.readings - problem.predicted(settings).stacked
    length_m, tension_N = np.hsplit(residual, 2)
    has_lengths = np.isfinite(problem.measured.length_m).all(axis=1)
    return ModelErrors(
        settings=settings,
        residual=residual,
        n_not_held=int((~mask).sum()),
        length_m=_remaining_error(length_m, compared),
        tension_N=_remaining_error(tension_N, compared),
        foretold=forward_error(problem, settings, compared & has_lengths),
    )


def _remaining_error(residual: FloatArray, rows: BoolArray) -> RemainingError | None:
    seen = residual[rows]
    if np.isnan(seen).all():
        return None
    interval = bootstrap(seen, block_of(len(residual))[rows])
    return RemainingError(interval, float(np.nanmedian(np.abs(seen))))
