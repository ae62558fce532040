"""`designer diagnose --plan`: which poses to measure, and what they will tell."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from designer.cli.options import catalogue_of, quantity_of, study_of
from designer.errors import InputError
from designer.spelling import did_you_mean
from designer.units import FORCE, LENGTH, Dimension

if TYPE_CHECKING:
    from designer.analysis.lengths import Lengths
    from designer.cli.terminal import ProgressBars
    from designer.diagnosis.plan import Plan
    from designer.model.cable import Cable
    from designer.model.measurements import Measurements
    from designer.plugins import Plugins
    from designer.study import Study


def write_plan(
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
    from designer.report.plan import write_plan_report
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
    from designer.measured.assign import POSITION, ROTATION_VECTOR

    names = (*POSITION, *ROTATION_VECTOR)[: plan.places.shape[1]]
    return lengths.to_csv(names, plan.places)


def _print_plan(plan: Plan, written: Sequence[str]) -> None:
    """Print what to expect of each unknown, and what the poses do not tell."""
    from designer.cli.tables import bad
    from designer.cli.terminal import bare_table, show
    from designer.report.plan import deviation

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
