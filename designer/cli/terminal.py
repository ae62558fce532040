"""What the commands print: progress bars, tables, one-line notes."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from designer.io.process import end_at_closed_pipe, is_terminal

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis, PoseAnalysis
    from designer.diagnosis.result import Diagnosis
    from designer.selection.groups.result import GroupChoice
    from designer.selection.result import SelectionResult
    from designer.study import Selection, Study
    from designer.workspace.interference import Interference
    from designer.workspace.result import Census, Extreme, WorkspaceMap


class _Console(Console):
    """Ends as other programs do where nobody reads on; rich would give a negative answer."""

    def on_broken_pipe(self) -> None:
        """Be told of a closed pipe."""
        end_at_closed_pipe()


# A pipe has no width: then tables are as wide as they need to be, not cut at 80 columns. Names may
# hold what rich takes for emoji, such as ":1:".
_out = _Console(highlight=False, emoji=False, width=None if is_terminal(sys.stdout) else 240)
_notes = _Console(stderr=True, highlight=False, emoji=False)
_SMALLEST_SAVING_KG = 1e-6
_MOST_TURNS = 12
"""Turns of the loop that are shown; near poses that no cable can hold it makes hundreds."""
_WIDEST = 1e9
_TOLD_EVERY_S = 5.0
"""Time between lines of progress where output goes to a file."""


class ProgressBars:
    """Context manager that shows one bar a task on standard error."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("{task.description:<10}", markup=False),
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
    """Context manager that shows what is being tried; call it with a new text.

    Where nobody reads on a screen, a line is written from time to time.
    """

    def __init__(self, text: str) -> None:
        self._status = _notes.status(Text(text)) if _notes.is_terminal else None
        self._began_s = self._told_s = time.monotonic()

    def __enter__(self) -> Spinner:
        if self._status is not None:
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._status is not None:
            self._status.stop()

    def __call__(self, text: str) -> None:
        """Show another text."""
        now_s = time.monotonic()
        if self._status is not None:
            self._status.update(Text(text))
        elif now_s - self._told_s >= _TOLD_EVERY_S:
            self._told_s = now_s
            _notes.print(f"{now_s - self._began_s:.0f} s: {text}", markup=False, soft_wrap=True)


def bare_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table whose headings and title are printed as they are, brackets and all."""
    shown = None if title is None else escape(title)
    return Table(
        *map(escape, headings), title=shown, title_justify="left", show_header=bool(headings)
    )


def show(shown: Table | str) -> None:
    """Print a table, or a line with rich's markup, on standard output."""
    _out.print(shown)


def announce_compiling() -> None:
    """Say when the solver has to be compiled, so that the seconds of a first run are no surprise.

    Which parts of it a study needs shows only as it runs, so the note comes when one is compiled.
    """
    from designer.kernel.compiling import tell_of_compiling

    tell_of_compiling(
        lambda: _notes.print("Compiling the solver: once on this machine, up to a minute …")
    )


def print_left_out(problems: Iterable[str]) -> None:
    """Name every plugin, grade or effect that was left out, one line each."""
    for problem in problems:
        _notes.print(problem, markup=False, soft_wrap=True)


def print_summary(analysis: Analysis, folder: Path, written: Sequence[str]) -> None:
    """Print the short table at the end of ``designer report``."""
    table = bare_table(title=analysis.study.name)
    for row in _summary(analysis):
        table.add_row(*row)
    _out.print(table)
    _out.print(f"{folder}: {', '.join(written)}", markup=False)


def _summary(analysis: Analysis) -> Iterator[tuple[str, str]]:
    if analysis.pose is not None:
        sizing = analysis.pose.sizing
        yield "pose", _extreme(float(sizing.diameter_m), float(sizing.statics.largest_tension_N))
        if analysis.study.pose_outside:
            yield "", f"[bold red]{analysis.study.pose_outside}[/]"
    if analysis.workspace is not None:
        yield from _summary_of_workspace(analysis.workspace)
    if analysis.groups is not None:
        yield from _summary_of_groups(analysis.groups)
    for label, text in analysis.hanging.notes():
        yield label, f"[bold red]{text}[/]"
    if analysis.selection is not None:
        label = "cable" if analysis.groups is None else "one for all"
        yield from _summary_of_selection(analysis.selection, label, analysis.study.selection)
    interference = None if analysis.qualities is None else analysis.qualities.interference
    if interference is not None:
        yield "clearance", _clearance(interference)


def _summary_of_workspace(workspace: WorkspaceMap) -> Iterator[tuple[str, str]]:
    if not workspace.is_feasible:
        yield "worst pose", f"[bold red]none: {_why_none(workspace.census)}[/]"
    for label, extreme in (("worst pose", workspace.sagging), ("  massless", workspace.massless)):
        if extreme is not None:
            yield label, _placed(extreme)
    for name, count in workspace.census.statuses.items():
        if count > 0:
            share = workspace.census.fraction(name)
            text = f"{count} of {workspace.census.samples} ({share:.1%})"
            yield f"  {name.replace('_', ' ')}", text


def _why_none(census: Census) -> str:
    if census.excluded == census.samples:
        return "every pose is left out"
    return f"no cable serves {'all' if census.statuses['solved'] else 'any'} of it"


def _placed(extreme: Extreme) -> str:
    at = ", ".join(f"{round(x, 9) + 0.0:.4g}" for x in extreme.position_m)
    text = f"{_extreme(extreme.diameter_m, extreme.max_tension_N)} at ({at}) m"
    turn_deg = np.degrees(extreme.rotation_vector_rad)
    if turn_deg.any():
        text += f", turned by ({', '.join(f'{x:.3g}' for x in turn_deg)})°"
    return text


def _summary_of_selection(
    selection: SelectionResult, label: str, asked: Selection | None
) -> Iterator[tuple[str, str]]:
    chosen = selection.chosen
    if chosen is None:
        yield label, f"[bold red]none[/]: {escape(selection.reason or '')}"
        return
    yield label, f"[bold]{escape(chosen.grade.id)}, {escape(chosen.size.id)}[/]"
    used = chosen.verification.utilisation
    yield "  utilisation", f"{used:.1%} {_terms(asked, chosen.efficiency)}"
    mass = f"{chosen.cable.linear_density_kg_per_m:.4g} kg/m, {chosen.total_mass_kg:.4g} kg in all"
    yield "  mass", mass


def _clearance(found: Interference) -> str:
    worst = found.worst
    if worst is None:
        return "nothing to compare: " + (
            "all cables meet at the platform" if found.samples else "no pose is solved"
        )
    nearest = f"{1e3 * worst.distance_m:.4g} mm between {escape(' and '.join(worst.names))}"
    if not found.is_violated:
        return f"kept, {nearest}"
    return f"[bold red]not kept[/]: {nearest}, {1e3 * found.clearance_m:.4g} mm asked for"


def _summary_of_groups(choice: GroupChoice) -> Iterator[tuple[str, str]]:
    if choice.chosen is None:
        yield "groups", f"[bold red]none[/]: {escape(choice.proof_sentence)}"
        return
    found = zip(choice.groups, choice.chosen.products, strict=True)
    n_products = len({*choice.chosen.products})
    yield "cables", f"[bold]{n_products} product{'' if n_products == 1 else 's'} for the groups[/]"
    for (group, product), used in zip(found, choice.chosen.verification.utilisation, strict=True):
        yield f"  {escape(group.name)}", f"{escape(product.label)}, {used:.1%} used"
    saving = "" if choice.saving_kg is None else _saving(choice.saving_kg)
    gap = "proved least" if choice.proof == "optimal" else f"gap {choice.gap:.2%}"
    yield "  groups' mass", f"{choice.chosen.total_mass_kg:.4g} kg in all{saving}; {gap}"


def _saving(saving_kg: float) -> str:
    """Return what the groups save over one product for all, as it ends a sentence."""
    if abs(saving_kg) < _SMALLEST_SAVING_KG:
        return ", as with one product for all"
    return f", {abs(saving_kg):.4g} kg {'less' if saving_kg > 0.0 else 'more'}"


def print_diagnosis(diagnosis: Diagnosis, folder: Path, written: Sequence[str]) -> None:
    """Print the short table at the end of ``designer diagnose``."""
    table = bare_table(title=diagnosis.study.name)
    for finding in diagnosis.findings:
        values = ", ".join(
            f"{name} = {e.value:.4g} ± {e.std:.2g}" for name, e in finding.parameters.items()
        )
        table.add_row(f"[bold]{escape(finding.effect.key)}[/]", escape(values))
        if finding.rivals:
            table.add_row("  or", escape(", ".join(finding.rivals)))
    if not diagnosis.findings:
        table.add_row("effects", "none found")
    for label, text in _against(diagnosis):
        table.add_row(label, escape(text))
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
            used = f", {choice.utilisation:.1%} used"
            named = f"{choice.grade}, {choice.size_id}{used}" if choice.grade else "none"
            table.add_row(label, escape(named))
    for label, use in (
        ("  the one before", diagnosis.kept),
        ("on the machine", diagnosis.mounted_after),
    ):
        if use is not None:
            too_much = "" if use.utilisation <= 1.0 else ": [bold red]too much[/]"
            table.add_row(label, f"{use.utilisation:.1%} used{too_much}")
    _out.print(table)
    _out.print(f"{folder}: {', '.join(written)}", markup=False)


def _against(diagnosis: Diagnosis) -> Iterator[tuple[str, str]]:
    """Yield what speaks against the model, and what was withdrawn."""
    from designer.diagnosis.trends import in_runs

    bad = "[bold red]{}[/]".format
    for what in diagnosis.not_tried:
        yield bad("no time for"), what
    for event in diagnosis.structure_after.events:
        yield bad("unexplained"), f"goes with {event.text}"
    for carrier in diagnosis.structure_after.present[:1]:
        share = f"{carrier.fraction_of_variance:.0%} of its variance"
        yield bad("unexplained"), f"goes with {carrier.name}, {share}"
        if place := diagnosis.left_in:
            yield "  most in", f"{place.reading}, rows {', '.join(in_runs(place.rows))}"
    if diagnosis.is_scattered:
        times = max(diagnosis.scatter.values())
        yield bad("scatter"), f"{times:.2g} times the noise: more than the sensors explain"
    for doubt in diagnosis.doubts:
        yield bad("not plausible"), doubt
    for gone in diagnosis.withdrawn:
        yield "withdrawn", f"{gone.effect}: {gone.reason.value}"


def _terms(asked: Selection | None, efficiency: float) -> str:
    """Return what a utilisation refers to: safety factor, and what ends and bends take away."""
    assert asked is not None
    losses = "no loss" if efficiency == 1.0 else f"{efficiency:.3g} left"
    return f"at safety factor {asked.safety_factor:g}, {losses} at end fittings and bends"


def _extreme(diameter_m: float, tension_N: float) -> str:
    if not np.isfinite(diameter_m):
        return "no cable"
    return f"{_figure(1e3 * diameter_m, 3)} mm, {_force(tension_N)}"


def _force(force_N: float) -> str:
    return f"{force_N:.4g} N" if force_N < 1e3 else f"{_figure(force_N / 1e3, 2)} kN"


def print_pose(study: Study, pose: PoseAnalysis) -> None:
    """Print the sizing of the configured pose."""
    statics = pose.sizing.statics
    _out.print(f"{study.name}: {statics_sentence(pose)}", markup=False)
    table = bare_table("", "diameter [mm]", "largest tension [N]", title="Sizing")
    sizing = pose.sizing
    rows = [("massless", float(sizing.massless_diameter_m), float(sizing.massless_tension_N))]
    turns = [
        (f"loop {turn}", iterate.diameter_m, iterate.max_tension_N)
        for turn, iterate in enumerate(pose.loop.iterates[1:], 1)
    ]
    shown = turns if len(turns) <= _MOST_TURNS else [*turns[:_MOST_TURNS], None, turns[-1]]
    for row in [*rows, *shown]:
        if row is None:
            table.add_row("…")
        else:
            table.add_row(row[0], _figure(1e3 * row[1], 5), _figure(row[2], 2))
    table.add_row(
        f"[bold]{'thinnest' if sizing.is_thinnest else 'thinnest found'}[/]",
        f"[bold]{_figure(1e3 * float(sizing.diameter_m), 5)}[/]",
        f"[bold]{_figure(float(statics.largest_tension_N), 2)}[/]",
    )
    _out.print(table)
    if pose.loop.iterates and not pose.loop.has_converged:
        _out.print(f"loop: {pose.loop.outcome}")
    if statics.is_solved:
        _print_cables(pose)
    outside = f"The configured pose {study.pose_outside}." if study.pose_outside else ""
    for remark in (outside, pose.caution, pose.rest.sentence if pose.rest else ""):
        if remark:
            _out.print(remark, markup=False, soft_wrap=True)


def _figure(value: float, decimals: int) -> str:
    """Return a figure as wide as a column can take; "none" where there is none."""
    if not np.isfinite(value):
        return "none"
    is_plain = value == 0.0 or 10.0**-decimals <= abs(value) < _WIDEST
    return f"{value:.{decimals}f}" if is_plain else f"{value:.6g}"


def _print_cables(pose: PoseAnalysis) -> None:
    statics = pose.sizing.statics
    table = bare_table(
        "cable", "length [m]", "F_x [N]", "F_z [N]", "tension at exit [N]", "at platform [N]",
        title="Cables at the optimum",
    )  # fmt: skip
    columns = (
        statics.length_m, statics.force_x_N, statics.force_z_N,
        statics.exit_tension_N, statics.platform_tension_N,
    )  # fmt: skip
    for index, (length, *forces) in enumerate(zip(*columns, strict=True), 1):
        table.add_row(str(index), _figure(length, 8), *(_figure(force, 3) for force in forces))
    _out.print(table)
    closure = float(pose.sizing.closure_residual_m)
    balance = float(pose.sizing.equilibrium_residual_N)
    _out.print(f"residuals: closure {closure:.1e} m, equilibrium {balance:.1e} N")


def statics_sentence(pose: PoseAnalysis) -> str:
    """Return the verdict of the configured pose in words."""
    from designer.model.verdict import Verdict

    return Verdict(int(pose.sizing.statics.verdict)).sentence
