"""The governing poses solved a second time, by methods other than those of the kernel.

They have in common where cables begin and end, and the straight cables that they start from.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from designer.model.cable import Material
from designer.model.robot import Poses
from designer.physics.quadrature import end_position_m
from designer.sizing.newton import Sizing
from designer.statics.inverse import Statics, solve_sagging

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

_SAME_DIAMETER = 1e-6
"""Of the diameter: what the optimisers reach."""
_SAME_END = 1e-8
"""Of the longest cable: a micrometre on 100 m; the quadrature itself is good to 1e-12."""


@dataclass(frozen=True, slots=True)
class SecondAnswer:
    """One number, ours and by another method."""

    method: str  #: what found the other one
    quantity: str  #: what it is, and at which pose
    unit: str  #: of both, SI
    ours: float
    theirs: float  #: NaN where the other method found nothing, see ``remark``
    tolerance: float = field(metadata={"json": None})  #: difference up to which the two agree
    remark: str = ""  #: why there is nothing to compare; empty where there is
    #: whether theirs may be larger: a thicker cable that also holds refutes no thinner one
    may_be_more: bool = field(default=False, metadata={"json": None})

    also_in_files: ClassVar = ("difference",)

    @property
    def difference(self) -> float:
        """Theirs less ours."""
        return self.theirs - self.ours

    @property
    def agrees(self) -> bool:
        """Whether the two agree, or there is nothing to compare."""
        off = -self.difference if self.may_be_more else abs(self.difference)
        return bool(self.remark) or off <= self.tolerance


def second_answers(analysis: Analysis) -> tuple[SecondAnswer, ...]:
    """Verify the configured pose, the worst pose, and that of the chosen rope."""
    pose, worst = analysis.pose, analysis.worst_sizing
    answers: list[SecondAnswer] = []
    if pose is not None:
        answers += verify("configured pose", pose.material, pose.sizing)
    if worst is not None:
        material = analysis.built.material(analysis.study.material)
        answers += verify("worst pose", material, worst)
    chosen = analysis.chosen
    if chosen is not None:
        loaded = chosen.governing.loaded
        place = chosen.verification.worst_place
        statics = solve_sagging(loaded.robot, Poses.at(place), loaded.cable)
        if statics.is_solved:
            answers.append(verify_cables(f"{chosen.name}, at its worst pose", statics))
    return tuple(answers)


def verify(name: str, material: Material, sizing: Sizing) -> list[SecondAnswer]:
    """Find a needed diameter again by an optimiser, and where its cables end by quadrature.

    The optimiser is SciPy's SLSQP on the unknowns of Riehl et al., ICRA 2010, section IV.C, or for
    more cables than degrees of freedom a sequence of convex programmes by Clarabel; neither knows
    pulleys.

    Parameters
    ----------
    name : str
        What pose it is, such as ``worst pose``.
    material : Material
        The family of cables.
    sizing : Sizing
        Ours, of one pose.
    """
    if not sizing.statics.is_solved:
        return []
    return [_diameter(name, material, sizing), verify_cables(name, sizing.statics)]


def _diameter(name: str, material: Material, sizing: Sizing) -> SecondAnswer:
    robot, pose = sizing.statics.robot, sizing.statics.poses
    ours = float(sizing.diameter_m)
    theirs, remark = np.nan, "did not converge"
    method = "convex programmes (Clarabel)" if robot.is_redundant else "SLSQP (SciPy)"
    try:
        if robot.is_redundant:
            from designer.sizing.scp import size_by_scp

            theirs = size_by_scp(robot, pose, material).diameter_m
        else:
            from designer.sizing.nlp import size_by_nlp

            theirs = size_by_nlp(robot, pose, material).diameter_m
    except ValueError as error:
        remark = str(error)
    remark = "" if np.isfinite(theirs) else remark
    quantity = f"needed diameter, {name}"
    has_others = not bool(sizing.is_thinnest)
    return SecondAnswer(
        method, quantity, "m", ours, theirs, _SAME_DIAMETER * ours, remark, has_others
    )


def verify_cables(name: str, statics: Statics) -> SecondAnswer:
    """Integrate the cable equation with our lengths and forces: how far off does a cable end?"""
    geometry = statics.geometry()
    weight, stiffness = (
        np.broadcast_to(figure, statics.length_m.shape)
        for figure in (statics.weight_N_per_m, statics.axial_stiffness_N)
    )
    rows = zip(
        statics.free_length_m,
        statics.force_x_N,
        statics.force_z_N,
        stiffness,
        weight,
        strict=True,
    )
    ends = np.array([end_position_m(*map(float, cable)) for cable in rows])
    off = ends - np.stack([geometry.horizontal_distance_m, -geometry.drop_m], axis=-1)
    farthest = float(np.hypot(*off.T).max())
    return SecondAnswer(
        "quadrature of the cable equation",
        f"distance of a cable's end from its attachment, {name}",
        "m",
        0.0,
        farthest,
        _SAME_END * float(statics.free_length_m.max()),
    )
