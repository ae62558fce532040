"""Work with files: the report, tables, the map for ParaView; optimisations and sweeps of plans."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from operator import attrgetter
from pathlib import Path
from typing import Any, Literal

import numpy as np

from designer.documents.plain import csv_text
from designer.errors import Fault, InputError, NothingToExportError, OutputError
from designer.explore.answers import (
    CableReadout,
    MapAnswer,
    RopeRow,
    Ropes,
    map_answer,
    pose_answer,
    quick_ropes,
)
from designer.explore.question import Question
from designer.explore.session import text_of
from designer.io.output import file_names, output_folder, write_file
from designer.plugins import require_ring
from designer.progress import Reporter

ExportContent = Literal[
    "report", "picture", "tables", "vtk", "lengths", "csv", "caspr", "moordyn", "mujoco", "gltf"
]
"""What can be exported; a picture is taken by the window itself, the last are formats of
`designer export`."""
COLUMNS = {
    "utilisation": "utilisation",
    "diameter": "diameter_m",
    "tension": "max_tension_N",
    "governing": "governing_cable",
    "sag": "sag_over_chord",
    "stiffness": "stiffness_N_per_m",
    "frequency": "lowest_frequency_Hz",
    "verdict": "verdict",
    "left_out": "left_out",
    "unserved": "unserved",
}
"""Names of the quantities in files."""
_ROPE_COLUMNS = {
    "grade": "grade.id",
    "size_id": "size.id",
    "maker": "grade.manufacturer",
    "product": "grade.product",
    "construction": "grade.construction",
    "material": "grade.material",
    "trust": "grade.trust",
    "doubt": "size.doubt",
    "diameter_m": "size.diameter_m",
    "linear_mass_kg_per_m": "size.linear_density_kg_per_m",
    "breaking_load_N": "size.minimum_breaking_load_N",
    "allowable_tension_N": "allowable_tension_N",
    "utilisation": "verification.utilisation",
    "max_tension_N": "verification.max_tension_N",
    "total_mass_kg": "figures.mass_kg",
    "cost": "figures.cost",
    "drum_diameter_m": "figures.drum_diameter_m",
    "stiffness_N_per_m": "figures.stiffness_N_per_m",
    "standing": "standing",
    "reason": "reason",
    "is_searched": "verification.is_refined",
}
"""Of each column of the table of ropes, what a row has there."""
_ALL = frozenset(COLUMNS)


@dataclass(frozen=True, slots=True)
class Written:
    """What was written, the first file the one to open; and what a reader must know of it."""

    files: tuple[Path, ...]
    remarks: tuple[str, ...] = ()


def export(
    question: Question,
    reporter: Reporter,
    *,
    content: ExportContent,
    target: Path,
    ropes: Ropes | None = None,
    poses: Path | None = None,
) -> Written:
    """Write files, whole or not at all; raise DesignerError where that fails, or nothing is there.

    The ``content`` ``report`` is what `designer report` writes, into the folder ``target``;
    ``tables``: ``cables.csv``, ``map.csv`` and ``ropes.csv``, with the ``ropes`` as they are shown,
    into that folder; ``vtk``: the map, into a file ``.vtu``; ``lengths``: what `designer lengths`
    writes, at a table of ``poses``, else along the path of the study. Else what `designer export`
    does.
    """
    target = Path(target)
    if content == "report":
        return _report(question, reporter, target)
    if content == "tables":
        return _tables(question, target, ropes)
    if content == "vtk":
        return _vtk(question, target)
    if content == "lengths":
        return _lengths(question, reporter, target, poses)
    return _for_program(question, reporter, content, target)


def _lengths(question: Question, reporter: Reporter, target: Path, poses: Path | None) -> Written:
    """Write the unstrained lengths at poses, as `designer lengths` does."""
    from designer.analysis.analyse import Analysis
    from designer.analysis.lengths import lengths_of, scope_of_lengths
    from designer.io.poses import along_path, poses_in, read_poses

    study, in_motion = question.study, poses is None
    table = along_path(study) if poses is None else read_poses(poses, study.robot)
    turned = poses_in(study.workspace, table)
    analysis = Analysis.begin(study, question.catalogue, reporter=reporter)
    lengths = lengths_of(analysis, turned, in_motion=in_motion)
    if lengths is None:
        raise NothingToExportError("No rope serves this study, so there are no lengths")
    write_file(target, lengths.to_csv(table.names, table.values))
    left_out = (f"{poses}: column {name} holds texts: left out" for name in table.left_out)
    remarks = (*left_out, *lengths.remarks(), *scope_of_lengths(study, in_motion=in_motion))
    return Written((target,), remarks)


def _for_program(question: Question, reporter: Reporter, name: str, target: Path) -> Written:
    """Write the study for another program, as `designer export` does."""
    require_ring("export")
    from designer.exports.formats import FORMATS, export_study

    exported = export_study(FORMATS[name], target, question.study, question.catalogue, reporter)
    lost = tuple(f"Not in it: {line}" for line in exported.lost)
    return Written(tuple(target.parent / file for file in exported.files), lost)


def _report(question: Question, reporter: Reporter, folder: Path) -> Written:
    from designer.analysis.analyse import analyse
    from designer.report.figures.opengl import begin_probe
    from designer.report.render import REPORT_FILES, write_report_files

    begin_probe()
    with output_folder(folder, REPORT_FILES) as building:
        analysis = analyse(question.study, question.catalogue, building, reporter)
        write_report_files(analysis, building, reporter=reporter)
        written = [name for name in REPORT_FILES if (building / name).exists()]
    return Written(tuple(folder / name for name in written))


def _tables(question: Question, folder: Path, ropes: Ropes | None) -> Written:
    cables = map(asdict, pose_answer(question).cables)
    tables = {"cables.csv": _csv([f.name for f in fields(CableReadout)], cables)}
    chart = map_answer(question, fine=True, quantities=_ALL)
    if chart.grids:
        columns = map_columns(chart)
        rows = np.column_stack([*columns.values()])
        tables["map.csv"] = _csv([*columns], (dict(zip(columns, row, strict=True)) for row in rows))
    ropes = ropes or quick_ropes(question)
    if ropes is not None:
        tables["ropes.csv"] = rope_table(ropes)
    with output_folder(folder) as building:
        for name, text in tables.items():
            (building / name).write_bytes(text.encode())
    return Written(tuple(folder / name for name in tables))


def map_columns(chart: MapAnswer) -> dict[str, Any]:
    """Return the columns of all points of a map (n_points,), by their names with SI units."""
    columns = dict(zip(("x_m", "y_m", "z_m"), chart.positions_m.T, strict=True))
    return columns | {
        name: chart.values[key] for key, name in COLUMNS.items() if key in chart.values
    }


def rope_table(ropes: Ropes) -> str:
    axes = ("x_m", "y_m", "z_m")

    def figures(row: RopeRow) -> dict[str, Any]:
        place = [None] * 3 if row.place is None else row.place[:3].tolist()
        columns = {name: attrgetter(path)(row) for name, path in _ROPE_COLUMNS.items()}
        return columns | dict(zip(axes, place, strict=True))

    return _csv([*_ROPE_COLUMNS, *axes], map(figures, ropes.rows))


def _csv(names: Sequence[str], rows: Iterable[dict[str, Any]]) -> str:
    """Return a table as text; what is not a number is an empty cell."""
    cells = ([None if row[k] != row[k] else row[k] for k in names] for row in rows)
    return csv_text([names, *cells])


def _vtk(question: Question, target: Path) -> Written:
    """Write the map as one unstructured grid, with what the columns of the table hold."""
    import pyvista as pv

    if target.suffix != ".vtu":
        raise OutputError(f"{target}: the map for ParaView is a file that ends in .vtu")
    chart = map_answer(question, fine=True, quantities=_ALL)
    if not chart.grids:
        raise OutputError(f"{target}: the study has no workspace, and so no map")
    pieces = pv.MultiBlock()
    for name, grid in chart.grids.items():
        is_list = grid.shape[1] == 1
        axes = (grid[..., axis][..., None] for axis in range(3))
        piece = pv.PolyData(grid[:, 0]) if is_list else pv.StructuredGrid(*axes)
        for key in chart.values:  # VTK counts the first axis first
            piece.point_data[COLUMNS[key]] = chart.on(name, key).T.ravel()
        pieces.append(piece, name)
    with output_folder(target.parent) as building:
        pieces.combine().save(building / target.name)
    return Written((target,))


# From the plans that the commands take


@dataclass(frozen=True, slots=True)
class OptimisedStudy:
    """What an optimisation came to, for the window."""

    headline: str  #: The objective before and after, or that nothing better was found
    variables: tuple[str, ...]  #: What was chosen, each with its value before and after
    trust: tuple[str, ...]  #: How far it is to be believed, a sentence each
    given_text: str  #: The study as the search had it
    text: str | None  #: The study with the better design; None where none was found


def optimised_study(question: Question, reporter: Reporter, *, plan: Path) -> OptimisedStudy:
    """Search for a better design of the study in the window, as `designer optimise` does.

    Raises InputError if the plan is faulty, or is of another study, or the study is not saved.
    """
    require_ring("optimise")
    from designer.optimum.optimise import optimum_of
    from designer.optimum.plan import read_optimisation
    from designer.optimum.report import headline, trust_lines, variable_rows

    laid_out = read_optimisation(plan, question.plugins.with_others)
    _require_study_of(question, plan, laid_out.document.name)
    optimum = optimum_of(laid_out, reporter)
    return OptimisedStudy(
        headline(optimum),
        tuple(f"{name}: {old or '–'} → {new}" for name, old, new, _ in variable_rows(optimum)),
        tuple(trust_lines(optimum)),
        question.text,
        optimum.text if optimum.is_better else None,
    )


def sweep_study(question: Question, reporter: Reporter, *, plan: Path, target: Path) -> Written:
    """Solve a sweep of the study in the window, as `designer sweep` does.

    Writes the store ``target`` and a folder with its report beside it. A sweep that was given up
    goes on with the same plan and store.

    Raises InputError if the plan is faulty, or is of another study, or the study is not saved; or
    if something else is at the target; OutputError if a file cannot be written.
    """
    require_ring("sweep")
    from designer.sweeps import run as running
    from designer.sweeps.plan import read_sweep
    from designer.sweeps.report import write_sweep
    from designer.sweeps.run import opened, read_store, report_folder

    laid_out = read_sweep(plan, question.plugins.with_others)
    _require_study_of(question, plan, laid_out.base.document.name)
    folder, count = report_folder(target), running.processor_count()
    with output_folder(folder) as building:
        with opened(target, laid_out) as store:
            running.run(laid_out, store, running.processes(count), count, reporter)
        write_sweep(read_store(target), plan.stem, building)
        written = file_names(building)
    pages = sorted(written, key=lambda name: not name.endswith(".html"))
    return Written((*(folder / name for name in pages), target))


def _require_study_of(question: Question, plan: Path, study: str) -> None:
    """Refuse a plan that would not begin with what is seen in the window."""
    if Path(study).resolve() != question.path.resolve():
        problem = f"is {study}, and {question.path} is open"
        raise InputError([Fault(str(plan), None, "study", problem, "a plan of the open study")])
    if text_of(question.path) != question.text:
        problem = f"{study} is another in the window than in its file, which the plan starts from"
        raise InputError([Fault(str(plan), None, "study", problem, "a study that is saved")])
