"""The tables that the commands print at their end, and the lines below them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.markup import escape

from designer.cli.terminal import bare_table, show
from designer.grades.grade import TYPICAL_LOAD_FRACTION, Grade
from designer.grades.listing import facts
from designer.model.load_case import STATIC
from designer.model.verdict import Answer
from designer.spelling import kilograms, position, stated

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis
    from designer.analysis.pose import PoseAnalysis
    from designer.selection.groups import GroupChoice
    from designer.selection.result import SelectionResult
    from designer.study import Selection, Study
    from designer.workspace.sweep import WorkspaceMap


_MOST_TURNS = 12
"""Turns of the loop that are shown; near poses that no cable can hold it makes hundreds."""
bad = "[bold red]{}[/]".format

Row = tuple[str, ...]


def print_rows(title: str, rows: Iterable[Row], *headings: str) -> None:
    """Print a table."""
    table = bare_table(*headings, title=title)
    for row in rows:
        table.add_row(*row)
    show(table)


def print_written(folder: Path, written: Sequence[str]) -> None:
    """Print what was written into a folder, and why there is no PDF."""
    from designer.report.templates import why_no_pdf

    show(f"{folder}: {', '.join(written)}", markup=False)
    if why_no_pdf():
        show(why_no_pdf(), markup=False)


def print_summary(analysis: Analysis, folder: Path, written: Sequence[str]) -> None:
    """Print the short table at the end of ``designer report``."""
    print_rows(analysis.study.name, summary_rows(analysis))
    print_written(folder, written)


def summary_rows(analysis: Analysis) -> Iterator[Row]:
    """Yield label and text of each line of that table."""
    if analysis.pose is not None:
        sizing = analysis.pose.sizing
        yield "pose", _extreme(float(sizing.diameter_m), float(sizing.statics.largest_tension_N))
        if analysis.study.pose_outside:
            yield "", bad(analysis.study.pose_outside)
    if analysis.workspace is not None:
        yield from _summary_of_workspace(analysis.workspace)
    for need in analysis.needs:
        verification = need.governing.verification
        text = (
            _extreme(need.diameter_m, verification.max_tension_N)
            if need.is_held
            else bad("no cable")
        )
        yield f"  {escape(need.governing.case.name)}", text
    if analysis.groups is not None:
        yield from _summary_of_groups(analysis.groups, analysis.selection)
    for label, text in analysis.hanging.notes():
        yield label, bad(text)
    if analysis.selection is not None:
        label = "cable" if analysis.groups is None else "one for all"
        yield from _summary_of_selection(analysis.selection, label, analysis.study.selection)
    if analysis.uncertainty is not None and analysis.uncertainty.is_asked:
        from designer.report.phrases import in_a_sentence

        yield "  probability", in_a_sentence(analysis.uncertainty).replace("\u00a0", " ")
    yield from _summary_of_requirements(analysis)


def _summary_of_workspace(workspace: WorkspaceMap) -> Iterator[Row]:
    census = workspace.census
    if census.is_all_left_out:
        yield "worst pose", bad("none: every pose is left out")
    elif not workspace.is_feasible:
        part = "all" if census.statuses["solved"] else "any"
        yield "worst pose", bad(f"none: no cable was found that serves {part} of it")
    for label, extreme in (("worst pose", workspace.sagging), ("  massless", workspace.massless)):
        if extreme is not None:
            text = _extreme(extreme.diameter_m, extreme.max_tension_N)
            yield label, f"{text} at {position(extreme.place)}"
    if workspace.massless is None and not census.is_all_left_out:
        yield "  massless", "none: straight cables do not hold every pose"
    for name, count in census.statuses.items():
        if count > 0:
            text = f"{count} of {census.samples} ({census.fraction(name):.1%})"
            yield f"  {name.replace('_', ' ')}", text


def _extreme(diameter_m: float, tension_N: float) -> str:
    if not np.isfinite(diameter_m):
        return "no cable"
    force = f"{tension_N:.4g} N" if tension_N < 1e3 else f"{figure(tension_N / 1e3, 2)} kN"
    return f"{figure(1e3 * diameter_m, 3)} mm, {force}"


def _summary_of_selection(
    selection: SelectionResult, label: str, request: Selection | None
) -> Iterator[Row]:
    yield from _summary_of_chosen(selection, label, request)
    for exclusion in selection.exclusions:
        yield f"  not chosen: {exclusion.sizes}", escape(f"{exclusion.why}; {exclusion.example}")


def _summary_of_chosen(
    selection: SelectionResult, label: str, request: Selection | None
) -> Iterator[Row]:
    chosen = selection.chosen
    if chosen is None:
        yield label, f"{bad('none')}: {escape(selection.reason or '')}"
        return
    assert request is not None
    yield label, f"[bold]{escape(chosen.grade.id)}, {escape(chosen.size.id)}[/]"
    losses = "no loss" if chosen.efficiency == 1.0 else f"{chosen.efficiency:.3g} left"
    lost_at = "end fittings, bends and sheaves"
    terms = f"at safety factor {request.safety_factor:g}, {losses} at {lost_at}"
    case = chosen.governing.case
    terms = terms if case is STATIC else f"in the load case '{escape(case.name)}'"
    if selection.preference:
        yield "  preference", escape(selection.preference)
    yield "  utilisation", f"{chosen.verification.utilisation:.1%} {terms}"
    for result in chosen.cases:
        if result.case is not STATIC:
            verification, cable = result.verification, result.most_used
            more = f"; {escape(result.loaded.words)}" if result.loaded.words else ""
            tension = f"{verification.max_tension_N / 1e3:.4g} kN"
            used = f"{verification.utilisation:.1%}, cable {cable} with {tension}"
            yield (
                f"  {escape(result.case.name)}",
                f"{used}, at {position(verification.worst_place[:3])}{more}",
            )
    mass = (
        f"{chosen.cable.rope_density_kg_per_m:.4g} kg/m, {kilograms(chosen.total_mass_kg)} in all"
    )
    yield "  mass", mass
    if chosen.cable.attached:
        masses = (f"{line.linear_density_kg_per_m:.4g}" for line in chosen.cable.attached)
        yield "  attached along it", f"{', '.join(masses)} kg/m"


def _summary_of_requirements(analysis: Analysis) -> Iterator[Row]:
    """Yield the answer, and each requirement that is not known to hold."""
    interference = None if analysis.qualities is None else analysis.qualities.interference
    if interference is not None and interference.worst is None:
        yield "clearance", "nothing to compare: all cables meet at the platform"
    terms, answer, count = analysis.terms, analysis.answer, len(analysis.requirements)
    head = f"[bold{' yellow' if terms.subject_to else ''}]{escape(terms.head(answer))}[/]"
    yield "[bold]answer[/]", f"{head}; {count - len(analysis.unmet)} of {count} hold"
    if omissions := terms.omissions(answer):
        yield "", escape(omissions)
    for condition in terms.subject_to:
        yield "  subject to", escape(f"{condition.what}. {condition.sentences}")
    for loss in analysis.findings.equilibrium_losses if analysis.answer is Answer.NO else ():
        words = f"straight cables cannot hold the platform in {loss.share:.1%} of the poses"
        yield f"  '{escape(loss.loaded.case.name)}'", bad(f"{words}, whatever the rope")
    for requirement in analysis.unmet:
        labels = [] if requirement.cable is None else [f"cable {requirement.cable}"]
        if requirement.load_case != "all":
            labels.insert(0, f"'{requirement.load_case}'")
        if requirement.place is not None:
            labels.append(f"at {position(requirement.place[:3])}")
        words = f"{requirement.words}; {', '.join(labels)}" if labels else requirement.words
        yield f"  {requirement.title.lower()}", bad(escape(words))


def _summary_of_groups(choice: GroupChoice, selection: SelectionResult | None) -> Iterator[Row]:
    chosen = choice.chosen
    if not chosen.is_found:
        yield "groups", f"{bad('none')}: {escape(choice.proof_sentence)}"
        return
    n_products = len(chosen.products)
    yield "cables", f"[bold]{n_products} product{'' if n_products == 1 else 's'} for the groups[/]"
    utilisation = chosen.verification.utilisation
    for group, rope, used in zip(chosen.groups, chosen.ropes, utilisation, strict=True):
        yield f"  {escape(group.name)}", f"{escape(rope.label)}, {used:.1%} used"
    saving = ""
    if choice.saving_kg is not None and abs(choice.saving_kg) < 1e-6:
        saving = ", as with one product for all"
    elif choice.saving_kg is not None:
        saving = (
            f", {kilograms(abs(choice.saving_kg))} {'less' if choice.saving_kg > 0.0 else 'more'}"
        )
    gap = "proved least" if choice.proof == "optimal" else f"gap {choice.gap:.2%}"
    mass = f"{kilograms(chosen.total_mass_kg)} in all{saving}"
    if choice.objective == "mass":
        yield "  groups' mass", f"{mass}; {gap}"
    else:  # what is proved is told of what was minimised
        yield "  groups' mass", mass
        is_estimated = selection is not None and selection.price_estimate is not None
        estimate = ", a borrowed estimate" if is_estimated else ""
        yield "  groups' cost", f"{choice.total:.4g} {choice.unit} in all{estimate}; {gap}"


def print_pose(study: Study, pose: PoseAnalysis) -> None:
    """Print the sizing of the configured pose."""

    statics = pose.sizing.statics
    show(f"{study.name}: {statics.sentence}", markup=False)
    print_rows("Sizing", _sizing_rows(pose), "", "diameter [mm]", "largest tension [N]")
    if pose.loop.iterates and not pose.loop.has_converged:
        show(f"loop: {pose.loop.outcome}")
    if statics.is_solved:
        table = bare_table(
            "cable", "length [m]", "F_x [N]", "F_z [N]", "tension at exit [N]", "at platform [N]",
            title="Cables at the optimum",
        )  # fmt: skip
        columns = (
            statics.length_m, statics.force_x_N, statics.force_z_N,
            statics.exit_tension_N, statics.platform_tension_N,
        )  # fmt: skip
        for index, (length, *forces) in enumerate(zip(*columns, strict=True), 1):
            table.add_row(str(index), figure(length, 8), *(figure(force, 3) for force in forces))
        show(table)
        closure = float(pose.sizing.closure_residual_m)
        balance = float(pose.sizing.equilibrium_residual_N)
        show(f"residuals: closure {closure:.1e} m, equilibrium {balance:.1e} N")
    outside = f"The configured pose {study.pose_outside}." if study.pose_outside else ""
    for remark in (outside, pose.caution, pose.rest.sentence if pose.rest else ""):
        if remark:
            show(remark, markup=False, soft_wrap=True)


def _sizing_rows(pose: PoseAnalysis) -> Iterator[Row]:
    def figures(diameter_m: float, tension_N: float) -> Row:
        return figure(1e3 * diameter_m, 5), figure(tension_N, 2)

    sizing = pose.sizing
    yield "massless", *figures(float(sizing.massless_diameter_m), float(sizing.massless_tension_N))
    turns = [
        (f"loop {turn}", *figures(iterate.diameter_m, iterate.max_tension_N))
        for turn, iterate in enumerate(pose.loop.iterates[1:], 1)
    ]
    yield from turns if len(turns) <= _MOST_TURNS else [*turns[:_MOST_TURNS], ("…",), turns[-1]]
    best = figures(float(sizing.diameter_m), float(sizing.statics.largest_tension_N))
    name = "thinnest" if sizing.is_thinnest else "thinnest found"
    yield tuple(f"[bold]{text}[/]" for text in (name, *best))


def figure(value: float, decimals: int) -> str:
    """Return a figure as wide as a column can take; "none" where there is none."""
    if not np.isfinite(value):
        return "none"
    is_plain = value == 0.0 or 10.0**-decimals <= abs(value) < 1e9
    return f"{value:.{decimals}f}" if is_plain else f"{value:.6g}"


def print_grades(grades: Sequence[Grade]) -> None:
    """Print the list of grades, those of one publisher together."""
    table = bare_table(
        "grade", "construction", "material", "sizes", "d [mm]", "MBL [kN]", "trust", "from"
    )
    table.columns[0].no_wrap = True  # an id that is cut is none
    for publisher in sorted({grade.source.publisher for grade in grades}, key=str.casefold):
        table.add_section()
        table.add_row(f"[bold]{escape(publisher)}[/]")
        for grade in grades:
            if grade.source.publisher == publisher:
                n_doubtful = sum(size.doubt is not None for size in grade.sizes)
                loads_kN = [1e-3 * size.minimum_breaking_load_N for size in grade.sizes]
                cells = (
                    f"  {grade.id}",
                    stated(grade.construction, grade.core),
                    stated(grade.material or "", grade.finish.removeprefix("stainless, ")),
                    f"{len(grade.sizes)}" + (f" ({n_doubtful}?)" if n_doubtful else ""),
                    _range(1e3 * grade.sizes[0].diameter_m, 1e3 * grade.thickest.diameter_m),
                    _range(min(loads_kN), max(loads_kN)),
                    grade.trust,
                    grade.origin,
                )
                table.add_row(*map(escape, cells))
    show(table)
    show(
        "trust: A maker's or standard's table, B seller's transcript, C third hand; (n?) doubtful "
        "sizes; for document and address: designer catalog show GRADE"
    )


def _range(start: float, last: float) -> str:
    ends = (f"{start:.4g}", f"{last:.4g}")
    return "–".join(dict.fromkeys(ends))


def print_grade(grade: Grade) -> None:
    """Print all that is known of one grade; a column that is empty is left out."""
    print_rows(grade.id, ((name, escape(text)) for name, text in facts(grade)))
    price = f"price [{grade.currency}/m]"
    sizes = bare_table(
        *("size", "d [mm]", "MBL [kN]", "mass [kg/m]", "A [mm²]", "EA [MN]", price, "doubt")
    )
    for size in grade.sizes:
        area_m2 = grade.metallic_area_m2(size)
        sizes.add_row(
            escape(size.id),
            f"{1e3 * size.diameter_m:.4g}",
            f"{size.minimum_breaking_load_N / 1e3:.4g}",
            f"{size.linear_density_kg_per_m:.4g}",
            "" if area_m2 is None else f"{1e6 * area_m2:.4g}",
            f"{grade.axial_stiffness_N(size) / 1e6:.4g}",
            "" if size.price_per_m is None else f"{size.price_per_m:.4g}",
            escape(size.doubt or ""),
        )
    sizes.columns = [column for column in sizes.columns if any(column.cells)]
    show(sizes)
    if grade.stiffness is not None and len(grade.stiffness.load_fraction) > 1:
        show(f"EA at {TYPICAL_LOAD_FRACTION:g} of the breaking load")
