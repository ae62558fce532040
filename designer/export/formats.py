"""The formats by their names, and what each needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from designer.export.caspr import to_caspr
from designer.export.gltf import to_gltf
from designer.export.moordyn import to_moordyn
from designer.export.mujoco import to_mujoco
from designer.export.robot import Export, ExportedRobot
from designer.export.workshop import to_csv


@dataclass(frozen=True, slots=True)
class Format:
    """One format.

    Parameters
    ----------
    write : callable
        From the robot and the stem of the files' names to the files.
    ending : str
        How the first of them ends.
    needs_cables, needs_ropes : bool
        Whether the design is solved for it, and whether that must come to ropes of a catalogue.
    needs_maps : bool
        Whether it shows maps of the workspace.
    """

    write: Callable[[ExportedRobot, str], Export]
    ending: str
    needs_cables: bool = True
    needs_ropes: bool = False
    needs_maps: bool = False

    def refusal(self, exported: ExportedRobot) -> str:
        """Return why there is nothing to write, in a clause; empty where there is something."""
        if self.needs_ropes and not exported.has_ropes():
            return "No rope serves this study, so there is nothing to cut"
        if self.needs_cables and exported.design is None:
            return "No cable serves this study, so there is nothing to write"
        return ""


FORMATS = {
    "caspr": Format(to_caspr, "_bodies.xml", needs_cables=False),
    "moordyn": Format(to_moordyn, ".txt"),
    "mujoco": Format(to_mujoco, ".xml"),
    "gltf": Format(to_gltf, ".glb", needs_maps=True),
    "csv": Format(to_csv, ".csv", needs_ropes=True),
}
