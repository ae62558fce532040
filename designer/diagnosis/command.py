"""`designer diagnose`: measured data beside the model; before there are any, which to measure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from designer.cli.options import (
    Config,
    NoPlugins,
    Template,
    catalogue_of,
    option,
    output_option,
    quantity_of,
    study_of,
)
from designer.errors import InputError
from designer.spelling import did_you_mean, in_runs
from designer.units import FORCE, LENGTH, Dimension

if TYPE_CHECKING:
    from designer.analysis.lengths import Lengths
    from designer.cli.tables import Row
    from designer.cli.terminal import ProgressBars
    from designer.diagnosis.check import Check
    from designer.diagnosis.plan import Plan
    from designer.diagnosis.result import Diagnosis, Estimate
    from designer.model.cable import Cable
    from designer.model.measurements import Measurements
    from designer.plugins import Plugins
    from designer.study import Study


def diagnose(
    config: Config,
    output: Annotated[Path | None, output_option("CONFIG-diagnosis")] = None,
    checks: Annotated[
        bool, typer.Option("--check", help="Search nothing: how well do the declared effects fit?")
    ] = False,
    data: Annotated[
        Path | None,
        option("--data", metavar="CSV", text="Measured data, instead of the study's."),
    ] = None,
    plans: Annotated[
        bool, typer.Option("--plan", help="Before there are data: which poses to measure?")
    ] = False,
    poses: Annotated[
        int | None, typer.Option("--poses", metavar="N", help="With --plan: how many poses.")
    ] = None,
    unknown: Annotated[
        list[str] | None,
        typer.Option(
            "--unknown", metavar="NAME", help="With --plan: instead of measurements.unknown."
        ),
    ] = None,
    length_noise: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH", help="With --plan: deviation of a length, instead of the study's."
        ),
    ] = None,
    tension_noise: Annotated[
        str | None,
        typer.Option(metavar="FORCE", help="With --plan: deviation of a tension, as before."),
    ] = None,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Compare measured data with the model, and find the effect that the model lacks.

    Writes diagnosis.html, diagnosis.pdf, diagnosis.json, residuals.csv and CONFIG.diagnosed.yaml,
    which has what was fitted and found under `effects:`, and how surely it is known under
    `uncertainty:`; `designer report` on it uses both. With --check
    nothing is searched, and check.html, check.pdf and diagnosis.json go into CONFIG-check.

    With --plan there are no data yet: it chooses the poses that tell most of what is unknown, and
    writes plan.csv for the controller, plan.html, plan.pdf and plan.json, with the deviations to
    expect, into CONFIG-plan; with -o FILE.csv the table alone. What is unknown, what will be read
    and its noise stand under `measurements:`, whose file need not be there, or in options.

    \b
    Examples:
      designer diagnose built-crane.yaml
      A month later:  designer diagnose --check built-crane.diagnosed.yaml --data new.csv
      Before:  designer diagnose --plan crane.yaml --unknown anchors --length-noise "1 mm"

    Exit status 0: the model, with what was found, agrees with the data, or the plan tells all that
    is unknown. 1: something is left or not plausible, declared effects do not help, or the plan
    leaves something unknown. 2: the input is wrong.
    """
    asked = (poses, unknown, length_noise, tension_noise)
    if plans:
        is_alone = not checks and data is None
        return _write_plan(config, output, *asked, is_alone, template, no_plugins=no_plugins)
    if any(asked):
        raise InputError.at("designer diagnose", "has options of a plan", "--plan beside them")
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out
    from designer.documents.table import is_bag
    from designer.io.output import file_names, output_folder, require_file
    from designer.measured.read import read_measured

    study, plugins = study_of(config, no_plugins)
    if data is not None and study.measurements is not None:
        if not data.is_file() and not is_bag(data):
            raise InputError.at("--data", f"there is no file {data}", "a CSV file")
        study = replace(study, measurements=study.measurements.of_file(data))
    measured = read_measured(study)
    catalogue = None if checks else catalogue_of(study, plugins)
    announce_compiling()
    folder = output or Path(f"{config.stem}-{'check' if checks else 'diagnosis'}")

    from designer.diagnosis.check import Check, check
    from designer.diagnosis.design import with_design
    from designer.diagnosis.diagnose import diagnose_study
    from designer.diagnosis.report import write_check, write_diagnosis
    from designer.diagnosis.study import diagnosed_config

    doing = "checking" if checks else "searching"
    with output_folder(folder) as building, ProgressBars(doing) as bars:
        require_file(folder / f"{config.stem}.diagnosed.yaml")
        result: Check | Diagnosis
        if catalogue is None:
            result = check(study, measured, bars)
            bars("report")
            write_check(result, building, template)
        else:
            result = diagnose_study(study, measured, bars)
            bars("the design with and without")
            result = with_design(result, catalogue.grades)
            bars("report")
            write_diagnosis(result, building, template)
            residuals = result.residuals_csv()
            (building / "residuals.csv").write_text(residuals, encoding="utf-8")
            text = diagnosed_config(result, folder)
            (building / f"{config.stem}.diagnosed.yaml").write_text(text, encoding="utf-8")
        (building / "diagnosis.json").write_text(f"{result.to_json()}\n", encoding="utf-8")
        written = file_names(building)
    if isinstance(result, Check):
        _print_check(result, folder, written)
        return result.is_positive
    n_known = len(study.known_effects.problems)
    print_left_out(result.study.known_effects.problems[n_known:])
    _print_diagnosis(result, folder, written)
    return result.is_positive


def _print_diagnosis(diagnosis: Diagnosis, folder: Path, written: Sequence[str]) -> None:
    """Print the verdict, and the short table at the end of ``designer diagnose``."""
    errors = [
        f"{kind.name} error {kind.scale * before.heldout.value:.3g} → "
        f"{kind.scale * after.heldout.value:.3g} {kind.unit}"
        for kind, before, after in diagnosis.errors
    ]
    from designer.cli.tables import bad, print_rows, print_written
    from designer.cli.terminal import show

    words = diagnosis.verdict.value.replace("nothing_to_find", "agrees").replace("_", " ")
    answer = f"{words}: {', '.join(errors)} on unseen rows"
    show(answer if diagnosis.is_positive else bad(answer))
    print_rows(diagnosis.study.name, [*_found(diagnosis), *_bettered(diagnosis)])
    print_written(folder, written)


def _estimated(estimate: Estimate) -> str:
    is_known = math.isfinite(estimate.std)
    doubt = f"± {estimate.std:.2g}" if is_known else "(not determined by these rows)"
    return f"{estimate.value:.4g} {doubt}"


def _found(diagnosis: Diagnosis) -> Iterator[Row]:
    """Yield the effects, what speaks against the model, and what was withdrawn."""
    from designer.cli.tables import bad

    if diagnosis.measured.thinned:
        yield "a long log", diagnosis.measured.thinned
    if not diagnosis.measured.has_poses:
        yield "poses", escape(diagnosis.measured.origin_of_poses)
    for finding in diagnosis.findings:
        values = ", ".join(f"{name} = {_estimated(e)}" for name, e in finding.parameters.items())
        yield f"[bold]{escape(finding.effect.key)}[/]", escape(values)
        if finding.rivals or diagnosis.has_no_rivals(finding):
            yield "  or", escape(", ".join(finding.rivals) or "none in the list")
    if diagnosis.is_smooth:
        yield "together", "may have one cause that varies smoothly with position"
    if not diagnosis.findings:
        yield "effects", "none found"
    structure, place = diagnosis.structure_after, diagnosis.left_in
    goes_with = [e.text for e in structure.events]
    goes_with += [
        f"{c.name}, {c.fraction_of_variance:.0%} of its variance" for c in structure.present[:1]
    ]
    times = f"{max(diagnosis.scatter.values(), default=0.0):.2g} times the noise"
    for label, texts in (
        (bad("no time for"), diagnosis.not_tried),
        (bad("unexplained"), [f"goes with {text}" for text in goes_with]),
        ("  most in", [f"{place.reading}, rows {', '.join(in_runs(place.rows))}"] if place else []),
        ("  check next", diagnosis.next_checks),
        (bad("scatter"), [f"{times}: more than the sensors explain"] * diagnosis.is_scattered),
        (bad("not plausible"), diagnosis.doubts),
        ("withdrawn", [f"{gone.effect}: {gone.reason.value}" for gone in diagnosis.withdrawn]),
    ):
        yield from ((label, escape(text)) for text in texts)


def _bettered(diagnosis: Diagnosis) -> Iterator[Row]:
    """Yield the errors and the cables before and after."""
    from designer.cli.tables import bad

    for kind, *errors in diagnosis.errors:
        was, now = (kind.scale * error.heldout.value for error in errors)
        yield f"{kind.name} error", f"{was:.3g} → {now:.3g} {kind.unit} on unseen rows"
    if diagnosis.left_out:
        yield "  left out", diagnosis.left_out
    for each in diagnosis.sessions:
        is_strange = each.session in diagnosis.strange_sessions
        why = f": {bad('not explained by the machine that others fit')}" * is_strange
        yield f"  session {each.session}", f"{each.in_words}{why}"
    if diagnosis.not_held:
        yield "  rows not held", escape(f"{diagnosis.not_held}; not counted")
    choices = (("cable before", diagnosis.design_before), ("after", diagnosis.design_after))
    for label, choice in choices:
        if choice is not None:
            named = f"{choice.grade}, {choice.size_id}, {choice.utilisation:.1%} used"
            yield label, escape(named) if choice.grade else "none"
    uses = (("  the one before", diagnosis.kept), ("on the machine", diagnosis.mounted_after))
    for label, use in uses:
        if use is not None:
            too_much = "" if use.utilisation <= 1.0 else f": {bad('too much')}"
            yield label, f"{use.utilisation:.1%} used{too_much}"


def _print_check(check: Check, folder: Path, written: Sequence[str]) -> None:
    """Print what is left without and with the declared effects, and what to make of it."""
    from designer.cli.tables import print_rows, print_written
    from designer.cli.terminal import show

    print_rows(check.study.name, _left(check), "error", "model", "rms", "95 %", "median")
    for line in check.remarks():
        show(line, markup=False)
    print_written(folder, written)


def _left(check: Check) -> Iterator[Row]:
    from designer.model.measurements import KINDS

    for kind in KINDS:
        for label, model in check.models:
            if deviation := kind.of(model):
                figures = (deviation.rms.value, *deviation.rms.interval, deviation.median)
                value, low, high, median = (f"{kind.scale * x:.4g}" for x in figures)
                yield rf"{kind.name} \[{kind.unit}]", label, value, f"{low} to {high}", median
    for label, model in check.models:
        if model.foretold is not None and model.foretold.n_solved:
            place = model.foretold.position_m
            value, low, high = (f"{1e3 * x:.4g}" for x in (place.value, *place.interval))
            yield r"pose by lengths \[mm]", label, value, f"{low} to {high}", ""


# Before there are data: which poses to measure, and what they will tell.


def _write_plan(
    config: Path,
    output: Path | None,
    n_poses: int | None,
    unknown: Sequence[str] | None,
    length_noise: str | None,
    tension_noise: str | None,
    is_alone: bool,
    template: Path | None,
    *,
    no_plugins: bool,
) -> bool:
    """Choose poses, write and print the plan; tell whether they tell all that is unknown."""
    if not is_alone:
        raise InputError.at("--plan", "has no use for --check or --data", "a plan alone")
    from designer.cli.terminal import ProgressBars, announce_compiling
    from designer.io.output import file_names, output_folder, require_file

    study, plugins = study_of(config, no_plugins)
    _check_options(study, n_poses, unknown or ())
    if study.measurements is None and not (unknown and (length_noise or tension_noise)):
        expected = "unknown and noise there, or --unknown with --length-noise or --tension-noise"
        raise InputError([study.source.fault("measurements", "is missing", expected)])
    length_m = _noise("--length-noise", length_noise, LENGTH)
    tension_N = _noise("--tension-noise", tension_noise, FORCE)
    target = output or Path(f"{config.stem}-plan")
    is_table = target.suffix == ".csv"
    folder = target.parent if is_table else target
    announce_compiling()

    from designer.analysis.lengths import Lengths
    from designer.diagnosis.plan import plan
    from designer.diagnosis.plan_report import write_plan_report
    from designer.selection.assignment import DesignCable

    with output_folder(folder) as building, ProgressBars("planning") as bars:
        if is_table:
            require_file(target)
        cable, name = _cable(study, plugins, bars)
        measurements = _measurements(study, cable)
        if unknown:
            measurements = replace(measurements, unknown=tuple(unknown))
        if length_m or tension_N:
            measurements = replace(measurements, length_noise_m=length_m, tension_noise_N=tension_N)
        answer = plan(study, measurements, cable, n_poses, bars)
        table = _table(
            answer, Lengths(DesignCable(cable, name), answer.statics, ~answer.statics.is_solved)
        )
        (building / (target.name if is_table else "plan.csv")).write_text(table, encoding="utf-8")
        if not is_table:
            bars("report")
            write_plan_report(answer, name, building, template)
            (building / "plan.json").write_text(f"{answer.to_json()}\n", encoding="utf-8")
        written = file_names(building)
    _print_plan(answer, [str(folder / name) for name in written])
    return answer.is_positive


def _check_options(study: Study, n_poses: int | None, unknown: Sequence[str]) -> None:
    """Refuse at once what would be refused once a rope has been chosen."""
    if study.workspace is None:
        expected = "the region in which poses can be measured"
        raise InputError([study.source.fault("workspace", "is missing", expected)])
    if n_poses is not None and n_poses < 1:
        raise InputError.at("--poses", f"is {n_poses}", "a whole number, at least 1")
    known = {name for e in study.known_effects.effects for name in (e.id, e.also_called) if name}
    for name in unknown:
        if name not in known:
            expected = ", ".join(sorted(known)) + did_you_mean(name, sorted(known))
            raise InputError.at("--unknown", f"'{name}' is not known", expected)


def _noise(name: str, text: str | None, dimension: Dimension) -> float | None:
    if text is None:
        return None
    value = quantity_of(name, text, dimension)
    if not 0.0 < value < math.inf:
        raise InputError.at(name, f"is {text}", "more than zero")
    return value


def _cable(study: Study, plugins: Plugins, bars: ProgressBars) -> tuple[Cable, str]:
    """Return the cable on the machine, its name, and what it may be pulled by.

    Where the study says nothing of it, that of the design.
    """
    from designer.analysis.analyse import Analysis
    from designer.model.cable import Cable

    on_machine = study.measurements
    if on_machine is not None:
        strength_N, selection = on_machine.minimum_breaking_load_N or math.inf, study.selection
        if selection is not None:
            reeving = study.robot.winches.reeving_efficiency
            strength_N *= min(selection.termination_efficiency, reeving) / selection.safety_factor
        return on_machine.cable(strength_N), "the cable on the machine"
    bars("no measurements.cable is declared: first the rope of the design")
    # Deviations hardly depend on the rope: it is searched for, and not proved.
    qualities = Analysis.begin(
        study.unproved, catalogue_of(study, plugins), reporter=bars
    ).qualities
    if qualities is None or not isinstance(qualities.cable.cable, Cable):
        expected = "{linear_mass: …, axial_stiffness: …}: the design has no single rope"
        raise InputError([study.source.fault("measurements.cable", "is missing", expected)])
    return qualities.cable.cable, qualities.cable.name


def _measurements(study: Study, rope: Cable) -> Measurements:
    from designer.model.measurements import Measurements

    if study.measurements is not None:  # of one more session
        unknown = study.measurements.all_unknown
        return replace(study.measurements, unknown=unknown, sessions=())
    return Measurements(Path("measured.csv"), rope.rope_density_kg_per_m, rope.axial_stiffness_N)


def _table(plan: Plan, lengths: Lengths) -> str:
    from designer.documents.columns import POSITION, ROTATION_VECTOR

    names = (*POSITION, *ROTATION_VECTOR)[: plan.places.shape[1]]
    return lengths.to_csv(names, plan.places)


def _print_plan(plan: Plan, written: Sequence[str]) -> None:
    """Print what to expect of each unknown, and what the poses do not tell."""
    from designer.cli.tables import bad
    from designer.cli.terminal import bare_table, show
    from designer.diagnosis.plan_report import deviation

    title = f"{len(plan.places)} poses of {plan.n_candidates} that the robot holds: deviations"
    table = bare_table("unknown", "expected", "random poses", title=title)
    for e in plan.expected:
        unit = e.parameter.unit
        table.add_row(e.label, deviation(e.std, unit), deviation(e.std_random, unit))
    show(table)
    if plan.untold:
        names = ", ".join(e.label for e in plan.untold)
        show(bad(f"These poses do not tell: {names}."), soft_wrap=True)
    for path in written:
        show(f"{path} written", markup=False)
