"""The formats by their names, and what each needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from designer.errors import InputError, NothingToExportError
from designer.exports.caspr import to_caspr
from designer.exports.gltf import to_gltf
from designer.exports.moordyn import to_moordyn
from designer.exports.mujoco import to_mujoco
from designer.exports.robot import Export, ExportedRobot
from designer.exports.workshop import to_csv
from designer.grades.registry import Catalogue
from designer.io.output import output_folder, require_file
from designer.progress import Reporter
from designer.study import Study


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

    def why_not(self, exported: ExportedRobot) -> str:
        """Say why there is nothing to write; empty where there is."""
        if self.needs_ropes and not exported.has_ropes():
            return "No rope serves this study, so there is nothing to cut: see designer report."
        if self.needs_cables and exported.design is None:
            return "No cable serves this study, so there is nothing to write: see designer report."
        return ""


FORMATS = {
    "caspr": Format(to_caspr, "_bodies.xml", needs_cables=False),
    "moordyn": Format(to_moordyn, ".txt"),
    "mujoco": Format(to_mujoco, ".xml"),
    "gltf": Format(to_gltf, ".glb", needs_maps=True),
    "csv": Format(to_csv, ".csv", needs_ropes=True),
}


def export_study(
    name: str, path: Path, study: Study, catalogue: Catalogue, reporter: Reporter
) -> Export:
    """Write a study for another program, into a file and what belongs beside it.

    Raises
    ------
    InputError
        If the file's name does not end as the format's do, or it cannot hold such a robot.
    NothingToExportError
        If no cable or rope serves the study.
    OutputError
        If a file cannot be written.
    """
    kind = FORMATS[name]
    if not path.name.endswith(kind.ending):
        expected = f"a name that ends in {kind.ending}"
        raise InputError.at("--output", f"{path} is no file of {name}", expected)
    with output_folder(path.parent) as building:
        require_file(path)  # what is in the way shows before the work
        exported = ExportedRobot.of(study, catalogue, reporter, with_maps=kind.needs_maps)
        if kind.needs_ropes and not exported.has_ropes():
            raise NothingToExportError("No rope serves this study, so there is nothing to cut")
        if kind.needs_cables and exported.design is None:
            raise NothingToExportError("No cable serves this study, so there is nothing to write")
        made = kind.write(exported, path.name.removesuffix(kind.ending))
        for file, content in made.files.items():
            (building / file).write_bytes(content)
    return made
