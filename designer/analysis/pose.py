"""The configured pose alone, sized in every way."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from designer import checked
from designer.errors import InputError
from designer.model.cable import Material
from designer.sizing.loop import LoopSizing, size_by_loop
from designer.sizing.newton import Sizing, limit_ratio, size_poses
from designer.statics.inverse import MasslessStatics, solve_massless
from designer.statics.rest import RestingPlaces, resting_places
from designer.study import Study, as_built_by, require_enough_cables
from designer.workspace.section import section_of_pose


@dataclass(frozen=True, eq=False, repr=False)
class PoseAnalysis(checked.Shown):
    """The configured pose alone.

    Parameters
    ----------
    material : Material
        The family as built.
    sizing : Sizing
        Optimum by Newton, no leading axes.
    massless : MasslessStatics
        Straight weightless cables.
    loop : LoopSizing
        The basic loop with its iterates.
    limit_ratio : float
        Stress at infinite section over allowable stress; at 1 no finite cable is left.
    """

    material: Material
    sizing: Sizing
    massless: MasslessStatics
    loop: LoopSizing
    limit_ratio: float

    @cached_property
    def rest(self) -> RestingPlaces | None:
        """Whether the platform stays there on cables of the optimum; None where there is none."""
        statics = self.sizing.statics
        if not statics.is_solved:
            return None
        cable = self.material.cable(float(self.sizing.diameter_m))
        return resting_places(statics.robot, statics.poses, cable, statics.length_m)

    @property
    def caution(self) -> str:
        """What a reader must know of cables that hang below the platform; empty if none does."""
        statics = self.sizing.statics
        if not (statics.is_solved and statics.hangs_below):
            return ""
        chord_m = statics.geometry().chord_m
        sentences = [
            f"Cable {k + 1} hangs below the platform, {statics.length_m[k]:.4g} m long over a "
            f"distance of {chord_m[k]:.4g} m."
            for k in np.flatnonzero(statics.hanging_cables)
        ]
        if not np.isfinite(self.sizing.massless_tension_N):
            sentences.append("Straight cables cannot hold this pose: what hangs there is a weight.")
        return " ".join(sentences)


def analyse_pose(study: Study) -> PoseAnalysis:
    """Size the configured pose in every way.

    Raises
    ------
    InputError
        If the study has no pose, or the robot has fewer cables than degrees of freedom.
    """
    require_enough_cables(study)
    if study.pose is None:
        fault = study.source.fault("pose", "is missing", "a pose, such as [250, 200, -50]")
        raise InputError([fault])
    built = as_built_by(study)
    built = replace(built, robot=built.robot.at_rest)
    section_m = section_of_pose(built, study.pose, study.material)
    robot, material = built.robot, built.material(study.material, section_m)
    return PoseAnalysis(
        material=material,
        sizing=size_poses(robot, study.pose, material, proves_thinnest=True),
        massless=solve_massless(robot, study.pose),
        loop=size_by_loop(robot, study.pose, material),
        limit_ratio=float(limit_ratio(robot, study.pose, material)),
    )
