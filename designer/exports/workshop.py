"""Rows for the workshop: what is to be cut, ended and spooled for each cable, as CSV."""

from __future__ import annotations

import math
from collections.abc import Iterable

from designer.analysis.lengths import FabricatedCable, fabricated_cables
from designer.documents.plain import csv_text
from designer.exports.robot import Export, ExportedRobot
from designer.model.winches import DEAD_TURNS
from designer.statics.inverse import Statics

ENDS = 2
"""Of a cable: at the platform and on the drum."""


def to_csv(exported: ExportedRobot, stem: str) -> Export:
    """Return a row for each cable; units stand in the names of the columns.

    Takes a design that comes to ropes: see `ExportedRobot.has_ropes`.
    """
    analysis, study = exported.analysis, exported.study
    lost = exported.lost_worst
    if study.load_cases:
        lost.append("load cases in what holds at the two poses, where the platform is at rest")
    lost.append("a proof; one that comes upon a worse pose may ask for thicker ropes")
    poses = {"reference": exported.reference, "worst": exported.worst}
    rows = [
        _fabrication(exported, cable)
        | {
            name: value
            for pose, statics in poses.items()
            if statics is not None
            for name, value in _at(pose, statics, cable.number - 1).items()
        }
        | {"remarks": " | ".join(exported.heading(lost))}
        for cable in fabricated_cables(analysis)
    ]
    table: list[Iterable[object]] = [rows[0].keys(), *(row.values() for row in rows)]
    return Export({f"{stem}.csv": csv_text(table).encode()}, tuple(lost))


def _fabrication(exported: ExportedRobot, cable: FabricatedCable) -> dict[str, object]:
    robot, selection, k = exported.robot, exported.study.selection, cable.number - 1
    assert selection is not None
    x, y, z = robot.exit_points_m[k].tolist()
    drum, spooled, positions_m = cable.drum, cable.spooled, robot.winches.positions_m
    lead_m = math.nan
    if positions_m is not None:
        lead_m = math.dist(positions_m[k], robot.exit_points_m[k])
    return {
        "cable": cable.number,
        "grade": cable.grade.id,
        "size": cable.size.id,
        "rope_diameter_m": cable.size.diameter_m,
        "minimum_breaking_load_N": cable.size.minimum_breaking_load_N,
        "linear_density_kg_per_m": cable.size.linear_density_kg_per_m,
        "exit_x_m": x,
        "exit_y_m": y,
        "exit_z_m": z,
        "shortest_unstrained_m": _number(cable.shortest_m),
        "longest_unstrained_m": _number(cable.longest_m),
        "length_to_cut_m": _number(cable.order_m),
        "length_to_cut_rule": _rule(cable),
        "winch_to_exit_point_m": _number(lead_m),
        "terminations": ENDS,
        "termination_efficiency": selection.termination_efficiency,
        "drum_diameter_m": _number(drum.diameter_m if drum else cable.suggested_drum_m),
        "drum_is_from": "study" if drum else "rope table, suggested",
        "drum_turns": _number(cable.turns),
        "drum_layers": spooled.layers if spooled else None,
    }


def _rule(cable: FabricatedCable) -> str:
    dead = f" and {DEAD_TURNS} dead turns on the suggested drum"
    if cable.drum is not None:
        dead = f" and {cable.drum.dead_turns} dead turns on the drum of the study"
    elif math.isnan(cable.suggested_drum_m):
        dead = ", without dead turns as no drum is suggested"
    return (
        f"longest unstrained length from the exit point at 20 °C{dead}, rounded up to 0.1 m; what "
        "lies between winch and exit point and what the end fittings take come on top"
    )


def _at(pose: str, statics: Statics, k: int) -> dict[str, object]:
    names = ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad")
    place = zip(names, statics.poses.place.tolist(), strict=True)
    return {
        **{f"{pose}_{name}": _number(value + 0.0) for name, value in place},
        f"{pose}_unstrained_length_m": _number(float(statics.length_m[k])),
        f"{pose}_exit_tension_N": _number(float(statics.exit_tension_N[k])),
        f"{pose}_platform_tension_N": _number(float(statics.platform_tension_N[k])),
    }


def _number(value: float) -> str | None:
    return None if math.isnan(value) else f"{value:.10g}"
