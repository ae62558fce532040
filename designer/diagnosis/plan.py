"""Which poses to measure: those that tell most of what is unknown, or part two rivals.

Before there is a log, D-optimal: of the poses that the robot holds, those whose readings have the
largest determinant of JᵀJ, J being the slopes of the readings, in units of noise, in the unknowns.
Poses are added one by one, then exchanged while the determinant grows (Fedorov, Theory of Optimal
Experiments, 1972). After a diagnosis, those at which two effects that its data cannot tell apart
predict most differently.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.diagnosis.calibration import Identifiability, identifiability_of
from designer.diagnosis.case import case_of
from designer.diagnosis.fit import jacobian
from designer.diagnosis.problem import Problem
from designer.documents.plain import json_text
from designer.effects.effect import Effect, Parameter, Setting, as_built
from designer.errors import InputError
from designer.measured.rows import FEWEST_ROWS
from designer.model.cable import Cable
from designer.model.measurements import Measured, Measurements, Noise
from designer.model.region import Region
from designer.model.robot import Poses
from designer.statics.inverse import Statics, solve_sagging
from designer.study import Study, declared_settings

_CANDIDATES = 400
"""Positions to choose from: in a cube, neighbours are a seventh of its side apart."""
_DRAWS = 20
"""Random choices that the plan is compared with."""
_SWEEPS = 10
"""Over all chosen poses, to exchange them: two or three settle it."""
_FAINT = 1e-9
"""Of the mean information of a pose: what a direction has that no pose tells of."""
_SIZES = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
"""Numbers of poses, over those of the plan, for which deviations are shown."""
MOST_POSES = 200
"""A day's work; the exchange takes seconds for as many."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What to expect of a parameter."""

    effect: Effect  #: which it is
    parameter: Parameter
    std: float  #: standard deviation with the poses of the plan; inf where they settle no value
    std_random: float  #: median of the same over random choices of as many poses

    @property
    def label(self) -> str:
        """What it is called among those of all effects."""
        return f"{self.parameter.label} of {self.effect.key}"

    @property
    def is_told(self) -> bool:
        """Whether it will be known better than it is now, by what is plausible of it."""
        low, high = self.parameter.plausible
        return self.std < 0.5 * (high - low)


class DeviationCurve(NamedTuple):
    """The largest deviation of an effect's parameters, in one unit, by number of poses."""

    effect_id: str
    unit: str
    std: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Poses to measure."""

    study: Study  #: the problem; the noise of a kind that is not read is inf
    noise: Noise
    statics: Statics  #: the robot at the poses, in the order in which to visit them
    #: (n_poses, 3 or 6): position [m], and rotation vector [rad] where the platform can turn
    places: FloatArray
    n_candidates: int  #: poses that the robot holds, of which these were chosen
    expected: tuple[Expected, ...]  #: what to expect of each unknown
    condition: float  #: as in `designer.diagnosis.calibration`
    observability: float
    sizes: tuple[int, ...]  #: numbers of poses of the curves
    curves: tuple[DeviationCurve, ...]  #: deviations over the number of poses

    @property
    def untold(self) -> tuple[Expected, ...]:
        """What these poses will not tell."""
        return tuple(parameter for parameter in self.expected if not parameter.is_told)

    @property
    def is_positive(self) -> bool:
        """Whether the poses tell all that is unknown."""
        return not self.untold

    def to_json(self) -> str:
        """Return the text of ``plan.json``; a missing number is None."""
        answer: dict[str, Any] = {
            "poses": self.places,
            "candidates": self.n_candidates,
            "noise": {"length_m": self.noise.length_m, "tension_N": self.noise.tension_N},
            "expected": [
                {
                    **e.effect.identified(),
                    "parameter": e.parameter.name,
                    "std": e.std,
                    "std_random": e.std_random,
                    "told": e.is_told,
                }
                for e in self.expected
            ],
            "condition": self.condition,
            "observability": self.observability,
            "by_poses": {
                "poses": self.sizes,
                "largest": [{"id": c.effect_id, "unit": c.unit, "std": c.std} for c in self.curves],
            },
        }
        return json_text(answer)


def plan(
    study: Study,
    measurements: Measurements,
    cable: Cable,
    n_poses: int | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Plan:
    """Choose poses to measure what is unknown of a machine.

    Parameters
    ----------
    study : Study
        With a workspace.
    measurements : Measurements
        What is unknown, and the noise of what will be read; its file need not be there.
    cable : Cable
        That is on the machine, with what it may be pulled by.
    n_poses : int, optional
        How many; if left out, twice as many as it takes to have more readings than unknowns, and
        no fewer than a diagnosis asks for.
    progress : callable
        Told what is being done.

    Raises
    ------
    InputError
        If there is nothing to choose from, or to be identified.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):  # as in a diagnosis
        return _plan(study, measurements, cable, n_poses, progress)


def _plan(
    study: Study,
    measurements: Measurements,
    cable: Cable,
    n_poses: int | None,
    progress: Callable[[str], None],
) -> Plan:
    progress("poses that the robot holds")
    problem, effects, statics, places = candidates(study, measurements, cable)
    progress("slopes of the readings")
    slopes = slopes_at(problem, effects, study)
    parameters = [(effect, p) for effect in effects for p in effect.parameters]
    typical = np.array([p.typical for _, p in parameters])
    n_read = max(int(np.isfinite(problem.measured.readings[0]).sum()), 1)
    net = max(n_read - problem.predict.row_unknowns, 1)
    count = n_poses or min(
        max(2 * -(-len(parameters) // net), FEWEST_ROWS), len(places), MOST_POSES
    )
    if count > len(places):
        expected = f"at most {len(places)}: as many of those tried does the robot hold"
        raise InputError.at("--poses", f"is {count}", expected)
    progress("the choice")
    chosen = exchanged(slopes, count)
    identifiability = identifiability_of(slopes[chosen], count)
    rng = np.random.default_rng(0)
    draws = [rng.choice(len(places), count, replace=False) for _ in range(_DRAWS)]
    std_random = (
        np.median([identifiability_of(slopes[draw], count).std for draw in draws], axis=0) * typical
    )
    sizes = sorted({min(max(round(share * count), 1), len(places)) for share in _SIZES})
    by_size = [
        identifiability if n == count else identifiability_of(slopes[exchanged(slopes, n)], n)
        for n in sizes
    ]
    route = chosen[_route(places[chosen, :3])]
    std = identifiability.std * typical
    return Plan(
        study,
        problem.noise,
        statics=solve_sagging(statics.robot, Poses.at(places[route]), _that_can_break(cable)),
        places=places[route],
        n_candidates=len(places),
        expected=tuple(
            Expected(*pair, float(std[k]), float(std_random[k]))
            for k, pair in enumerate(parameters)
        ),
        condition=identifiability.condition,
        observability=identifiability.observability,
        sizes=tuple(sizes),
        curves=tuple(_curves(parameters, by_size, typical)),
    )


def candidates(
    study: Study, measurements: Measurements, cable: Cable
) -> tuple[Problem, list[Effect], Statics, FloatArray]:
    """Return the problem at all poses that the robot holds, its unknowns, statics and places."""
    if study.workspace is None:
        expected = "the region in which poses can be measured"
        raise InputError([study.source.fault("workspace", "is missing", expected)])
    noise = measurements.declared_noise
    if not noise:
        expected = "the deviation of one length, of one tension, or both: as far as they are read"
        raise InputError([study.source.fault("measurements.noise", "is missing", expected)])
    if not measurements.has_poses:
        place, problem = "measurements.unknown", "'poses' are unknown, and so cannot be planned"
        raise InputError([study.source.fault(place, problem, "poses that are measured")])
    places = _places(study)
    unread = np.full((len(places), study.robot.n_cables), np.nan)
    measured = Measured(Poses.at(places), unread, unread, settled=True)
    machine = case_of(study, measurements, measured).machine
    robot = as_built(machine, declared_settings(study, machine)).robot
    statics = solve_sagging(robot, measured.poses, _that_can_break(cable))
    tension_N = statics.cable_tension_N
    is_held = statics.is_solved & (tension_N <= cable.allowable_tension_N).all(axis=-1)
    if not is_held.any():
        problem = f"the robot holds none of {len(places)} poses with its cable"
        raise InputError([study.source.fault("workspace.region", problem, "poses that it holds")])
    length_m, tension_N = statics.length_m[is_held], statics.exit_tension_N[is_held]
    measured = Measured(
        Poses.at(places[is_held]),
        length_m if "length" in noise else np.full_like(length_m, np.nan),
        tension_N if "tension" in noise else np.full_like(length_m, np.nan),
        settled=True,
        row_numbers=np.arange(1, int(is_held.sum()) + 1),
    )
    case = case_of(study, measurements, measured)
    for name in measurements.unknown:
        named = [effect for effect in case.given if effect.is_among([name])]
        if not named or any(effect.follows_rows for effect in named):
            why = dict(case.skipped).get(name, "no reading of such poses would show it")
            why = "it depends on the way from pose to pose" if named else why
            problem = f"'{name}' cannot be planned for: {why}"
            expected = "what poses at rest can tell"
            raise InputError([study.source.fault("measurements.unknown", problem, expected)])
    if not case.given:
        expected = "what the poses shall tell, such as anchors and length_offset"
        raise InputError([study.source.fault("measurements.unknown", "is empty", expected)])
    sizes = Noise(noise.get("length", math.inf), noise.get("tension", math.inf), "declared")
    problem_there = Problem(measured, case.predictor(), sizes)
    return problem_there, list(case.given), statics, places[is_held]


def _that_can_break(cable: Cable) -> Cable:
    """Return a cable with a strength: at twice its length at the latest it breaks.

    The internal forces of a robot with cables to spare are shared out by what the cables allow.
    """
    return replace(
        cable, allowable_tension_N=min(cable.allowable_tension_N, cable.axial_stiffness_N)
    )


def _places(study: Study) -> FloatArray:
    """Return places all over the workspace (n_places, 3 or 6), each turned in one of its ways."""
    workspace = study.workspace
    assert workspace is not None
    sampled = workspace.region.samples_m(_CANDIDATES, "low_discrepancy", 0)
    position_m = np.concatenate(list(sampled))
    if study.robot.is_point_mass:
        return position_m
    turns, row = workspace.orientations.at(position_m), np.arange(len(position_m))
    # Neighbours of a low-discrepancy sequence lie far apart: turns in their order go everywhere.
    return np.hstack([position_m, turns[row, row % turns.shape[1]]])


def slopes_at(problem: Problem, effects: Sequence[Effect], study: Study) -> FloatArray:
    """Return the slopes of the readings (n_poses, 2 n_cables, n_parameters), per typical change."""
    declared = {s.effect.key: s.values for s in declared_settings(study, problem.predict.machine)}
    values = [declared.get(effect.key, effect.neutral) for effect in effects]
    vector = np.array([
        values_of_effect.get(p.name, p.neutral)
        for effect, values_of_effect in zip(effects, values, strict=True)
        for p in effect.parameters
    ])  # fmt: skip
    typical = np.array([p.typical for effect in effects for p in effect.parameters])
    return np.asarray(np.nan_to_num(jacobian(problem, effects, vector) * typical))


def exchanged(slopes: FloatArray, count: int) -> IntArray:
    """Return the poses (count,) with the largest determinant, as far as exchanges find it."""
    total = np.einsum("rcp,rcq->pq", slopes, slopes)
    information = total * 0.0 + np.eye(len(total)) * _FAINT * np.trace(total) / len(slopes)
    chosen: list[int] = []
    for _ in range(count):
        chosen.append(_best(slopes, information, chosen))
        information = information + slopes[chosen[-1]].T @ slopes[chosen[-1]]
    for _ in range(_SWEEPS):
        before = list(chosen)
        for place, pose in enumerate(before):
            information = information - slopes[pose].T @ slopes[pose]
            unchanged = chosen[:place] + chosen[place + 1 :]
            chosen[place] = _best(slopes, information, unchanged)
            information = information + slopes[chosen[place]].T @ slopes[chosen[place]]
        if chosen == before:
            break
    return np.array(chosen)


def _best(slopes: FloatArray, information: FloatArray, excluded: Sequence[int]) -> int:
    """Return the pose that multiplies the determinant by most, of those not taken."""
    inverse = np.linalg.inv(information)
    growth = slopes @ inverse @ slopes.transpose(0, 2, 1) + np.eye(slopes.shape[1])
    gain = np.linalg.slogdet(growth)[1]
    gain[list(excluded)] = -np.inf
    return int(np.argmax(gain))


def _route(position_m: FloatArray) -> IntArray:
    """Return the order in which to visit positions: from the lowest, each time to the nearest."""
    route = [int(np.argmin(position_m[:, 2]))]
    while len(route) < len(position_m):
        away = np.linalg.norm(position_m - position_m[route[-1]], axis=1)
        away[route] = np.inf
        route.append(int(np.argmin(away)))
    return np.array(route)


def _curves(
    parameters: Sequence[tuple[Effect, Parameter]],
    by_size: Sequence[Identifiability],
    typical: FloatArray,
) -> Iterator[DeviationCurve]:
    std = np.array([identifiability.std for identifiability in by_size]) * typical
    kinds = [(effect.id, p.unit) for effect, p in parameters]
    for kind in dict.fromkeys(kinds):
        alike = [k for k, kind_of_parameter in enumerate(kinds) if kind_of_parameter == kind]
        yield DeviationCurve(*kind, std[:, alike].max(axis=1))


# Poses that tell two rivals apart.

_RIVAL_CANDIDATES = 2000
"""Positions to look at: in a cube, neighbours are a twelfth of its side apart."""
_SPACING = 0.15
"""Share of the region between proposals: else all three would be one place."""
_DISTINCT_STD = 3.0
"""Standard deviations between two rivals that are distinguished."""


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """Poses whose measurement would tell two rivals apart."""

    found: str  #: effect that was found, then its rival
    rival: str
    positions_m: FloatArray = field(metadata={"json": "poses"})  #: (n_poses, 3): where to measure
    #: (n_poses,): difference of their predictions there, in units of noise, over all readings of a
    #: pose
    separation: FloatArray

    @property
    def repeats(self) -> FloatArray:
        """How often to measure each pose, until the two are three deviations apart (n_poses,).

        Inf where both predict the same.
        """
        with np.errstate(divide="ignore"):
            return np.ceil((_DISTINCT_STD / self.separation) ** 2)


def propose(
    problem: Problem,
    region: Region | None,
    fitted: Sequence[Setting],
    rival: Sequence[Setting],
    names: tuple[str, str],
) -> Proposal:
    """Return the poses at which the predictions of two models, both fitted, differ most.

    The surroundings of a new pose are taken from the middle row. Where there is no region, poses
    are sought in the box of the measured ones.
    """
    positions = _rival_positions(problem.measured, region)
    measured = _measured_at(problem.measured, positions)
    elsewhere = replace(problem, measured=measured, predict=problem.predict.at(measured))
    readings, rival_readings = (
        elsewhere.predicted(settings).stacked for settings in (fitted, rival)
    )
    is_measured = ~np.isnan(problem.measured.readings).all(axis=0)
    gap = (readings - rival_readings)[:, is_measured] / problem.sigma[is_measured]
    separation = np.sqrt(np.nansum(gap**2, axis=1))
    size = np.maximum(np.ptp(positions, axis=0), 1e-9)
    chosen: list[int] = []
    for k in np.argsort(-separation):
        apart = [np.abs((positions[k] - positions[c]) / size).max() > _SPACING for c in chosen]
        if all(apart):
            chosen.append(int(k))
        if len(chosen) == 3:  # one to decide, two in case that it cannot be reached
            break
    return Proposal(*names, positions[chosen], separation[chosen])


def _rival_positions(measured: Measured, region: Region | None) -> FloatArray:
    if region is not None:
        return np.concatenate(list(region.samples_m(_RIVAL_CANDIDATES, "low_discrepancy", 0)))
    position = measured.poses.position_m
    rng = np.random.default_rng(0)
    return rng.uniform(position.min(axis=0), position.max(axis=0), (_RIVAL_CANDIDATES, 3))


def _measured_at(measured: Measured, positions: FloatArray) -> Measured:
    """Return rows at rest at other positions, turned as the middle row, in its surroundings."""
    middle, count = measured.n_rows // 2, len(positions)
    rotation = measured.poses.rotation
    unread = np.full((count, measured.length_m.shape[1]), np.nan)

    def repeated(column: FloatArray | None) -> FloatArray | None:
        return None if column is None else np.repeat(column[middle : middle + 1], count, axis=0)

    return replace(
        measured,
        settled=True,
        poses=Poses(positions, rotation if rotation.ndim == 2 else rotation[middle]),
        length_m=unread,
        tension_N=unread,
        time_s=repeated(measured.time_s),
        temperature_C=repeated(measured.temperature_C),
        wind_m_per_s=repeated(measured.wind_m_per_s),
        covariates={},
        row_numbers=np.arange(1, count + 1),
        session=None,
    )
