"""From a study with measurements to a case for the diagnosis, and the noise of its sensors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import fit
from designer.diagnosis.free_poses import FreePredictor, first_poses, with_frame_held
from designer.diagnosis.problem import Predictor, Problem, SessionsPredictor
from designer.diagnosis.statistics import heldout_rows, spread
from designer.effects.effect import NEEDS, Effect, Setting, as_built, frame_size_m
from designer.effects.platform_loads import LEAST_ROWS
from designer.errors import InputError
from designer.measured.sense import left_handed
from designer.model.measurements import KINDS, Measured, Measurements, Noise
from designer.model.robot import Machine
from designer.statics.geometry import cable_geometry
from designer.study import Study, declared_settings


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """What a diagnosis starts from."""

    study: Study  #: the study, its measurements, the machine as drawn, the data
    measurements: Measurements
    machine: Machine
    measured: Measured
    #: effects that the data can show, in the order in which they act
    candidates: tuple[Effect, ...]
    given: tuple[Effect, ...]  #: what is unknown from the start
    skipped: tuple[tuple[str, str], ...]  #: effects that the data cannot show
    #: declared effects that act on these data, less those that are unknown
    fixed: tuple[Setting, ...] = ()
    idle: tuple[tuple[str, str], ...] = ()  #: declared effects for which these data lack something

    def predictor(self) -> Predictor:
        """Return the model as declared, for these rows."""
        kind = Predictor if self.measured.has_poses else FreePredictor
        if self.measured.session is not None:
            kind = SessionsPredictor
        return kind(self.machine, self.measured, self.fixed, self.study.known_effects)

    def fault(self, problem: str, expected: str) -> InputError:
        """Return what is wrong with the data as a whole."""
        return InputError.at(self.measurements.file, problem, expected)

    def check_held(self, predict: Predictor) -> None:
        """Refuse poses most of which no cables hold: frames, units or exit points are mixed up."""

        def n_held(measured: Measured) -> int:
            return int((~np.isnan(predict.at(measured)(()).length_m).any(axis=1)).sum())

        n_rows, n_rows_held = self.measured.n_rows, n_held(self.measured)
        if 2 * n_rows_held < n_rows:
            problem = f"the robot as declared can hold {n_rows_held} of {n_rows} poses"
            expected = "poses between its exit points, in the same frame and unit"
            views = left_handed(self.machine.robot, self.measured)
            n_held_mirrored, frame = max((n_held(view), frame) for frame, view in views)
            if 2 * n_held_mirrored > n_rows + n_rows_held:
                expected += f"; with {frame}, it can hold {n_held_mirrored}"
            raise self.fault(problem, expected)


def case_of(study: Study, measurements: Measurements, measured: Measured) -> Case:
    """Return what the diagnosis starts from.

    An effect that is declared and unknown is fitted like any unknown.
    """
    measurements = _less_estimated_noise(measurements, measured)
    # The diagnosis asks no strength of the cable, and only laws of plugins ask its diameter.
    rope = measurements.cable()
    density = study.material.density_kg_per_m3
    if measurements.diameter_m is not None:
        density = rope.linear_density_kg_per_m / (0.25 * math.pi * measurements.diameter_m**2)
    machine = Machine(
        study.robot.at_rest,
        rope,
        surroundings=study.surroundings,
        rope_density_kg_per_m3=float(density),
    )
    declared = declared_settings(study, machine)
    built = as_built(machine, declared)
    if not measured.has_poses and np.isnan(measured.poses.position_m).any():
        assert study.workspace is not None  # the config has been checked
        measured = replace(measured, poses=first_poses(built, measured, study.workspace.region))
    settings = [*declared, *_session_settings(study, measurements, machine)]
    fixed = [s for s in settings if not is_unknown(s.effect, measurements)]
    fixed_effects = {setting.effect.key: setting.effect for setting in fixed}
    possible = with_those_of_sessions(study.known_effects.of(built), measurements)
    effects = [e for e in possible if e.key not in fixed_effects]
    recorded = _recorded(study, measured)
    if built.robot.pulley_radius_m or "pulley_radius" in measurements.all_unknown:
        recorded |= {"pulleys"}
    ongoing = [e for e in (*effects, *fixed_effects.values()) if persists(e)]
    stopped = {e.key: PERSISTS for e in ongoing if measurements.sessions}
    skipped = {
        e.key: stopped.get(e.key) or _missing(e, recorded) or _too_few(e, measured) for e in effects
    }
    visible = [e for e in effects if not skipped[e.key]]
    # A winch's scale is without its zero where the zeros of all are declared.
    has_zeros = any(setting.effect.id == "length_offset" for setting in fixed)
    unknown = [
        e.beside({"length_offset"}) if has_zeros and e.id == "winch_scale" else e
        for e in visible
        if is_unknown(e, measurements)
    ]
    n_sessions = len(measurements.sessions)
    unknown_alone = [less_given(e, unknown, n_sessions) for e in unknown]
    given = tuple(_as_unknown(e, measurements, machine) for e in unknown_alone if e.parameters)
    if not measured.has_poses:
        given, note = with_frame_held(given, machine.robot, measured)
        measured = replace(measured, notes=(*measured.notes, *note))
    given_keys = {e.key for e in given}
    candidates = [e for e in visible if e.key not in given_keys]
    unshared = [less_given(e, given, n_sessions) for e in candidates]
    skipped |= {e.key: "is a part of what is unknown" for e in unshared if not e.parameters}
    # On the machine a declared effect acts unseen; only wind has to be told.
    lacking = {
        e.key: stopped.get(e.key)
        or (_missing(e, recorded) if e.on_machine is None or "wind" in e.needs else "")
        for e in fixed_effects.values()
    }
    return Case(
        study,
        measurements,
        machine,
        measured,
        candidates=tuple(e for e in unshared if e.parameters),
        given=given,
        skipped=tuple((key, why) for key, why in skipped.items() if why),
        fixed=tuple(s for s in fixed if not lacking[s.effect.key]),
        idle=tuple((key, why) for key, why in lacking.items() if why),
    )


def _less_estimated_noise(measurements: Measurements, measured: Measured) -> Measurements:
    """Return them without a noise that a diagnosis estimated before: nobody declared it."""
    estimated = measurements.estimated_noise
    if not (estimated and measured.has_poses):
        return measurements
    return replace(
        measurements,
        length_noise_m=None if "length" in estimated else measurements.length_noise_m,
        tension_noise_N=None if "tension" in estimated else measurements.tension_noise_N,
    )


def _session_settings(study: Study, measurements: Measurements, machine: Machine) -> list[Setting]:
    """Return the effects that are declared of single sessions."""
    return [
        replace(setting, effect=setting.effect.of_session(k))
        for k in range(1, len(measurements.sessions) + 1)
        for setting in declared_settings(
            replace(study, effects=study.effects_of_session(k)), machine
        )
    ]


_FAR_M = 1e6
"""Rows of different sessions are no neighbours."""
_UNKNOWN_FACTOR = 10.0
"""How many times as far as a finding that which is unknown may be from the drawing."""
_OF_FRAME, _MORE_M, _AT_MOST_M = 0.1, 0.1, 3.0
"""How far a point of the frame, or a length, may be off that somebody has paced out, or taped round
corners: a tenth of the frame and 0.1 m, at most 3 m."""


def _as_unknown(effect: Effect, measurements: Measurements, machine: Machine) -> Effect:
    """Return an effect with what is plausible of it where it is unknown from the start."""
    limit_m = next((m for name, m in measurements.plausible_m if effect.is_among([name])), None)
    times = _UNKNOWN_FACTOR
    if effect.id == "attachment_offset":
        times = 1.0
    elif effect.id in ("anchor_offset", "length_offset") and limit_m is None:
        limit_m = min(_OF_FRAME * frame_size_m(machine) + _MORE_M, _AT_MOST_M)
    parameters = []
    for p in effect.parameters:
        ends = (p.neutral, *(p.neutral + times * (end - p.neutral) for end in p.plausible))
        low, high = (min(ends), max(ends)) if limit_m is None else (-limit_m, limit_m)
        parameters.append(replace(p, size=replace(p.size_here, plausible=(low, high))))
    return replace(effect, parameters=tuple(parameters))


def _missing(effect: Effect, recorded: frozenset[str]) -> str:
    """Return what the data lack for an effect to show; empty where it shows."""
    missing = sorted(effect.needs - recorded)
    return f"needs {NEEDS[missing[0]]}" if missing else ""


def _too_few(effect: Effect, measured: Measured) -> str:
    """Return that an effect finds nowhere to start in the rows that a fit may see, if so."""
    if effect.starts_from is None:
        return ""
    seen = measured.without_readings(heldout_rows(measured.n_rows, measured.session))
    starts = effect.starts_from(measured, seen.readings)
    return "" if starts else "needs more rows, or lengths that change more"


def _recorded(study: Study, measured: Measured) -> frozenset[str]:
    chord_m = cable_geometry(study.robot, measured.poses).chord_m
    signs = np.sign(np.diff(chord_m, axis=0))
    n_reversals = np.sum(signs[1:] * signs[:-1] < 0.0, axis=0)
    recorded = {
        "motion": not measured.settled,
        "rotation": not study.robot.is_point_mass,
        "pose": measured.has_poses,
        "length": not np.isnan(measured.length_m).all(),
        "tension": not np.isnan(measured.tension_N).all(),
        "reversals": bool((n_reversals >= LEAST_ROWS).any()),
    }
    return measured.columns | {name for name, is_there in recorded.items() if is_there}


def first_noise(
    measurements: Measurements,
    measured: Measured,
    predict: Predictor,
    rows: BoolArray,
    effects: Sequence[Effect] = (),
) -> Noise:
    """Return the noise as declared, else as the fast part of the first residual shows it.

    Samples of a motion: second differences of the residual, from which anything slow drops out.
    Poses at rest: differences between neighbours in space, which share what depends on the pose.

    Of ``rows`` (n_rows,), which a fit may see, after ``effects`` that are unknown from the start
    are fitted.
    """
    declared = measurements.declared_noise
    read = {kind.name for kind in KINDS if np.isfinite(kind.of(measured)).any()}
    if read <= declared.keys():
        return Noise(declared.get("length", 1.0), declared.get("tension", 1.0), "declared")
    length, tension = (
        float(np.nanmedian(np.abs(kind))) if np.isfinite(kind).any() else 1.0
        for kind in (measured.length_m, measured.tension_N)
    )
    # By how much a model may be off at first: mostly their ratio counts, and tensions are foretold
    # worse than lengths.
    rough = Problem(measured, predict, Noise(0.01 * length, 0.1 * tension, "rough"))
    settings = fit(rough, effects, rows).settings if effects else ()
    lengths, tensions = np.hsplit(rough.residual(settings) * rough.sigma, 2)
    kinds = {"length": lengths, "tension": tensions}
    unknown = {name: kind for name, kind in kinds.items() if name not in declared}
    sizes = declared | {name: _fast_part(kind, measured) for name, kind in unknown.items()}
    missing = [name for name, kind in unknown.items() if not np.isnan(kind).all()]
    how = "neighbouring poses" if measured.settled else "second differences in time"
    source = f"{' and '.join(missing)} estimated from {how} of the residual"
    return Noise(sizes["length"], sizes["tension"], source if missing else "declared")


def rescaled(noise: Noise, measurements: Measurements, residual: FloatArray) -> Noise:
    """Return estimated noise corrected by the residual that a better model leaves.

    The residual (n_rows, 2 n_cables) is in units of ``noise``.
    """
    length, tension = (_robust_std(kind) for kind in np.hsplit(residual, 2))
    return Noise(
        noise.length_m if measurements.length_noise_m is not None else noise.length_m * length,
        noise.tension_N if measurements.tension_noise_N is not None else noise.tension_N * tension,
        noise.source,
    )


def _fast_part(kind: FloatArray, measured: Measured) -> float:
    from scipy.spatial import cKDTree

    if not measured.settled:
        return _robust_std(np.diff(kind, n=2, axis=0)) / math.sqrt(6.0)  # 1² + 2² + 1² variances
    seen = ~np.isnan(kind).all(axis=1)
    if seen.sum() < 2:
        return 1.0
    position, kind = measured.poses.position_m[seen], kind[seen]
    if measured.session is not None:  # each has zeros of its own
        apart = _FAR_M * measured.session[seen, None]
        position = np.hstack([position, apart])
    _, nearest = cKDTree(position).query(position, k=2)
    return _robust_std(kind - kind[nearest[:, 1]]) / math.sqrt(2.0)  # of two readings


def _robust_std(values: FloatArray) -> float:
    """Standard deviation of the bulk; 1 where there are no values."""
    return 1.0 if np.isnan(values).all() else max(spread(values), 1e-12)


# What differs between sessions of one machine that was measured several times.


def may_be_of_session(effect: Effect) -> bool:
    """Tell whether an effect may have come about between two sessions, and is looked for in one."""
    return effect.cause == "setting_up" or effect.between_sessions


PERSISTS = "goes on from session to session, and their clocks do not tell how far"
"""Why an effect is not looked for."""


def persists(effect: Effect) -> bool:
    """Tell whether an effect, such as creep, counts the time since it began."""
    return "time" in effect.needs and not effect.needs_motion


def is_unknown(effect: Effect, measurements: Measurements) -> bool:
    """Tell whether an effect is unknown from the start, of the machine or of its session."""
    if effect.session is None:
        return effect.is_among(measurements.unknown)
    of_session = measurements.sessions[effect.session - 1]
    return replace(effect, session=None).is_among(of_session.unknown)


def with_those_of_sessions(effects: Sequence[Effect], measurements: Measurements) -> list[Effect]:
    """Return effects, then those that may be, or are unknown, of one session, for each of them."""
    numbers = range(1, len(measurements.sessions) + 1)
    variants = [(effect, effect.of_session(k)) for k in numbers for effect in effects]
    return [
        *effects,
        *(e for effect, e in variants if may_be_of_session(effect) or is_unknown(e, measurements)),
    ]


def less_given(effect: Effect, given: Sequence[Effect], n_sessions: int) -> Effect:
    """Return an effect without the numbers that are unknown wherever it acts.

    That is what another effect has as unknown of the machine, of its own session, or of every
    session, and not of another cable.
    """
    same_cable = [e for e in given if e is not effect and e.cable in (None, effect.cable)]
    ids = {e.id for e in same_cable if e.session in (None, effect.session)}
    if effect.session is None and n_sessions:
        of_each = [{e.id for e in same_cable if e.session == k + 1} for k in range(n_sessions)]
        of_every = set.intersection(*of_each)
        if effect.id in of_every:
            return replace(effect, parameters=())
        ids |= of_every
    return effect.beside(ids)
