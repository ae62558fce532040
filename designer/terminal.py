"""What the commands print: progress bars, tables, one-line notes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from designer.catalogue.grade import Grade
from designer.catalogue.listing import GradeRow, facts, size_rows
from designer.catalogue.registry import Catalogue

if TYPE_CHECKING:
    from designer.analysis import Analysis, PoseAnalysis
    from designer.diagnosis.result import Diagnosis
    from designer.study import Study

# A pipe has no width: then tables are as wide as they need to be, not cut at 80 columns.
_out = Console(highlight=False, width=None if sys.stdout.isatty() else 240)
_notes = Console(stderr=True, highlight=False)


class ProgressBars:
    """Context manager that shows one bar a task on standard error."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("{task.description:<10}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=_notes,
            disable=not _notes.is_terminal,
        )

    def __enter__(self) -> ProgressBars:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Callable[[int], None]]:
        """Open a task of ``total`` steps; yields the function that advances it."""
        bar = self._progress.add_task(name, total=total)
        yield lambda steps: self._progress.advance(bar, steps)
        self._progress.update(bar, completed=total, total=total)


class Spinner:
    """Context manager that shows what is being tried; call it with a new text."""

    def __init__(self, text: str) -> None:
        self._status = _notes.status(text)

    def __enter__(self) -> Spinner:
        self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._status.stop()

    def __call__(self, text: str) -> None:
        """Show another text."""
        self._status.update(escape(text))


def announce_compiling() -> None:
    """Say that the first run on a machine compiles, so that its seconds are no surprise."""
    from designer.kernel.compiling import is_cached
    from designer.kernel.square import solve_range

    if not is_cached(solve_range):
        _notes.print("Compiling the solver: once on this machine, some seconds …")


def print_faults_of(catalogue: Catalogue) -> None:
    """Name every plugin or file that was left out of the catalogue."""
    for problem in catalogue.problems:
        _notes.print(f"catalogue: {problem}", markup=False)


def print_summary(analysis: Analysis, folder: Path) -> None:
    """Print the short table at the end of ``designer report``."""
    table = Table(title=escape(analysis.study.name), title_justify="left", show_header=False)
    for row in _summary(analysis):
        table.add_row(*row)
    _out.print(table)
    names = ", ".join(sorted(file.name for file in folder.iterdir() if file.is_file()))
    _out.print(f"{folder}: {names}", markup=False)


def _summary(analysis: Analysis) -> Iterator[tuple[str, str]]:
    if analysis.pose is not None:
        sizing = analysis.pose.sizing
        yield "pose", _extreme(float(sizing.diameter_m), float(sizing.statics.largest_tension_N))
    if analysis.workspace is not None:
        workspace = analysis.workspace
        for label, extreme in (
            ("worst pose", workspace.sagging),
            ("  massless", workspace.massless),
        ):
            if extreme is not None:
                at = ", ".join(f"{x:.4g}" for x in extreme.position_m)
                yield label, f"{_extreme(extreme.diameter_m, extreme.max_tension_N)} at ({at}) m"
        for name, count in workspace.census.statuses.items():
            if count > 0:
                share = workspace.census.fraction(name)
                yield (
                    f"  {name.replace('_', ' ')}",
                    f"{count} of {workspace.census.samples} ({share:.1%})",
                )
        if not workspace.is_feasible:
            left_out = workspace.census.excluded == workspace.census.samples
            why = "every pose is left out" if left_out else "part of it has no finite cable"
            yield "worst pose", f"[bold red]none: {why}[/]"
    if analysis.selection is not None:
        chosen = analysis.selection.chosen
        if chosen is None:
            yield "cable", f"[bold red]none[/]: {escape(analysis.selection.reason or '')}"
        else:
            yield "cable", f"[bold]{escape(chosen.grade.id)}, {escape(chosen.size.id)}[/]"
            yield (
                "  utilisation",
                f"{chosen.verification.utilisation:.1%} at safety factor {_factor(analysis)}",
            )
            yield (
                "  mass",
                f"{chosen.size.linear_density_kg_per_m:.4g} kg/m, "
                f"{chosen.total_mass_kg:.4g} kg in all",
            )


def print_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Print the short table at the end of ``designer diagnose``."""
    table = Table(title=escape(diagnosis.study.name), title_justify="left", show_header=False)
    for finding in diagnosis.findings:
        values = ", ".join(
            f"{name} = {e.value:.4g} ± {e.std:.2g}" for name, e in finding.parameters.items()
        )
        table.add_row(f"[bold]{finding.effect.key}[/]", values)
        if finding.rivals:
            table.add_row("  or", ", ".join(finding.rivals))
    if not diagnosis.findings:
        table.add_row("effects", "none found")
    if diagnosis.is_unexplained:
        carrier = diagnosis.structure_after.carriers[0]
        share = f"{carrier.fraction_of_variance:.0%} of its variance"
        table.add_row("[bold red]unexplained[/]", f"goes with {escape(carrier.name)}, {share}")
    for kind, scale, unit in (("length", 1e3, "mm"), ("tension", 1.0, "N")):
        before, after = (
            stage.length_m if kind == "length" else stage.tension_N
            for stage in (diagnosis.stages[0], diagnosis.final)
        )
        if before is not None and after is not None:
            was, now = scale * before.heldout.value, scale * after.heldout.value
            table.add_row(f"{kind} error", f"{was:.3g} → {now:.3g} {unit} on unseen rows")
    for label, choice in (
        ("cable before", diagnosis.design_before),
        ("after", diagnosis.design_after),
    ):
        if choice is not None:
            table.add_row(label, f"{choice.grade}, {choice.size_id}" if choice.grade else "none")
    _out.print(table)
    names = ", ".join(sorted(file.name for file in folder.iterdir() if file.is_file()))
    _out.print(f"{folder}: {names}", markup=False)


def _factor(analysis: Analysis) -> str:
    return f"{analysis.study.selection.safety_factor:g}" if analysis.study.selection else ""


def _extreme(diameter_m: float, tension_N: float) -> str:
    if not np.isfinite(diameter_m):
        return "no cable"
    return f"{1e3 * diameter_m:.3f} mm, {tension_N / 1e3:.2f} kN"


def print_pose(study: Study, pose: PoseAnalysis) -> None:
    """Print the sizing of the configured pose."""
    statics = pose.sizing.statics
    _out.print(f"{study.name}: {statics_sentence(pose)}", markup=False)
    table = Table("", "diameter [mm]", "largest tension [N]", title="Sizing", title_justify="left")
    table.add_row(
        "massless",
        f"{1e3 * float(pose.sizing.massless_diameter_m):.5f}",
        f"{float(pose.sizing.massless_tension_N):.2f}",
    )
    for turn, iterate in enumerate(pose.loop.iterates[1:], 1):
        table.add_row(
            f"loop {turn}", f"{1e3 * iterate.diameter_m:.5f}", f"{iterate.max_tension_N:.2f}"
        )
    table.add_row(
        "[bold]optimum[/]",
        f"[bold]{1e3 * float(pose.sizing.diameter_m):.5f}[/]",
        f"[bold]{float(statics.largest_tension_N):.2f}[/]",
    )
    _out.print(table)
    if statics.is_solved:
        _print_cables(pose)


def _print_cables(pose: PoseAnalysis) -> None:
    statics = pose.sizing.statics
    table = Table(
        "cable", "length [m]", "F_x [N]", "F_z [N]", "tension at exit [N]", "at platform [N]",
        title="Cables at the optimum", title_justify="left",
    )  # fmt: skip
    columns = (
        statics.length_m, statics.force_x_N, statics.force_z_N,
        statics.exit_tension_N, statics.platform_tension_N,
    )  # fmt: skip
    for index, (length, *forces) in enumerate(zip(*columns, strict=True), 1):
        table.add_row(str(index), f"{length:.8f}", *(f"{force:.3f}" for force in forces))
    _out.print(table)
    closure = float(pose.sizing.closure_residual_m)
    balance = float(pose.sizing.equilibrium_residual_N)
    _out.print(f"residuals: closure {closure:.1e} m, equilibrium {balance:.1e} N")


def statics_sentence(pose: PoseAnalysis) -> str:
    """Return the verdict of the configured pose in words."""
    from designer.verdict import Verdict

    return Verdict(int(pose.sizing.statics.verdict)).sentence


def print_grades(rows: Sequence[GradeRow]) -> None:
    """Print the list of grades."""
    table = Table(
        "grade", "construction", "finish", "sizes", "d [mm]", "MBL [kN]", "trust", "from", "source"
    )
    for row in rows:
        table.add_row(
            escape(row.id),
            escape(f"{row.construction} {row.core}"),
            escape(row.finish),
            f"{row.n_sizes}" + (f" ({row.n_doubtful}?)" if row.n_doubtful else ""),
            _range(row.diameter_m, 1e3),
            _range(row.minimum_breaking_load_N, 1e-3),
            row.trust,
            escape(row.origin),
            escape(row.source),
        )
    _out.print(table)
    _out.print(
        "trust: A maker's or standard's table, B seller's transcript, C third hand; "
        "(n?) doubtful rows"
    )


def print_grade(grade: Grade) -> None:
    """Print all that is known of one grade."""
    known = Table(title=escape(grade.id), title_justify="left", show_header=False)
    for name, text in facts(grade):
        known.add_row(name, escape(text))
    _out.print(known)
    sizes = Table("size", "d [mm]", "MBL [kN]", "mass [kg/m]", "EA [MN]", "doubt")
    for row in size_rows(grade):
        sizes.add_row(
            escape(row.id),
            f"{1e3 * row.diameter_m:.4g}",
            f"{row.minimum_breaking_load_N / 1e3:.4g}",
            f"{row.linear_density_kg_per_m:.4g}",
            f"{row.axial_stiffness_N / 1e6:.4g}",
            escape(row.doubt),
        )
    _out.print(sizes)


def _range(ends: tuple[float, float], scale: float) -> str:
    return f"{scale * ends[0]:.4g}–{scale * ends[1]:.4g}"
