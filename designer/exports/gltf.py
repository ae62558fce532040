"""What the report draws in space as binary glTF: robot, region and maps, a scene for each map."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from designer import __version__
from designer.analysis.field import RegionField, cable_curves_m
from designer.analysis.maps import WorkspaceMaps, rope_maps, workspace_maps
from designer.arrays import FloatArray
from designer.exports.glb import Surface, glb
from designer.exports.robot import Export, ExportedRobot, lost_by_all
from designer.report.figures import overlay, palette
from designer.report.figures.colours import DIAMETER, UTILISATION, MapQuantity, Steps, tension_of
from designer.report.figures.parts import hull_faces
from designer.report.figures.scenes import scale_of
from designer.report.figures.stage import (
    banded,
    counted_surface,
    failed_surface,
    left_out_surface,
)
from designer.statics.inverse import Statics

if TYPE_CHECKING:
    from pyvista import PolyData

CABLE, BALL = 0.0012, 0.006
"""Drawn radii of cables and points over the size of the robot; ropes would be too thin to see."""


def to_gltf(exported: ExportedRobot, stem: str) -> Export:
    """Return a file whose scenes are the maps of the workspace, or the robot alone without one.

    Raises
    ------
    InputError
        If the reference pose is not held at rest.
    """
    lost = [
        "forces, and figures but for scales and cables; cables are drawn thicker than they are",
        *exported.lost_of_cables,
        *exported.lost_worst,
        *lost_by_all(exported.study),
    ]
    size_m = _size_m(exported)
    if exported.robot.platform.hull_m is not None:
        lost.append("the hull of the platform; drawn is that of its attachments")
    robot = [_balls("exit points", exported.robot.exit_points_m, BALL * size_m, palette.INK)]
    robot += _pose("reference pose", exported.reference, size_m, palette.SAG)
    scenes: dict[str, list[Surface]] = {}
    if exported.worst is not None:
        robot += _pose("worst pose", exported.worst, size_m, palette.WARNING)
    if exported.study.workspace is not None:
        for maps, quantity in _maps(exported):
            scenes[quantity.label] = list(_map(maps.thinned(), quantity, size_m))
    asset = {
        "generator": f"cdpr-designer {__version__}",
        "extras": {"comment": exported.heading(lost)},
    }
    content = glb(scenes or {"robot": []}, robot, exported.robot.level, asset)
    return Export({f"{stem}.glb": content}, tuple(lost))


def _size_m(exported: ExportedRobot) -> float:
    points = [exported.robot.exit_points_m, exported.reference.poses.position_m[None]]
    return float(np.ptp(np.concatenate(points), axis=0).max())


def _maps(exported: ExportedRobot) -> Iterator[tuple[WorkspaceMaps, MapQuantity]]:
    """Yield what is shown of the ropes, if there are any, then of the configured family."""
    analysis = exported.analysis
    with analysis.reporter.task("maps", 2) as advance:
        family = workspace_maps(analysis)
        advance(1)
        if analysis.ropes is not None:
            ropes = rope_maps(family, analysis.ropes)
            yield ropes, UTILISATION
            yield ropes, tension_of(ropes.section)
        advance(1)
    yield family, DIAMETER


def _pose(name: str, statics: Statics, size_m: float, colour: str) -> Iterator[Surface]:
    import pyvista

    tubes = [
        _triangles(pyvista.lines_from_points(curve).tube(radius=CABLE * size_m, n_sides=8))
        for curve in cable_curves_m(statics)
    ]
    for number, tube in enumerate(tubes, start=1):
        length_m, tension_N = statics.length_m[number - 1], statics.exit_tension_N[number - 1]
        facts = {"unstrained_length_m": float(length_m), "exit_tension_N": float(tension_N)}
        yield Surface(f"{name}, cable {number}", tube, _rgb(colour), extras=facts)
    corners_m = statics.poses.attachment_points_m(statics.robot)
    faces = hull_faces(corners_m)
    if len(faces):
        yield Surface(f"{name}, platform", corners_m[faces], _rgb(colour))
    else:
        centre_m = statics.poses.position_m[None]
        yield _balls(f"{name}, platform", centre_m, 2.0 * BALL * size_m, colour)


def _map(maps: WorkspaceMaps, quantity: MapQuantity, size_m: float) -> Iterator[Surface]:
    steps = scale_of(maps, quantity)
    if not maps.has_area:
        yield from _points(maps.section, quantity, steps, BALL * size_m)
    for name, field in maps.shell.items():
        counted = counted_surface(field, quantity)
        if steps is not None and counted.n_cells > 0:
            yield from _coloured(f"{name}: {quantity.title}", counted, quantity, steps)
        meanings = dict(overlay.meanings([field]))
        parts = {
            palette.WARNING: failed_surface(field),
            palette.LEFT_OUT: left_out_surface(field, quantity),
        }
        for colour, part in parts.items():
            if part.n_cells > 0:
                meaning = meanings.get(colour, "no value")
                yield Surface(f"{name}: {meaning}", _triangles(part), _rgb(colour), is_lit=False)


def _coloured(
    name: str, surface: PolyData, quantity: MapQuantity, steps: Steps
) -> Iterator[Surface]:
    bands = banded(surface, steps).triangulate()
    if bands.n_cells > 0:
        colours = np.asarray(bands.cell_data["colour"]) / 255.0
        legend = _legend(quantity, steps)
        yield Surface(name, _triangles(bands), colours, is_lit=False, extras=legend)


def _legend(quantity: MapQuantity, steps: Steps) -> dict[str, object]:
    from matplotlib.colors import to_hex

    edges = steps.edges.tolist()
    scale = [
        {"from": low, "to": high, "colour": to_hex(steps.colormap(k))}
        for k, (low, high) in enumerate(pairwise(edges))
    ]
    return {"quantity": quantity.title, "unit": quantity.unit, "scale": scale}


def _points(
    field: RegionField, quantity: MapQuantity, steps: Steps | None, radius_m: float
) -> Iterator[Surface]:
    values, places = quantity.of(field), field.position_m
    finite = np.isfinite(values)
    if steps is not None and finite.any():
        colours = steps.colours_of(steps.norm(values[finite])) / 255.0
        balls = _ball_triangles(places[finite], radius_m)
        each = np.repeat(colours, len(balls) // len(colours), axis=0)
        legend = _legend(quantity, steps)
        yield Surface(quantity.title, balls, each, is_lit=False, extras=legend)
    for colour, meaning in overlay.meanings([field]):
        is_it = field.is_infeasible if colour == palette.WARNING else field.is_left_out
        yield _balls(meaning, places[is_it], radius_m, colour)


def _balls(name: str, centres_m: FloatArray, radius_m: float, colour: str) -> Surface:
    return Surface(name, _ball_triangles(centres_m, radius_m), _rgb(colour))


def _ball_triangles(centres_m: FloatArray, radius_m: float) -> FloatArray:
    import pyvista

    ball = _triangles(pyvista.Sphere(radius=radius_m, theta_resolution=12, phi_resolution=9))
    return np.asarray((centres_m[:, None, None] + ball).reshape(-1, 3, 3))


def _triangles(mesh: PolyData) -> FloatArray:
    """Return the corners of the triangles of a mesh (n, 3, 3) [m]."""
    plain = mesh.triangulate()
    return np.asarray(plain.points[plain.regular_faces], dtype=np.float64)


def _rgb(colour: str) -> FloatArray:
    from matplotlib.colors import to_rgb

    return np.array(to_rgb(colour))
