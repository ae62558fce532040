"""What the sections of a design report are made from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from designer.analysis.analyse import Analysis
from designer.analysis.rope_maps import rope_maps
from designer.report.design.drawings import Drawings

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
    def drawings(self) -> Drawings:
        """The figures, each drawn when it is first asked for."""
        return Drawings(self)

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


def source_of(analysis: Analysis, *, draws: bool = True) -> Source:
    """Return what a report is made from; with ``draws`` false, without figures."""
    from designer.report.figures.opengl import why_no_scenes

    return Source(analysis, draws, why_no_scenes() if draws else "")
