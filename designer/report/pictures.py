"""The figures of a report, by the place where each is shown."""

from __future__ import annotations

from dataclasses import dataclass

from designer.report.parts import Picture


@dataclass(frozen=True, slots=True)
class Pictures:
    """All figures; None where a study gives nothing to draw.

    Parameters
    ----------
    robot : Picture or None
        The robot with its cables in their true shape, for the first page.
    loop_chart : Picture or None
        Diameter and tension over the turns of the loop.
    pose_scene : Picture or None
        The robot in the configured pose.
    verdicts : Picture or None
        The samples by verdict.
    workspace : tuple of Picture
        Maps and charts of the workspace, in the order in which they are shown.
    candidates : Picture or None
        Sizes and need of each grade.
    pareto : Picture or None
        The sizes that no other beats, among all that hold.
    usable_chart : Picture or None
        How much of the workspace each size of a grade serves.
    usable_scene : Picture or None
        Where some of its sizes serve, in space.
    stiffness : Picture or None
        Displacement under a unit force at the middle height.
    clearance : Picture or None
        Smallest clearance at the middle height.
    groups : Picture or None
        The robot from above with the cables of each group.
    missing : str
        Why pictures in space are left out; empty where they are not.
    """

    robot: Picture | None = None
    loop_chart: Picture | None = None
    pose_scene: Picture | None = None
    verdicts: Picture | None = None
    workspace: tuple[Picture, ...] = ()
    candidates: Picture | None = None
    pareto: Picture | None = None
    usable_chart: Picture | None = None
    usable_scene: Picture | None = None
    stiffness: Picture | None = None
    clearance: Picture | None = None
    groups: Picture | None = None
    missing: str = ""
