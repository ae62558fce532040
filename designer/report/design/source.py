"""What the sections of a design report are made from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, find
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
    findings : Findings
        What follows from them.
    draws : bool
        Whether figures are drawn.
    missing : str
        Why pictures in space are left out; empty where they are not.
    """

    analysis: Analysis
    findings: Findings
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
    def robot(self) -> Picture | None:
        """The robot in the configured pose, in space; None without such pictures."""
        pose = self.analysis.pose
        if not self.draws_scenes or pose is None:
            return None
        from designer.report.figures.scenes import robot_scene

        caption = "The robot in the configured pose"
        if pose.sizing.statics.is_solved:
            caption += ", its cables in their true shape, each with its tension at the exit point"
        return scene(f"{caption}.", "The robot with its cables, in space", robot_scene(pose))


def source_of(analysis: Analysis, *, draws: bool = True) -> Source:
    """Return what a report is made from; with ``draws`` false, without figures."""
    from designer.report.figures.opengl import why_no_scenes

    return Source(analysis, find(analysis), draws, why_no_scenes() if draws else "")
