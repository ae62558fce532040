"""Binary glTF that VTK's own reader opens: where things stand, their names, their colours."""

from __future__ import annotations

import json
import struct
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import pyvista

from designer.exports.gltf import Surface, glb, to_gltf
from designer.exports.robot import ExportedRobot
from designer.io.config import read_study

POINT = """
name: Hall crane
robot:
  anchors: [[0, 0, 9], [12, 0, 9], [6, 9, 9]]
  platform: {mass: 300 kg}
cable: {grade: unirope-7x19-galvanised, safety_factor: 5}
pose: [6, 3, 3]
"""
WORKSPACE = """
workspace: {region: {box: [[5, 7], [2, 4], [1, 5]]}, samples: 200}
selection: {grades: [unirope-7x19-galvanised], safety_factor: 5}
"""
LISTED = "workspace: {region: {points: [[6, 3, 3], [5, 2, 6], [5.5, 3, 2]]}}"
LYING = POINT.replace(
    "[[0, 0, 9], [12, 0, 9], [6, 9, 9]]\n",
    "[[9, 0, 0], [9, 12, 0], [9, 6, 9]]\n  gravity: [-1, 0, 0]\n",
).replace("[6, 3, 3]", "[3, 6, 3]")


def exported(folder: Path, text: str, **options: bool) -> ExportedRobot:
    path = folder / "hall.yaml"
    path.write_text(text)
    return ExportedRobot.of(read_study(path), **options)


def document(content: bytes) -> dict:
    """The JSON of a file, whose frame is checked on the way."""
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, kind = struct.unpack_from("<I4s", content, 12)
    assert (kind, size % 4) == (b"JSON", 0)
    parsed = json.loads(content[20 : 20 + size])
    rest, kind = struct.unpack_from("<I4s", content, 20 + size)
    assert (kind, rest, 28 + size + rest) == (b"BIN\0", parsed["buffers"][0]["byteLength"], length)
    for accessor in parsed["accessors"]:
        view = parsed["bufferViews"][accessor["bufferView"]]
        width = {("VEC3", 5126): 12, ("VEC4", 5121): 4}[accessor["type"], accessor["componentType"]]
        assert view["byteLength"] == width * accessor["count"]
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= rest
    return parsed


def opened(folder: Path, content: bytes) -> pyvista.PolyData:
    path = folder / "robot.glb"
    path.write_bytes(content)
    parts = pyvista.read(path)
    return parts.combine().extract_surface(algorithm="dataset_surface")


@pytest.mark.parametrize("text", [POINT, LYING], ids=["upright", "lying"])
def test_vtk_opens_the_robot_with_y_up(tmp_path: Path, text: str) -> None:
    robot = exported(tmp_path, text)
    made = to_gltf(robot, "robot")
    parsed = document(made.files["robot.glb"])
    names = [mesh["name"] for mesh in parsed["meshes"]]
    assert names == ["exit points", *(f"reference pose, cable {k}" for k in (1, 2, 3)),
                     "reference pose, platform"]  # fmt: skip
    assert all(line in " ".join(parsed["asset"]["extras"]["comment"]) for line in made.lost)
    low, high = np.reshape(opened(tmp_path, made.files["robot.glb"]).bounds, (3, 2)).T
    # Exit points 9 m up, all in one level; the platform 6 m below, 12 m wide and 9 m deep.
    margin = 0.03 * 12.0
    assert high[1] == pytest.approx(9.0, abs=margin)
    assert low[1] == pytest.approx(3.0, abs=margin)
    assert sorted([high[0] - low[0], high[2] - low[2]]) == pytest.approx([9.0, 12.0], abs=margin)
    cable = next(node for node in parsed["nodes"] if node["name"] == "reference pose, cable 2")
    tension_N = robot.reference.exit_tension_N[1]
    assert cable["extras"]["exit_tension_N"] == pytest.approx(tension_N)


def test_colours_are_linear_in_light_and_scenes_are_apart(tmp_path: Path) -> None:
    corner = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    scenes = {
        "one": [Surface("half", corner, np.array([0.5, 1.0, 0.02]), is_lit=False)],
        "two": [Surface("two", np.vstack([corner, corner + 1.0]), np.eye(3)[:2])],
    }
    content = glb(
        scenes, [Surface("both", corner, np.zeros(3))], np.eye(3), {"generator": "a test"}
    )
    parsed = document(content)
    (common, first), (again, second) = (scene["nodes"] for scene in parsed["scenes"])
    assert common == again
    assert first != second
    half = parsed["meshes"][1]["primitives"][0]
    view = parsed["bufferViews"][parsed["accessors"][half["attributes"]["COLOR_0"]]["bufferView"]]
    start = len(content) - parsed["buffers"][0]["byteLength"] + view["byteOffset"]
    assert list(content[start : start + 4]) == [55, 255, 0, 255]  # 0.5 on a screen is 0.214
    assert parsed["materials"][half["material"]]["extensions"] == {"KHR_materials_unlit": {}}
    assert opened(tmp_path, content).n_cells == 2  # the first scene and what is common


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "maps", "meshes"),
    [
        (WORKSPACE, ["utilisation [%]", "largest tension [kN]", "needed diameter [mm]"], "wall"),
        (LISTED, ["needed diameter [mm]"], "needed diameter"),
    ],
    ids=["region", "points"],
)
def test_each_map_is_a_scene_with_its_scale(tmp_path: Path, more: str, maps, meshes: str) -> None:
    robot = exported(tmp_path, POINT + more, with_maps=True)
    parsed = document(to_gltf(robot, "robot").files["robot.glb"])
    assert [scene["name"] for scene in parsed["scenes"]] == maps
    assert any(mesh["name"].startswith(meshes) for mesh in parsed["meshes"])
    scales = [node["extras"] for node in parsed["nodes"] if "scale" in node.get("extras", {})]
    assert {scale["quantity"] for scale in scales} == {name.rsplit(" [", 1)[0] for name in maps}
    for scale in scales:
        steps = scale["scale"]
        assert all(low["to"] == high["from"] for low, high in pairwise(steps))
        assert len({step["colour"] for step in steps}) == len(steps)
