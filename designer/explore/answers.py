"""What is known of a state of the window: the pose, the map, the ropes; and against another state.

Nothing here knows of Qt. Each kind of question (`designer.explore.question`) has its function:
`pose_answer`, `map_answer`, `worst_answer`, `quick_ropes` at a part of the samples, `full_ropes` as
in the report. A state that is pinned as A is compared with the present one by `compare`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.governing import PlatformModes, modes_at
from designer.analysis.maps import cable_curves_m, chords_m
from designer.analysis.requirements import Terms
from designer.arrays import BoolArray, FloatArray, IntArray
from designer.explore.fields import Field
from designer.explore.quantities import BY_KEY, CHEAP
from designer.explore.question import Question, Rope, RopePerCable, cables_words
from designer.grades.grade import Grade, Size
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable, Cables
from designer.model.load_case import STATIC
from designer.model.polygon import every_second
from designer.model.region import Region
from designer.model.robot import Poses
from designer.model.verdict import Answer, Requirement, Verdict
from designer.model.workspace import Workspace
from designer.progress import SILENT, Reporter
from designer.proof.prove import Proof
from designer.report import format as fmt
from designer.selection.candidate import UNKNOWN, Candidate, CandidateFigures, undominated
from designer.selection.cases import Cases, envelope, governing, refine_all
from designer.selection.compare import burdens, is_undominated, rejection_words
from designer.selection.groups import GroupChoice
from designer.selection.refutation import verify_groups
from designer.selection.result import SelectionResult
from designer.selection.select import at_samples
from designer.selection.verify import NOT_TRIED, Verification
from designer.sizing.newton import size_poses
from designer.statics.inverse import (
    Statics,
    exit_angle_rad,
    sag_m,
    sag_ratio,
    solve_sagging,
    stretch_m,
)
from designer.statics.modes import frequencies_Hz
from designer.statics.rest import resting_places
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.workspace.demand import at_worst_orientation, demand_of, is_left_out, size_worst
from designer.workspace.section import section_of_workspace
from designer.workspace.sweep import WorkspaceMap, map_workspace

#: Places in one call of the solver: what a pose that is waited for has to wait at most
_BATCH = 2**12
MAX_POINTS = 3000  #: Of a list of points: as many as are told apart on a screen
_RINGS, _SPOKES, _ROWS = 45, 120, 24  #: Of a fine grid: its faces are a few pixels wide
_QUICK_SAMPLES = 1500
Values = Mapping[str, FloatArray]  #: By the key of the quantity, SI; NaN where a place has none

# The pose


@dataclass(frozen=True, slots=True)
class CableReadout:
    """One cable in this pose."""

    number: int  #: From 1, in the order of the anchors
    #: Unstrained, from the exit point, around the pulley where there is one; and straight [m]
    length_m: float
    chord_m: float
    exit_tension_N: float  #: Tension at either end [N]
    platform_tension_N: float
    angle_rad: float  #: How far below the horizontal it leaves its exit point [rad]
    #: How far it strays from the line between its ends, and how much its load stretches it [m]
    sag_m: float
    stretch_m: float
    utilisation: float  #: Largest tension anywhere in it over the allowable one
    hangs_below: bool  #: Whether it hangs below the platform


@dataclass(frozen=True, slots=True, eq=False)
class PoseAnswer:
    """What is known of one pose."""

    verdict: Verdict  #: What became of it, with the rope or, without one, with the thinnest cable
    #: What the cables are of; None for the thinnest cable that holds the pose
    rope: Rope | RopePerCable | None
    cables: tuple[CableReadout, ...]  #: Empty unless solved
    #: (n_cables, 81, 3) their true shape, from the exit points to the platform [m]; None unless
    #: solved
    curves_m: FloatArray | None
    #: (n_cables, 2, 3) straight lines from exit points to attachments [m], solved or not
    chords_m: FloatArray
    #: The thinnest cable of the configured family that holds this pose [m]; NaN for none
    diameter_m: float
    #: Largest in any cable [N], and over the allowable tension; NaN unless solved
    max_tension_N: float
    utilisation: float
    #: Smallest force over displacement; zero where the platform would not stay, NaN unless solved
    stiffness_N_per_m: float
    is_stable: bool | None  #: Whether the platform stays; None unless solved
    stability: str  #: The same in a sentence; empty unless solved
    caution: str  #: What else a reader must know; or empty
    outside: str  #: In what the pose is none of the workspace; or empty
    statics: Statics  #: The equilibrium, if it is solved

    @property
    def is_solved(self) -> bool:
        return self.verdict is Verdict.SOLVED

    @property
    def modes(self) -> PlatformModes | None:
        """How the platform oscillates, winches braked; None unless solved, or of no known inertia.

        Computed when it is asked for, since it takes as long as half of the rest.
        """
        density = self.statics.weight_N_per_m / STANDARD_GRAVITY_M_PER_S2
        body = self.statics.robot.platform
        return modes_at(self.statics, body, density, cables_words(self.rope), STATIC.name)

    @property
    def is_too_weak(self) -> bool:
        """Whether the chosen rope is in balance here and beyond its allowable tension."""
        return self.is_solved and self.rope is not None and self.utilisation > 1.0

    @property
    def sentence(self) -> str:
        """The verdict for the reader; of a rope that is too weak here, that."""
        if self.is_too_weak:
            return (
                "The cables are in balance, but the rope is too weak here: its largest tension is "
                f"{100.0 * self.utilisation:.4g} % of the allowable one."
            )
        return self.verdict.sentence

    def curves_exaggerated_m(self, factor: float) -> FloatArray | None:
        """Return the shapes with their distance from the chords times a factor, None unless solved.

        For the eye alone. Each point is compared with the point of the chord at the same share of
        the length.
        """
        if self.curves_m is None:
            return None
        ends = self.curves_m[:, [0, -1]]
        share = np.linspace(0.0, 1.0, self.curves_m.shape[1])[:, None]
        straight = ends[:, :1] + share * (ends[:, 1:] - ends[:, :1])
        return np.asarray(straight + factor * (self.curves_m - straight))


def pose_answer(question: Question, *, settled: bool = False) -> PoseAnswer:
    """Solve the pose of a question.

    Where it has ``settled``, other places where the platform could rest on the same lengths are
    searched for as well, which takes longer.
    """
    robot, pose, rope = question.robot, question.pose, question.cable
    sizing = size_poses(robot, pose, question.material)
    statics, cable = sizing.statics, rope
    if rope is not None:
        statics = solve_sagging(robot, pose, rope)
    elif statics.is_solved:
        cable = question.material.cable(float(sizing.diameter_m))
    verdict = Verdict(int(statics.verdict))
    stays, stability, stiffness = None, "", np.nan
    if verdict is Verdict.SOLVED and cable is not None:
        softness = float(largest_displacement_m_per_N(statics))
        stays = bool(np.isfinite(softness))  # it is NaN where the balance is not stable
        stiffness = 1.0 / softness if stays else 0.0
        stability = "The platform rests here." if stays else "The platform would not stay here."
        if settled:
            rest = resting_places(robot, pose, cable, statics.length_m)
            stays, stability = rest.is_stable, rest.sentence
    cautions = (
        ["At rest, without the load cases of the study."] if question.study.load_cases else []
    )
    if statics.is_solved and statics.hangs_below:
        numbers = ", ".join(str(k + 1) for k in np.flatnonzero(statics.hanging_cables))
        hang = f"s {numbers} hang" if "," in numbers else f" {numbers} hangs"
        cautions.append(f"Cable{hang} below the platform.")
    allowable = np.nan if cable is None else cable.allowable_tension_N
    utilisation = np.asarray(statics.cable_tension_N / allowable)
    return PoseAnswer(
        verdict=verdict,
        rope=question.rope,
        cables=_cables(statics, utilisation) if verdict is Verdict.SOLVED else (),
        curves_m=cable_curves_m(statics) if verdict is Verdict.SOLVED else None,
        chords_m=chords_m(statics),
        diameter_m=float(sizing.diameter_m),
        max_tension_N=float(statics.largest_tension_N),
        utilisation=float(utilisation.max()),
        stiffness_N_per_m=stiffness,
        is_stable=stays,
        stability=stability,
        caution=" ".join(cautions),
        outside=question.outside,
        statics=statics,
    )


def _cables(statics: Statics, utilisation: FloatArray) -> tuple[CableReadout, ...]:
    figures = {
        "length_m": statics.length_m,
        "chord_m": statics.geometry().chord_m,
        "exit_tension_N": statics.exit_tension_N,
        "platform_tension_N": statics.platform_tension_N,
        "angle_rad": exit_angle_rad(statics),
        "sag_m": sag_m(statics),
        "stretch_m": stretch_m(statics),
        "utilisation": utilisation,
    }
    return tuple(
        CableReadout(
            number=k + 1,
            hangs_below=bool(hangs),
            **{name: float(values[k]) for name, values in figures.items()},
        )
        for k, hangs in enumerate(statics.hanging_cables)
    )


# The map


@dataclass(frozen=True, slots=True, eq=False)
class MapAnswer:
    """The map of a state."""

    #: (n, m, 3) positions [m], see `map_grids`; empty without a workspace
    grids: Mapping[str, FloatArray]
    #: (n_points,) of all points of the grids, one grid after the other, the values by the keys of
    #: `designer.explore.quantities`, SI, each position in the orientation that asks for the most
    #: there; NaN where there is none. Beside them, as 0 and 1, ``left_out`` (what the study leaves
    #: out) and, where it was asked for, ``unserved`` (what no rope serves that no other one beats).
    values: Values
    #: What tensions are of; None for the thinnest cable of the family at each pose
    rope: Rope | RopePerCable | None = None
    #: The same of the state that is compared with, at the same positions
    before: MapAnswer | None = None

    @property
    def positions_m(self) -> FloatArray:
        """All points of the grids (n_points, 3) [m]."""
        return np.concatenate([np.empty((0, 3)), *(g.reshape(-1, 3) for g in self.grids.values())])

    def points_of(self, grids: Iterable[str]) -> IntArray:
        ends = np.cumsum([grid[..., 0].size for grid in self.grids.values()])
        numbers = dict(zip(self.grids, np.split(np.arange(sum(ends[-1:])), ends[:-1]), strict=True))
        return np.concatenate([np.empty(0, dtype=int), *(numbers[name] for name in grids)])

    def on(self, grid: str, key: str) -> FloatArray:
        return self.values[key][self.points_of([grid])].reshape(self.grids[grid].shape[:2])

    def difference(self, key: str) -> FloatArray | None:
        """Return what a quantity has become less what it was (n_points,), SI; None without A.

        NaN where there is none in either state. Categories have no difference but whether they are
        another one, 1, or not, 0.
        """
        if self.before is None or key not in self.before.values:
            return None
        now, was = self.values[key], self.before.values[key]
        if key in BY_KEY and BY_KEY[key].is_category:
            both_nan = np.isnan(now) & np.isnan(was)
            return np.asarray((now != was) & ~both_nan, dtype=np.float64)
        return np.asarray(now - was)


def map_grids(region: Region, slice_share: float, *, fine: bool) -> Mapping[str, FloatArray]:
    """Return grids of positions (n, m, 3) [m], by their names.

    Of a prism its ``top``, ``bottom`` and ``wall``, and ``slice``, level, at a share of the height;
    of a rectangle ``section``; of a list ``points`` (n, 1, 3), thinned out where there are very
    many. Unless ``fine``, every second row and column.
    """
    grids = dict(region.outside_m(_RINGS, _SPOKES, _ROWS))
    if not grids:
        points = np.concatenate([*region.samples_m(MAX_POINTS, "grid", 0)])
        return {"points": points[:: -(-len(points) // MAX_POINTS)][:, None]}
    section = region.section_m(slice_share, _RINGS, _SPOKES)
    if section is not None and not region.is_upright:
        grids["slice"] = section
    return grids if fine else {name: grid[every_second(grid)] for name, grid in grids.items()}


def map_answer(
    question: Question,
    *,
    fine: bool = False,
    slice_share: float = 0.5,
    quantities: frozenset[str] = CHEAP,
    against: Question | None = None,
) -> MapAnswer:
    """Compute the map on `map_grids`, where it is asked for ``against`` another state as well.

    ``quantities`` are keys of what is needed, with ``unserved`` among them: the less, the quicker;
    what costs nothing more is there anyway.
    """
    if question.workspace is None:
        return MapAnswer({}, {}, question.rope)
    grids = map_grids(question.workspace.region, slice_share, fine=fine)
    positions_m, before = MapAnswer(grids, {}).positions_m, None
    if against is not None and against.workspace is not None:
        values = values_at(against, against.workspace, positions_m, quantities)
        before = MapAnswer(grids, values, against.rope)
    values = values_at(question, question.workspace, positions_m, quantities)
    return MapAnswer(grids, values, question.rope, before)


def values_at(
    question: Question, workspace: Workspace, positions_m: FloatArray, keys: frozenset[str]
) -> Values:
    """Return the quantities ``keys`` at positions (n, 3), each (n,); see `MapAnswer`."""
    step = max(_BATCH // workspace.orientations.count, 1)
    pieces = [
        _values(question, workspace, positions_m[at : at + step], keys)
        for at in range(0, len(positions_m), step)
    ]
    values = {key: np.concatenate([piece[key] for piece in pieces]) for key in pieces[0]}
    if "unserved" in keys:
        is_open = values["verdict"] != Verdict.OUTSIDE_HULL  # else no rope can
        values["unserved"] = np.ones(len(positions_m))
        values["unserved"][is_open] = unserved(question, workspace, positions_m[is_open])
    return values


def _values(
    question: Question, workspace: Workspace, positions_m: FloatArray, keys: frozenset[str]
) -> Values:
    cable, values = question.cable, {}
    if cable is None or "diameter" in keys:
        _, sizing = size_worst(question.robot, workspace, positions_m, question.material)
        statics, values["diameter"] = sizing.statics, sizing.diameter_m
    if cable is not None:
        statics = _solve_worst_orientation(question, workspace, positions_m, cable)
    utilisation = _utilisation(statics, cable)
    governing_cable = np.nan_to_num(utilisation, nan=-np.inf).argmax(axis=-1)
    values |= {
        "utilisation": utilisation.max(axis=-1),
        "tension": statics.largest_tension_N,
        "governing": np.where(statics.is_solved, governing_cable + 1.0, np.nan),
        "verdict": statics.verdict.astype(np.float64),
        "left_out": is_left_out(statics, workspace.hangs_below).astype(np.float64),
    }
    if "sag" in keys:
        with np.errstate(invalid="ignore"):
            values["sag"] = sag_ratio(statics).max(axis=-1)
    if "stiffness" in keys:
        softness = largest_displacement_m_per_N(statics)
        stays = np.where(np.isnan(softness), 0.0, 1.0 / softness)
        values["stiffness"] = np.where(statics.is_solved, stays, np.nan)
    if "frequency" in keys:
        density = statics.weight_N_per_m / STANDARD_GRAVITY_M_PER_S2
        values["frequency"] = frequencies_Hz(statics, question.robot.platform, density)
    return values


def _solve_worst_orientation(
    question: Question, workspace: Workspace, positions_m: FloatArray, cable: Cable | Cables
) -> Statics:
    """Solve positions (n, 3) with a rope, each in the orientation of its largest utilisation."""

    def demand(places: FloatArray) -> FloatArray:
        statics = solve_sagging(question.robot, Poses.at(places), cable)
        used = _utilisation(statics, cable).max(axis=-1)
        return demand_of(used, statics, workspace.hangs_below)

    places = at_worst_orientation(workspace.space, positions_m, demand)
    return solve_sagging(question.robot, Poses.at(places), cable)


def _utilisation(statics: Statics, cable: Cable | Cables | None) -> FloatArray:
    """Return largest over allowable tension of each cable (..., n_cables).

    That of the thinnest cable is 1, by definition.
    """
    tension = statics.cable_tension_N
    if cable is None:
        return np.asarray(tension / tension.max(axis=-1, keepdims=True))
    return np.asarray(tension / cable.allowable_tension_N)


def unserved(question: Question, workspace: Workspace, positions_m: FloatArray) -> BoolArray:
    """Tell which positions (n, 3) no rope serves, in one of the orientations asked for at least.

    Tried are the ropes that no other one beats, see `designer.selection.candidate.undominated`.
    What the study leaves out with some rope is not asked for.
    """
    is_unserved = np.ones(len(positions_m), dtype=np.bool_)
    count, below = workspace.orientations.count, workspace.hangs_below
    step = max(_BATCH // count, 1)
    strongest_first = sorted(
        (candidate.cable for candidate in undominated(question.candidates)),
        key=lambda cable: -cable.allowable_tension_N,
    )
    for cable in strongest_first:
        remaining = np.flatnonzero(is_unserved)
        for start in range(0, len(remaining), step):
            batch = remaining[start : start + step]
            poses = Poses.at(workspace.space.places(positions_m[batch]))
            statics = solve_sagging(question.robot, poses, cable)
            demand = demand_of(statics.largest_tension_N, statics, below).reshape(-1, count)
            is_unserved[batch] = (demand > cable.allowable_tension_N).any(axis=1)
    return is_unserved


@dataclass(frozen=True, slots=True, eq=False)
class WorstAnswer:
    """The worst poses of the region, searched for between the samples, as in the report."""

    workspace: WorkspaceMap  #: With the thinnest cable of the family for every pose
    rope: Verification | None  #: What the chosen rope meets; None where none is chosen
    #: (6,) what to mark: where the rope is used most, or is not held; without a rope, the pose that
    #: needs the thickest cable, or one that none holds [m, rad]. None where every pose is left out.
    place: FloatArray | None
    sentence: str  #: What that is

    @property
    def diameter_m(self) -> float | None:
        sizing = self.workspace.sagging
        return None if sizing is None else sizing.diameter_m

    @property
    def utilisation(self) -> float | None:
        return None if self.rope is None else self.rope.utilisation


def worst_answer(question: Question, reporter: Reporter = SILENT) -> WorstAnswer | None:
    """Search for the worst poses; None without a workspace."""
    workspace = question.workspace
    if workspace is None:
        return None
    family = question.study.material
    section_m = section_of_workspace(question.built, workspace, family)
    built = replace(question.built, section_m=section_m)
    with reporter.task("workspace", workspace.sample_count) as advance:
        chart = map_workspace(built.robot, workspace, built.material(family), progress=advance)
    if question.cable is None:
        return WorstAnswer(chart, None, *_worst_of_family(chart, question))
    of_case = ""
    if isinstance(question.rope, Rope):  # in all load cases, as the report does
        cases = Cases(question.robot, workspace, question.study.load_cases or (STATIC,))
        cables = [[question.cable_in(case, question.rope)] for case in cases.load_cases]
        (sampled,) = cases.sampled(cables, lambda _: None)
        searched = refine_all(sampled)
        case = governing(searched).case
        verification = envelope(searched)
        of_case = "" if case is STATIC else f" in the load case '{case.name}'"
    else:
        verification = _verify_groups(question, workspace, question.cable)
    place = verification.worst_place
    if not np.isfinite(place).all():
        return WorstAnswer(chart, verification, None, "The rope serves no pose.")
    if np.isinf(verification.utilisation):
        sentence = f"No equilibrium was found here with this rope{of_case}, for example."
    else:
        sentence = (
            f"The pose of the largest utilisation: {100.0 * verification.utilisation:.4g} % of the "
            f"allowable tension{of_case}."
        )
    return WorstAnswer(chart, verification, np.pad(place, (0, 6 - len(place))), sentence)


def _verify_groups(question: Question, workspace: Workspace, cable: Cable | Cables) -> Verification:
    """Return what the ropes of groups meet over the whole workspace."""
    robot = question.robot
    assert isinstance(cable, Cables)  # of one rope see above
    groups = verify_groups(robot, workspace, cable, [np.array([k]) for k in range(robot.n_cables)])
    worst = int(np.argmax(groups.utilisation))
    utilisation = float(groups.utilisation[worst])
    tension = utilisation * float(cable.allowable_tension_N[worst])
    unknown, place = np.full(robot.n_cables, np.nan), groups.worst_place[worst]
    return Verification(place, tension, utilisation, groups.longest_m, unknown, groups.is_refined)


def _worst_of_family(chart: WorkspaceMap, question: Question) -> tuple[FloatArray | None, str]:
    if chart.sagging is not None:
        needed = f"{1e3 * chart.sagging.diameter_m:.4g} mm"
        at_rest = " at rest, without the load cases" if question.study.load_cases else ""
        return chart.sagging.place, f"The pose that needs the thickest cable{at_rest}, {needed}."
    pose = chart.infeasible_pose
    if pose is None:
        return None, "Every pose is excluded."
    return pose.place, "No cable of the configured family holds the platform here, for example."


# The ropes


@dataclass(frozen=True, slots=True, eq=False)
class RopeRow:
    """One size of one grade, and what became of it."""

    grade: Grade  #: As the catalogue has them
    size: Size
    reason: str  #: Why it is the best, or falls out
    standing: str = "not_tried"  #: As `designer.selection.result.Standing`, or ``not_tried``
    #: With end fittings, bending and safety factor; NaN where it was not tried
    allowable_tension_N: float = math.nan
    #: What it meets over the workspace, and what ropes are compared by
    verification: Verification = NOT_TRIED
    figures: CandidateFigures = UNKNOWN
    is_rejected: bool = False  #: Whether it is known to fail a requirement beside strength

    @property
    def rope(self) -> Rope:
        return Rope(self.grade.id, self.size.id)

    @property
    def holds(self) -> bool:
        """Whether it is strong enough and fails nothing else, as far as it was looked at."""
        return self.verification.holds and not self.is_rejected

    @property
    def place(self) -> FloatArray | None:
        """Where it is used most (6,) [m, rad]; None where that is not known."""
        place = self.verification.worst_place
        return np.pad(place, (0, 6 - len(place))) if np.isfinite(place).all() else None


@dataclass(frozen=True, slots=True, eq=False)
class Ropes:
    """All ropes; of the full selection with the answer to the study."""

    rows: tuple[RopeRow, ...]  #: In the order of the catalogue
    best: Rope | None  #: The best by the study's objectives
    reason: str  #: Why none is
    #: Whether this is the full selection, as in the report; else what a part of the samples tells,
    #: which is no proof
    is_final: bool
    #: What groups of cables get, where the study has some and the selection is full
    groups: GroupChoice | None = None
    #: What plugins and grade files gave that could not be used, one line each
    problems: tuple[str, ...] = ()
    #: What is proved of the best, as in the report; None until the full selection, or for groups
    proof: Proof | None = None
    #: All that the study asks for, as in the report; none until the full selection
    requirements: tuple[Requirement, ...] = ()
    answer: Answer | None = None  #: What follows from them; None until the full selection
    #: What the answer covers and is subject to; None until the full selection
    terms: Terms | None = None

    def row(self, rope: Rope | RopePerCable | None) -> RopeRow | None:
        return next((row for row in self.rows if row.rope == rope), None)

    @property
    def assignment(self) -> RopePerCable | None:
        """The rope of each cable by its group, to be looked at; None where none was found."""
        if self.groups is None or not self.groups.chosen.is_found:
            return None
        ropes = self.groups.chosen.by_cable
        return RopePerCable(tuple(Rope(rope.grade.id, rope.size.id) for rope in ropes))

    @property
    def makers(self) -> tuple[str, ...]:
        return tuple(sorted({row.grade.manufacturer for row in self.rows}))

    @property
    def materials(self) -> tuple[str, ...]:
        return tuple(sorted({row.grade.material for row in self.rows if row.grade.material}))


def quick_ropes(question: Question) -> Ropes | None:
    """Return what a part of the samples tells of all ropes; None without a workspace."""
    workspace, selection = question.workspace, question.selection
    if workspace is None:
        return None
    sampled = replace(workspace, samples=min(workspace.samples, _QUICK_SAMPLES))
    grades, load_cases = question.catalogue.grades, question.study.load_cases
    candidates = at_samples(sampled, selection, grades, question.built, load_cases)
    objectives = [name for name in selection.objectives if name != "stiffness"]
    best, holding = None, [c for c in candidates if c.verification.holds and c.rejected_by is None]
    front = {id(c) for c in holding}
    if objectives and selection.objectives[0] != "stiffness":
        comparable = [c for c in holding if np.isfinite(c.figures.burden(objectives[0]))]
        best = min(comparable, key=lambda c: c.key(objectives), default=None)
        is_in_front = is_undominated(burdens(holding, objectives))
        front = {id(c) for c, is_in in zip(holding, is_in_front, strict=True) if is_in}
    rows = tuple(_quick_row(c, c is best, id(c) in front) for c in candidates)
    reason = "" if best else "none holds at the samples" if not holding else "needs the full search"
    chosen = None if best is None else Rope(best.grade.id, best.size.id)
    return Ropes(rows, chosen, reason, is_final=False, problems=question.catalogue.problems)


def _quick_row(candidate: Candidate, is_best: bool, is_in_front: bool) -> RopeRow:
    verification = candidate.verification
    if is_best:
        standing, reason = "chosen", "best at the samples"
    elif np.isinf(verification.utilisation):
        standing, reason = "not_held", "no equilibrium was found in some pose"
    elif not verification.holds:
        standing, reason = "too_thin", "beyond its allowable tension in some pose"
    elif (rejection := rejection_words(candidate)) is not None:
        standing, reason = "rejected", rejection
    elif is_in_front:
        standing, reason = "undominated", "holds at the samples; no other rope dominates it there"
    else:
        standing, reason = "dominated", "holds at the samples; another rope dominates it there"
    return _row(candidate, standing, reason)


def _row(candidate: Candidate, standing: str, reason: str) -> RopeRow:
    return RopeRow(
        candidate.grade,
        candidate.size,
        reason,
        standing,
        candidate.cable.allowable_tension_N,
        candidate.verification,
        candidate.figures,
        candidate.rejected_by is not None,
    )


def full_ropes(question: Question, reporter: Reporter = SILENT) -> Ropes:
    """Answer the study, choose among all ropes, and prove the best, by the pipeline of the report.

    Where the study asks for no rope, ropes are chosen as usual, and the answer is without them. No
    rows without a workspace.
    """
    study, catalogue = question.study, question.catalogue
    analysis = of_ropes = Analysis.begin(study, catalogue, reporter=reporter)
    if study.workspace is not None and study.selection is None:
        asking = replace(study, selection=question.selection)
        of_ropes = Analysis.begin(asking, catalogue, reporter=reporter)
    ropes = Ropes((), None, "", is_final=True)
    if of_ropes.selection is not None:
        ropes = ropes_of(of_ropes.selection, of_ropes.groups)
    return _answered(replace(ropes, problems=catalogue.problems), analysis)


def requirements_alone(question: Question) -> Ropes:
    """Answer a study that asks for no rope; no rows."""
    analysis = Analysis.begin(question.study, question.catalogue)
    return _answered(Ropes((), None, "", is_final=True), analysis)


def _answered(ropes: Ropes, analysis: Analysis) -> Ropes:
    """Return the ropes with the answer to the study, and what it covers."""
    answer, terms = analysis.answer, analysis.terms
    return replace(ropes, requirements=analysis.requirements, answer=answer, terms=terms)


def ropes_of(selection: SelectionResult, groups: GroupChoice | None = None) -> Ropes:
    chosen = selection.chosen
    rows = [_row(c, c.standing, c.reason) for c in selection.candidates]
    rows += [
        RopeRow(omitted.grade, size, omitted.reason)
        for omitted in selection.not_tried
        for size in omitted.sizes
    ]
    return Ropes(
        rows=tuple(rows),
        best=None if chosen is None else Rope(chosen.grade.id, chosen.size.id),
        reason=selection.reason or "",
        is_final=True,
        groups=groups,
        proof=selection.proof,
    )


# Two states


@dataclass(frozen=True, slots=True, eq=False)
class Pin:
    """A state with what was known of it; None for what was not yet."""

    question: Question
    fields: tuple[Field, ...]
    pose: PoseAnswer | None = None
    worst: WorstAnswer | None = None
    ropes: Ropes | None = None

    @property
    def best(self) -> RopeRow | None:
        return None if self.ropes is None else self.ropes.row(self.ropes.best)


@dataclass(frozen=True, slots=True)
class Change:
    """What reads otherwise in the two states, empty for what is not there."""

    title: str
    before: str
    after: str
    difference: float | None = None  #: After less before, NaN if not known; None of no figure
    unit: str = ""

    @property
    def difference_text(self) -> str:
        if self.difference is None or math.isnan(self.difference):
            return "" if self.difference is None else fmt.MISSING
        text = fmt.number(self.difference, 3)
        has_sign = text.startswith("−") or self.difference == 0.0
        return f"{'' if has_sign else '+'}{text} {self.unit}"


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """What has become otherwise."""

    #: Values of the study, the rope that is looked at, the verdict, the best rope
    changes: tuple[Change, ...]
    figures: tuple[Change, ...]  #: Figures of the answer, those that are the same among them
    gained: tuple[Rope, ...]  #: Ropes that hold now and did not, and the other way round
    lost: tuple[Rope, ...]
    #: Whether the ropes of both were found in the same way; else a part of the differences is that
    #: one is the full selection, and the other what some samples tell
    is_like_with_like: bool


# Title, unit, what leads to it from SI, and the figure of a state; None where it is not known
_FIGURES: tuple[tuple[str, str, float, Callable[[Pin], float | None]], ...] = (
    ("Diameter needed here", "mm", 1e3, lambda p: p.pose.diameter_m if p.pose else None),
    ("Largest tension here", "kN", 1e-3, lambda p: p.pose.max_tension_N if p.pose else None),
    ("Utilisation here", "%", 100.0, lambda p: p.pose.utilisation if p.pose else None),
    ("Stiffness here", "kN/m", 1e-3, lambda p: p.pose.stiffness_N_per_m if p.pose else None),
    ("Diameter needed at worst", "mm", 1e3, lambda p: p.worst.diameter_m if p.worst else None),
    ("Utilisation at worst", "%", 100.0, lambda p: p.worst.utilisation if p.worst else None),
    (
        "Mass of all cables, best rope",
        "kg",
        1.0,
        lambda p: p.best.figures.mass_kg if p.best else None,
    ),
)


def compare(before: Pin, after: Pin) -> Differences:
    """Return what has become otherwise; what is not known of one of the states is left out."""
    held, holds = (
        {row.rope: row.holds for row in pin.ropes.rows} if pin.ropes else {}
        for pin in (before, after)
    )
    both = [rope for rope in holds if rope in held]
    finals = {pin.ropes.is_final for pin in (before, after) if pin.ropes}
    return Differences(
        changes=tuple(_changes(before, after)),
        figures=tuple(_figures(before, after)),
        gained=tuple(rope for rope in both if holds[rope] and not held[rope]),
        lost=tuple(rope for rope in both if held[rope] and not holds[rope]),
        is_like_with_like=len(finals) < 2,
    )


def _changes(before: Pin, after: Pin) -> Iterator[Change]:
    was, now = ({field.path: field for field in pin.fields} for pin in (before, after))
    for path in dict.fromkeys([*was, *now]):
        old, new = was.get(path), now.get(path)
        if (old and old.meaning) != (new and new.meaning):
            title = (new or old).label  # type: ignore[union-attr]
            yield Change(title, old.text if old else "", new.text if new else "")
    words = {
        "Rope": [_label(pin.question.rope) for pin in (before, after)],
        "Verdict": [pin.pose.sentence if pin.pose else "" for pin in (before, after)],
        "Best rope": [_label(pin.best.rope if pin.best else None) for pin in (before, after)],
    }
    for title, (old_text, new_text) in words.items():
        if old_text != new_text:
            yield Change(title, old_text, new_text)


def _label(rope: Rope | RopePerCable | None) -> str:
    return "" if rope is None else rope.label


def _figures(before: Pin, after: Pin) -> Iterator[Change]:
    for title, unit, scale, figure in _FIGURES:
        was, now = figure(before), figure(after)
        if was is not None and now is not None:
            texts = [
                fmt.MISSING if math.isnan(value) else f"{fmt.number(scale * value, 4)} {unit}"
                for value in (was, now)
            ]
            yield Change(title, texts[0], texts[1], scale * (now - was), unit)
