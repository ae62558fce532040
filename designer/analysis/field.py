"""Sizing at many positions, and the shape of cables: what maps and scenes are coloured with."""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import combinations
from typing import Any

import numpy as np

from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.model.polygon import every_second
from designer.model.region import CHUNK
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics
from designer.study import Study
from designer.workspace.demand import is_left_out, size_worst


@dataclass(frozen=True, slots=True, eq=False)
class RegionField:
    """Sizing at positions over any axes; NaN where there is no value.

    Parameters
    ----------
    position_m : array (..., 3)
        Positions of the platform [m].
    diameter_m, tension_N : array (...)
        Needed diameter [m] and largest tension [N] with sag.
    massless_diameter_m, massless_tension_N : array (...)
        The same with straight weightless cables.
    uplift : array (...)
        Largest vertical pull of any cable down on the platform, over the platform's weight; above
        zero that cable hangs below the platform.
    verdict : array (...) of int
        One `Verdict` a position.
    is_left_out : array (...) of bool
        Whether the study leaves the position out.
    utilisation : array (...) or None
        Of a given rope; the diameters are NaN then.
    """

    position_m: FloatArray
    diameter_m: FloatArray
    tension_N: FloatArray
    massless_diameter_m: FloatArray
    massless_tension_N: FloatArray
    uplift: FloatArray
    verdict: VerdictArray
    is_left_out: BoolArray
    utilisation: FloatArray | None = None

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
        chosen = every_second(self.position_m)
        kept: dict[str, Any] = {
            item.name: None if value is None else value[chosen]
            for item in fields(self)
            for value in [getattr(self, item.name)]
        }
        return RegionField(**kept)


def field_at(study: Study, position_m: FloatArray) -> RegionField:
    """Size the positions (..., 3) of a study's workspace, each in its worst orientation."""
    workspace = study.workspace
    if workspace is None:
        return field_of(study, position_m)
    flat, axes = position_m.reshape(-1, 3), position_m.shape[:-1]
    if workspace.orientations.count == 1:
        return field_of(study, workspace.space.places(flat).reshape(*axes, -1))
    step = max(CHUNK // workspace.orientations.count, 1)
    worst = [
        size_worst(study.robot, workspace, flat[at : at + step], study.material)[0]
        for at in range(0, len(flat), step)
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
    """The largest sag among the cables of a pose.

    Parameters
    ----------
    cable : int
        Which cable, from 0.
    on_chord_m, on_cable_m : array (3,)
        Points on the straight line and on the cable, square to the line [m].
    """

    cable: int
    on_chord_m: FloatArray
    on_cable_m: FloatArray

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
