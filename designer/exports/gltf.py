"""What the report draws in space as binary glTF: robot, region and maps, a scene for each map.

Binary glTF 2.0 (ISO/IEC 12113) holds triangles with colours, in scenes.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from designer import __version__
from designer.analysis.maps import (
    RegionField,
    WorkspaceMaps,
    cable_curves_m,
    rope_maps,
    workspace_maps,
)
from designer.arrays import FloatArray
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


_MAGIC, _VERSION, _JSON, _BINARY = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
_FLOAT, _BYTE = 5126, 5121
CABLE, BALL = 0.0012, 0.006
"""Drawn radii of cables and points over the size of the robot; ropes would be too thin to see."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles under one name."""

    name: str  #: of the node and its mesh
    triangles_m: FloatArray  #: (n, 3, 3) corners [m]
    #: (3,) red, green and blue from 0 to 1 as on a screen, of all or of each triangle
    colours: FloatArray
    #: whether light falls on it; else its colours are what a scale says they are
    is_lit: bool = True
    extras: Mapping[str, Any] = field(default_factory=dict)  #: what else is to be known of it


def glb(
    scenes: Mapping[str, Sequence[Surface]],
    shared: Sequence[Surface],
    turn: FloatArray,
    asset: Mapping[str, Any],
) -> bytes:
    """Return a file of scenes, each with its own surfaces and the shared ones; the first is shown.

    ``turn`` (3, 3) leads from the frame of the surfaces to one whose z axis points up.
    """
    buffers = _Buffers()
    y_up = np.eye(4)
    y_up[:3, :3] = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]) @ turn
    matrix = y_up.ravel(order="F").tolist()
    common = buffers.group("robot", shared, matrix)
    listed = [
        {"name": name, "nodes": [common, buffers.group(name, surfaces, matrix)]}
        if surfaces
        else {"name": name, "nodes": [common]}
        for name, surfaces in scenes.items()
    ]
    return buffers.file({"asset": {"version": "2.0", **asset}, "scene": 0, "scenes": listed})


class _Buffers:
    """Collects nodes, meshes and their bytes."""

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._lists: dict[str, list[dict[str, Any]]] = {
            name: [] for name in ("nodes", "meshes", "accessors", "bufferViews")
        }

    def _add(self, name: str, entry: dict[str, Any]) -> int:
        self._lists[name].append(entry)
        return len(self._lists[name]) - 1

    def group(self, name: str, surfaces: Sequence[Surface], matrix: list[float]) -> int:
        """Add surfaces below one node and return its number."""
        children = [self._surface(surface) for surface in surfaces]
        return self._add("nodes", {"name": name, "matrix": matrix, "children": children})

    def _surface(self, surface: Surface) -> int:
        points = surface.triangles_m.reshape(-1, 3).astype(np.float32)
        # Colours of vertices are linear in light (sRGB, IEC 61966-2-1).
        screen_rgb = np.broadcast_to(surface.colours, (len(surface.triangles_m), 3))
        linear = np.where(
            screen_rgb <= 0.04045, screen_rgb / 12.92, ((screen_rgb + 0.055) / 1.055) ** 2.4
        )
        colours = np.ones((len(points), 4))
        colours[:, :3] = np.repeat(linear, 3, axis=0)
        ends = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        attributes = {
            "POSITION": self._accessor(points, _FLOAT, "VEC3", ends),
            "COLOR_0": self._accessor(
                np.round(255.0 * colours).astype(np.uint8), _BYTE, "VEC4", {"normalized": True}
            ),
        }
        primitive = {"attributes": attributes, "material": 0 if surface.is_lit else 1}
        mesh = self._add("meshes", {"name": surface.name, "primitives": [primitive]})
        node = {"name": surface.name, "mesh": mesh}
        return self._add("nodes", node | ({"extras": surface.extras} if surface.extras else {}))

    def _accessor(
        self, values: NDArray[Any], component: int, kind: str, more: Mapping[str, Any]
    ) -> int:
        view = {"buffer": 0, "byteOffset": len(self._bytes), "byteLength": values.nbytes}
        self._bytes += values.tobytes()
        number = self._add("bufferViews", view | {"target": 34962})
        entry = {"bufferView": number, "componentType": component, "count": len(values)}
        return self._add("accessors", entry | {"type": kind, **more})

    def file(self, head: Mapping[str, Any]) -> bytes:
        """Return the whole as one file."""
        unlit = "KHR_materials_unlit"
        look = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8}}
        document = {
            **head,
            **self._lists,
            "extensionsUsed": [unlit],
            "materials": [
                {"name": "lit", "doubleSided": True, **look},
                {"name": "scale", "doubleSided": True, **look, "extensions": {unlit: {}}},
            ],
            "buffers": [{"byteLength": len(self._bytes)}],
        }
        text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        parts = struct.pack("<II", len(text), _JSON) + text
        parts += struct.pack("<II", len(self._bytes), _BINARY) + bytes(self._bytes)
        return struct.pack("<III", _MAGIC, _VERSION, 12 + len(parts)) + parts


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
    for name, side in maps.shell.items():
        counted = counted_surface(side, quantity)
        if steps is not None and counted.n_cells > 0:
            yield from _coloured(f"{name}: {quantity.title}", counted, quantity, steps)
        meanings = dict(overlay.meanings([side]))
        parts = {
            palette.WARNING: failed_surface(side),
            palette.LEFT_OUT: left_out_surface(side, quantity),
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
        rgb = np.repeat(colours, len(balls) // len(colours), axis=0)
        legend = _legend(quantity, steps)
        yield Surface(quantity.title, balls, rgb, is_lit=False, extras=legend)
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
