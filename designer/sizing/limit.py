"""The infinite section: how near a pose is to having no finite cable at all."""

from __future__ import annotations

from designer.arrays import FloatArray
from designer.model.cable import Material
from designer.model.robot import Poses, Robot
from designer.statics.task import Task, solve_task


def limit_ratio(robot: Robot, poses: Poses, material: Material) -> FloatArray:
    """Return the stress at infinite section over the allowable stress, for each pose (...).

    As the section grows, the platform's weight stops mattering: the cables hang between the exit
    points and a weightless platform, and their stress tends to a value that depends on geometry
    and ρ g only. The margin to the boundary of the workspace is 1 minus this ratio: below 1, a
    finite cable exists. At or above 1 none does where the taut cable sets the ratio; where it is
    the slack one, pulling it up may still help, which the verdict of the sizing decides.

    With more cables than degrees of freedom it is the least ratio that any internal forces reach.

    NaN where that limit was not solved.
    """
    task = Task(
        material.elastic_compliance_per_m,
        material.strength_length_m,
        0.0,
        sag_max=robot.family_sag_max,
    )
    solution, _ = solve_task(robot, poses, task)
    return solution.load_factor.reshape(poses.shape)
