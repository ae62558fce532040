"""`designer sweep`: a study over values of its fields."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from designer.cli.options import INTERRUPTED, NoPlugins, Template, argument, output_option

if TYPE_CHECKING:
    import xarray as xr


def sweep(
    plan: Annotated[Path, argument("SWEEP", "What to vary, a YAML file.")],
    output: Annotated[Path | None, output_option("SWEEP.zarr", "STORE")] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, max=1024, help="Processes; all processors if left out.")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A running Dask cluster to solve on.")
    ] = None,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Solve a study for many values of its fields, and keep what you name of each.

    \b
        study: crane.yaml
        vary:
          robot.platform.mass: {from: 100 kg, to: 300 kg, count: 21}
          selection.safety_factor: [4, 5, 6]
        keep: [selection.chosen.utilisation, selection.chosen.total_mass_kg]

    Writes a Zarr store for xarray.open_zarr, and beside it STORE-report with a report of
    trade-offs. A sweep that was ended in any way goes on with the same command. Values that are no
    valid study are kept with the reason.

    Example:  designer sweep masses.yaml --workers 4

    Exit status 0: all points are solved. 2: the input is wrong, or the store cannot be written.
    130: it was ended by Ctrl-C.
    """
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out, show
    from designer.io.output import file_names, output_folder
    from designer.io.process import ends_gently

    announce_compiling()

    from designer.sweeps import run as running
    from designer.sweeps.plan import read_sweep
    from designer.sweeps.report import write_sweep
    from designer.sweeps.run import opened, read_store, report_folder

    laid_out = read_sweep(plan, with_plugins=not no_plugins)
    print_left_out(laid_out.base.catalogue().problems)
    path = output or Path(f"{plan.stem}.zarr")
    count = workers or running.processor_count()
    make = running.processes(count)
    if cluster:
        make, count = running.cluster(cluster)
    folder = report_folder(path)
    with output_folder(folder) as building:  # made first: what is in its way shows before the work
        with opened(path, laid_out) as store, ProgressBars() as bars:
            before = laid_out.n_points - sum(map(len, store.pending()))
            if before:
                print_left_out([f"{path}: goes on after {before} of {laid_out.n_points} points"])
            with ends_gently() as stop:
                running.run(laid_out, store, make, count, bars, stop)
            n_pending = sum(map(len, store.pending()))
            if n_pending:
                progress = f"{laid_out.n_points - n_pending} of {laid_out.n_points} points"
                why = f"ended with {progress}, which stay; the same command goes on"
                print_left_out([f"{path}: {why}"])
                raise typer.Exit(INTERRUPTED)
        dataset = read_store(path)
        write_sweep(dataset, plan.stem, building, template)
        written = file_names(building)
    _print_summary(dataset)
    show(f"{path}, {folder}: {', '.join(written)}", markup=False)


def _print_summary(dataset: xr.Dataset) -> None:
    """Print the range of each number that is kept, and why points have none."""
    import numpy as np
    from rich.markup import escape

    from designer.analysis.result_json import evaluates_answer
    from designer.cli.terminal import bare_table, show
    from designer.sweeps.report import NOT_EVALUATED, unit_of

    table = bare_table(
        "", "least", "median", "most", "points", title=_points(dataset.sizes["point"])
    )
    for name, column in dataset.filter_by_attrs(role="kept").items():
        values = (
            column.values[~np.isnan(column.values)] if column.dtype.kind == "f" else np.array([])
        )
        if len(values):
            figures = (np.min(values), np.median(values), np.max(values))
            unit = unit_of(column.attrs)
            label = f"{name} [{unit}]" if unit else str(name)
            table.add_row(escape(label), *(f"{x:.5g}" for x in figures), str(len(values)))
    if table.row_count:
        show(table)
    if not evaluates_answer(str(name) for name in dataset.filter_by_attrs(role="kept")):
        show(NOT_EVALUATED, markup=False)
    reasons, counts = np.unique([why for why in dataset.reason.values if why], return_counts=True)
    for count, why in sorted(zip(counts, reasons, strict=True), reverse=True)[:10]:
        show(f"{_points(count)}: {why}", markup=False)


def _points(count: int) -> str:
    return f"{count} point{'' if count == 1 else 's'}"
