"""What sheaves between platform and drum take of the tension, by an account of its own."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pairs.options import BASES
from pairs.table import analysed
from scipy.interpolate import CubicSpline

from designer.analysis.analyse import Analysis
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.render import rendered

G, UP = 9.81, np.array([0.0, 0.0, 1.0])
"""As the product has it [m/s²]."""
TIME_S = np.array([0.0, 3.0, 6.0, 9.0])
LOSSES = {"sheave_efficiency": 0.93, "sheaves": 3}
BEHIND = 0.93 * 0.93 * 0.93
DRIVEN = {
    **{"drum_diameter": 0.3, "layers": 2, "gear_ratio": 20.0, "efficiency": 0.8},
    "motor": {"torque": 50.0, "power": 2e3},
}


def crane(folder: Path, winches: dict[str, Any], rows: Any = None, **more: Any) -> Analysis:
    """The crane of the pairs with winches, along a path or over its region."""
    base = BASES["crane"]
    text = base | {"robot": base["robot"] | {"winches": winches}}
    text["selection"] = base["selection"] | more
    if rows is not None:
        table = np.column_stack([TIME_S, rows])
        np.savetxt(folder / "p.csv", table, "%.15g", ",", header="time_s,x_m,y_m,z_m", comments="")
        text["workspace"] = {"path": "p.csv"}
    return analysed(text, folder)


def rows_of(seed: int) -> np.ndarray:
    return np.array([6.0, 4.0, 4.0]) + np.random.default_rng(seed).uniform(-1.0, 1.0, size=(4, 3))


def drawn_and_returned_J(rows: np.ndarray, kept: float, efficiency: float) -> np.ndarray:
    """Return the energies (2, n_cables) of a point mass on weightless cables, step by step [J]."""
    exits, place = (
        np.array(BASES["crane"]["robot"]["anchors"]),
        CubicSpline(TIME_S, rows, bc_type="clamped"),
    )
    energies, instants = np.zeros((2, len(exits))), np.linspace(TIME_S[0], TIME_S[-1], 4001)
    for start, end in pairwise(instants):
        middle = 0.5 * (start + end)
        toward = exits - place(middle)
        toward /= np.linalg.norm(toward, axis=1, keepdims=True)
        pull_N = np.linalg.solve(toward.T, 240.0 * (place(middle, 2) + G * UP))
        for k, exit_point in enumerate(exits):
            paid_m = np.linalg.norm(place(end) - exit_point) - np.linalg.norm(
                place(start) - exit_point
            )
            if paid_m < 0.0:  # the drum pulls more than the platform feels, the motor more again
                energies[0, k] += pull_N[k] * -paid_m / kept / efficiency
            else:
                energies[1, k] += pull_N[k] * paid_m * kept * efficiency
    return energies


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("seed", [26, 1130, 40417])
def test_energy_is_that_of_an_integration_step_by_step(tmp_path: Path, seed: int) -> None:
    rows = rows_of(seed)
    analysis = crane(tmp_path, DRIVEN | LOSSES, rows)
    assert analysis.path is not None
    (case,) = analysis.path.cases
    ours, theirs = np.array(case.energy_J), drawn_and_returned_J(rows, BEHIND, 0.8)
    bare = drawn_and_returned_J(rows, 1.0, 0.8)
    assert ours == pytest.approx(theirs, abs=0.02 * theirs.max())  # the rope weighs little
    assert np.abs(bare - theirs).max() > 0.1 * theirs.max()
    (block,) = (row for row in analysis.to_dict()["path"]["winches"] if row["cable"] == 2)
    assert block["energy_drawn_J"] == pytest.approx(theirs[0, 1], abs=0.02 * theirs.max())


def test_torque_and_tension_at_the_drum_by_the_direction(tmp_path: Path) -> None:
    analysis = crane(tmp_path, DRIVEN | LOSSES | {"tension_max": 5000.0}, rows_of(7))
    assert analysis.path is not None
    assert analysis.chosen is not None
    (case,), d = analysis.path.cases, analysis.chosen.size.diameter_m
    asked = {each.id: each for each in analysis.requirements}
    paying = np.gradient(case.statics.length_m, case.motion.time_s, axis=0, edge_order=2) > 0.0
    at_drum = np.where(paying, case.tension_N * BEHIND, case.tension_N / BEHIND)
    torque = at_drum * (0.15 + 1.5 * d) / 20.0
    assert case.drum_tension_N == pytest.approx(at_drum)
    assert case.torque_Nm == pytest.approx(np.where(paying, 0.8 * torque, torque / 0.8))
    # At rest each is about to be hauled in, as a winch meets it at worst.
    most = case.tension_N.max() / BEHIND
    assert asked["winch_tension"].demand == pytest.approx(most, rel=1e-6)
    starting = most * (0.15 + 1.5 * d) / 20.0 / 0.8
    assert asked["winch_torque"].demand == pytest.approx(starting, rel=1e-6)
    power = np.abs(case.power_W).max()
    assert asked["motor_power"].demand == pytest.approx(power)
    header, first, *_ = analysis.path.to_csv().splitlines()
    cells = dict(zip(header.split(","), first.split(","), strict=True))
    assert float(cells["drum_tension_3_N"]) == pytest.approx(at_drum[0, 2], rel=1e-9)


@pytest.mark.parametrize(
    ("fitting", "sheave", "share"),
    [(1.0, None, BEHIND), (0.75, None, 0.75), (0.9, None, BEHIND), (0.75, 0.2, None)],
)
def test_strength_is_held_against_the_drum(
    tmp_path: Path, fitting: float, sheave: float | None, share: float | None
) -> None:
    more: dict[str, Any] = {"termination_efficiency": fitting}
    more |= {} if sheave is None else {"sheave_diameter": sheave}
    analysis = crane(tmp_path, LOSSES, **more)
    chosen = analysis.chosen
    assert chosen is not None
    if share is None:
        assert sheave is not None
        bent = 1.0 - 0.5 / np.sqrt(sheave / chosen.size.diameter_m)
        share = min(0.75, bent * BEHIND)
    (strength,) = (each for each in analysis.requirements if each.id == "breaking_load")
    factor = BASES["crane"]["selection"]["safety_factor"]
    allowable_N = chosen.size.minimum_breaking_load_N * share / factor
    assert strength.capacity == pytest.approx(allowable_N)
    assert strength.utilisation == pytest.approx(strength.demand / allowable_N)


def test_configured_family_is_as_much_thicker_as_its_stress_is_less(tmp_path: Path) -> None:
    base = {name: part for name, part in BASES["crane"].items() if name != "selection"}
    cable = {"density": 7800.0, "youngs_modulus": 1e11, "allowable_stress": 2e8}
    weaker = cable | {"allowable_stress": 2e8 * BEHIND}
    needed = [
        analysed(base | {"cable": c, "robot": base["robot"] | {"winches": w}}, tmp_path).workspace
        for c, w in ((cable, LOSSES), (weaker, {}), (cable, {}))
    ]
    reeved, less, bare = (one.sagging.diameter_m for one in needed if one and one.sagging)
    assert reeved == pytest.approx(less, rel=1e-9)
    assert reeved > 1.05 * bare


def test_pages_say_where_the_rope_bears_most(tmp_path: Path) -> None:
    drawings = Drawings(crane(tmp_path, DRIVEN | LOSSES, rows_of(3)), missing="not drawn here")
    path, answer, assumptions, reactions = (
        " ".join(rendered(section(drawings, name)).body.replace("&nbsp;", " ").split())
        for name in ("path", "answer", "assumptions", "reactions")
    )
    assert "tension at the drum, behind the sheaves" in path
    assert "over the 0.8044 that 3 sheaves at 93.0 % keep where the winch pulls" in path
    assert "over the 0.8044 that 3 sheaves" in answer
    assert "No loss assumed" not in answer
    assert "which is conservative for a cable that rises from there" in assumptions
    assert "1/0.93 of what is counted" in reactions


def test_drum_and_motor_of_each_cable_at_the_governing_pose(tmp_path: Path) -> None:
    analysis = crane(tmp_path, LOSSES | DRIVEN | {"motor": {"torque": 50.0}})
    told = analysis.to_dict()["governing"]["cables"]
    (size,) = {rope.size.diameter_m for rope in analysis.assignment.by_cable}
    for cable in told:
        at_drum = cable["exit_tension_N"] / BEHIND
        assert cable["drum_tension_N"] == pytest.approx(at_drum, rel=1e-12)
        arm = 0.15 + 1.5 * size
        assert cable["motor_torque_Nm"] == pytest.approx(at_drum * arm / 20.0 / 0.8, rel=1e-12)
    page = " ".join(rendered(section(Drawings(analysis), "checks")).body.split())
    assert "At the drum" in page
    assert "torque of the motor" in page
    without = crane(tmp_path, {}).to_dict()["governing"]["cables"]
    assert {cable["motor_torque_Nm"] for cable in without} == {None}
