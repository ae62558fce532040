"""The map: every quantity at every point of the grids, and the worst pose of the region."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.explore.quantities import BY_KEY, CHEAP
from designer.explore.question import Question, Rope, RopePerCable
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable, Cables
from designer.model.load_case import STATIC
from designer.model.region import Region
from designer.model.rings import every_second
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.progress import SILENT, Reporter
from designer.selection.candidate import undominated
from designer.selection.cases import Cases, governing, searched_all, together
from designer.selection.groups.trials import verify_groups
from designer.selection.verify import Verification
from designer.statics.inverse import Statics, sag_ratio, solve_sagging
from designer.statics.modes import frequencies_Hz
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.workspace.demand import at_worst_orientation, demand_of, is_left_out, size_worst
from designer.workspace.section import section_of_workspace
from designer.workspace.sweep import WorkspaceMap, map_workspace

_PIECE = 2**12
"""Places in one call of the solver: what a pose that is waited for has to wait at most."""
_MOST_POINTS = 3000
"""Of a list of points: as many as are told apart on a screen."""
_RINGS, _SPOKES, _ROWS = 45, 120, 24
"""Of a fine grid: its faces are a few pixels wide."""
Values = Mapping[str, FloatArray]
"""By the key of the quantity, SI; NaN where a place has none."""


@dataclass(frozen=True, slots=True, eq=False)
class MapAnswer:
    """The map of a state.

    Parameters
    ----------
    grids : mapping of str to array (n, m, 3)
        Positions [m], see `map_grids`; empty without a workspace.
    values : mapping of str to array (n_points,)
        Of all points of the grids, one grid after the other, the values by the keys of
        `designer.explore.quantities`, SI, each position in the orientation that asks for the most
        there; NaN where there is none. Beside them, as 0 and 1, ``left_out`` (what the study leaves
        out) and, where it was asked for, ``unserved`` (what no rope serves that no other one
        beats).
    rope : Rope, RopePerCable or None
        What tensions are of; None for the thinnest cable of the family at each pose.
    before : MapAnswer or None
        The same of the state that is compared with, at the same positions.
    """

    grids: Mapping[str, FloatArray]
    values: Values
    rope: Rope | RopePerCable | None = None
    before: MapAnswer | None = None

    @property
    def positions_m(self) -> FloatArray:
        """All points of the grids (n_points, 3) [m]."""
        return np.concatenate([np.empty((0, 3)), *(g.reshape(-1, 3) for g in self.grids.values())])

    def points_of(self, grids: Iterable[str]) -> IntArray:
        """Return the numbers of the points of some grids."""
        ends = np.cumsum([grid[..., 0].size for grid in self.grids.values()])
        numbers = dict(zip(self.grids, np.split(np.arange(sum(ends[-1:])), ends[:-1]), strict=True))
        return np.concatenate([np.empty(0, dtype=int), *(numbers[name] for name in grids)])

    def on(self, grid: str, key: str) -> FloatArray:
        """Return the values of a quantity on a grid (n, m)."""
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
        points = np.concatenate([*region.samples_m(_MOST_POINTS, "grid", 0)])
        return {"points": points[:: -(-len(points) // _MOST_POINTS)][:, None]}
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
    """Compute the map.

    Parameters
    ----------
    fine, slice_share
        Of the grids, see `map_grids`.
    quantities : frozenset of str
        Keys of what is asked for, with ``unserved`` among them; what costs nothing more is there
        as well. The less, the quicker.
    against : Question, optional
        A state to compare with, at the same positions.
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
    step = max(_PIECE // workspace.orientations.count, 1)
    pieces = [
        _values(question, workspace, positions_m[at : at + step], keys)
        for at in range(0, len(positions_m), step)
    ]
    found = {key: np.concatenate([piece[key] for piece in pieces]) for key in pieces[0]}
    if "unserved" in keys:
        proved = found["verdict"] == Verdict.OUTSIDE_HULL
        left = unserved(question, workspace, positions_m[~proved])
        found["unserved"] = np.ones(len(positions_m))
        found["unserved"][~proved] = left
    return found


def _values(
    question: Question, workspace: Workspace, positions_m: FloatArray, keys: frozenset[str]
) -> Values:
    cable, found = question.cable, {}
    if cable is None or "diameter" in keys:
        _, sizing = size_worst(question.robot, workspace, positions_m, question.material)
        statics, found["diameter"] = sizing.statics, sizing.diameter_m
    if cable is not None:
        statics = _worst_with(question, workspace, positions_m, cable)
    used = _used(statics, cable)
    governing_cable = np.nan_to_num(used, nan=-np.inf).argmax(axis=-1)
    found |= {
        "utilisation": used.max(axis=-1),
        "tension": statics.largest_tension_N,
        "governing": np.where(statics.is_solved, governing_cable + 1.0, np.nan),
        "verdict": statics.verdict.astype(np.float64),
        "left_out": is_left_out(statics, workspace.hangs_below).astype(np.float64),
    }
    if "sag" in keys:
        with np.errstate(invalid="ignore"):
            found["sag"] = sag_ratio(statics).max(axis=-1)
    if "stiffness" in keys:
        softness = largest_displacement_m_per_N(statics)
        stays = np.where(np.isnan(softness), 0.0, 1.0 / softness)
        found["stiffness"] = np.where(statics.is_solved, stays, np.nan)
    if "frequency" in keys:
        density = statics.weight_N_per_m / STANDARD_GRAVITY_M_PER_S2
        platform = question.robot.platform
        found["frequency"] = frequencies_Hz(statics, platform, density)
    return found


def _worst_with(
    question: Question, workspace: Workspace, positions_m: FloatArray, cable: Cable | Cables
) -> Statics:
    """Solve positions (n, 3) with a rope, each in the orientation in which it is used most."""
    robot, space = question.robot, workspace.space
    places = space.places(positions_m)
    statics = solve_sagging(robot, Poses.at(places), cable)
    if space.orientations.count == 1:
        return statics
    asked = demand_of(_used(statics, cable).max(axis=-1), statics, workspace.hangs_below)
    return solve_sagging(robot, Poses.at(at_worst_orientation(space, places, asked)), cable)


def _used(statics: Statics, cable: Cable | Cables | None) -> FloatArray:
    """Return largest over allowable tension of each cable (..., n_cables).

    The thinnest cable is used up to its limit, by definition.
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
    left = np.ones(len(positions_m), dtype=np.bool_)
    count = workspace.orientations.count
    strongest_first = sorted(
        undominated(question.candidates),
        key=lambda candidate: -candidate.cable.allowable_tension_N,
    )
    for candidate in strongest_first:
        at = np.flatnonzero(left)
        if not len(at):
            break
        for start in range(0, len(at), max(_PIECE // count, 1)):
            some = at[start : start + max(_PIECE // count, 1)]
            poses = Poses.at(workspace.space.places(positions_m[some]))
            statics = solve_sagging(question.robot, poses, candidate.cable)
            allowable = candidate.cable.allowable_tension_N
            used = demand_of(statics.largest_tension_N, statics, workspace.hangs_below)
            left[some] = (used.reshape(-1, count) > allowable).any(axis=1)
    return left


@dataclass(frozen=True, slots=True, eq=False)
class WorstAnswer:
    """The worst poses of the region, searched for between the samples, as in the report.

    Parameters
    ----------
    workspace : WorkspaceMap
        With the thinnest cable of the family for every pose.
    rope : Verification or None
        What the chosen rope meets; None where none is chosen.
    place : array (6,) or None
        What to mark: where the rope is used most, or is not held; without a rope, the pose that
        needs the thickest cable, or one that none holds [m, rad]. None where every pose is left
        out.
    sentence : str
        What that is.
    """

    workspace: WorkspaceMap
    rope: Verification | None
    place: FloatArray | None
    sentence: str


def worst_answer(question: Question, reporter: Reporter = SILENT) -> WorstAnswer | None:
    """Search for the worst poses; None without a workspace."""
    workspace = question.workspace
    if workspace is None:
        return None
    built = question.built
    section_m = section_of_workspace(built, workspace, question.study.material)
    built = replace(built, section_m=section_m)
    with reporter.task("workspace", workspace.sample_count) as advance:
        material = built.material(question.study.material)
        found = map_workspace(built.robot, workspace, material, progress=advance)
    if question.cable is None:
        return WorstAnswer(found, None, *_worst_of_family(found, question))
    if isinstance(question.rope, Rope):
        met, case = _met_in_cases(question, workspace, question.rope)
    else:
        met, case = _met(question, workspace, question.cable), ""
    return WorstAnswer(found, met, *_worst_of_rope(met, case))


def _met_in_cases(question: Question, workspace: Workspace, rope: Rope) -> tuple[Verification, str]:
    """Return what a rope meets in all load cases, and that which governs; as the report does."""
    cases = Cases(question.robot, workspace, question.study.load_cases or (STATIC,))
    cables = [[question.cable_in(case, rope)] for case in cases.each]
    (found,) = cases.sampled(cables, lambda _: None)
    found = searched_all(found)
    case = governing(found).case
    return together(found), "" if case is STATIC else f" in the load case '{case.name}'"


def _met(question: Question, workspace: Workspace, cable: Cable | Cables) -> Verification:
    """Return what the ropes of groups meet over the whole workspace."""
    robot = question.robot
    assert isinstance(cable, Cables)  # of one rope see above
    one_each = [np.array([k]) for k in range(robot.n_cables)]
    met = verify_groups(robot, workspace, cable, one_each)
    worst = int(np.argmax(met.utilisation))
    used = float(met.utilisation[worst])
    tension = used * float(cable.allowable_tension_N[worst])
    unknown = np.full(robot.n_cables, np.nan)
    place = met.worst_place[worst]
    return Verification(place, tension, used, met.longest_m, unknown, met.is_refined)


def _worst_of_family(found: WorkspaceMap, question: Question) -> tuple[FloatArray | None, str]:
    if found.sagging is not None:
        needed = f"{1e3 * found.sagging.diameter_m:.4g} mm"
        at_rest = " at rest, without the load cases" if question.study.load_cases else ""
        return found.sagging.place, f"The pose that needs the thickest cable{at_rest}, {needed}."
    pose = found.infeasible_pose
    if pose is None:
        return None, "Every pose is left out."
    return pose.place, "No cable of the configured family holds the platform here, for example."


def _worst_of_rope(met: Verification, case: str) -> tuple[FloatArray | None, str]:
    place = met.worst_place
    if not np.isfinite(place).all():
        return None, "The rope serves no pose."
    place = np.pad(place, (0, 6 - len(place)))
    if np.isinf(met.utilisation):
        return place, f"No equilibrium was found here with this rope{case}, for example."
    percent = f"{100.0 * met.utilisation:.4g} %"
    return (
        place,
        f"The pose in which the rope is used most, {percent} of its allowable tension{case}.",
    )
