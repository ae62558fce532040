"""Whether an analysis of ours agrees with the reference: at each governing place, and at others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pairs import options
from pairs.quantities import (
    clearance_m,
    frequencies_Hz,
    least_eigenvalue_N_per_m,
    least_stiffness_N_per_m,
    lowest_m,
    sag_ratio,
)
from pairs.reference import Pose, Problem, State, feasible, hang, load_on, settle, solve
from pairs.scenario import (
    growth_of,
    in_motion,
    kept_by_sheaves,
    level_directions,
    line_at,
    problem_of,
    random_places,
    turn_at,
    turns_of,
    up_of,
)
from scipy.interpolate import CubicSpline

from designer.analysis.analyse import Analysis
from designer.model.load_case import Loaded
from designer.model.robot import Poses
from designer.model.verdict import Requirement
from designer.selection.cases import CaseResult
from designer.statics.inverse import solve_sagging
from designer.workspace.demand import settled

SAME = 1e-6
AT_SAG = 1e-5
"""Where a limit on sag governs: the solvers keep it by a least pull that is on the safe side."""
_NOTHING = 1e-6
"""In metres, or newtons beside loads of hundreds: the end of a rope that hangs slack bears none."""
DIFFERENCES = 1e-3
"""Of stiffness, which the reference takes from differences, and of a walk along a rope in steps."""
ELEMENTS, ON_PULLEYS = 5e-3, 2e-2
"""Of frequencies: finite elements hang from where cables leave pulleys, and do not roll."""


@dataclass(frozen=True)
class Situation:
    """A load case in one direction, with the ropes of the answer."""

    text: Mapping[str, Any]
    ropes: list[tuple[Any, Any]]
    case: Mapping[str, Any]
    wind: np.ndarray | None = None
    inertia: np.ndarray | None = None
    lost: int | None = None
    wrench: np.ndarray | None = None

    @classmethod
    def of(cls, text: Mapping[str, Any], ropes: list, found: CaseResult) -> Situation:
        named = {case["name"]: case for case in text.get("load_cases", ())}
        one = found.loaded
        case = named.get(found.case.name, {})
        return cls(text, ropes, case, one.wind, one.inertia, one.lost_cable, one.wrench_N)

    @property
    def problem(self) -> Problem:
        case = self.case
        if self.wrench is not None:
            case = {**case, "wrench": {"force": self.wrench[:3], "moment": self.wrench[3:]}}
        return problem_of(self.text, self.ropes, case, self.wind, self.inertia)

    def problem_at(self, pose: Pose) -> Problem:
        """Return the problem with the inertia that it has in a pose."""
        return in_motion(self.problem, self.text, self.case, pose.position_m)

    @property
    def growth(self) -> float:
        return growth_of(self.text, self.case, self.ropes[0][0])

    @property
    def keeps_lengths(self) -> bool:
        return self.lost is not None or self.growth != 0.0

    def turned(self, rng: np.random.Generator) -> Situation:
        """Return the case in directions, and under a wrench, at random where it has any."""
        up, wind, inertia = up_of(self.text), self.wind, self.inertia
        if wind is not None and "direction" not in self.case["wind"]:
            wind = level_directions(self.text, up, 2, rng)[rng.integers(2)]
        if inertia is not None:
            free = self.problem.freedoms[:, :3]
            free = free[np.abs(free).max(axis=1) > 0.0]
            inertia = rng.normal(size=len(free)) @ free
            inertia = inertia / np.linalg.norm(inertia)
        wrench = self.wrench
        if wrench is not None and isinstance(self.case["wrench_set"], list):
            wrench = _six(self.case["wrench_set"][rng.integers(len(self.case["wrench_set"]))], 3)
        elif wrench is not None:
            low, high = _six(self.case["wrench_set"], (3, 2)).T
            wrench = low + rng.uniform(size=6) * (high - low)
        return replace(self, wind=wind, inertia=inertia, wrench=wrench)


def _six(given: Mapping[str, Any], shape: Any) -> np.ndarray:
    """Return force and moment in a row, or their ranges one below the other."""
    return np.concatenate([given.get(name, np.zeros(shape)) for name in ("force", "moment")])


def ropes_of(analysis: Analysis) -> list[tuple[Any, Any]]:
    """Return grade and size of each cable, as the texts have them."""

    def named(grade: str, size: str) -> tuple[Any, Any]:
        sheet = options.GRADES[grade]
        return sheet, next(one for one in sheet["sizes"] if one["id"] == size)

    if analysis.assignment.has_groups:
        return [named(one.grade.id, one.size.id) for one in analysis.assignment.by_cable]
    chosen = analysis.chosen
    return [named(chosen.grade.id, chosen.size.id)] * analysis.study.robot.n_cables


def is_balanced(state: State) -> bool:
    """Tell whether the pulls carry the platform."""
    problem = state.problem
    arms = state.attachment_m - state.pose.position_m
    held = np.concatenate([state.pull_N.sum(axis=0), np.cross(arms, state.pull_N).sum(axis=0)])
    left = problem.freedoms @ (held + load_on(problem, state.pose.rotation))
    return bool(np.abs(left).max() < 1e-7 * problem.scale_N * max(problem.reach_m, 1.0))


def hangs_below(state: State) -> bool:
    """Tell whether a cable from above hangs below the platform."""
    up = state.problem.up
    from_above = (state.problem.exits_m - state.attachment_m) @ up >= 0.0
    return bool((from_above & (state.pull_N @ up < 0.0)).any())


def is_slack(one: Situation, pose: Pose) -> bool:
    """Tell whether the limit on sag governs the choice of the internal forces."""
    problem = one.problem_at(pose)
    if problem.n == len(problem.freedoms):
        return False
    state = solve(problem, pose)
    return state is not None and sag_ratio(state) > 0.9999 * (problem.sag_max or np.inf)


def tension_at(one: Situation, pose: Pose, ours: CaseResult | None = None) -> tuple[float, str]:
    """Return utilisation in a pose by the reference, and what is wrong with our lengths there.

    Of robots that choose internal forces on kept lengths the lengths are ours: the reference says
    whether they are as good as its own.
    """
    best = solve(one.problem_at(pose), pose)
    if best is None:
        return np.inf, ""
    if not one.keeps_lengths:
        return best.utilisation, ""
    lengths, wrong, start = best.total_m, "", pose
    if ours is not None:
        loss = ours.loss
        lengths = loss.before.length_m[0]
        start = Pose.of(loss.rest.place[0]) if np.isfinite(loss.rest.position_m).all() else pose
        hung = hang(one.problem, pose, lengths, near=best)
        if hung is None or not is_balanced(hung):
            wrong = "our lengths do not hold the pose before the loss"
        elif hung.utilisation > best.utilisation * (1.0 + SAME):
            wrong = (
                f"our lengths ask for {hung.utilisation:.9g}, the best for {best.utilisation:.9g}"
            )
    problem, lengths = one.problem, (1.0 + one.growth) * lengths
    if one.lost is not None:
        problem = problem.without(one.lost)
        lengths = np.delete(lengths, one.lost - 1)
    rest = settle(problem, start, lengths)
    return (np.inf if rest is None else rest.utilisation), wrong


def disagreements(
    text: Mapping[str, Any], analysis: Analysis, others: int = 6, seed: int = 0
) -> Iterator[str]:
    """Yield in a line each figure of an analysis that the reference does not confirm."""
    ropes, rng = ropes_of(analysis), np.random.default_rng(seed)
    text = with_choices(text, analysis) | {"rope_m": ropes[0][1]["diameter"]}
    if analysis.assignment.has_groups:
        yield from _groups(text, ropes, analysis, rng, others)
        return
    for found in analysis.chosen.cases:
        yield from _case(Situation.of(text, ropes, found), found, rng, others)
    for one in analysis.requirements:
        if one.id in QUANTITIES:
            yield from _requirement(text, ropes, analysis, one)
        if one.id == "rope_life" and len(ropes) == analysis.study.robot.degrees_of_freedom:
            yield from _life(text, ropes, analysis, one)
    if "positions" in text["robot"].get("winches", {}):
        yield from _reactions(text, ropes, analysis)


def _case(
    one: Situation, found: CaseResult, rng: np.random.Generator, others: int
) -> Iterator[str]:
    name = f"{found.case.name} {found.loaded.words}".strip()
    pose = Pose.of(found.verification.worst_place)
    theirs, wrong = tension_at(one, pose, found)
    if wrong:
        yield f"{name}: {wrong}"
    same = AT_SAG if one.text["workspace"].get("sag") != "none" and is_slack(one, pose) else SAME
    if abs(found.utilisation / theirs - 1.0) > same:
        yield f"{name}: utilisation {found.utilisation:.9g}, reference {theirs:.9g} at {pose}"
    yield from _no_worse(one, found.utilisation, name, rng, others)


def _no_worse(
    one: Situation, most: float, name: str, rng: np.random.Generator, others: int
) -> Iterator[str]:
    """Yield the places at random that ask for more than the governing one."""
    if one.keeps_lengths:  # which lengths those are, where they may be chosen, is ours to say
        others = min(others, 8) if len(one.problem.freedoms) == one.problem.n else 0
    excludes = one.text["workspace"].get("hangs_below") == "exclude"
    for pose in random_places(one.text, one.case, others, rng) if others else ():
        there = one.turned(rng)
        problem = there.problem_at(pose)
        if not one.keeps_lengths and not excludes:
            some = feasible(problem, pose)
            if some is not None and some.utilisation <= most * (1.0 + SAME):
                continue
        state = solve(problem, pose)
        if excludes and state is not None and hangs_below(state):
            continue
        used = np.inf if state is None else state.utilisation
        if one.keeps_lengths:
            used, _ = tension_at(there, pose)
        if used > most * (1.0 + SAME):
            along = f"{there.wind} {there.inertia} {there.wrench}"
            yield f"{name}: {used:.9g} at {pose} {along}, told {most:.9g}"


def state_at(there: Situation, loaded: Loaded, place: np.ndarray) -> State | None:
    """Return the state in a pose with the lengths that we choose there; None where none holds."""
    pose, poses = Pose.of(place), Poses.at(place[None])
    problem = there.problem_at(pose)
    if not there.keeps_lengths:
        length = solve_sagging(loaded.robot, poses, loaded.cable).length_m[0]
        hung = hang(problem, pose, length, near=feasible(problem, pose))
        return hung if hung is not None and is_balanced(hung) else None
    loss = settled(loaded, poses)
    length = (1.0 + there.growth) * loss.before.length_m[0]
    if there.lost is not None:
        problem, length = problem.without(there.lost), np.delete(length, there.lost - 1)
    return settle(problem, Pose.of(loss.rest.place[0]), length)


def _requirement(text, ropes, analysis: Analysis, one: Requirement) -> Iterator[str]:
    """Compare a requirement at its place, and see that no listed pose is worse."""
    loaded = one.loaded
    cases = {case["name"]: case for case in text.get("load_cases", ())}
    case = cases.get(one.load_case, {})
    there = Situation(
        text, ropes, case, loaded.wind, loaded.inertia, loaded.lost_cable, loaded.wrench_N
    )
    quantity = QUANTITIES[one.id]
    name = f"{one.load_case} {one.direction} {one.id}"
    turn = turn_at(text, one.place[:3])
    if turn is not None and not np.allclose(one.place[3:], turn, rtol=0.0, atol=1e-9):
        yield f"{name}: turned by {one.place[3:]}, reference {turn}"
    state = state_at(there, loaded, one.place)
    if state is None:
        yield f"{name}: the reference does not hold {one.place}"
        return
    text = {**text, "lost": loaded.lost_cable}
    ours = _severity(one, text)
    theirs = quantity(state, text)
    same = DIFFERENCES if one.id in ("stability", "stiffness") else SAME
    if one.id in ("excitation", "platform_frequency"):
        same = ON_PULLEYS if "pulley_radius" in text.get("effects", {}) else ELEMENTS
    if not np.isclose(ours, theirs, rtol=same, atol=_NOTHING * (one.id in AT_NOTHING)):
        yield f"{name}: {ours:.9g}, reference {theirs:.9g} at {one.place}"
    region = case.get("region") or text["workspace"].get("region", {})
    if (
        one.id in ("stability", "stiffness", "clearance", "excitation", "platform_frequency")
        or "points" not in region
    ):
        return
    if "orientation_range" in text["workspace"]:
        return
    for pose in random_places(text, case, 9, np.random.default_rng(0)):
        place = np.concatenate([pose.position_m, pose.turn_rad][: len(one.place) // 3])
        state = state_at(there, loaded, place)
        if state is not None and quantity(state, text) < ours - 1e-6 * abs(ours) - 1e-6:
            yield f"{name}: {quantity(state, text):.9g} at {place}, told {ours:.9g}"


def with_choices(text: Mapping[str, Any], analysis: Analysis) -> dict[str, Any]:
    """Return a text with the orientations that are ours to choose."""
    free, workspace = text["workspace"].get("orientation_free"), analysis.study.workspace
    if free is None or workspace is None:
        return dict(text)

    def rotation_vector_of(position: np.ndarray) -> np.ndarray:
        turn = workspace.space.places(position[None])[0, 3:]
        ends = np.array([free.get(name, [0.0, 0.0]) for name in ("rx", "ry", "rz")])
        assert (turn >= ends[:, 0] - 1e-12).all()
        assert (turn <= ends[:, 1] + 1e-12).all()
        return turn

    return {**text, "turn_of": rotation_vector_of}


def _reactions(text, ropes, analysis: Analysis) -> Iterator[str]:
    """Compare the forces on the supports with the pulls of both branches of each rope."""
    cases = {case["name"]: case for case in text.get("load_cases", ())}
    winches = np.array(text["robot"]["winches"]["positions"])
    for one in analysis.reactions:
        loaded = one.loaded
        if loaded.lost_cable is not None:
            continue
        there = Situation(
            text, ropes, cases.get(one.load_case, {}), loaded.wind, loaded.inertia, None,
            loaded.wrench_N,
        )  # fmt: skip
        state = state_at(there, loaded, one.place)
        if state is None:
            yield f"reaction on {one.mast}: the reference does not hold {one.place}"
            continue
        pull, cable = state.exit_pull_N[one.mast - 1], one.mast - 1
        along = winches[cable] - state.problem.exits_m[cable]
        force = np.linalg.norm(pull) * along / np.linalg.norm(along) - pull
        least = SAME * np.linalg.norm(pull) + _NOTHING
        if not np.allclose(one.force_N, force, rtol=SAME, atol=least):
            yield f"{one.load_case}: reaction on {one.mast} {one.force_N}, reference {force}"


def _life(text, ropes, analysis: Analysis, one: Requirement) -> Iterator[str]:
    """Walk along a rope and count what bends each place of it, over the sheave alone."""
    loaded, life = one.loaded, text["selection"]["rope_life"]
    if text["selection"]["grades"] == ["pairs-fibre"]:
        if one.state.value != "open":
            yield f"rope life of a fibre rope is {one.state.value}"
        return
    winches = text["robot"].get("winches", {})
    if "positions" in winches and "drum_diameter" in winches:  # then drums bend it as well
        return
    cases = {case["name"]: case for case in text.get("load_cases", ())}
    there = Situation(
        text, ropes, cases.get(one.load_case, {}), loaded.wind, None, None, loaded.wrench_N
    )
    shares, turn = np.linspace(0.0, 1.0, 81), turns_of(text, 1, np.random.default_rng(0))[0]
    poses = [Pose(line_at(text, share)[0], turn) for share in shares]
    states = [solve(there.problem_at(pose), pose) for pose in poses]
    if any(state is None for state in states):
        yield "rope life: the reference does not hold the path"
        return
    fine = np.linspace(0.0, 1.0, 4001)
    runs = []
    for k in range(len(ropes)):
        size = ropes[k][1]
        pull = [float(np.linalg.norm(state.exit_pull_N[k])) for state in states]
        tension = CubicSpline(shares, pull)(fine)
        ends = [
            CubicSpline(shares, [length[k] for length in lengths])(fine)
            for lengths in ([s.free_m for s in states], [s.total_m for s in states])
        ]
        runs.append(1.0 / worn(ends, tension, size["diameter"], text, life))
    if not np.isclose(one.capacity, min(runs), rtol=DIFFERENCES):
        yield f"rope life {one.capacity:.6g} runs, reference {min(runs):.6g}"


def worn(ends, tension: np.ndarray, d: float, text, life) -> float:
    """Return the share of its life that a run takes of the place that wears most."""
    low, high = min(end.min() for end in ends), max(end.max() for end in ends)
    places = low + (high - low) * (np.arange(1000) + 0.5) / 1000
    over, damage, bent = text["selection"]["sheave_diameter"], np.zeros(1000), np.zeros(1000, bool)
    crossed = []
    for end in ends:
        for k in np.flatnonzero(np.diff(end)):
            hit = (places - end[k]) * (places - end[k + 1]) < 0.0
            bent |= hit
            losses = text["robot"].get("winches", {}).get("sheave_efficiency", 1.0)
            hauled = ends[1][k + 1] < ends[1][k]
            pull = 0.5 * (tension[k] + tension[k + 1]) / (losses if hauled else 1.0)
            crossed.append((hit, pull))
    zone = max(bent.sum() * (high - low) / 1000 / d, 10.0)
    d_mm, ratio = 1e3 * d, np.log10(over / d)
    size = 0.52 / ((max(d_mm, 4.0) / 16.0) ** 0.3 - 0.48)
    length = 1.49 / (2.49 - ((zone - 2.5) / 57.5) ** -0.14)
    for hit, pull in crossed:
        load = np.log10(pull / d_mm**2) - 0.4 * np.log10(life["wire_strength"] / 1770e6)
        borne = 10.0 ** (
            life["b0"] + (life["b1"] + life["b3"] * ratio) * load + life["b2"] * ratio
        ) * size * length  # fmt: skip
        damage[hit] += 0.5 / borne
    return float(damage.max())


def _severity(one: Requirement, text) -> float:
    """Return the quantity of a requirement so that less of it is worse."""
    if one.id in ("sag", "winch_torque"):
        return -one.demand
    if one.id in ("excitation", "winch_tension"):
        return -one.utilisation
    return one.capacity


def _excitation(state: State, text) -> float:
    low, high = text["selection"]["limits"]["excitation"]
    frequency, _ = frequencies_Hz(state, text)
    return -float(np.minimum(high / frequency, frequency / low).max())


def _of_platform(state: State, text) -> float:
    frequencies, shares = frequencies_Hz(state, text)
    return float(frequencies[shares >= 0.05][0])


def _paid_out(state: State, text) -> np.ndarray:
    """Tell which cables get longer along a path, which is a straight line from rest to rest."""
    if "path" not in text["workspace"]:
        return np.zeros(state.problem.n, dtype=bool)
    first, last = np.array(options.PATHS[text["workspace"]["path"]])
    at = state.pose.position_m
    if min(np.linalg.norm(at - end) for end in (first, last)) < 1e-9:
        return np.zeros(state.problem.n, dtype=bool)
    return (state.attachment_m - state.problem.exits_m) @ (last - first) > 0.0


def _drum_tensions_N(state: State, text) -> np.ndarray:
    kept = kept_by_sheaves(text)
    losses = np.where(_paid_out(state, text), kept, 1.0 / kept)
    return np.linalg.norm(state.exit_pull_N, axis=1) * losses


def _torque_Nm(state: State, text) -> float:
    """Return the largest torque of a motor, its rope in the outermost layer."""
    winches = text["robot"]["winches"]
    radius = 0.5 * winches["drum_diameter"] + (winches.get("layers", 1) - 0.5) * text["rope_m"]
    efficiency = winches["efficiency"]
    losses = np.where(_paid_out(state, text), efficiency, 1.0 / efficiency)
    return float((_drum_tensions_N(state, text) * losses).max() * radius / winches["gear_ratio"])


def _share_of_winch(state: State, text) -> float:
    """Return the largest tension over that of its winch."""
    largest = text["robot"]["winches"]["tension_max"]
    each = largest if isinstance(largest, list) else [largest] * len(text["robot"]["anchors"])
    of_cables = [limit for cable, limit in enumerate(each, start=1) if cable != text["lost"]]
    return max(
        float(tension_N) / limit
        for tension_N, limit in zip(_drum_tensions_N(state, text), of_cables, strict=True)
        if limit is not None
    )


QUANTITIES = {
    "least_tension": lambda state, _: float(state.least_tension_N.min()),
    "stability": lambda state, _: least_eigenvalue_N_per_m(state),
    "stiffness": lambda state, _: least_stiffness_N_per_m(state),
    "sag": lambda state, _: -sag_ratio(state),
    "winch_tension": lambda state, text: -_share_of_winch(state, text),
    "winch_torque": lambda state, text: -_torque_Nm(state, text),
    "floor": lambda state, _: lowest_m(state),
    "clearance": lambda state, _: clearance_m(state),
    "excitation": _excitation,
    "platform_frequency": _of_platform,
}
AT_NOTHING = ("floor", "clearance", "least_tension")
"""What may be nothing, of which rounding leaves something."""


def _groups(text, ropes, analysis: Analysis, rng, others: int) -> Iterator[str]:
    choice = analysis.groups
    met, n = choice.chosen.verification, len(ropes)
    one = Situation(text, ropes, {})
    members = [[cable - 1 for cable in group.cables] for group in choice.groups]
    for group, place, used in zip(members, met.worst_place, met.utilisation, strict=True):
        state = solve(one.problem, Pose.of(place))
        theirs = (state.tension_N / one.problem.allowable_N)[group].max()
        if n == len(one.problem.freedoms) and abs(used / theirs - 1.0) > SAME:
            yield f"group {group}: utilisation {used:.9g}, reference {theirs:.9g} at {place}"
    most = float(met.utilisation.max())
    at = Pose.of(met.worst_place[int(met.utilisation.argmax())])
    theirs = solve(one.problem, at).utilisation
    if abs(most / theirs - 1.0) > SAME:
        yield f"groups: utilisation {most:.9g}, reference {theirs:.9g} at {at}"
    yield from _no_worse(one, most, "groups", rng, others)
