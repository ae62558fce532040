"""The closed loop: measured data, residual, missing effect, better model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.blocks import heldout_rows
from designer.diagnosis.correction import smooth_correction
from designer.diagnosis.errors_of import outliers_of, stage, without_outliers
from designer.diagnosis.fit import Fit, fit
from designer.diagnosis.foretell import foretell, with_sound_lengths
from designer.diagnosis.hold import Outcome, search_and_hold, structure_left
from designer.diagnosis.noise import noise_of, rescaled, rough_noise
from designer.diagnosis.pace import Pace
from designer.diagnosis.physical import imbalance_of
from designer.diagnosis.predict import Predictor
from designer.diagnosis.problem import Problem
from designer.diagnosis.propose import propose
from designer.diagnosis.result import Diagnosis, Estimate, Finding, Proposal, Stage
from designer.diagnosis.structure import Structure, covariates_of
from designer.diagnosis.unseen import Gain, keep_what_helps
from designer.diagnosis.whereabouts import Whereabouts, whereabouts
from designer.effects.effect import Effect, Setting
from designer.errors import Fault, InputError
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.study import Measurements, Study

_NOISE_ROUNDS = 2
_NOISE_CHANGE = 0.15
_UNKNOWN = 10.0
"""How many times as far as a finding that which is declared unknown may be from the drawing."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """What a diagnosis starts from.

    Parameters
    ----------
    study, measurements, machine, measured
        The study, its measurements, the machine as drawn, the data.
    candidates : tuple of Effect
        Effects that the data can show, in the order in which they act.
    given : tuple of Effect
        What is unknown from the start.
    skipped : tuple of (effect, reason)
        Effects that the data cannot show.
    fixed : tuple of Setting
        Declared effects that act on these data, less those that are unknown.
    idle : tuple of (effect, reason)
        Declared effects for which these data lack something.
    """

    study: Study
    measurements: Measurements
    machine: Machine
    measured: Measured
    candidates: tuple[Effect, ...]
    given: tuple[Effect, ...]
    skipped: tuple[tuple[str, str], ...]
    fixed: tuple[Setting, ...] = ()
    idle: tuple[tuple[str, str], ...] = ()


def diagnose(case: Case, progress: Callable[[str], None] = lambda _: None) -> Diagnosis:
    """Find what the model lacks, and say how sure that is.

    Raises
    ------
    InputError
        If there are fewer readings than the unknowns ask for, or the robot as declared cannot
        hold most of the poses.
    """
    from threadpoolctl import threadpool_limits

    # Systems of this size are solved in less time than it takes to wake threads: a hundred times
    # less where other programs keep the processors busy.
    with threadpool_limits(1, user_api="blas"):
        return _diagnose(case, Pace(progress, case.measurements.search_time_s))


def _diagnose(case: Case, progress: Pace) -> Diagnosis:
    measured = case.measured
    heldout = heldout_rows(measured.n_rows)
    _check_size(case, heldout)
    predict = Predictor(case.machine, measured, case.fixed, case.study.known_effects)
    check_held(case, predict)
    # Whatever is decided on the way is decided without them: noise, effects, what is withdrawn.
    seen = replace(case, measured=measured.without_readings(heldout))
    outcome = _with_settled_noise(seen, ~heldout, progress)
    problem = Problem(measured, predict, outcome.problem.noise)
    outcome, gains = keep_what_helps(outcome, problem, heldout, progress)
    # What is told of the model shall not depend on the path that the search took to it.
    problem = replace(problem, predict=predict.at(measured))
    search = outcome.search
    base = fit(outcome.problem, case.given, ~heldout) if search.found else search.fit
    before, after = problem.residual(base.settings), problem.residual(search.fit.settings)
    predicted = problem.predicted(search.fit.settings)
    compared = heldout & with_sound_lengths(problem, search.fit.settings)
    covariates = covariates_of(measured, problem.surroundings(search.fit.settings))
    findings = tuple(_finding(outcome, e, gains[e.key]) for e in search.found)
    return Diagnosis(
        study=case.study,
        machine=case.machine,
        measured=measured,
        noise=problem.noise,
        heldout=heldout,
        findings=findings,
        given=tuple(s for s in search.fit.settings if s.effect in case.given),
        withdrawn=outcome.withdrawn,
        skipped=case.skipped,
        steps=search.steps,
        stages=_stages(outcome, problem, base, heldout),
        structure_before=structure_left(problem, base.settings, np.ones_like(heldout)),
        structure_after=outcome.structure,
        residual_before=before,
        residual_after=after,
        predicted=predicted,
        covariates=covariates,
        outliers=outliers_of(after, measured.row_numbers),
        left_in=_left_in(after, outcome.structure, covariates, measured),
        correction=smooth_correction(after, outcome.structure, covariates, heldout),
        proposals=_proposals(case, outcome, findings),
        doubts=tuple(_doubts(case, search.fit)),
        foretold_before=foretell(problem, base.settings, compared),
        foretold_after=foretell(problem, search.fit.settings, compared),
        not_tried=progress.left_out,
        imbalance=imbalance_of(problem.predict.built(search.fit.settings), measured),
    )


def _with_settled_noise(case: Case, rows: BoolArray, progress: Pace) -> Outcome:
    """Search; where noise is estimated, search again with what the better model leaves of it."""
    measured = case.measured
    predict = Predictor(case.machine, measured, case.fixed, case.study.known_effects)
    rough = Problem(measured, predict, rough_noise(measured))
    left = rough.residual(_given_fit(rough, case, rows)) * rough.sigma
    noise = noise_of(case.measurements, measured, left)
    outcome: Outcome | None = None
    for _ in range(_NOISE_ROUNDS):
        problem = Problem(measured, predict, noise)
        found = search_and_hold(problem, case.candidates, case.given, rows, progress)
        # A search that came to its end is better than a later one that did not.
        outcome = outcome if outcome and progress.is_over else found
        # The fast part of a motion's residual is the sensors' own; that of poses at rest still
        # holds what neighbours do not share, and is taken again from the better model.
        if noise.source == "declared" or not measured.settled:
            break
        better = rescaled(noise, case.measurements, problem.residual(outcome.search.fit.settings))
        change = max(
            abs(better.length_m / noise.length_m - 1), abs(better.tension_N / noise.tension_N - 1)
        )
        noise = better
        if change < _NOISE_CHANGE:
            break
        if progress.is_over:
            progress.leave_out("the search again, with the noise that the found effects leave")
            break
    assert outcome is not None
    return outcome


def _given_fit(rough: Problem, case: Case, rows: BoolArray) -> tuple[Setting, ...]:
    return fit(rough, case.given, rows).settings if case.given else ()


def _finding(outcome: Outcome, effect: Effect, gain: Gain) -> Finding:
    search, searcher = outcome.search, outcome.searcher
    rivals = searcher.rivals(search.found, effect, search.fit, search.steps)
    parameters = _estimates(search.fit)[effect.key]
    return Finding(
        effect=effect,
        parameters=parameters,
        rivals=tuple(dict.fromkeys(r.key for r in rivals)),
        heldout_gain=gain.share,
        heldout_gain_std=gain.std,
        warnings=tuple(_warnings(effect, parameters)),
    )


def _left_in(
    residual: FloatArray,
    structure: Structure,
    covariates: Mapping[str, FloatArray],
    measured: Measured,
) -> Whereabouts | None:
    if not structure.present:
        return None
    return whereabouts(residual, covariates[structure.present[0].name], measured.row_numbers)


def _warnings(effect: Effect, parameters: Mapping[str, Estimate]) -> Iterator[str]:
    near = all(
        abs(parameters[p.name].value - p.neutral) < 2 * parameters[p.name].std
        for p in effect.parameters
    )
    if near:
        yield "no value of it is further from doing nothing than twice its standard deviation"


def _doubts(case: Case, model: Fit) -> Iterator[str]:
    """Yield values of what was unknown that nobody would believe, even of what is unknown."""
    estimates = _estimates(model)
    for effect in case.given:
        for p in effect.parameters:
            low, high = (p.neutral + _UNKNOWN * (end - p.neutral) for end in p.plausible)
            found = estimates[effect.key][p.name]
            if not low - 2 * found.std <= found.value <= high + 2 * found.std:
                yield (
                    f"{effect.key}: {p.name} = {found.value:.4g} {p.unit} is not plausible "
                    f"({low:.4g} to {high:.4g} would be)"
                )


def _estimates(model: Fit) -> dict[str, dict[str, Estimate]]:
    answer: dict[str, dict[str, Estimate]] = {}
    at = 0
    for setting in model.settings:
        answer[setting.effect.key] = {}
        for name, value in setting.values.items():
            answer[setting.effect.key][name] = Estimate(value, float(model.std[at]))
            at += 1
    return answer


def _stages(outcome: Outcome, problem: Problem, base: Fit, heldout: BoolArray) -> tuple[Stage, ...]:
    """Errors as declared, then with the found effects one after the other."""
    label = "as declared, unknowns fitted" if base.settings else "as declared"
    sound = ~np.isnan(without_outliers(problem.residual(outcome.search.fit.settings)))
    stages = [stage(problem, label, base.settings, heldout, sound)]
    added: list[Effect] = []
    near = base
    for effect in outcome.search.found:
        added.append(effect)
        last = len(added) == len(outcome.search.found)
        near = outcome.search.fit if last else outcome.searcher.fit(added, near)
        stages.append(stage(problem, f"+ {effect.key}", near.settings, heldout, sound))
    return tuple(stages)


def _proposals(case: Case, outcome: Outcome, findings: Sequence[Finding]) -> tuple[Proposal, ...]:
    region = case.study.workspace.region if case.study.workspace else None
    by_key = {effect.key: effect for effect in case.candidates}
    answer = []
    for finding in findings:
        rest = [e for e in outcome.search.found if e.key != finding.effect.key]
        for rival in finding.rivals[:2]:
            swapped = outcome.searcher.fit([*rest, by_key[rival]], outcome.search.fit)
            names = (finding.effect.key, rival)
            answer.append(
                propose(
                    outcome.problem.predict,
                    case.measured,
                    outcome.problem.noise,
                    region,
                    outcome.search.fit.settings,
                    swapped.settings,
                    names,
                )
            )
    return tuple(answer)


def _check_size(case: Case, heldout: BoolArray) -> None:
    measured = case.measured
    readings = np.hstack([measured.length_m, measured.tension_N])[~heldout]
    known = int(np.sum(~np.isnan(readings)))
    unknown = sum(len(effect.parameters) for effect in case.given)
    if known <= unknown + 2:
        raise InputError(
            [
                Fault(
                    str(case.measurements.file),
                    None,
                    "",
                    f"{known} readings to fit, after holding some out, for {unknown} unknowns",
                    f"at least {unknown + 3}",
                )
            ]
        )


def check_held(case: Case, predict: Predictor) -> None:
    """Refuse poses most of which no cables can hold: frames, units or exit points are mixed up."""
    held = ~np.isnan(predict(()).length_m).any(axis=1)
    if 2 * held.sum() < held.size:
        problem = f"the robot as declared can hold {held.sum()} of {held.size} poses"
        expected = "poses between its exit points, in the same frame and unit"
        raise InputError([Fault(str(case.measurements.file), None, "", problem, expected)])
