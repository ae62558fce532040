"""What the sections of a design report are made from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from designer.analysis.analyse import Analysis
from designer.analysis.rope_maps import rope_maps
from designer.report.blocks import Picture
from designer.report.pictures import scene

if TYPE_CHECKING:
    from designer.analysis.maps import WorkspaceMaps


@dataclass(frozen=True)
class Source:
    """An analysis, and what several sections of its report share.

    Parameters
    ----------
    analysis : Analysis
        All results.
    draws : bool
        Whether figures are drawn.
    missing : str
        Why pictures in space are left out; empty where they are not.
    """

    analysis: Analysis
    draws: bool = False
    missing: str = ""

    @property
    def draws_scenes(self) -> bool:
        """Whether pictures in space are drawn."""
        return self.draws and not self.missing

    @cached_property
    def maps(self) -> WorkspaceMaps | None:
        """What the figures of the workspace show; None without them."""
        if not self.draws or self.analysis.workspace is None:
            return None
        from designer.analysis.maps import workspace_maps

        return workspace_maps(self.analysis)

    @cached_property
    def rope_maps(self) -> WorkspaceMaps | None:
        """What the maps of these ropes show; None without them."""
        if self.maps is None or self.analysis.ropes is None:
            return None
        return rope_maps(self.maps, self.analysis.ropes)

    @cached_property
    def robot(self) -> Picture | None:
        """The robot in the configured pose, in space; None without such pictures."""
        pose = self.analysis.pose
        if not self.draws_scenes or pose is None:
            return None
        from designer.report.figures.scenes import robot_scene

        caption = "The robot in the configured pose"
        if pose.sizing.statics.is_solved:
            caption += ", its cables in their true shape, each with its tension at the exit point"
        statics = pose.sizing.statics
        body, up = statics.robot.platform, statics.robot.level[2]
        loads = [("weight", -statics.robot.weight_N * up), ("load", body.wrench_N[:3])]
        drawn = robot_scene(statics, loads=loads)
        return scene(f"{caption}.", "The robot with its cables, in space", drawn)


def source_of(analysis: Analysis, *, draws: bool = True) -> Source:
    """Return what a report is made from; with ``draws`` false, without figures."""
    from designer.report.figures.opengl import why_no_scenes

    return Source(analysis, draws, why_no_scenes() if draws else "")
