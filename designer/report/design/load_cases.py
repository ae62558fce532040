"""The load cases: what each changes, and what the chosen rope meets in it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from designer.analysis.findings import Findings
from designer.model.load_case import LoadCase, Wind
from designer.report import format as fmt
from designer.report.blocks import Column, Heads, Row, Section, Statement, Table
from designer.report.design.source import Source
from designer.report.material_class import class_of
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult
from designer.selection.family_need import CaseNeed
from designer.selection.samples import FEW_SAMPLES
from designer.statics.cable_loss import Fate
from designer.study import Study

_PARTS: dict[str, Callable[[LoadCase], bool]] = {
    "dynamic factor": lambda case: case.dynamic_factor > 1.0,
    "acceleration": lambda case: case.acceleration_m_per_s2 > 0.0,
    "wind": lambda case: case.wind is not None,
    "ice": lambda case: case.ice is not None,
    "loss of a cable": lambda case: case.cable_lost is not None,
    "change of temperature": lambda case: bool(case.temperature_change_K),
}
"""What a load case can have, for what none of a study has."""


def loads_statement(study: Study) -> Statement:
    """Return in what loads the answer holds, and what is in none of them."""
    cases = study.load_cases
    lacking = [name for name, has in _PARTS.items() if not any(map(has, cases))]
    without = f"no {fmt.listing(lacking, 'or')}" if lacking else ""
    if not cases:
        return Statement("Loads", f"One static load case, at rest: {without} is in it.", "doubt")
    names = fmt.listing(case.name for case in cases)
    lacks = f" {fmt.capital(without)} is in any of them." if lacking else ""
    what = "cable" if study.selection is None else "rope"
    return Statement("Loads", f"The {what} is to hold in every load case: {names}.{lacks}")


def section(source: Source) -> Section | None:
    """Return what the chosen rope meets in each load case; None where the study has none."""
    study, selection = source.analysis.study, source.analysis.selection
    if source.analysis.needs:
        return _of_family(source, source.analysis.needs)
    if not study.load_cases or selection is None:
        return None
    chosen = selection.chosen
    leaves_out = study.workspace is not None and study.workspace.hangs_below == "exclude"
    return Section.of(
        "load-cases",
        "Load cases",
        _statement(chosen),
        *carried_away(source.analysis.findings),
        _asked(study),
        None if chosen is None else _met(chosen, leaves_out=leaves_out),
        _LEFT_OUT if leaves_out else None,
        _lost(chosen) if chosen is not None else None,
        _HOW,
        None if chosen is None else _warmed(study, chosen),
        _pulleys(source),
        "The configured family, the shares of the region that sizes serve, stiffness and clearance "
        "are those of the static load of the study; the maps of the chosen rope are those of the "
        "case named there.",
    )


_HOW = (
    "Wind makes ½ · 1.25\u00a0kg/m³ · v² of pressure, times drag coefficient and area on the "
    "platform, at the origin of its frame, and times drag coefficient and diameter on each "
    "unstrained length of a cable, along the wind and at full speed whatever the cable's "
    "inclination. The dynamic factor is on weight and wrench of the platform, not on the "
    "cables' own weight; an inertia force points where it is worst, as far as a search from "
    "14 directions finds it, and so does wind that may come from all directions, from 8. Not "
    "covered: the inertia of the cables' own mass, and the swing of the platform until it rests "
    "after the loss of a cable, which may double the change of the tensions."
)


def _of_family(source: Source, needs: tuple[CaseNeed, ...]) -> Section:
    """Return what each load case needs of the configured family."""
    study = source.analysis.study
    leaves_out = study.workspace is not None and study.workspace.hangs_below == "exclude"
    columns: Heads = (
        *("Load case", Column("Diameter"), Column("Largest tension"), Column("Cable")),
        *("Platform at", "Direction or loss"),
    )
    most = source.analysis.most_needed
    rows = [_need_row(one, governs=one is most and one.is_held) for one in needs]
    caption = (
        "The thinnest diameter of the configured family that was found for each load case, with "
        "its own ice and drag, where the case asks for most."
    )
    keeps = any(case.temperature_change_K for case in study.load_cases)
    return Section.of(
        "load-cases",
        "Load cases",
        *carried_away(source.analysis.findings),
        _asked(study),
        Table.of(caption, columns, *rows),
        _LEFT_OUT if leaves_out else None,
        _HOW,
        _KEPT if keeps else None,
        _pulleys(source),
        "The maps are those of the static load of the study; stiffness and clearance are those of "
        "the thickest of these cables, in that load.",
    )


_KEPT = (
    "By a change of temperature cables grow as the study says, else as steel does, by 12 × 10⁻⁶ "
    "per kelvin (EN 1993-1-1, 3.2.6), and braked winches let the platform settle. Winches that "
    "regulate the pose change lengths instead, and no tension."
)


def _need_row(one: CaseNeed, *, governs: bool) -> Row:
    met, found = one.governing.verification, one.governing
    size, tension = fmt.millimetres(one.diameter_m), fmt.newtons(met.max_tension_N)
    cells = (
        found.case.name,
        size if one.is_held else "none holds",
        tension if one.is_held else fmt.MISSING,
        str(found.most_used or "") if one.is_held else fmt.MISSING,
        fmt.position(met.worst_place[:3]),
        fmt.printed(found.loaded.words) or fmt.MISSING,
    )
    return Row(cells, "good" if governs else "" if one.is_held else "bad")


def carried_away(findings: Findings) -> Iterator[Statement]:
    """Yield the load cases in which the platform would be blown or pulled away."""
    for one in findings.adrift:
        case, robot = one.loaded.case, one.loaded.robot
        how = "blown" if case.wind is not None else "pulled"
        words = fmt.printed(one.loaded.words)
        text = (
            f"In the load case '{case.name}', {words}, straight cables cannot hold the "
            f"platform in {fmt.share(one.share)} of the poses in which they hold it at rest, such "
            f"as {fmt.position(one.place)}: it is pushed with {fmt.newtons(one.push_N)} and weighs "
            f"{fmt.newtons(robot.weight_N)}. Only the weight of rope that hangs far below could "
            "hold it there, if anything, so a rope's length, mass and cost mean little. Park it in "
            "a region of its own where cables hold it, or make it heavier in this case."
        )
        yield Statement(f"The platform would be {how} away", text, "bad")


def _pulleys(source: Source) -> str:
    cases = source.analysis.study.load_cases
    if source.analysis.built.robot.pulley_radius_m == 0.0 or not any(case.wind for case in cases):
        return ""
    return (
        "In wind the pulleys stay upright and face the attachment points, while the cables bow out "
        "of their planes; pulleys that swivel freely would follow the bow."
    )


def _statement(chosen: Candidate | None) -> Statement:
    if chosen is None:
        text = "The reasons stand with each size in the table of candidates."
        return Statement("No rope holds in every load case", text, "bad")
    most = chosen.governing
    where = fmt.position(most.verification.worst_place[:3])
    words = f", {fmt.printed(most.loaded.words)}" if most.loaded.words else ""
    text = (
        f"The load case '{most.case.name}' governs: cable {most.most_used} is used to "
        f"{fmt.utilisation(most.utilisation)} with the platform at {where}{words}."
    )
    return Statement("The chosen rope is strong enough in every load case", text, "good")


def _asked(study: Study) -> Table:
    rows = [Row((case.name, _changes(case))) for case in study.load_cases]
    caption = "The load cases. What is not named is as in the rest of the study."
    return Table.of(caption, ("Load case", "Changes"), *rows)


def _from(wind: Wind) -> str:
    if wind.direction is not None:
        return "in one direction"
    return "from its worst direction" if wind.count is None else f"in {wind.count} directions"


def _changes(case: LoadCase) -> str:
    """Return what a load case changes of the study."""
    parts = []
    if case.mass_kg is not None:
        parts.append(f"platform of {fmt.kilograms(case.mass_kg)}")
    if case.wrench_N is not None:
        force = ", ".join(fmt.trimmed(float(x)) for x in case.wrench_N)
        parts.append(f"wrench ({force})\u00a0N, N·m")
    if case.dynamic_factor > 1.0:
        parts.append(f"dynamic factor {fmt.trimmed(case.dynamic_factor)}")
    if case.acceleration_m_per_s2 > 0.0:
        parts.append(f"acceleration {fmt.trimmed(case.acceleration_m_per_s2)}\u00a0m/s²")
    if case.wind is not None:
        speed = f"{fmt.trimmed(case.wind.speed_m_per_s)}\u00a0m/s"
        pressure = f"{fmt.trimmed(case.wind.pressure_Pa)}\u00a0Pa"
        parts.append(f"wind of {speed} {_from(case.wind)}, pressure {pressure}")
    if case.ice is not None:
        parts.append(f"ice {fmt.millimetres(case.ice.thickness_m)} thick around the cables")
    if case.temperature_change_K:
        parts.append(f"cables {_warmer(case)}, winches braked")
    if case.cable_lost is not None:
        which = "each cable in turn" if case.cable_lost == "each" else f"cable {case.cable_lost}"
        parts.append(f"{which} lost")
    if case.safety_factor is not None:
        parts.append(f"safety factor {fmt.trimmed(case.safety_factor)}")
    if case.termination_efficiency is not None:
        parts.append(f"end fittings keep {fmt.percent(case.termination_efficiency)}")
    if case.region is not None:
        low, high = case.region.bounds_m
        parts.append(f"platform between {fmt.position(low)} and {fmt.position(high)}")
    return fmt.capital("; ".join(parts)) or "Nothing: the static load"


_LEFT_OUT = (
    "Poses in which a cable hangs below the platform are left out, as configured: in each load "
    "case, and in each direction of its wind and inertia force, those in which one hangs then. "
    "Where a cable is lost, how they hang before counts."
)


def _met(chosen: Candidate, *, leaves_out: bool) -> Table:
    columns: Heads = (
        *("Load case", Column("Used"), Column("Largest tension"), Column("Allowable")),
        *([Column("Axial stiffness")] if chosen.cable.stiffening else []),
        *(Column("Cable"), "Platform at", "Direction or loss"),
        *([Column("Poses that count")] if leaves_out else []),
        "Verdict",
    )
    rows = [_row(one, one is chosen.governing, leaves_out=leaves_out) for one in chosen.cases]
    return Table.of(f"{fmt.capital(chosen.name)}, in each load case at its worst.", columns, *rows)


def _row(found: CaseResult, governs: bool, *, leaves_out: bool) -> Row:
    met, cable = found.verification, found.loaded.cable
    largest, allowable = fmt.newtons_alike(met.max_tension_N, cable.allowable_tension_N)
    verdict = "holds" if met.holds else "does not hold"
    return Row(
        (
            found.case.name,
            fmt.utilisation(met.utilisation),
            largest,
            allowable,
            *([fmt.newtons(cable.axial_stiffness_N)] if cable.stiffening else []),
            str(found.most_used or ""),
            fmt.position(met.worst_place[:3]),
            fmt.printed(found.loaded.words) or "–",
            *([fmt.share(found.sampled.counted, found.sampled.samples)] if leaves_out else []),
            f"{verdict}, governs" if governs else verdict,
        ),
        "good" if governs else "",
    )


def _warmer(case: LoadCase) -> str:
    change = case.temperature_change_K or 0.0
    return f"{fmt.trimmed(abs(change))}\u00a0K {'warmer' if change > 0.0 else 'colder'}"


def _lost(chosen: Candidate) -> str:
    """Return what becomes of the platform at the worst pose of each case that keeps lengths."""
    parts = []
    for found in chosen.cases:
        loss = found.loss
        if loss is None:
            continue
        fate = Fate(int(loss.fate[0]))
        what = [f"without cable {found.loaded.lost_cable}"] if found.loaded.lost_cable else []
        what += [_warmer(found.case)] if found.case.temperature_change_K else []
        words, is_lost = fate.words, found.loaded.lost_cable is not None
        if fate is Fate.RESTS_ELSEWHERE or (fate is Fate.HOLDS and not is_lost):
            at, moved = fmt.position(loss.rest.position_m[0]), float(loss.moved_m[0])
            away = fmt.millimetres(moved) if moved < 1.0 else fmt.metres(moved)
            words = f"{Fate.RESTS_ELSEWHERE.words}, {away} away at {at}"
        parts.append(f"'{found.case.name}': {', '.join(what)}, at the pose above, {words}.")
    if not parts:
        return ""
    return (
        f"{fmt.capital(' '.join(parts))} There the cables keep the lengths that they had, as on "
        "braked winches; what the loss of a cable itself sets swinging is not in this but by a "
        f"dynamic factor, nor is what the platform may strike. Each was followed from "
        f"{FEW_SAMPLES} samples and the corners of the region, that of the chosen rope from more, "
        "and searched between them."
    )


def _warmed(study: Study, chosen: Candidate) -> str:
    """Return what a change of temperature does to winches that regulate, and what grows by it."""
    cases = [case for case in study.load_cases if case.temperature_change_K]
    if not cases:
        return "Winches hold each pose, so a change of temperature changes lengths and no tension."
    cable, given, table = chosen.cable, cases[0].expansion_per_K, chosen.grade.thermal_expansion
    if given is not None:
        expansion, whose = given, "as the study gives it"
    elif table is not None:
        expansion, whose = cable.expansion_per_K, f"by the table of {chosen.grade.id}"
    else:
        expansion, whose = cable.expansion_per_K, "that of steel (EN 1993-1-1, 3.2.6)"
        if class_of(chosen.grade) == "fibre":
            whose += f", which a rope of {chosen.grade.material} need not have"
    largest = max(abs(case.temperature_change_K or 0.0) for case in cases)
    paid_m = abs(expansion) * largest * float(chosen.verification.longest_m.max())
    grows = f"{fmt.trimmed(1e6 * expansion)}\u202f×\u202f10⁻⁶ per kelvin"
    return (
        f"By a change of temperature cables grow by {grows}, {whose}; "
        "exit points and platform are taken to stay as they are. With braked winches the platform "
        f"settles. Winches that regulate the pose pay out or haul in up to "
        f"{fmt.millimetres(paid_m)} instead, and no tension changes: then such a case asks for no "
        "more than its other loads do."
    )
