"""The formats by their names, and what each needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from designer.errors import DesignerError
from designer.export.caspr import to_caspr
from designer.export.gltf import to_gltf
from designer.export.moordyn import to_moordyn
from designer.export.mujoco import to_mujoco
from designer.export.robot import Export, ExportedRobot
from designer.export.workshop import to_csv
from designer.plugins import Plugins, named, registered


@dataclass(frozen=True, slots=True)
class Format:
    """One format.

    Parameters
    ----------
    name : str
        As `designer export --to` takes it.
    write : callable
        From the robot and the stem of the files' names to the files.
    ending : str
        How the first of them ends.
    needs_cables, needs_ropes : bool
        Whether the design is solved for it, and whether that must come to ropes of a catalogue.
    needs_maps : bool
        Whether it shows maps of the workspace.
    """

    name: str
    write: Callable[[ExportedRobot, str], Export]
    ending: str
    needs_cables: bool = True
    needs_ropes: bool = False
    needs_maps: bool = False


FORMATS = {
    form.name: form
    for form in (
        Format("caspr", to_caspr, "_bodies.xml", needs_cables=False),
        Format("moordyn", to_moordyn, ".txt"),
        Format("mujoco", to_mujoco, ".xml"),
        Format("gltf", to_gltf, ".glb", needs_maps=True),
        Format("csv", to_csv, ".csv", needs_ropes=True),
    )
}
"""Our own formats."""


def load_formats(plugins: Plugins) -> tuple[dict[str, Format], list[str]]:
    """Return our own formats and those of plugins, and a line for each that is left out."""
    formats, problems = registered(
        plugins, "register_exporters", Format, lambda form: form.name, FORMATS
    )
    return FORMATS | {name: _guarded(*item) for name, item in formats.items()}, problems


def _guarded(form: Format, label: str) -> Format:
    def write(robot: ExportedRobot, stem: str) -> Export:
        with named(label, f"fails in writing {form.name}", DesignerError):
            made = form.write(robot, stem)
            if not isinstance(made, Export):
                raise TypeError(f"it returned {type(made).__name__}, not an Export")
        return made

    return replace(form, write=write)
