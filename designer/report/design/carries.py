"""What carries the result: sensitivities, reserves, sizes beside the chosen one, the way out."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from designer.analysis.carries import Carries, SizeBeside
from designer.analysis.group_slopes import GroupSlopes
from designer.analysis.reserve import Reserve
from designer.analysis.sensitivities import Sensitivities
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.blocks import (
    Block,
    Column,
    Heads,
    Picture,
    Row,
    Section,
    Statement,
    Table,
)
from designer.report.design.source import Source
from designer.report.pictures import chart

_NAMES = {
    "payload": "Payload",
    "breaking_load": "Breaking load",
    "efficiency": "End fittings and bending keep",
    "modulus": "Stiffness EA",
    "linear_mass": "Mass of the rope",
}
_OF_ALL_GROUPS = ("payload", "breaking_load", "efficiency")
_MOVE_M = 0.01
_MOST_MOVES = 3


def section(source: Source) -> Section | None:
    """Return what carries the result; None where no rope is chosen for all cables."""
    found = source.analysis.carries
    if found is None:
        groups = source.analysis.group_slopes
        return _of_groups(groups) if groups else None
    slopes, moves = found.sensitivities, _moves(found)
    return Section.of(
        "carries",
        "What carries the result",
        _reserves(found),
        _slopes(found, moves),
        _chart(slopes, moves) if source.draws else None,
        slopes.why_not,
        _sizes(found.sizes),
        *_way_out(found),
    )


def _of_groups(groups: tuple[GroupSlopes, ...]) -> Section:
    lacking = [one for one in groups if one.why_not]
    why = ""
    if lacking:
        names = fmt.listing(one.group.name for one in lacking)
        why = f"Without slopes: {names}. {lacking[0].why_not}"
    return Section.of(
        "carries",
        "What carries the result",
        _group_table(groups),
        why,
        "Reserves and the way out of the region are computed for one rope on all cables; of ropes "
        "for groups they are not known.",
    )


def _group_table(groups: tuple[GroupSlopes, ...]) -> Table:
    """Return what each input changes of each group's utilisation."""
    names = [one.group.name for one in groups]
    inputs = [(key, name) for key, name in _NAMES.items() if key in _OF_ALL_GROUPS]
    inputs += [(f"modulus_{name}", f"Stiffness EA of {name}") for name in names]
    inputs += [(f"linear_mass_{name}", f"Mass of the rope of {name}") for name in names]
    rows = [Row(("Used now", "", *(fmt.utilisation(one.utilisation) for one in groups)), "muted")]
    for key, title in inputs:
        each = (_points(0.01 * one.utilisation * one.of(key).elasticity) for one in groups)
        rows.append(Row((title, "1\u00a0%", *each)))
    step = f"{fmt.trimmed(1e3 * _MOVE_M)}\u00a0mm"
    for title, slopes in _group_moves(groups):
        rows.append(Row((title, step, *(_points(_MOVE_M * slope) for slope in slopes))))
    caption = (
        "What changes the utilisation of each group at its own worst pose, in percentage points, "
        "by the slopes of the solved equations, the pose held. Breaking load and fittings are "
        "those of the group's own rope. Of the exit points those that matter most; result.json "
        "has all. A dash: no slope."
    )
    return Table.of(caption, ("Input", Column("More by"), *map(Column, names)), *rows)


def _group_moves(groups: tuple[GroupSlopes, ...]) -> Iterator[tuple[str, list[float]]]:
    """Yield what moves outward, and the exit points that matter most, with the slopes [1/m]."""
    region = [one.of("region").derivative for one in groups]
    if any(region):
        yield "Sides of the region outward", region
    each = np.stack([one.exit_points_per_m for one in groups])
    most = np.nan_to_num(np.abs(each)).max(axis=0)
    for at in np.argsort(-most, axis=None, kind="stable")[:_MOST_MOVES].tolist():
        cable, axis = divmod(at, 3)
        yield f"Exit point {cable + 1} along {'xyz'[axis]}", each[:, cable, axis].tolist()


def _reserves(found: Carries) -> Statement:
    payload, region, platform = found.payload, found.region, found.governing.loaded.bare[0].platform
    parts = []
    if payload is not None:
        alike = ", its loads alike" if platform.wrench_N.any() else ""
        parts.append(
            "Weight and constant loads of the platform may grow by "
            f"{fmt.percent(payload.value - 1.0)} (a platform of "
            f"{fmt.kilograms(payload.value * platform.mass_kg)} instead of "
            f"{fmt.kilograms(platform.mass_kg)}{alike}){_end(payload)}"
        )
    if region is not None:
        parts.append(
            f"The sides of the region may move outward by {fmt.metres(region.value)}{_end(region)}"
        )
    if payload is None:
        parts.append("No end of the reserve in payload was found")
    text = ". ".join(parts)
    return Statement("Reserve", f"{text}. Each alone, by a search over the region at that end.")


def _end(one: Reserve) -> str:
    where = f"at {fmt.position(one.place)}"
    if not one.is_held:
        return f" until a pose {where} is not held at all"
    return f" until {fmt.fixed(100.0 * one.utilisation, 1)}\u00a0% are used, {where}"


def _moves(found: Carries) -> list[tuple[str, float]]:
    """Return what moves outward, and the exit points that matter most, with their slopes [1/m]."""
    moves = [("Sides of the region outward", found.sensitivities.of("region").derivative)]
    slopes = found.sensitivities.exit_points_per_m
    order = np.argsort(-np.abs(np.nan_to_num(slopes)).ravel(), kind="stable")
    for at in order[:_MOST_MOVES].tolist():
        cable, axis = divmod(at, 3)
        slope = float(slopes[cable, axis])
        if math.isfinite(slope):
            moves.append((f"Exit point {cable + 1} along {'xyz'[axis]}", slope))
    return [(name, slope) for name, slope in moves if math.isfinite(slope)]


def _slopes(found: Carries, moves: list[tuple[str, float]]) -> Table:
    slopes, used = found.sensitivities, found.governing.utilisation
    values = {
        "payload": fmt.kilograms(found.governing.loaded.bare[0].platform.mass_kg),
        "breaking_load": fmt.newtons(slopes.of("breaking_load").value),
        "efficiency": fmt.percent(slopes.of("efficiency").value),
        "modulus": fmt.newtons(slopes.of("modulus").value),
        "linear_mass": fmt.kilograms_per_metre(slopes.of("linear_mass").value),
    }
    rows = [
        Row((name, values[key], "1\u00a0%", _points(0.01 * used * slopes.of(key).elasticity)))
        for key, name in _NAMES.items()
    ]
    step = f"{fmt.trimmed(1e3 * _MOVE_M)}\u00a0mm"
    rows += [Row((name, "", step, _points(_MOVE_M * slope))) for name, slope in moves]
    how = "by differences of solved states" if slopes.method == "differences" else (
        "by the slopes of the solved equations, the pose held, since it is the worst"
    )  # fmt: skip
    caption = (
        f"What changes the utilisation of {fmt.utilisation(used)} at the governing pose, {how}. "
        "Of the exit points those that matter most; result.json has all. A dash: no slope."
    )
    columns: Heads = (
        *("Input", Column("Now"), Column("More by")),
        Column("Utilisation", "percentage points"),
    )
    return Table.of(caption, columns, *rows)


def _points(change: float) -> str:
    if math.isnan(change):
        return fmt.MISSING
    text = fmt.fixed(100.0 * change, 3)
    return text if text.startswith("−") else f"+{text}"


def _chart(slopes: Sensitivities, moves: list[tuple[str, float]]) -> Picture | None:
    from designer.report.figures.charts_carries import carries_chart

    each = [(name, slopes.of(key).elasticity) for key, name in _NAMES.items()]
    used = -slopes.of("efficiency").derivative * slopes.of("efficiency").value
    shares = [(name, used * value) for name, value in each if math.isfinite(value)]
    if not shares or not moves:
        return None
    step = f"{fmt.trimmed(1e3 * _MOVE_M)} mm"
    drawn = carries_chart(shares, [(n, 100.0 * _MOVE_M * slope) for n, slope in moves], step)
    found = chart("The same as bars.", "Bars to the left and right of zero", drawn)
    return replace(found, kind="screen")  # paper has it all in the table


def _sizes(sizes: tuple[SizeBeside, ...]) -> Table | None:
    if len(sizes) < 2:
        return None
    columns = (
        *("Size", Column("Diameter"), Column("Largest tension"), Column("Used")),
        *(Column("Safety factor"), Column("All cables"), "Load case"),
    )
    tensions = fmt.newtons_alike(*(one.max_tension_N for one in sizes))
    rows = [
        Row(
            (
                one.candidate.size.id,
                fmt.millimetres(one.candidate.size.diameter_m),
                tension,
                fmt.utilisation(one.utilisation),
                fmt.fixed(one.safety_factor, 2),
                fmt.kilograms(one.candidate.total_mass_kg),
                one.load_case,
            ),
            "good" if one.candidate.standing == "chosen" else "",
        )
        for one, tension in zip(sizes, tensions, strict=True)
    ]
    caption = (
        "The chosen size and those beside it. Those are taken at the samples and at the worst "
        "pose of the chosen one, which may miss a little."
    )
    return Table.of(caption, columns, *rows)


def _way_out(found: Carries) -> Iterator[Block]:
    """Yield how far out of the region the first pose lies that is not held."""
    failures, nearest = found.failures, found.nearest
    if not failures:
        return
    reach = fmt.metres(failures[0].reach_m)
    far = f"over {reach}"
    cells = [fmt.fixed(f.distance_m, 2) if f.distance_m >= 0.0 else far for f in failures]
    text = f"No pose up to {reach} outside the region was found that the rope does not hold."
    if nearest is not None:
        where = fmt.position(nearest.position_m)
        text = (
            f"The nearest pose that the rope does not hold lies {fmt.metres(nearest.distance_m)} "
            f"outside the region, {fmt.printed(nearest.name)}, at {where}: {_why(nearest.why)}."
        )
    yield Statement("Outside the region", text)
    caption = (
        "Distance from the region to the first failure in each direction, in the load case "
        f"'{found.governing.case.name}' and turned as at the governing pose, on ways from corners, "
        "edges and sides straight outward."
    )
    heads: Heads = ("", *(Column(one.name.replace("-", "−"), "m") for one in failures))
    yield Table.of(caption, heads, ("First failure", *cells))


def _why(name: str) -> str:
    if name == "overloaded":
        return "it is used beyond 100\u00a0%"
    verdict = next((one for one in Verdict if one.label == name), None)
    return name if verdict is None else verdict.clause
