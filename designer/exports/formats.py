"""The formats by their names, and what each needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from designer.api import AnyStudy, as_study
from designer.errors import DesignerError, InputError, NothingToExportError, WrongValueError
from designer.exports.caspr import to_caspr
from designer.exports.gltf import to_gltf
from designer.exports.moordyn import to_moordyn
from designer.exports.mujoco import to_mujoco
from designer.exports.robot import Export, ExportedRobot
from designer.exports.workshop import to_csv
from designer.grades.registry import Catalogue, load_catalogue
from designer.io.output import output_folder, require_file
from designer.plugins import Plugins, named, registered
from designer.progress import SILENT, Reporter
from designer.study import Study


@dataclass(frozen=True, slots=True)
class Format:
    """One format."""

    name: str  #: as `designer export --to` takes it
    write: Callable[[ExportedRobot, str], Export]  #: from robot and stem of the files' names
    ending: str  #: of the first file's name
    needs_cables: bool = True  #: whether the design is solved for it
    needs_ropes: bool = False  #: whether that must come to ropes of a catalogue
    needs_maps: bool = False  #: whether it shows maps of the workspace


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
    formats, problems = registered(plugins, "register_exporters", Format, lambda form: form.name)
    return {name: _guarded(*item) for name, item in formats.items()}, problems


def _guarded(form: Format, label: str) -> Format:
    def write(robot: ExportedRobot, stem: str) -> Export:
        with named(label, f"fails in writing {form.name}", DesignerError):
            made = form.write(robot, stem)
            if not isinstance(made, Export):
                raise TypeError(f"it returned {type(made).__name__}, not an Export")
        return made

    return replace(form, write=write)


def export_study(
    kind: Format, path: Path, study: Study, catalogue: Catalogue, reporter: Reporter
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
    if not path.name.endswith(kind.ending):
        expected = f"a name that ends in {kind.ending}"
        raise InputError.at("--output", f"{path} is no file of {kind.name}", expected)
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


def export(study: AnyStudy, to: str, path: Path | str) -> tuple[str, ...]:
    """Write the study for another program; returns what that cannot take, a line each.

    ``to`` is ``caspr``, ``moordyn``, ``mujoco``, ``gltf`` or ``csv``. As `designer export` does.

    Raises
    ------
    InputError
        If there is no such format, the name of the file has another ending than it, or nothing
        serves the study.
    OutputError
        If it cannot be written.
    """
    if to not in FORMATS:
        raise WrongValueError("export", "to", f"to is {to!r}", ", ".join(FORMATS))
    kind, target, study = FORMATS[to], Path(path), as_study(study)
    if not target.name.endswith(kind.ending):
        raise WrongValueError("export", "path", f"path is {target.name!r}", f"…{kind.ending}")
    try:
        made = export_study(kind, target, study, load_catalogue(), SILENT)
    except NothingToExportError as reason:
        raise InputError.at(study.source.path, str(reason)) from None
    return tuple(made.lost)
