"""The formats by their names, and what each needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from designer.exports.caspr import to_caspr
from designer.exports.gltf import to_gltf
from designer.exports.moordyn import to_moordyn
from designer.exports.mujoco import to_mujoco
from designer.exports.robot import Export, ExportedRobot
from designer.exports.workshop import to_csv


@dataclass(frozen=True, slots=True)
class Format:
    """One format."""

    #: from the robot and the stem of the files' names to the files
    write: Callable[[ExportedRobot, str], Export]
    ending: str  #: how the first of them ends
    needs_cables: bool = True  #: whether the design is solved for it
    needs_ropes: bool = False  #: whether that must come to ropes of a catalogue
    needs_maps: bool = False  #: whether it shows maps of the workspace


FORMATS = {
    "caspr": Format(to_caspr, "_bodies.xml", needs_cables=False),
    "moordyn": Format(to_moordyn, ".txt"),
    "mujoco": Format(to_mujoco, ".xml"),
    "gltf": Format(to_gltf, ".glb", needs_maps=True),
    "csv": Format(to_csv, ".csv", needs_ropes=True),
}
