"""The declared model on measured data: what is left without and with its effects, no search."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.blocks import block_of
from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import Case, check_held
from designer.diagnosis.errors_of import bootstrap, outliers_of
from designer.diagnosis.fit import fit
from designer.diagnosis.foretell import foretell
from designer.diagnosis.hold import structure_left
from designer.diagnosis.noise import noise_of, rough_noise
from designer.diagnosis.predict import Predictor
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Foretold, Interval, Outlier
from designer.diagnosis.structure import Structure
from designer.effects.effect import Setting
from designer.model.measured_data import Measured, Noise
from designer.study import Measurements, Study

CARRIED = "as estimated when diagnosed"


@dataclass(frozen=True, slots=True)
class Left:
    """What a model leaves of one kind of reading, nothing left out, in SI units.

    Parameters
    ----------
    rms : Interval
        Root mean square.
    median : float
        Of the size of each error.
    """

    rms: Interval
    median: float


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """One model on the data.

    Parameters
    ----------
    settings : tuple of Setting
        Its effects.
    residual : array (n_rows, 2 n_cables)
        Measured less predicted lengths [m], then tensions [N]; NaN where there is none.
    n_not_held : int
        Rows that this machine could not hold.
    length_m, tension_N : Left or None
        Over the rows that every model holds; None where nothing of the kind was measured.
    foretold : Foretold or None
        Pose and tensions by the lengths alone.
    """

    settings: tuple[Setting, ...]
    residual: FloatArray
    n_not_held: int
    length_m: Left | None
    tension_N: Left | None
    foretold: Foretold | None


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """The declared model on data.

    Parameters
    ----------
    study, measured, noise
        The problem.
    without, declared : Model
        Without any effect, and with those that the config declares.
    fitted : Model or None
        Without any, but what the config calls unknown fitted to these very rows: the best that can
        be said without the effects. None where nothing is unknown, or the rows are too few.
    idle : tuple of (effect, reason)
        Declared effects for which these data lack something.
    n_compared : int
        Rows that every model holds.
    structure : Structure
        Test of what the declared model leaves.
    outliers : tuple of Outlier
        Readings that stand off from the declared model; they are not left out.
    """

    study: Study
    measured: Measured
    noise: Noise
    without: Model
    declared: Model
    fitted: Model | None
    idle: tuple[tuple[str, str], ...]
    n_compared: int
    structure: Structure
    outliers: tuple[Outlier, ...]

    @property
    def helps(self) -> bool:
        """Whether less is left, in units of noise, than by any model without the effects."""
        others = [self.without, *([self.fitted] if self.fitted else [])]
        return all(self._size(self.declared) < self._size(other) for other in others)

    @property
    def is_positive(self) -> bool:
        """Whether the declared model stands: it holds all rows, helps, and leaves no structure."""
        holds = self.declared.n_not_held <= self.without.n_not_held
        helps = self.helps or not self.declared.settings
        return holds and helps and not self.structure.is_present

    def _size(self, model: Model) -> float:
        kinds = ((model.length_m, self.noise.length_m), (model.tension_N, self.noise.tension_N))
        return sum((left.rms.value / noise) ** 2 for left, noise in kinds if left is not None)


def check(
    study: Study,
    measurements: Measurements,
    measured: Measured,
    progress: Callable[[str], None] = lambda _: None,
) -> Check:
    """Compare the data with the model as declared; only the baseline's unknowns are ever fitted.

    Raises
    ------
    InputError
        If the robot as declared cannot hold most of the poses.
    EffectError
        If an effect of a plugin fails.
    """
    case = case_of(study, replace(measurements, unknown=()), measured)
    bare = case_of(replace(study, effects=()), measurements, measured)
    everything = Predictor(case.machine, measured, case.fixed, study.known_effects)
    check_held(case, everything)
    noise = _noise(measurements, measured, everything)
    declared = Problem(measured, everything, noise)
    bare_predict = Predictor(case.machine, measured, (), study.known_effects)
    without = Problem(measured, bare_predict, noise)
    problems: dict[str, tuple[Problem, tuple[Setting, ...]]] = {
        "declared": (declared, ()),
        "without": (without, ()),
    }
    if bare.given and _can_be_fitted(bare, without):
        progress("what is unknown, fitted without the effects")
        problems["fitted"] = (without, _fitted(bare, without))
    models = _models(problems, case.fixed, progress)
    progress("what is left")
    return Check(
        study=study,
        measured=measured,
        noise=noise,
        without=models["without"],
        declared=models["declared"],
        fitted=models.get("fitted"),
        idle=case.idle,
        n_compared=int(_held(problems).sum()),
        structure=structure_left(declared, (), np.ones(measured.n_rows, dtype=np.bool_)),
        outliers=outliers_of(declared.residual(()), measured.row_numbers),
    )


def _noise(measurements: Measurements, measured: Measured, predict: Predictor) -> Noise:
    rough = Problem(measured, predict, rough_noise(measured))
    noise = noise_of(measurements, measured, rough.residual(()) * rough.sigma)
    is_carried = noise.source == "declared" and measurements.estimated_noise
    return replace(noise, source=CARRIED) if is_carried else noise


def _can_be_fitted(bare: Case, problem: Problem) -> bool:
    """Tell whether there are more readings than unknowns; a check needs no such rows."""
    unknown = sum(len(effect.parameters) for effect in bare.given)
    return problem.free_readings(np.isfinite(problem.readings)) > unknown


def _fitted(bare: Case, problem: Problem) -> tuple[Setting, ...]:
    everywhere = np.ones(bare.measured.n_rows, dtype=bool)
    return fit(problem, bare.given, everywhere).settings


Problems = Mapping[str, tuple[Problem, tuple[Setting, ...]]]


def _held(problems: Problems) -> BoolArray:
    """Return the rows that every model holds (n_rows,)."""
    return np.asarray(np.all([_holds(*problem) for problem in problems.values()], axis=0))


def _holds(problem: Problem, settings: Sequence[Setting]) -> BoolArray:
    return np.asarray(np.isfinite(problem.predicted(settings).length_m).all(axis=1))


def _models(
    problems: Problems, fixed: tuple[Setting, ...], progress: Callable[[str], None]
) -> dict[str, Model]:
    rows = _held(problems)
    answer = {}
    for name, (problem, settings) in problems.items():
        progress(f"poses by the lengths alone, {name}")
        answer[name] = _model(problem, settings, rows)
    answer["declared"] = replace(answer["declared"], settings=fixed)
    return answer


def _model(problem: Problem, settings: tuple[Setting, ...], rows: BoolArray) -> Model:
    predicted = problem.predicted(settings)
    residual = problem.readings - np.hstack([predicted.length_m, predicted.tension_N])
    n = residual.shape[1] // 2
    has_lengths = np.isfinite(problem.measured.length_m).all(axis=1)
    return Model(
        settings=settings,
        residual=residual,
        n_not_held=int((~_holds(problem, settings)).sum()),
        length_m=_left(residual[:, :n], rows),
        tension_N=_left(residual[:, n:], rows),
        foretold=foretell(problem, settings, rows & has_lengths),
    )


def _left(residual: FloatArray, rows: BoolArray) -> Left | None:
    seen = residual[rows]
    if np.isnan(seen).all():
        return None
    interval = bootstrap(seen, block_of(len(residual))[rows])
    return Left(interval, float(np.nanmedian(np.abs(seen))))
