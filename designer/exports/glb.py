"""Binary glTF 2.0 (ISO/IEC 12113): triangles with colours, in scenes."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designer.arrays import FloatArray

_MAGIC, _VERSION, _JSON, _BINARY = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
_FLOAT, _BYTE = 5126, 5121


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles under one name.

    Parameters
    ----------
    name : str
        Of the node and its mesh.
    triangles_m : array (n, 3, 3)
        Corners [m].
    colours : array (3,) or (n, 3)
        Red, green and blue from 0 to 1 as on a screen, of all or of each triangle.
    is_lit : bool
        Whether light falls on it; else its colours are what a scale says they are.
    extras : mapping
        What else is to be known of it.
    """

    name: str
    triangles_m: FloatArray
    colours: FloatArray
    is_lit: bool = True
    extras: Mapping[str, Any] = field(default_factory=dict)


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
        shown = np.broadcast_to(surface.colours, (len(surface.triangles_m), 3))
        linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
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
