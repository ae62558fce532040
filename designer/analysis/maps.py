"""The values that the figures of a workspace show, computed once and shared by all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.edge import EdgeProfile, edge_profile
from designer.analysis.field import RegionField, field_at, field_of
from designer.analysis.governing import GoverningRopes
from designer.arrays import FloatArray
from designer.model.polygon import every_second
from designer.model.region import Region
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, solve_massless
from designer.study import Study, as_built_by
from designer.workspace.demand import demand_of, in_worst_turn, is_left_out
from designer.workspace.sweep import WorkspaceMap, columns

_MOST_POINTS = 3000
_RINGS, _SPOKES = 45, 120
"""Half as fine as the maps of the family: a pose of a rope costs more than a size."""


@dataclass(frozen=True, slots=True, eq=False)
class Focus:
    """The pose that the figures of a workspace turn to.

    Parameters
    ----------
    position_m : array (3,)
        Where it is [m].
    label : str
        What it is, such as ``worst pose``.
    statics : Statics or None
        Equilibrium there with the cable that it needs; None where there is none.
    field : RegionField
        Sizing there, no axes.
    """

    position_m: FloatArray
    label: str
    statics: Statics | None
    field: RegionField


@dataclass(frozen=True, slots=True, eq=False)
class Served:
    """What share of the workspace a cable of a given diameter serves.

    Parameters
    ----------
    diameter_m, share : array (n,)
        Diameters, ascending [m], and the share of all poses that need no more.
    massless_diameter_m, massless_share : array (n,)
        The same if sag is ignored.
    unserved : float
        Share of the poses that no diameter serves.
    needed_m : float
        The continuous optimum, refined beyond the samples [m]; NaN if there is none.
    massless_needed_m : float
        The same if sag is ignored [m]; NaN if there is none.
    samples : int
        Number of poses that the shares are taken from.
    """

    diameter_m: FloatArray
    share: FloatArray
    massless_diameter_m: FloatArray
    massless_share: FloatArray
    unserved: float
    needed_m: float
    massless_needed_m: float
    samples: int


@dataclass(frozen=True, slots=True, eq=False)
class WorkspaceMaps:
    """All that the figures of a workspace show.

    Parameters
    ----------
    study : Study
        The problem, with robot and cables as they were solved, see `as_built`.
    focus : Focus
        The worst pose, or what stands for it.
    section : RegionField
        The region at its greatest height (rings, spokes + 1), see `Region.section_m`; a rectangle
        itself; for a list of points the points themselves (n_points,), thinned out where there are
        very many.
    shell : mapping of str to RegionField
        Outside of the region and two cuts, see `Region.cutaway_m`; of a rectangle the section;
        empty for a list of points.
    edge : EdgeProfile or None
        Along the line from the centre through the focus to the hull of the exit points; None
        where the centre lies outside that hull.
    served : Served
        Share of the workspace over diameter.
    impossible_m : array (n, 3, 3)
        Triangles in which the part ends that is proved to be served by no rope [m].
    """

    study: Study
    focus: Focus
    section: RegionField
    shell: Mapping[str, RegionField]
    edge: EdgeProfile | None
    served: Served
    impossible_m: FloatArray

    @property
    def region(self) -> Region:
        """The region of the study's workspace."""
        return _workspace(self.study).region

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
    if survey is None or analysis.sweep_file is None:
        raise ValueError("the analysis has no workspace")
    region, part = _workspace(study).region, analysis.servable
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
        points = np.concatenate([*region.samples_m(_MOST_POINTS, "grid", 0)])
        section, shell = field_at(study, points[:: -(-len(points) // _MOST_POINTS)]), {}
    return WorkspaceMaps(
        study=study,
        focus=focus,
        section=section,
        shell=shell,
        edge=edge_profile(study, focus.position_m),
        served=served(analysis.sweep_file, _workspace(study), survey),
        impossible_m=np.empty((0, 3, 3)) if part is None else part.border_m,
    )


def as_built(study: Study, section_m: float | None = None) -> Study:
    """Return the study with the robot and the cables that its declared effects make of them.

    ``section_m`` is that of the analysis.
    """
    built = as_built_by(study, section_m)
    return replace(study, robot=built.robot, material=built.material(study.material), effects=())


def served(sweep_file: Path, workspace: Workspace, survey: WorkspaceMap) -> Served:
    """Return the share of the workspace over diameter, from every sample of a sweep."""
    names = ("verdict", "hangs_below", "diameter", "massless_diameter")
    verdict, hangs, diameter, massless = columns(sweep_file, *names)
    if workspace.hangs_below == "exclude":
        counts = ~((hangs == 1) | (verdict == Verdict.NO_FINITE_CABLE))
        diameter, massless = diameter[counts], massless[counts]
    total = max(len(diameter), 1)
    return Served(
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
        pose = Poses.at(_workspace(study).region.bounds_m.mean(axis=0))
    field = field_of(study, pose.place)
    statics = size_poses(study.robot, pose, study.material).statics
    if survey.sagging is not None:
        label = "worst pose"
    else:
        label = f"{field.why_infeasible}, for example here" if field.is_infeasible else "left out"
    return Focus(pose.position_m, label, statics if statics.is_solved else None, field)


def _workspace(study: Study) -> Workspace:
    assert study.workspace is not None
    return study.workspace


def rope_maps(family: WorkspaceMaps, rope: GoverningRopes) -> WorkspaceMaps:
    """Return the maps of a region with the values of a rope instead of what each pose needs."""
    region, place = rope.workspace.region, rope.place
    statics = rope.worst
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
    space, axes = rope.workspace.space, position_m.shape[:-1]
    places = space.places(position_m.reshape(-1, 3))
    if space.orientations.count > 1:
        statics = rope.statics(places)
        demand = demand_of(rope.used(statics), statics, rope.workspace.hangs_below)
        places = in_worst_turn(space, places, demand)
    return _at(rope, places.reshape(*axes, -1))


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
        utilisation=rope.used(statics),
    )
