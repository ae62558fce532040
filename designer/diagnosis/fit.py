"""Robust least squares for the parameters of given effects, and how sure their values are.

Two things ask for care. The time from which an effect acts at once has no slope, and lies between
two rows. And at the edge of what the cables hold readings change much faster than the pose: a taut
cable's length changes by no more than the pose does, but near the edge a cable hangs slack, and its
length tells the pose of the model a thousand times better than any camera tells the true one. A fit
that took the poses for exact would be settled by that row alone. Deviations are therefore given as
if, in such rows, the poses had the noise of a length.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.problem import Problem
from designer.diagnosis.statistics import SIGNIFICANCE, score_covariances
from designer.effects.effect import Effect, Setting, Values, frame_size_m
from designer.effects.platform_loads import LEAST_ROWS
from designer.statics.forward import moved_poses

_LINEARITY_RTOL = 0.1
"""Of a change, by how much another may miss what slopes foretell: steps with them still do good."""
_JUMP = 1e3
"""Of the noise and of the median row's change: no slope, but another balance of a fitted pose."""
HUBER = 3.0
"""Standard deviations up to which a residual counts by its square: noise exceeds it in 1 of 370."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Effects with fitted parameters."""

    settings: tuple[Setting, ...]  #: the effects in the order in which they act, with their values
    vector: FloatArray  #: (n_parameters,): all values in that order
    #: (n_parameters,): standard deviations, scaled up where the residual exceeds the noise, or
    #: where readings of one row, of neighbouring rows or of one block are alike
    std: FloatArray
    loss: float  #: robust sum of squares over the fitted rows, in units of noise
    n_data: int  #: number of readings fitted, less those that internal forces took
    #: for each effect, by how much the readings that tell of it are fewer than they look, at least
    #: 1: mean ratio of variances (Rao and Scott, Ann. Statist. 12, 1984).
    inflation: Mapping[str, float] = field(default_factory=dict)
    #: for each effect, how far all its values together are from doing nothing, squared, in units of
    #: their covariance: the smallest over the estimates of it that ``std`` is the largest of
    wald: Mapping[str, float] = field(default_factory=dict)
    #: (n_parameters, n_parameters): of all values: correlations by least squares, with ``std``
    covariance: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    @property
    def variance(self) -> float:
        """Loss over degrees of freedom, at least 1: how much the noise is exceeded."""
        return max(1.0, self.loss / max(self.n_data - len(self.vector), 1))

    def is_plausible(self, effect: Effect) -> bool:
        """Tell whether an effect has values here that an engineer would believe."""
        values = next(s.values for s in self.settings if s.effect.key == effect.key)
        return all(p.is_plausible(values[p.name]) for p in effect.parameters)

    def is_faint(self, effect: Effect) -> bool:
        """Tell whether an effect may as well do nothing, by the covariance of all its values."""
        from scipy.stats import chi2

        return bool(chi2.sf(self.wald[effect.key], sum(effect.strength)) > SIGNIFICANCE)


def huber(residual: FloatArray) -> FloatArray:
    """Return the robust square of each residual: r² up to 3, linear beyond; 0 where NaN."""
    size = np.abs(np.nan_to_num(residual, nan=0.0))
    return np.where(size <= HUBER, size**2, 2.0 * HUBER * size - HUBER**2)


def settings_at(effects: Sequence[Effect], vector: FloatArray) -> tuple[Setting, ...]:
    """Give the effects the values of a vector."""
    values = iter(vector.tolist())
    return tuple(
        Setting(effect, {p.name: next(values) for p in effect.parameters}) for effect in effects
    )


def with_places(settings: Sequence[Setting]) -> Iterator[tuple[Setting, slice]]:
    """Yield each setting with the place of its values in the vector of all."""
    at = 0
    for setting in settings:
        yield setting, slice(at, at + len(setting.values))
        at += len(setting.values)


def starting_vector(
    effects: Sequence[Effect], settings: Sequence[Setting], start: Values
) -> FloatArray:
    """Return values to start from: those known, else ``start``, else a typical change."""
    values_of = {setting.effect.key: setting.values for setting in settings}
    vector = []
    for effect in effects:
        values = values_of.get(effect.key, start)
        for p in effect.parameters:
            low, high = p.bounds
            vector.append(np.clip(values.get(p.name, p.neutral + 0.1 * p.typical), low, high))
    return np.array(vector)


def fit(
    problem: Problem,
    effects: Sequence[Effect],
    rows: BoolArray,
    start: Sequence[Setting] = (),
    *,
    thorough: bool = False,
    anew: bool = False,
) -> Fit:
    """Fit all parameters of the effects to the readings of some rows.

    Huber's loss, bounds, and as many starts as the effects ask for. The slopes are differences of
    the compiled model over steps that each parameter's typical size sets, so short that one side
    will do.

    Parameters
    ----------
    problem : Problem
        Data and model.
    effects : sequence of Effect
        In the order in which they act.
    rows : array (n_rows,) of bool
        What may be seen.
    start : sequence of Setting
        Effects whose values are already near.
    thorough : bool
        Whether to go on until nothing moves; a trial need not, nor one part of a validation.
    anew : bool
        Whether known effects that have several valleys start in each of them again: the valley
        that an effect was found in alone need not be the one that it has beside another.
    """
    is_used = problem.used(rows)
    if start:
        problem.predict.trust_as(start, effects, problem.noise)
    if not effects:
        loss = float(huber(problem.misfit(())[is_used]).sum())
        return Fit((), np.empty(0), np.empty(0), loss, problem.free_readings(is_used))
    known_keys = {s.effect.key for s in start}
    several = [e for e in effects if e.starts or e.starts_from]  # valleys to start in
    fresh = [e for e in several if anew or e.key not in known_keys]
    # Evaluations from anywhere, and from near the end.
    iterations = 80 if thorough or not start or (anew and fresh) else 12
    valleys = _starts(problem, effects, start, fresh)
    is_known = {effect.key for effect in fresh} <= known_keys
    present = [starting_vector(effects, start, {})] if is_known or not valleys else []
    starts = [*valleys, *present]
    if anew or not start:  # the present values promise most, but may be in the wrong valley
        starts = [
            vector
            for group in (valleys, present)
            for vector in _promising(problem, effects, is_used, group)
        ]
    fits = [_fit_from(problem, effects, is_used, v, iterations, thorough=thorough) for v in starts]
    return min(fits, key=lambda candidate: candidate.loss)


def _starts(
    problem: Problem,
    effects: Sequence[Effect],
    start: Sequence[Setting],
    fresh: Sequence[Effect],
) -> list[FloatArray]:
    """Return vectors to start from: in each valley of each of the fresh effects."""
    starts = []
    fitted = {effect.key for effect in effects}
    for effect in fresh:
        rest_settings = [s for s in start if s.effect.key != effect.key]
        values_to_try = list(effect.starts)
        if effect.starts_from is not None:
            rest = tuple(s for s in rest_settings if s.effect.key in fitted)
            residual = problem.residual(rest) * problem.sigma
            values_to_try += effect.starts_from(problem.measured, residual)
        starts += [starting_vector(effects, rest_settings, values) for values in values_to_try]
    return starts


def _promising(
    problem: Problem, effects: Sequence[Effect], is_used: BoolArray, starts: Sequence[FloatArray]
) -> list[FloatArray]:
    """Return the start or two from which a linear step leaves least, of equal ones the nearer.

    Steps are taken while they do good: far off, where all readings of a winch stand off, the robust
    loss is so flat that the fit would not find its way.
    """
    reached: dict[tuple[float, float], FloatArray] = {}
    for vector in starts:
        promise, loss, end = _stepped(problem, effects, is_used, vector)
        reached.setdefault((round(np.log(promise + 1.0), 2), round(np.log(loss + 1.0), 2)), end)
    least = min((promise for promise, _ in reached), default=0.0)
    return [reached[key] for key in sorted(reached)[:2] if key[0] < least + 0.1]


def _stepped(
    problem: Problem, effects: Sequence[Effect], is_used: BoolArray, vector: FloatArray
) -> tuple[float, float, FloatArray]:
    """Return the loss that a linear step promises, and the loss and place where such steps lead."""
    low, high = np.array([p.bounds for effect in effects for p in effect.parameters]).T
    residual = problem.misfit(settings_at(effects, vector))[is_used]
    loss, promise = float(huber(residual).sum()), np.inf
    for _ in range(8):
        slopes = jacobian(problem, effects, vector, nearly=True)[is_used]
        promised, step = _linear_step(residual, slopes)
        trial = np.clip(vector + step, low, high)
        residual_there = problem.misfit(settings_at(effects, trial))[is_used]
        loss_there = float(huber(residual_there).sum())
        promise = min(promise, promised)
        if loss_there >= loss:
            break
        vector, residual = trial, residual_there
        is_over = loss_there > 0.8 * loss
        loss = loss_there
        if is_over:
            break
    return promise, loss, vector


def jacobian(
    problem: Problem, effects: Sequence[Effect], vector: FloatArray, *, nearly: bool = False
) -> FloatArray:
    """Return the slopes of the misfit (n_rows, n_channels, n_parameters).

    With ``nearly``, slopes that were taken near by will do; see `KeptSlopes`.
    """
    settings = settings_at(effects, vector)
    problem.predicted(settings)  # which tells how far readings are trusted
    trust = (problem.noise, problem.predict.distrust(settings, problem.noise))
    return problem.predict.slopes.of(
        settings, trust, lambda setting: _slopes(problem, settings, setting), nearly=nearly
    )


def _slopes(problem: Problem, settings: Sequence[Setting], moving: Setting) -> FloatArray:
    """Return the slopes of the misfit in the parameters of one of the settings.

    A row that the model holds on one side only tells its slope there; one that it does not hold at
    all, or whose pose jumps, has none.
    """
    is_read = problem.measured.is_read
    predicted = problem.in_noise(settings)
    slopes = []
    for p in moving.effect.parameters:
        if p.is_step_time:
            slopes.append(np.where(is_read, 0.0, np.nan))
            continue
        value = moving.values[p.name]
        # So short that one side will do, and far above the solver's residual.
        step = 1e-3 * max(p.typical, 0.1 * abs(value - p.neutral))
        slope = np.full(is_read.shape, np.nan)
        for moved in (value + step, value - step):
            is_lost = np.isnan(slope) & is_read & ~np.isnan(predicted)
            if not is_lost.any():
                break
            at_step = replace(moving, values={**moving.values, p.name: moved})
            settings_there = tuple(at_step if s is moving else s for s in settings)
            change = problem.in_noise(settings_there) - predicted
            if problem.predict.row_unknowns:
                size = np.nan_to_num(np.abs(change)).max(axis=1)
                change[size > _JUMP * max(1.0, float(np.median(size)))] = np.nan
            slope = np.where(is_lost, -change / (moved - value), slope)
        slopes.append(np.where(is_read, np.nan_to_num(slope), np.nan))
    return np.stack(slopes, axis=-1)


class StartingPoint(NamedTuple):
    """An effect where a fit may start: its values, the residual (n,) there, and slopes (n, p)."""

    setting: Setting
    residual: FloatArray
    slopes: FloatArray

    def moved(self, step: FloatArray) -> Setting:
        """Return the values after a step (p,), within bounds."""
        values = {
            p.name: float(np.clip(self.setting.values[p.name] + change, *p.bounds))
            for p, change in zip(self.setting.effect.parameters, step, strict=True)
        }
        return Setting(self.setting.effect, values)


class LinearTrial(NamedTuple):
    """The robust loss after one linear step, without one more effect in the model and with it.

    With it from the best of its starts, of which there are views.
    """

    without: float
    loss: float
    views: tuple[StartingPoint, ...] = ()

    @property
    def gain(self) -> float:
        """What the effect takes off the loss."""
        return self.without - self.loss


def linear_trial(
    problem: Problem, effects: Sequence[Effect], rows: BoolArray, present: Fit, effect: Effect
) -> LinearTrial:
    """Return what one linear step leaves of the robust loss, with one more effect in the model.

    The step is from the present values of the others, and for the effect from where it does
    nothing, as a score test has it (Rao, Proc. Cambridge Philos. Soc. 44, 1948), or from where a
    fit would start: the best of these.

    ``effects`` are all of the model with the added one, in the order in which they act, and
    ``present`` is the model without it.
    """
    is_used = problem.used(rows)
    problem.predict.trust_as(present.settings, effects, problem.noise)
    present_effects = [s.effect for s in present.settings]
    known_slopes = np.empty((int(is_used.sum()), 0))
    if present_effects:
        known_slopes = jacobian(problem, present_effects, present.vector, nearly=True)[is_used]
    losses, views = [], []
    start = _starts(problem, effects, present.settings, [effect])
    start = start or [starting_vector(effects, present.settings, {})]
    for vector in (starting_vector(effects, present.settings, effect.neutral), *start):
        settings = settings_at(effects, vector)
        (added,) = (s for s in settings if s.effect.key == effect.key)
        slopes = _slopes(problem, settings, added)[is_used]
        residual = problem.misfit(settings)[is_used]
        losses.append(_linear_step(residual, np.hstack([known_slopes, slopes]))[0])
        views.append(StartingPoint(added, residual, slopes))
    residual = problem.misfit(present.settings)[is_used]
    return LinearTrial(_linear_step(residual, known_slopes)[0], min(losses), tuple(views))


def _linear_step(residual: FloatArray, slopes: FloatArray) -> tuple[float, FloatArray]:
    """Return the least robust loss of a residual (n,) linear in parameters (n, p), and the step."""
    scale = np.maximum(np.linalg.norm(slopes, axis=0), 1e-300)
    unit, rest = slopes / scale, residual
    step = np.zeros(len(scale))
    for _ in range(20):  # weights anew: they settle where few readings stand off
        weight = np.minimum(1.0, HUBER / np.maximum(np.abs(rest), HUBER))
        weighted = unit * weight[:, None]
        square = weighted.T @ unit
        # Not zero, even where no parameter does anything.
        ridge = 1e-10 * (np.trace(square) + 1e-100) * np.eye(len(scale))
        step = -np.linalg.solve(square + ridge, weighted.T @ residual)
        rest = residual + unit @ step
    return float(huber(rest).sum()), step / scale


def _fit_from(
    problem: Problem,
    effects: Sequence[Effect],
    mask: BoolArray,
    start: FloatArray,
    iterations: int,
    *,
    thorough: bool,
) -> Fit:
    from scipy.optimize import least_squares

    # Relative: the final model is reported, a trial is only compared with others.
    tolerance = 1e-8 if thorough else 1e-5
    parameters = [p for effect in effects for p in effect.parameters]
    low, high = np.array([p.bounds for p in parameters]).T
    inside = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
    cached: tuple[FloatArray, FloatArray, FloatArray] | None = None

    def misfit(vector: FloatArray) -> FloatArray:
        return problem.misfit(settings_at(effects, vector))[mask]

    def slopes_at(vector: FloatArray) -> FloatArray:
        """Return slopes; those taken before, as long as the misfit follows them."""
        nonlocal cached
        residual = misfit(vector)
        if cached is not None and not thorough:
            place, before, slopes = cached
            linear_change = slopes @ (vector - place)
            if np.linalg.norm(residual - before - linear_change) < _LINEARITY_RTOL * np.linalg.norm(
                linear_change
            ):
                return slopes
        slopes = jacobian(problem, effects, vector, nearly=not thorough)[mask]
        cached = vector.copy(), residual, slopes
        return slopes

    for _ in range(5):  # until distrust of readings and times of steps agree with what is left
        answer = least_squares(
            misfit,
            inside,
            jac=slopes_at,
            bounds=(low, high),
            x_scale=[p.typical for p in parameters],
            loss="huber",
            f_scale=HUBER,
            xtol=tolerance,
            ftol=tolerance,
            max_nfev=iterations,
        )
        settings = settings_at(effects, answer.x)
        inside = answer.x.copy()
        for k, best in _step_times(problem, settings, mask).items():
            inside[k] = best.time_s
        is_judged_anew = problem.predict.trust_anew(settings, problem.noise)
        if not is_judged_anew and np.array_equal(inside, answer.x):
            break
    loss, count = 2.0 * float(answer.cost), problem.free_readings(mask)
    variance = max(1.0, loss / max(count - len(start), 1))
    # Slopes are scaled by Huber's weights, so that outliers add no certainty.
    slopes = np.zeros((*mask.shape, len(start)))
    slopes[mask] = answer.jac
    residual = np.full(mask.shape, np.nan)
    limit = HUBER * np.sqrt(variance)
    residual[mask] = np.clip(answer.fun, -limit, limit)
    if thorough:  # at the edge of what cables hold, a reading is not as sure as the sensor is
        doubt = steepness(problem, settings)
        slopes, residual = slopes / doubt[..., None], residual / doubt
    std, inflation, wald, covariance = _doubts(settings, slopes, residual, variance)
    for k, best in _step_times(problem, settings, mask, variance).items():
        std[k], covariance[k] = best.std_s, 0.0
        covariance[:, k] = 0.0
        covariance[k, k] = best.std_s**2
    return Fit(settings, answer.x, std, loss, count, inflation, wald, covariance)


class StepTime(NamedTuple):
    """A time [s] and its standard deviation [s]."""

    time_s: float
    std_s: float


def step_time(
    time_s: FloatArray, before: FloatArray, after: FloatArray, variance: float
) -> StepTime | None:
    r"""Return the time at which a step leaves least loss; None where too few rows show it.

    With a step between two rows the loss is Σ before up to the one and Σ after from the other; the
    time is midway. Within a gap between rows every time is as probable, and one gap against another
    as exp(-loss / 2 variance) times its width (Hinkley, Biometrika 57 (1970) 1), from which the
    deviation follows.

    Losses are of each row (n_rows,) without the effect and with it; rows in which these are equal
    tell nothing.
    """
    rows = np.flatnonzero(before != after)
    if len(rows) < 2 * LEAST_ROWS:
        return None
    rows = rows[np.argsort(time_s[rows], kind="stable")]
    last = np.arange(LEAST_ROWS - 1, len(rows) - LEAST_ROWS)  # before the step
    starts, ends = time_s[rows[last]], time_s[rows[last + 1]]
    width, middle = ends - starts, 0.5 * (starts + ends)
    if not width.any():
        return None
    loss = np.where(width > 0.0, np.cumsum((before - after)[rows])[last], np.inf)
    best = int(np.argmin(loss))
    weight = width * np.exp(-0.5 * (loss - loss[best]) / variance)
    square = weight @ ((middle - middle[best]) ** 2 + width**2 / 12.0) / weight.sum()
    return StepTime(float(middle[best]), float(np.sqrt(square)))


def _step_times(
    problem: Problem, settings: Sequence[Setting], mask: BoolArray, variance: float = 1.0
) -> dict[int, StepTime]:
    """Return where in the vector each time of a step stands, and its best value in these rows."""
    answer = {}
    for setting, columns in with_places(settings):
        for k, p in enumerate(setting.effect.parameters, start=columns.start):
            if not p.is_step_time:
                continue
            losses = []
            for value in p.bounds:  # with the step in all rows, then in none
                at_bound = replace(setting, values={**setting.values, p.name: value})
                misfit = problem.misfit(tuple(at_bound if s is setting else s for s in settings))
                losses.append(huber(np.where(mask, misfit, np.nan)).sum(axis=1))
            assert problem.measured.time_s is not None
            best = step_time(problem.measured.time_s, losses[1], losses[0], variance)
            if best is not None:
                answer[k] = best
    return answer


def _doubts(
    settings: Sequence[Setting], slopes: FloatArray, residual: FloatArray, variance: float
) -> tuple[FloatArray, dict[str, float], dict[str, float], FloatArray]:
    """Return deviations, inflation and Wald statistic of each effect, and covariance; see `Fit`."""
    scale = np.sqrt(np.sum(slopes**2, axis=(0, 1)))
    is_unseen = scale == 0.0
    scale[is_unseen] = 1.0
    unit = slopes / scale
    bread = np.linalg.pinv(np.einsum("rcp,rcq->pq", unit, unit), rcond=1e-12)
    plain = variance * bread
    clustered = [bread @ covariance @ bread for covariance in score_covariances(unit, residual)]
    spread = np.max([np.diag(covariance) for covariance in (plain, *clustered)], axis=0)
    inflation, wald = {}, {}
    for setting, columns in with_places(settings):
        acting = np.arange(len(scale))[columns][setting.effect.strength]
        change = np.array([setting.values[p.name] - p.neutral for p in setting.effect.parameters])
        away = change[setting.effect.strength] * scale[acting]
        block = np.ix_(acting, acting)
        wald[setting.effect.key] = min(
            float(away @ np.linalg.pinv(covariance[block], rcond=1e-9, hermitian=True) @ away)
            for covariance in (plain, *clustered)
        )
        inverse = np.linalg.pinv(plain[columns, columns], rcond=1e-9, hermitian=True)
        # A time of a step has no slope: no ratio either, and no share in the mean.
        seen = max(int(np.sum(~is_unseen[columns])), 1)
        ratios = [np.sum(inverse * covariance[columns, columns]) / seen for covariance in clustered]
        inflation[setting.effect.key] = float(max(1.0, *ratios))
    std = np.where(is_unseen, np.inf, np.sqrt(np.maximum(spread, 0.0)) / scale)
    deviation = np.sqrt(np.maximum(np.diag(bread), 1e-300))
    with np.errstate(invalid="ignore"):  # what has no slope has no covariance
        covariance = bread / np.outer(deviation, deviation) * np.outer(std, std)
    return std, inflation, wald, covariance


_STEEP = 5.0
"""Change of a length over that of the pose from which on a row is at the edge: a taut cable's is at
most 1, and over pulleys and with sag hardly more."""
_POSE_STEP = 1e-7
"""Over the frame's size: far above the solver's residual, and short against the way to the edge."""


def steepness(problem: Problem, settings: Sequence[Setting]) -> FloatArray:
    """Return by how much more than noise each reading is in doubt (n_rows, n_readings).

    That is √(1 + |∂r/∂pose|²) with the pose in units of a length's noise; 1 in rows that are not at
    the edge, and of robots whose internal forces or poses are taken from the readings themselves.
    """
    predict, measured = problem.predict, problem.measured
    robot, n_cables = predict.machine.robot, measured.length_m.shape[1]
    slopes = np.zeros((*measured.readings.shape, robot.degrees_of_freedom))
    if predict.row_unknowns:
        return np.ones(problem.measured.is_read.shape)
    predicted = problem.predicted(settings).stacked
    step_m = _POSE_STEP * frame_size_m(predict.machine)
    for k in range(robot.degrees_of_freedom):
        steps = np.zeros((measured.n_rows, robot.degrees_of_freedom))
        for side in (step_m, -step_m):  # the larger: the model may hold a row on one side only
            steps[:, k] = side
            at_step = replace(measured, poses=moved_poses(robot, measured.poses, steps))
            change = predict.at(at_step)(settings, problem.noise).stacked - predicted
            slope = np.nan_to_num(change / side)
            slopes[..., k] = np.where(np.abs(slope) > np.abs(slopes[..., k]), slope, slopes[..., k])
    steepest = np.max(np.abs(slopes[:, :n_cables]), axis=(1, 2))
    in_noise = np.linalg.norm(slopes, axis=-1) * problem.noise.length_m / problem.sigma
    return np.where(steepest[:, None] > _STEEP, np.sqrt(1.0 + in_noise**2), 1.0)
