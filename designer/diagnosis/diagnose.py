"""The closed loop: measured data, residual, missing effect, better model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from designer.arrays import BoolArray
from designer.diagnosis.accuracy import (
    Stage,
    errors_of_sessions,
    forward_error,
    outliers_of,
    stage,
    with_sound_lengths,
)
from designer.diagnosis.calibration import calibration_of
from designer.diagnosis.case import Case, case_of, first_noise, rescaled
from designer.diagnosis.fit import Fit, fit, with_places
from designer.diagnosis.free_poses import FreePredictor, absorbed_by_poses
from designer.diagnosis.hold import Gain, Outcome, keep_what_helps, search_and_hold
from designer.diagnosis.plan import Proposal, propose
from designer.diagnosis.problem import Problem, imbalance_of
from designer.diagnosis.result import Diagnosis, Estimate, Finding
from designer.diagnosis.search import without
from designer.diagnosis.statistics import heldout_rows, without_outliers
from designer.diagnosis.structure import (
    covariates_of,
    is_one_smooth_error,
    smooth_correction,
    structure_left,
    whereabouts,
    with_gross_errors,
)
from designer.effects.effect import Effect
from designer.effects.platform_loads import PLATFORM_FORCE
from designer.effects.setting_up import POSE_DISTORTION
from designer.errors import EffectError
from designer.model.measurements import Measured
from designer.progress import Pace
from designer.study import Study

_ALIKE = 0.15
"""Spread of the zeros of all load cells over their mean below which they have one cause."""


def diagnose_study(
    study: Study, measured: Measured, progress: Callable[[str], None] = lambda _: None
) -> Diagnosis:
    """Diagnose; an effect of a plugin that fails at work is left out, and all is done again.

    The study has measurements; that of the answer says in ``known_effects.problems`` what was left
    out.

    Raises
    ------
    EffectError
        If the config itself asks for the effect that fails.
    InputError
        See `diagnose`.
    """
    measurements = study.measurements
    assert measurements is not None
    asked_for = {effect.id for effect in study.effects} | set(measurements.all_unknown)
    asked_for |= {effect.id for effects in study.session_effects for effect in effects}
    while True:
        try:
            return diagnose(case_of(study, measurements, measured), progress)
        except EffectError as failure:
            if failure.effect_id in asked_for:
                raise
            without = study.known_effects.without(failure.effect_id, f"{failure}: left out")
            study = replace(study, known_effects=without)


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
    heldout = heldout_rows(measured.n_rows, measured.session)
    _check_size(case, heldout)
    predict = case.predictor()
    case.check_held(predict)
    # Whatever is decided on the way is decided without them: noise, effects, what is withdrawn.
    seen = replace(case, measured=measured.without_readings(heldout))
    if not measured.has_poses:
        noise = first_noise(seen.measurements, seen.measured, seen.predictor(), ~heldout)
        unfitted = Problem(seen.measured, seen.predictor(), noise)
        hidden = dict(absorbed_by_poses(unfitted, (*seen.given, *seen.candidates), (), ~heldout))
        case, seen = _without(case, hidden), _without(seen, hidden)
    outcome = _with_settled_noise(seen, ~heldout, progress)
    problem = Problem(measured, predict, outcome.problem.noise)
    outcome, gains = keep_what_helps(outcome, problem, heldout, progress)
    # What is reported of the model shall not depend on the path that the search took to it.
    problem = replace(problem, predict=predict.at(measured))
    return _diagnosis_of(case, outcome, problem, gains, heldout, progress)


def _diagnosis_of(
    case: Case,
    outcome: Outcome,
    problem: Problem,
    gains: Mapping[str, Gain],
    heldout: BoolArray,
    progress: Pace,
) -> Diagnosis:
    """Return all that is reported of the model that a search ended with."""
    measured = case.measured
    base = fit(outcome.searcher.problem, case.given, ~heldout) if outcome.found else outcome.fit
    first, last = base.settings, outcome.fit.settings
    before, after = problem.residual(first), problem.residual(last)
    if isinstance(problem.predict, FreePredictor):
        measured = replace(measured, poses=problem.predict.poses(last, problem.noise))
    compared = heldout & with_sound_lengths(problem, last)
    covariates = covariates_of(measured, problem.surroundings(last))
    rivals = {}  # of each finding, by what they are called
    for effect in outcome.found:
        groups = outcome.searcher.rivals(outcome.found, effect, outcome.fit, outcome.steps)
        rivals[effect.key] = {" and ".join(e.key for e in group): group for group in groups}
    shared: dict[str, tuple[Effect, ...]] = {}
    is_several = len(outcome.found) > 2 and case.measured.has_poses
    if is_several and is_one_smooth_error(before, after, measured.poses.position_m, heldout):
        # A force that changes with the place, where tensions were read.
        cause = POSE_DISTORTION if np.isnan(measured.tension_N).all() else PLATFORM_FORCE
        shared = {cause.id: (cause,)}
    findings = tuple(
        _finding(outcome, e, gains[e.key], rivals[e.key] | shared) for e in outcome.found
    )
    findings = _with_one_force(findings)
    structure = with_gross_errors(
        outcome.structure, after, problem.residual(()), measured.row_numbers
    )
    trend = correction = None
    if structure.present:
        name = structure.present[0].name
        trend = whereabouts(after, covariates[name], measured.row_numbers)
        correction = smooth_correction(after, name, covariates[name], heldout)
    return Diagnosis(
        study=case.study,
        machine=case.machine,
        measured=measured,
        noise=problem.noise,
        heldout=heldout,
        findings=findings,
        given=tuple(s for s in last if s.effect in case.given),
        withdrawn=outcome.withdrawn,
        skipped=case.skipped,
        steps=outcome.steps,
        stages=_stages(outcome, problem, base, heldout),
        structure_before=structure_left(problem, first, np.ones_like(heldout)),
        structure_after=structure,
        residual_before=before,
        residual_after=after,
        predicted=problem.predicted(last),
        covariates=covariates,
        outliers=outliers_of(after, measured.row_numbers),
        left_in=trend,
        correction=correction,
        proposals=_proposals(case, outcome, rivals),
        doubts=tuple(_doubts(case, outcome.fit)),
        foretold_before=forward_error(problem, first, compared),
        foretold_after=forward_error(problem, last, compared),
        not_tried=progress.left_out,
        imbalance=imbalance_of(problem.predict, last),
        predicted_before=problem.predicted(first),
        calibration=calibration_of(outcome.searcher.problem, outcome.fit),
        sessions=errors_of_sessions(problem, first, last, heldout),
    )


def _with_settled_noise(case: Case, rows: BoolArray, progress: Pace) -> Outcome:
    """Search; where noise is estimated, search again with what the better model leaves of it."""
    measured, predict = case.measured, case.predictor()
    noise = first_noise(case.measurements, measured, predict, rows, case.given)
    outcome: Outcome | None = None
    for _ in range(2):  # the second time with the noise that the first one's model leaves
        problem = Problem(measured, predict, noise)
        latest = search_and_hold(problem, case.candidates, case.given, rows, progress)
        # A search that came to its end is better than a later one that did not.
        outcome = outcome if outcome and progress.is_over else latest
        # The fast part of a motion's residual is the sensors' own; that of poses at rest still
        # holds what neighbours do not share, and is taken again from the better model.
        if noise.source == "declared" or not measured.settled:
            break
        better = rescaled(noise, case.measurements, problem.residual(outcome.fit.settings))
        change = max(
            abs(better.length_m / noise.length_m - 1), abs(better.tension_N / noise.tension_N - 1)
        )
        noise = better
        if change < 0.15:  # not worth another search: losses go with its square
            break
        if progress.is_over:
            progress.leave_out("the search again, with the noise that the found effects leave")
            break
    assert outcome is not None
    return outcome


def _with_one_force(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Return several findings with a force as rival of all, if it is of all but the ropes' mass.

    One that changes with the place: a constant one does what most of them do, and heavier ropes
    pull the more, the farther away the platform is.
    """
    exceptions = {
        finding.effect.id for finding in findings if PLATFORM_FORCE.id not in finding.rivals
    }
    if len(findings) < 3 or exceptions != {"linear_mass"}:
        return findings
    return tuple(
        replace(f, rivals=tuple(dict.fromkeys([*f.rivals, PLATFORM_FORCE.id]))) for f in findings
    )


def _finding(
    outcome: Outcome, effect: Effect, gain: Gain, rivals: Mapping[str, tuple[Effect, ...]]
) -> Finding:
    estimate = _estimates(outcome.fit)[effect.key]
    is_near = all(
        abs(estimate[p.name].value - p.neutral) < 2 * estimate[p.name].std
        for p in effect.parameters
        if not p.is_shape
    )
    doubt = "no value of it is further from doing nothing than twice its standard deviation"
    offsets = [number.value for number in estimate.values()] if effect.id == "tension_bias" else []
    is_alike = len(offsets) > 2 and bool(np.std(offsets) < _ALIKE * abs(np.mean(offsets)))
    common = "all cells are off alike, as by a force that all cables share"
    force = [PLATFORM_FORCE.id] * (is_alike and PLATFORM_FORCE.id not in rivals)
    set_up = [
        name
        for name, together in rivals.items()
        if effect.cause == "physics" and all(e.cause == "setting_up" for e in together)
    ]
    return Finding(
        effect=effect,
        parameters=estimate,
        rivals=(*rivals, *force),
        heldout_gain=gain.share,
        heldout_gain_std=gain.std,
        warnings=(*[doubt] * is_near, *[common] * is_alike),
        rule_out=tuple(set_up),
    )


def _doubts(case: Case, model: Fit) -> Iterator[str]:
    """Yield values of what was unknown that nobody would believe, even of what is unknown."""
    estimates = _estimates(model)
    # The offset of a winch with another scale is counted from where nothing is wound off.
    rescaled_winches = {s.effect.cable for s in model.settings if s.effect.id == "winch_scale"}
    no_homing = {f"offset_{cable}_m" for cable in rescaled_winches}
    for effect in case.given:
        for p in effect.parameters:
            if effect.id == "length_offset" and p.name in no_homing:
                continue
            low, high = p.plausible
            estimate = estimates[effect.key][p.name]
            if not low - 2 * estimate.std <= estimate.value <= high + 2 * estimate.std:
                yield (
                    f"{effect.key}: {p.name} = {estimate.value:.4g} {p.unit} is not plausible "
                    f"({low:.4g} to {high:.4g} would be)"
                )


def _estimates(model: Fit) -> dict[str, dict[str, Estimate]]:
    return {
        setting.effect.key: {
            name: Estimate(value, std)
            for (name, value), std in zip(
                setting.values.items(), model.std[columns].tolist(), strict=True
            )
        }
        for setting, columns in with_places(model.settings)
    }


def _stages(outcome: Outcome, problem: Problem, base: Fit, heldout: BoolArray) -> tuple[Stage, ...]:
    """Errors as declared, then with the found effects one after the other."""
    effects, last = outcome.found, outcome.fit
    label = "as declared, unknowns fitted" if base.settings else "as declared"
    models = [(label, base)]
    for count, effect in enumerate(effects, start=1):
        is_last = count == len(effects)
        model = last if is_last else outcome.searcher.fit(effects[:count], models[-1][1])
        models.append((f"+ {effect.key}", model))
    sound = ~np.isnan(without_outliers(problem.residual(last.settings)))
    for _, model in models:
        sound &= problem.holds(model.settings)[:, None]
    return tuple(stage(problem, name, model.settings, heldout, sound) for name, model in models)


def _proposals(
    case: Case, outcome: Outcome, rivals: Mapping[str, Mapping[str, tuple[Effect, ...]]]
) -> tuple[Proposal, ...]:
    if not case.measured.has_poses:  # nor would a proposed pose be measured
        return ()
    region = case.study.workspace.region if case.study.workspace else None
    problem = replace(outcome.searcher.problem, measured=case.measured)
    answer = []
    for key, of_finding in rivals.items():
        rest = without(outcome.found, key)
        for name, together in [*of_finding.items()][:2]:  # the best
            swapped = outcome.searcher.fit([*rest, *together], outcome.fit)
            pair = (outcome.fit.settings, swapped.settings)
            answer.append(propose(problem, region, *pair, (key, name)))
    return tuple(answer)


def _without(case: Case, hidden: Mapping[str, str]) -> Case:
    candidates = tuple(effect for effect in case.candidates if effect.key not in hidden)
    return replace(case, candidates=candidates, skipped=(*case.skipped, *hidden.items()))


def _check_size(case: Case, heldout: BoolArray) -> None:
    measured = case.measured
    given_up = 0 if measured.has_poses else case.predictor().row_unknowns
    n_free = int(np.maximum(measured.n_readings[~heldout] - given_up, 0).sum())
    unknown = sum(len(effect.parameters) for effect in case.given)
    if n_free <= unknown + 2:
        problem = f"{n_free} readings to fit, after holding some out, for {unknown} unknowns"
        raise case.fault(problem, f"at least {unknown + 3}")
