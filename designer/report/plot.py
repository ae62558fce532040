"""`analysis.plot`: the figures of the report as Matplotlib axes and PyVista scenes."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import TYPE_CHECKING

from designer.analysis.analyse import Analysis
from designer.errors import InputError
from designer.report.design.drawings import Drawings
from designer.report.figures import canvas
from designer.report.figures.colours import DIAMETER, UTILISATION
from designer.report.figures.scenes import add_workspace, robot_stage, scale_of, view_of
from designer.report.figures.stage import SCREEN, SceneCanvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import Plotter

CHARTS = (
    *("of_ropes", "of_family", "edge", "served", "verdicts", "pareto", "grades", "usable"),
    *("stiffness", "frequency", "clearance", "sensitivities", "odds", "shares", "groups"),
    *("path", "bending", "loop"),
)
"""As `designer.report.design.drawings.Drawings` has them."""


class Plots:
    """Charts of an analysis by name, such as ``plot.edge()``, and scenes in space.

    Each of `CHARTS` is a function that returns a list of Matplotlib axes, whose ``figure`` shows
    and saves them; empty where the analysis gives nothing for it.
    """

    def __init__(self, analysis: Analysis) -> None:
        self._analysis = analysis

    def __getattr__(self, name: str) -> Callable[[], list[Axes]]:
        """Return the function that draws a chart."""
        if name not in CHARTS:
            raise AttributeError(f"there is no plot {name!r}, but {', '.join(CHARTS)}")
        return partial(self._axes, name)

    def __dir__(self) -> list[str]:
        return [*CHARTS, "region", "pose"]

    @cached_property
    def _drawings(self) -> Drawings:
        return Drawings(self._analysis, draws=True)

    def _axes(self, name: str) -> list[Axes]:
        vars(self._drawings).pop(name, None)  # it keeps what it has drawn, as SVG
        with canvas.kept_figures() as figures:
            getattr(self._drawings, name)
        return [axes for figure in figures for axes in figure.axes]

    def region(self, *, off_screen: bool | None = None) -> Plotter:
        """Return the region cut open, coloured by what the ropes or the family need, to turn.

        ``off_screen`` is that of `pyvista.Plotter`: true for pictures without a window.

        Raises
        ------
        InputError
            If the study has no workspace.
        MissingLibraryError
            If this machine cannot draw in space.
        """
        maps = self._drawings.rope_maps or self._drawings.maps
        if maps is None:
            raise InputError([self._analysis.study.source.fault("workspace", "is missing")])
        quantity = DIAMETER if self._analysis.ropes is None else UTILISATION
        stage = SceneCanvas(view_of(maps), SCREEN)
        add_workspace(stage, maps, quantity, scale_of(maps, quantity))
        return _plotter(stage, off_screen)

    def pose(self, *, off_screen: bool | None = None) -> Plotter:
        """Return the robot in the configured pose, to turn; else in the one that governs.

        ``off_screen`` as in `region`.

        Raises
        ------
        InputError
            If there is neither.
        MissingLibraryError
            If this machine cannot draw in space.
        """
        pose, governing = self._analysis.pose, self._analysis.governing
        if pose is not None:
            statics = pose.sizing.statics
        elif governing is not None:
            statics = governing.equilibrium
        else:
            raise InputError([self._analysis.study.source.fault("pose", "is missing")])
        return _plotter(robot_stage(statics, pen=SCREEN)[0], off_screen)


def _plotter(stage: SceneCanvas, off_screen: bool | None) -> Plotter:
    import pyvista

    plotter = pyvista.Plotter(off_screen=off_screen)
    for actor in stage.scene.GetViewProps():
        plotter.add_actor(actor, reset_camera=False)
    stage.view.aim(plotter.renderer)
    stage.clear()
    return plotter
