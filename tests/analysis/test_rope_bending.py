"""Bending cycles along a path: the rope walked element by element, and the days that it lasts."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pairs.options import BASES
from pairs.table import analysed

from designer.analysis.analyse import Analysis
from designer.analysis.rope_bending import life_requirements
from designer.model.verdict import State

LIFE: dict[str, Any] = {
    "b0": 1.2, "b1": -2.5, "b2": 5.5, "b3": -1.7, "wire_strength": "1770 MPa",
    "source": "made up for a test", "runs_per_day": 30, "days_min": 100,
}  # fmt: skip
ROWS = ((5.0, 4.0, 3.0), (7.0, 4.0, 4.5), (5.5, 5.0, 3.0), (7.0, 3.5, 5.0))


def moving(folder: Path, *, has_drum: bool, **of_winches: Any) -> Analysis:
    """The crane of the pairs there and back along rows, its winches near its exit points."""
    path = np.column_stack([2.0 * np.arange(len(ROWS)), ROWS])
    np.savetxt(folder / "path.csv", path, "%.15g", ",", header="time_s,x_m,y_m,z_m", comments="")
    study: dict[str, Any] = BASES["crane"] | {"workspace": {"path": "path.csv"}}
    study["selection"] = study["selection"] | {
        "sheave_diameter": 0.3, "rope_life": LIFE,
    }  # fmt: skip
    if has_drum:
        positions = np.array(study["robot"]["anchors"]) - [0.0, 0.0, 1.0]
        winches = {
            "positions": positions.tolist(), "drum_diameter": 0.25, "layers": 1,
            "motor": {"torque": 1e6},
        } | of_winches  # fmt: skip
        study["robot"] = study["robot"] | {"winches": winches}
    return analysed(study, folder)


def borne(tension_N: float, d_mm: float, ratio: float, zone: float) -> float:
    """Feyrer's equation, in scalars."""
    lg = math.log10
    size = 0.52 / ((max(d_mm, 4.0) / 16.0) ** 0.3 - 0.48)
    length = 1.49 / (2.49 - ((zone - 2.5) / 57.5) ** -0.14)
    power = LIFE["b1"] + LIFE["b3"] * lg(ratio)
    return size * length * 10 ** (LIFE["b0"] + power * lg(tension_N / d_mm**2) + 5.5 * lg(ratio))


@pytest.mark.parametrize(("has_drum", "kept"), [(False, 1.0), (True, 1.0), (True, 0.9)])
def test_cycles_and_damage_are_those_of_a_rope_that_is_walked(
    tmp_path: Path, has_drum: bool, kept: float
) -> None:
    losses = {"sheave_efficiency": kept, "sheaves": 3} if kept < 1.0 else {}
    analysis = moving(tmp_path, has_drum=has_drum, **losses)
    path = analysis.path
    assert path is not None
    (case,), (cables,) = path.cases, path.bending
    d_m = path.cases[0].loaded.cable.diameter_m
    EA = float(case.loaded.cable.axial_stiffness_N)
    for k, cable in enumerate(cables):
        assert (cable.on_drum is not None) is has_drum
        zone = cable.bent_m / d_m
        for place in range(0, 1000, 97):
            sheave = drum = damage = 0.0
            before: list[bool] | None = None
            for i, (length, tension) in enumerate(
                zip(case.statics.length_m[:, k], case.tension_N[:, k], strict=True)
            ):
                ends = [length, length]
                if has_drum:
                    ends.append(length + 1.0 / (1.0 + tension / EA))
                at = [bool(cable.places_m[place] < end) for end in ends]
                for end, passed in enumerate(
                    at if before is None else map(bool.__ne__, at, before)
                ):
                    if before is None or not passed:
                        continue
                    mean = 0.5 * (tension + case.tension_N[i - 1, k])
                    if length < case.statics.length_m[i - 1, k]:  # hauled in, pulled at the drum
                        mean = mean / (kept * kept * kept if end == 2 else kept)
                    elif end == 2:
                        mean = mean * kept * kept * kept
                    over = 0.25 + d_m if end == 2 else 0.3
                    damage += 0.5 / borne(mean, 1e3 * d_m, over / d_m, zone)
                    sheave += 0.5 * (end < 2)
                    drum += 0.5 * (end == 2)
                before = at
            assert cable.on_sheave[place] == sheave
            assert cable.on_drum is None or cable.on_drum[place] == drum
            assert cable.damage is not None
            assert cable.damage[place] == pytest.approx(damage, rel=1e-9)
        assert cable.cycles.max() >= 1.0


def test_days_that_are_asked_for_are_a_requirement(tmp_path: Path) -> None:
    analysis = moving(tmp_path, has_drum=True)
    (life,) = (
        requirement for requirement in analysis.requirements if requirement.id == "rope_life"
    )
    path = analysis.path
    assert path is not None
    assert path.life is not None
    assert life.demand == 3000.0
    assert life.capacity == min(cable.runs or 0.0 for cable in path.bending[0])
    assert path.is_steel
    fibre = replace(path, is_steel=False)
    for factor, of_path, state in (
        (0.99, path, State.HOLDS),
        (1.01, path, State.FAILS),
        (0.01, fibre, State.OPEN),
    ):
        asked = replace(path.life, days_min=factor * life.capacity / 30.0)
        (other,) = life_requirements(of_path.bent, asked)
        assert other.state is state
    assert {cable.runs for cable in fibre.bending[0]} == {None}
