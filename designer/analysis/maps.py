"""The values that figures show, over the region and beyond, each computed once for all of them.

Sizing at positions and the shape of cables; the way from the middle of the region outward to the
first pose that is not held; maps of the family and of a rope; where sizes of one grade serve;
stiffness, frequency and clearance over a level section.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.governing import GoverningRopes
from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.model import polygon
from designer.model.polygon import every_second
from designer.model.region import CHUNK, Prism, Region
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict, are_open
from designer.model.workspace import Workspace
from designer.physics import catenary
from designer.selection.assignment import Qualities
from designer.selection.result import CoveredSize, SizeCoverage
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, solve_massless, solve_sagging
from designer.statics.modes import frequencies_Hz, knows_inertia
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.study import Study, as_built_by
from designer.workspace.clearance import smallest_clearance
from designer.workspace.demand import (
    at_worst_orientation,
    demand_of,
    diameter_demand,
    is_counted,
    is_left_out,
)
from designer.workspace.sweep import WorkspaceMap, columns

_RTOL = 1e-7
"""Error of a limit over the way to the edge; nearer it is not proved that no cable holds."""
_MAX_POINTS = 3000
_RINGS, _SPOKES = 45, 120
"""Half as fine as the maps of the family: a pose of a rope costs more than a size."""
_MAX_SIZES = 5
_EXCLUDED = 1e3
"""Utilisation of a pose that cannot be held or does not count."""
_MAX_SOLVED, _MAX_SEARCHED = 2e5, 2e4
"""Poses that are solved at most, and where each may have several branches, which are searched."""
_MIN_ROWS = 8
"""Of the largest grid."""


@dataclass(frozen=True, slots=True, eq=False)
class RegionField:
    """Sizing at positions over any axes; NaN where there is no value."""

    position_m: FloatArray  #: (..., 3) positions of the platform [m]
    diameter_m: FloatArray  #: (...) needed diameter with sag [m]
    tension_N: FloatArray  #: (...) largest tension with that diameter [N]
    massless_diameter_m: FloatArray  #: (...) the same with straight weightless cables
    massless_tension_N: FloatArray
    #: (...) largest vertical pull of any cable down on the platform, over the platform's weight;
    #: above zero that cable hangs below the platform
    uplift: FloatArray
    verdict: VerdictArray  #: (...) one `Verdict` a position
    is_left_out: BoolArray  #: (...) whether the study leaves the position out
    utilisation: FloatArray | None = None  #: (...) of a given rope; the diameters are NaN then

    @property
    def is_solved(self) -> BoolArray:
        """Positions (...) where a cable of the family holds the platform."""
        return np.asarray(self.verdict == Verdict.SOLVED)

    @property
    def is_held_straight(self) -> BoolArray:
        """Positions (...) that straight weightless cables hold as well."""
        return np.asarray(self.is_solved & ~np.isnan(self.massless_tension_N))

    @property
    def counts(self) -> BoolArray:
        """Positions (...) that have a value and are not left out."""
        return np.asarray(self.is_solved & ~self.is_left_out)

    @property
    def is_infeasible(self) -> BoolArray:
        """Positions (...) that the study asks for and no cable of the family can hold."""
        return np.asarray(~self.is_solved & ~self.is_left_out)

    @property
    def why_infeasible(self) -> str:
        """What keeps the platform from being held, in a few words; empty if nothing does."""
        reasons = {int(verdict) for verdict in self.verdict[self.is_infeasible]}
        if len(reasons) > 1:
            return "no cable holds the platform"
        return "".join(Verdict(reason).reason for reason in reasons)

    def every_second(self) -> RegionField:
        """Return every second point along both axes of a grid, its rim kept."""
        rows = every_second(self.position_m)
        values: dict[str, Any] = {
            item.name: None if value is None else value[rows]
            for item in fields(self)
            for value in [getattr(self, item.name)]
        }
        return RegionField(**values)


def field_at(study: Study, position_m: FloatArray) -> RegionField:
    """Size the positions (..., 3) of a study's workspace, each in its worst orientation."""
    workspace = study.workspace
    if workspace is None:
        return field_of(study, position_m)
    flat, axes = position_m.reshape(-1, 3), position_m.shape[:-1]
    demand = partial(diameter_demand, study.robot, study.material, workspace.hangs_below)
    worst = [
        at_worst_orientation(workspace.space, flat[at : at + CHUNK], demand)
        for at in range(0, len(flat), CHUNK)
    ]
    return field_of(study, np.concatenate(worst).reshape(*axes, -1))


def field_of(study: Study, place: FloatArray) -> RegionField:
    """Size the places (..., n_coordinates) of a study's workspace."""
    sizing = size_poses(study.robot, Poses.at(place), study.material)
    hangs_below = study.workspace.hangs_below if study.workspace else "include"
    return RegionField(
        position_m=place[..., :3],
        diameter_m=sizing.diameter_m,
        tension_N=sizing.statics.largest_tension_N,
        massless_diameter_m=sizing.massless_diameter_m,
        massless_tension_N=sizing.massless_tension_N,
        uplift=sizing.statics.force_z_N.max(axis=-1) / study.robot.weight_N,
        verdict=sizing.statics.verdict,
        is_left_out=is_left_out(sizing.statics, hangs_below),
    )


def cable_curves_m(statics: Statics, count: int = 81) -> FloatArray:
    """Return the true shape of every cable of one solved pose (n_cables, count, 3) [m].

    Evenly spaced along the unstrained length, from where the cable leaves the base to the
    platform.
    """
    length = statics.free_length_m[:, None]
    with np.errstate(invalid="ignore"):
        x, z = catenary.position_m(
            np.linspace(0.0, 1.0, count) * length,
            length,
            statics.force_x_N[:, None],
            statics.force_z_N[:, None],
            statics.axial_stiffness_N[:, None],
            statics.weight_N_per_m[:, None],
        )
    plan = statics.geometry().outward[:, None, :] * x[..., None]
    shape = np.concatenate([plan, z[..., None]], axis=-1)
    upright = statics.run.exit_points_m[:, None, :] + shape
    return np.asarray(upright @ statics.robot.upright)


def chords_m(statics: Statics) -> FloatArray:
    """Return the straight lines from exit points to attachment points (n_cables, 2, 3) [m].

    For any pose, solved or not; pulleys are left out.
    """
    ends = statics.poses.attachment_points_m(statics.robot)
    return np.stack([statics.robot.exit_points_m, ends], axis=1)


def body_lines_m(statics: Statics) -> list[FloatArray]:
    """Return lines (2, 3) between all attachment points; none for a point mass [m]."""
    if statics.robot.is_point_mass:
        return []
    corners = statics.poses.attachment_points_m(statics.robot)
    return [np.stack(pair) for pair in combinations(corners, 2)]


@dataclass(frozen=True, slots=True, eq=False)
class Sag:
    """The largest sag among the cables of a pose."""

    cable: int  #: which cable, from 0
    on_chord_m: FloatArray  #: (3,) on the straight line [m]
    on_cable_m: FloatArray  #: (3,) on the cable, square to the line [m]

    @property
    def depth_m(self) -> float:
        """How far the cable strays from the straight line [m]."""
        return float(np.linalg.norm(self.on_chord_m - self.on_cable_m))


def largest_sag(statics: Statics) -> Sag:
    """Return where a cable of a solved pose strays farthest from its chord."""
    curves = cable_curves_m(statics, 401)
    chord = curves[:, -1] - curves[:, 0]
    along = chord / np.linalg.norm(chord, axis=1, keepdims=True)
    offset = curves - curves[:, :1]
    on_chord = curves[:, :1] + np.einsum("cnk,ck->cn", offset, along)[..., None] * along[:, None]
    depth = np.linalg.norm(curves - on_chord, axis=2)
    cable, place = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return Sag(int(cable), on_chord[cable, place], curves[cable, place])


@dataclass(frozen=True, slots=True, eq=False)
class EdgeProfile:
    """Sizing along a level line from the centre of the region to the hull of the exit points."""

    #: (n,) distance to the hull's edge along the line, descending to zero [m]
    distance_m: FloatArray
    field: RegionField  #: sizing at these positions (n,)
    focus_distance_m: float  #: distance of the pose that the line was laid through [m]
    #: where the line leaves the region [m]; None for a list of points
    region_distance_m: float | None
    #: where the first pose that is not held lies, on the way outward [m]; farther out some may be
    #: held again. None where all are held, and where the centre is not.
    limit_distance_m: float | None
    #: where the first pose lies that straight cables cannot hold, so that a cable has to hang as a
    #: counterweight [m]; None as above
    straight_distance_m: float | None = None

    @property
    def holds_again(self) -> bool:
        """Whether poses beyond the first that is not held are held."""
        return bool((self._beyond == Verdict.SOLVED).any())

    @property
    def is_proved(self) -> bool:
        """Whether no cable can hold what is not held beyond the limit, instead of none found."""
        return not are_open(self._beyond).any()

    @property
    def _beyond(self) -> VerdictArray:
        limit = -np.inf if self.limit_distance_m is None else self.limit_distance_m
        return self.field.verdict[self.distance_m < limit]

    @property
    def stretches_not_held_m(self) -> list[tuple[float, float]]:
        """Distances at which each stretch of poses that are not held starts and stops [m]."""
        x, failed = self.distance_m, ~self.field.is_solved
        changes = np.flatnonzero(np.diff(failed)) + 1
        between = 0.5 * (x[changes - 1] + x[changes])
        if self.limit_distance_m is not None:
            between[0] = self.limit_distance_m
        ends = [*x[:1][failed[:1]].tolist(), *between.tolist(), *([0.0] if failed[-1] else [])]
        return list(zip(ends[::2], ends[1::2], strict=True))


def edge_profile(study: Study, focus_m: FloatArray) -> EdgeProfile | None:
    """Size the level line from the centre of the region through a pose to the edge of the hull.

    The line runs at the height of ``focus_m`` (3,) [m], and through it; where that lies in the
    centre, to the nearest edge. None where the centre of the region lies outside the hull of the
    exit points, the region or the robot lies in an upright plane, or things do not fall along z.
    """
    assert study.workspace is not None
    region = study.workspace.region
    is_tilted = study.robot.gravity_direction[:2].any()
    if region.is_upright or study.robot.is_planar or is_tilted:
        return None
    hull = Prism.over(study.robot.exit_points_m, 0.0, (0.0, 0.0)).polygon_m
    centre = region.centre_m
    if not Prism(hull, (-1.0, 1.0)).contains(np.array([*centre, 0.0])):
        return None
    offset = focus_m[:2] - centre
    if np.hypot(*offset) > 1e-6 * np.ptp(hull, axis=0).max():
        azimuth = float(np.arctan2(offset[1], offset[0]))
    else:  # the focus is in the centre: to the nearest edge
        around = np.linspace(-np.pi, np.pi, 361)
        azimuth = float(around[np.argmin([polygon.reach_m(hull, centre, a) for a in around])])
    reach = polygon.reach_m(hull, centre, azimuth)
    ray = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])

    def at(distance_m: FloatArray) -> RegionField:
        start = np.array([*centre, focus_m[2]])
        return field_at(study, start + (reach - distance_m)[:, None] * ray)

    distance = reach * np.linspace(1.0, 0.0, 400) ** 2  # denser toward the edge
    field = at(distance)
    inside = region.reach_m(centre, azimuth)
    return EdgeProfile(
        distance_m=distance,
        field=field,
        focus_distance_m=reach - float(np.hypot(*offset)),
        region_distance_m=None if inside is None else reach - inside,
        limit_distance_m=first_failure_m(at, distance, field, lambda stretch: stretch.is_solved),
        straight_distance_m=first_failure_m(
            at, distance, field, lambda stretch: stretch.is_held_straight
        ),
    )


def first_failure_m(
    at: Callable[[FloatArray], RegionField],
    distance_m: FloatArray,
    field: RegionField,
    is_held: Callable[[RegionField], BoolArray],
) -> float | None:
    """Return where the first pose that is not held lies, on the way outward [m].

    Bisects between two of the descending distances (n,) [m], ``field`` being that at all of them.
    None where all poses are held, and where the first is not.
    """
    from scipy.optimize import bisect

    failed = np.flatnonzero(~is_held(field))
    if len(failed) == 0 or failed[0] == 0:
        return None

    def sign(distance_m: float) -> float:
        return 1.0 if is_held(at(np.array([distance_m])))[0] else -1.0

    ends = distance_m[failed[0] - 1], distance_m[failed[0]]
    return float(bisect(sign, *ends, xtol=_RTOL * distance_m[0]))


@dataclass(frozen=True, slots=True, eq=False)
class Focus:
    """The pose that the figures of a workspace turn to."""

    position_m: FloatArray  #: (3,) where it is [m]
    label: str  #: what it is, such as ``worst pose``
    #: equilibrium there with the cable that it needs; None where there is none
    statics: Statics | None
    field: RegionField  #: sizing there, no axes


@dataclass(frozen=True, slots=True, eq=False)
class CoverageCurve:
    """What share of the workspace a cable of a given diameter serves."""

    diameter_m: FloatArray  #: (n,) ascending [m]
    share: FloatArray  #: (n,) of all poses that need no more
    massless_diameter_m: FloatArray  #: (n,) the same if sag is ignored
    massless_share: FloatArray
    unserved: float  #: share of the poses that no diameter serves
    needed_m: float  #: the continuous optimum, refined beyond the samples [m]; NaN if there is none
    massless_needed_m: float  #: the same if sag is ignored [m]; NaN if there is none
    samples: int  #: number of poses that the shares are taken from


@dataclass(frozen=True, slots=True, eq=False)
class WorkspaceMaps:
    """All that the figures of a workspace show."""

    study: Study  #: the problem, with robot and cables as they were solved, see `as_built`
    focus: Focus  #: the worst pose, or what stands for it
    #: the region at its greatest height (rings, spokes + 1), see `Region.section_m`; a rectangle
    #: itself; for a list of points the points themselves (n_points,), thinned out where there are
    #: very many
    section: RegionField
    #: outside of the region and two cuts, see `Region.cutaway_m`; of a rectangle the section; empty
    #: for a list of points
    shell: Mapping[str, RegionField]
    #: along the line from the centre through the focus to the hull of the exit points; None where
    #: the centre lies outside that hull
    edge: EdgeProfile | None
    coverage: CoverageCurve  #: share of the workspace over diameter
    #: (n, 3, 3) triangles in which the part ends that is proved to be served by no rope [m]
    impossible_m: FloatArray

    @property
    def workspace(self) -> Workspace:
        """The workspace of the study."""
        assert self.study.workspace is not None
        return self.study.workspace

    @property
    def region(self) -> Region:
        """The region of the study's workspace."""
        return self.workspace.region

    @property
    def has_area(self) -> bool:
        """Whether the region is more than a list of points."""
        return bool(self.shell)

    @property
    def shown(self) -> Sequence[RegionField]:
        """All fields that are seen in space."""
        return [*self.shell.values()] or [self.section]

    @property
    def is_upright(self) -> bool:
        """Whether the section is upright, and not level."""
        return self.region.is_upright or self.study.robot.is_planar

    @property
    def across(self) -> FloatArray:
        """Unit vector (3,) to the right in maps of the section."""
        if self.region.is_upright:
            return np.append(self.region.along, 0.0)
        upright = self.study.robot.upright if self.is_upright else np.eye(3)
        return np.asarray(upright[0])

    def flat_m(self, points_m: FloatArray) -> FloatArray:
        """Return where points (..., 3) lie in maps of the section (..., 2) [m]."""
        up = np.array([0.0, 0.0, 1.0] if self.is_upright else [0.0, 1.0, 0.0])
        return np.asarray(points_m @ np.stack([self.across, up]).T)

    @property
    def axis_labels(self) -> tuple[str, str]:
        """What the axes of such maps are."""
        main = int(np.argmax(self.across))
        is_axis = bool(self.across[main] > 1.0 - 1e-9)
        right = f"{'xyz'[main]} [m]" if is_axis else "along the plane [m]"
        return right, "z [m]" if self.is_upright else "y [m]"

    def thinned(self) -> WorkspaceMaps:
        """Return the same with every second point of the shell, for a smaller scene."""
        shell = {name: field.every_second() for name, field in self.shell.items()}
        return replace(self, shell=shell)


def workspace_maps(analysis: Analysis) -> WorkspaceMaps:
    """Compute what the figures of a workspace show, its sweep file in place.

    Raises
    ------
    ValueError
        If the analysis has no workspace.
    """
    study, survey = as_built(analysis.study, analysis.section_m), analysis.workspace
    if survey is None or survey.file is None:
        raise ValueError("the analysis has no workspace")
    region, part = survey.workspace.region, analysis.servable
    focus = _focus(study, survey)
    shell: Mapping[str, RegionField]
    positions = region.section_m()
    if positions is not None:
        section = field_at(study, positions)
        pieces = region.cutaway_m(focus.position_m)
        shell = {
            name: section if region.is_upright else field_at(study, grid)
            for name, grid in pieces.items()
        }
    else:
        points = np.concatenate([*region.samples_m(_MAX_POINTS, "grid", 0)])
        section, shell = field_at(study, points[:: -(-len(points) // _MAX_POINTS)]), {}
    return WorkspaceMaps(
        study=study,
        focus=focus,
        section=section,
        shell=shell,
        edge=edge_profile(study, focus.position_m),
        coverage=coverage_curve(survey.file, survey),
        impossible_m=np.empty((0, 3, 3)) if part is None else part.border_m,
    )


def as_built(study: Study, section_m: float | None = None) -> Study:
    """Return the study with the robot and the cables that its declared effects make of them.

    ``section_m`` is that of the analysis.
    """
    built = as_built_by(study, section_m)
    return replace(study, robot=built.robot, material=built.material(study.material), effects=())


def coverage_curve(sweep_file: Path, survey: WorkspaceMap) -> CoverageCurve:
    """Return the share of the workspace over diameter, from every sample of a sweep."""
    names = ("verdict", "hangs_below", "diameter", "massless_diameter")
    verdict, hangs, diameter, massless = columns(sweep_file, *names)
    if survey.workspace.hangs_below == "exclude":
        counts = ~((hangs == 1) | (verdict == Verdict.NO_FINITE_CABLE))
        diameter, massless = diameter[counts], massless[counts]
    total = max(len(diameter), 1)
    return CoverageCurve(
        *_cumulative(diameter, total),
        *_cumulative(massless, total),
        unserved=float(np.isnan(diameter).sum() / total),
        needed_m=survey.sagging.diameter_m if survey.sagging else float("nan"),
        massless_needed_m=survey.massless.diameter_m if survey.massless else float("nan"),
        samples=len(diameter),
    )


def _cumulative(diameter_m: FloatArray, total: int) -> tuple[FloatArray, FloatArray]:
    """Return at most a few hundred points of the cumulative curve, its ends among them."""
    ordered = np.sort(diameter_m[np.isfinite(diameter_m)])
    if len(ordered) == 0:
        return np.empty(0), np.empty(0)
    at = np.unique(np.linspace(0, len(ordered) - 1, 300).round().astype(int))
    return ordered[at], (at + 1.0) / total


def _focus(study: Study, survey: WorkspaceMap) -> Focus:
    """The worst pose; else a pose that cannot be held; else, with all left out, the middle."""
    if survey.sagging is not None:
        pose = survey.sagging.pose
    elif survey.infeasible_pose is not None:
        pose = survey.infeasible_pose
    else:
        pose = Poses.at(survey.workspace.region.bounds_m.mean(axis=0))
    field = field_of(study, pose.place)
    statics = size_poses(study.robot, pose, study.material).statics
    if survey.sagging is not None:
        label = "worst pose"
    else:
        label = f"{field.why_infeasible}, for example here" if field.is_infeasible else "left out"
    return Focus(pose.position_m, label, statics if statics.is_solved else None, field)


def rope_maps(family: WorkspaceMaps, rope: GoverningRopes) -> WorkspaceMaps:
    """Return the maps of a region with the values of a rope instead of what each pose needs."""
    region, place, statics = rope.workspace.region, rope.place, rope.worst
    focus = Focus(place[:3], "worst pose", statics if statics.is_solved else None, _at(rope, place))
    shell: dict[str, RegionField] = {}
    positions = region.section_m(1.0, _RINGS, _SPOKES)
    if positions is not None:
        section = _over(rope, positions)
        pieces = region.cutaway_m(place[:3])
        shell = {
            name: section if region.is_upright else _over(rope, grid[every_second(grid)])
            for name, grid in pieces.items()
        }
    else:
        section = _over(rope, family.section.position_m)
    study = replace(family.study, workspace=rope.workspace)
    return replace(family, study=study, focus=focus, section=section, shell=shell, edge=None)


def _over(rope: GoverningRopes, position_m: FloatArray) -> RegionField:
    """Return the field at positions (..., 3), each in the orientation that asks for the most."""

    def demand(places: FloatArray) -> FloatArray:
        statics = rope.statics(places)
        return demand_of(rope.utilisation(statics), statics, rope.workspace.hangs_below)

    places = at_worst_orientation(rope.workspace.space, position_m.reshape(-1, 3), demand)
    return _at(rope, places.reshape(*position_m.shape[:-1], -1))


def _at(rope: GoverningRopes, place: FloatArray) -> RegionField:
    statics = rope.statics(place)
    no_value = np.full(place.shape[:-1], np.nan)
    return RegionField(
        position_m=place[..., :3],
        diameter_m=no_value,
        tension_N=statics.largest_tension_N,
        massless_diameter_m=no_value,
        massless_tension_N=solve_massless(rope.robot, Poses.at(place)).largest_tension_N,
        uplift=statics.force_z_N.max(axis=-1) / rope.robot.weight_N,
        verdict=statics.verdict,
        is_left_out=is_left_out(statics, rope.workspace.hangs_below),
        utilisation=rope.utilisation(statics),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """Which sizes are shown, and what each of them meets on a grid through the opened region."""

    sizes: tuple[CoveredSize, ...]  #: thinnest first
    grids_m: tuple[FloatArray, ...]  #: (rows, columns, 3) outside of the opened region [m]
    #: (n_sizes, n_points) largest over allowable tension at the points of all grids; very large
    #: where a pose cannot be held or does not count
    utilisation: FloatArray

    @property
    def position_m(self) -> FloatArray:
        """The points of all grids (n_points, 3) [m]."""
        return np.concatenate([grid.reshape(-1, 3) for grid in self.grids_m])


def layers_of(maps: WorkspaceMaps, usable: SizeCoverage) -> Layers | None:
    """Solve the outside of the opened region with the sizes that are shown.

    None for a list of points, and where no size serves a part only.
    """
    sizes = chosen_sizes(usable)
    if "top" not in maps.shell or not sizes:
        return None
    grids = tuple(field.position_m for field in maps.shell.values())
    limit = _MAX_SOLVED if maps.study.robot.has_one_branch else _MAX_SEARCHED
    limit /= len(sizes) * maps.workspace.orientations.count
    while sum(grid[..., 0].size for grid in grids) > limit and max(map(len, grids)) > _MIN_ROWS:
        grids = tuple(grid[every_second(grid)] for grid in grids)
    points = np.concatenate([grid.reshape(-1, 3) for grid in grids])
    utilisation = [_utilisation(maps.study.robot, maps.workspace, size, points) for size in sizes]
    return Layers(sizes, grids, np.stack(utilisation))


def chosen_sizes(usable: SizeCoverage) -> tuple[CoveredSize, ...]:
    """Return a few sizes that serve a part, spread over their shares, and one that serves all.

    Thinnest first. Empty where no size serves a part only.
    """
    part = [size for size in usable.sizes if 0.0 < size.fraction < 1.0]
    serves_all = [size for size in usable.sizes if size.fraction == 1.0][:1]
    if not part:
        return ()
    shares = [size.fraction for size in part]
    spread = np.linspace(min(shares), max(shares), min(_MAX_SIZES - len(serves_all), len(part)))
    nearest = [min(part, key=lambda size: abs(size.fraction - share)) for share in spread]
    return tuple(size for size in usable.sizes if size in nearest or size in serves_all)


def _utilisation(
    robot: Robot, workspace: Workspace, size: CoveredSize, position_m: FloatArray
) -> FloatArray:
    largest = np.zeros(position_m.shape[:-1])
    rotations = workspace.orientations.at(position_m.reshape(-1, 3))
    for rotation_rad in rotations.swapaxes(0, 1):
        poses = Poses.at(position_m, rotation_rad.reshape(position_m.shape))
        statics = solve_sagging(robot, poses, size.cable)
        counts = is_counted(statics, workspace.hangs_below)
        utilisation = statics.largest_tension_N / size.cable.allowable_tension_N
        utilisation = np.where(counts, np.minimum(utilisation, _EXCLUDED), _EXCLUDED)
        largest = np.maximum(largest, utilisation)
    return largest


@dataclass(frozen=True, slots=True, eq=False)
class SectionMap:
    """A value over rings about the centre of the region, see `Region.section_m`."""

    position_m: FloatArray  #: (rings, spokes, 3) positions, all at one height [m]
    values: FloatArray  #: (rings, spokes) in SI units; NaN where there is none
    is_bad: BoolArray  #: (rings, spokes) where the study asks for a value and there is none
    exit_points_m: FloatArray  #: (n_cables, 3) of the robot [m]


def displacement_section(analysis: Analysis) -> SectionMap | None:
    """Return the largest displacement under a unit force [m/N]; None without an area."""
    design = analysis.qualities
    if design is None or (statics := _statics(design, 40, 144)) is None:
        return None
    displacement = largest_displacement_m_per_N(statics)
    return _section(design, statics, displacement, np.isnan(displacement))


def frequency_section(analysis: Analysis) -> SectionMap | None:
    """Return the lowest frequency [Hz]; None without an area or the platform's inertia."""
    design, robot = analysis.qualities, analysis.built.robot
    if design is None or not knows_inertia(robot, robot.platform):
        return None
    if (statics := _statics(design, 16, 60)) is None:
        return None
    lowest_Hz = frequencies_Hz(statics, robot.platform, design.cable.cable.linear_density_kg_per_m)
    return _section(design, statics, lowest_Hz, ~(lowest_Hz > 0.0))


def clearance_section(analysis: Analysis) -> SectionMap | None:
    """Return the smallest clearance [m]; None without an area or anything to compare."""
    design = analysis.qualities
    if design is None or design.interference is None or design.interference.worst is None:
        return None
    if (statics := _statics(design, 16, 60)) is None:
        return None
    return _section(design, statics, smallest_clearance(statics).distance_m, ~statics.is_solved)


def _statics(design: Qualities, rings: int, spokes: int) -> Statics | None:
    """Solve the section at the middle height; None where it has no area in plan."""
    if design.workspace.region.is_upright or design.robot.is_planar:
        return None
    positions = design.workspace.region.section_m(0.5, rings, spokes)
    if positions is None:
        return None
    poses = Poses.at(design.workspace.space.first(positions))
    return solve_sagging(design.robot, poses, design.cable.cable)


def _section(
    design: Qualities, statics: Statics, values: FloatArray, is_missing: BoolArray
) -> SectionMap:
    is_required = ~is_left_out(statics, design.workspace.hangs_below)
    return SectionMap(
        position_m=statics.poses.position_m,
        values=np.where(statics.is_solved & is_required, values, np.nan),
        is_bad=np.asarray(is_required & is_missing),
        exit_points_m=statics.robot.exit_points_m,
    )
