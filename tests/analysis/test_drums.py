"""What drums take up, against rope that is laid turn by turn, and what is asked of them."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from pairs.options import BASES
from pairs.table import analysed

from designer.explore.session import Session
from designer.model.cable import Attached
from designer.model.verdict import Answer
from designer.model.winches import Drum
from designer.plugins import find_plugins
from designer.report.design.report import design_report
from designer.report.render import render_html

DRUM = {"length": 0.06, "groove_pitch": 0.0055}


def laid(drum: Drum, rope_m: float, layers: int) -> list[list[float]]:
    """Return the radii of all turns by layers: circles that rest on two of the layer below."""
    pitch = drum.groove_pitch_m or rope_m
    lowest = [(pitch / 2 + k * pitch, drum.diameter_m / 2 + rope_m / 2) for k in range(999)]
    rows = [[turn for turn in lowest if turn[0] + pitch / 2 <= drum.length_m + 1e-9]]
    while len(rows) < layers:
        below, row = rows[-1], []
        for (x, r), (x_next, r_next) in pairwise(below):
            half = math.hypot(x_next - x, r_next - r) / 2
            row.append(((x + x_next) / 2, r + math.sqrt(rope_m**2 - half**2)))
        if len(below) < len(rows[0]):  # there is room at both flanges, beside the outermost turns
            rise = math.sqrt(rope_m**2 - (pitch / 2) ** 2)
            for (x, r), side in ((below[0], -1), (below[-1], 1)):
                row.append((x + side * pitch / 2, r + rise))
        rows.append(sorted(row))
    return [[radius for _, radius in row] for row in rows]


def helix_m(radius_m: float, pitch_m: float) -> float:
    """Return the length of a turn as that of a fine polygon [m]."""
    turn = np.linspace(0.0, 2.0 * np.pi, 20_001)
    points = [radius_m * np.cos(turn), radius_m * np.sin(turn), pitch_m * turn / (2.0 * np.pi)]
    return float(np.linalg.norm(np.diff(points, axis=1), axis=0).sum())


@pytest.mark.cases_by_default(4)
@pytest.mark.parametrize("seed", range(12))
def test_capacity_is_that_of_turns_laid_on_each_other(seed: int) -> None:
    rng = np.random.default_rng([seed, 20261125])
    rope_m = rng.uniform(0.002, 0.04)
    pitch_m = None if seed % 3 == 0 else rope_m * rng.uniform(1.01, 1.5)
    dead, layers = int(rng.integers(0, 5)), int(rng.integers(1, 6))
    length_m = (pitch_m or rope_m) * rng.uniform(7.1, 40.0)
    oversize = rng.uniform(0.0, 0.08)
    drum = Drum(
        rope_m * rng.uniform(15.0, 40.0), length_m, layers, pitch_m, dead, rope_oversize=oversize
    )
    thick_m = rope_m * (1.0 + oversize) if pitch_m is None else rope_m
    rows = laid(drum, thick_m, layers + 2)
    turns = [helix_m(radius, pitch_m or thick_m) for row in rows for radius in row][dead:]
    fitting = sum(map(len, rows[:layers])) - dead
    assert drum.capacity_m(rope_m) == pytest.approx(sum(turns[:fitting]), rel=1e-7)
    # Wound on until the stroke is on it.
    stroke_m = rng.uniform(0.2, 1.0) * sum(turns)
    on = np.cumsum(turns)
    full = int(np.searchsorted(on, stroke_m))
    part = (stroke_m - (on[full - 1] if full else 0.0)) / turns[full]
    layer = int(np.searchsorted(np.cumsum([len(row) for row in rows]), full + dead, side="right"))
    assert drum.spooled(rope_m, stroke_m) == (pytest.approx(full + part, rel=1e-6), layer + 1)
    outer_m = 2.0 * rows[layer][0]
    assert drum.diameters_m(rope_m)[layer] == pytest.approx(outer_m, rel=1e-12)


def test_smooth_drum_has_layers_as_equilateral_triangles() -> None:
    steps = np.diff(Drum(0.5, 1.0, rope_oversize=0.0).diameters_m(0.02))
    assert steps == pytest.approx(2.0 * 0.02 * math.sqrt(3.0) / 2.0)


@pytest.mark.parametrize(
    ("barrel_in", "length_in", "depth_in", "rope_in", "factor"),
    [(18.0, 20.0, 10.0, 0.5, 0.925), (24.0, 24.0, 6.0, 1.0, 0.239)],
)
def test_smooth_drum_takes_up_less_than_trade_factors_allow(
    barrel_in: float, length_in: float, depth_in: float, rope_in: float, factor: float
) -> None:
    """(A + D) A B K, in feet: the factors K of wire rope handbooks allow for oversize rope."""
    trade_m = 0.3048 * (depth_in + barrel_in) * depth_in * length_in * factor
    size_m, rope_m = np.array([barrel_in, length_in]) * 0.0254, rope_in * 0.0254
    drum = Drum(*size_m.tolist(), round(depth_in / rope_in), dead_turns=0)
    assert 0.95 * trade_m < drum.capacity_m(rope_m) < trade_m
    exact = replace(drum, rope_oversize=0.0)
    assert exact.capacity_m(rope_m) > trade_m


@pytest.mark.parametrize(("rope_m", "fits"), [(0.004, True), (0.006, False), (0.0027, False)])
def test_only_ropes_that_fit_the_grooves_are_spooled(rope_m: float, fits: bool) -> None:
    drum = Drum(0.12, 0.2, 2, groove_pitch_m=0.0055)
    assert drum.fits(rope_m) is fits
    assert (drum.capacity_m(rope_m) > 0.0) is fits
    assert (drum.spooled(rope_m, 0.1)[1] > 0) is fits


def test_drum_of_dead_turns_alone_takes_up_nothing() -> None:
    assert Drum(0.1, 0.02, 5, dead_turns=3).capacity_m(0.01) == 0.0


def crane(**winches: Any) -> dict[str, Any]:
    base = BASES["crane"]
    workspace = {"region": {"box": [[5.0, 7.0], [3.0, 5.0], [2.0, 5.0]]}, "samples": 60, "proof": 0}
    return base | {"robot": base["robot"] | {"winches": winches}, "workspace": workspace}


@pytest.mark.slow
def test_spooling_decides_the_answer(tmp_path: Path) -> None:
    short = analysed(crane(drum_diameter=0.12, drum=DRUM), tmp_path)
    (asked,) = (each for each in short.requirements if each.id == "spooling")
    assert not asked.holds
    assert short.answer is Answer.NO
    two = analysed(crane(drum_diameter=0.12, layers=2, drum=DRUM), tmp_path)
    (asked,) = (each for each in two.requirements if each.id == "spooling")
    assert two.answer is Answer.YES
    rope = two.assignment.rope
    assert rope is not None
    stroke_m = rope.verification.longest_m - rope.verification.shortest_m
    assert asked.demand == pytest.approx(stroke_m.max())
    assert asked.cable == stroke_m.argmax() + 1
    # 10 turns in grooves, 3 of them dead, and 9 above.
    low_m = math.pi * (0.12 + 0.005)
    high_m = low_m + 2.0 * math.pi * math.sqrt(0.005**2 - 0.00275**2)
    assert asked.capacity == pytest.approx(
        7 * math.hypot(low_m, 0.0055) + 9 * math.hypot(high_m, 0.0055)
    )


@pytest.mark.slow
def test_a_rope_that_does_not_fit_the_grooves_is_rejected(tmp_path: Path) -> None:
    study = crane(drum_diameter=0.12, layers=3, drum=DRUM | {"groove_pitch": 0.0085, "length": 0.2})
    analysis = analysed(study, tmp_path)
    rope = analysis.assignment.rope
    assert rope is not None and rope.size.id == "5 mm"
    tight = analysed(
        crane(drum_diameter=0.12, layers=3, drum=DRUM | {"groove_pitch": 0.0101, "length": 0.2}),
        tmp_path,
    ).assignment.rope
    assert tight is not None and tight.size.id == "8 mm"


def test_fleet_angle_is_that_at_a_flange(tmp_path: Path) -> None:
    aside = {"sheave_distance": 2.0, "fleet_angle_max": math.radians(0.85)}
    analysis = analysed(crane(drum_diameter=0.12, layers=2, drum=DRUM | aside), tmp_path)
    (fleet,) = (each for each in analysis.requirements if each.id == "fleet_angle")
    assert fleet.demand == pytest.approx(math.degrees(math.atan2(0.03, 2.0)))
    assert (fleet.unit, fleet.holds, analysis.answer) == ("deg", False, Answer.NO)


@pytest.mark.slow
def test_groups_and_the_family_are_spooled_as_well(tmp_path: Path) -> None:
    study = crane(drum_diameter=0.12, layers=2, drum=DRUM)
    groups = {"first": [1], "others": [2, 3]}
    grouped = study | {"selection": study["selection"] | {"groups": groups, "objectives": ["mass"]}}
    analysis = analysed(grouped, tmp_path)
    assert "spooling" in {each.id for each in analysis.requirements}
    assert len(json.loads(analysis.to_json())["winches"]) == 3
    family = {name: part for name, part in study.items() if name != "selection"}
    family["robot"] = study["robot"] | {
        "winches": {"drum_diameter": 0.12, "layers": 2, "drum": {"length": 0.06}}
    }
    analysis = analysed(family, tmp_path)
    (asked,) = (each for each in analysis.requirements if each.id == "spooling")
    assert analysis.workspace is not None
    assert analysis.workspace.sagging is not None
    drum = analysis.built.robot.winches.drum
    assert drum is not None
    needed_m = analysis.workspace.sagging.diameter_m
    assert asked.capacity == pytest.approx(drum.capacity_m(needed_m))
    high = {"name": "high", "region": {"box": [[5.0, 7.0], [3.0, 5.0], [7.0, 9.0]]}}
    both = analysed(family | {"load_cases": [{"name": "low"}, high]}, tmp_path)
    (wider,) = (each for each in both.requirements if each.id == "spooling")
    anchors = np.array(study["robot"]["anchors"])
    box = np.array([[5.0, 7.0], [3.0, 5.0], [2.0, 9.0]])
    spread = np.random.default_rng(3).uniform(*box.T, (20_000, 3))[:, None] - anchors
    lengths_m = np.linalg.norm(spread, axis=-1)  # taut, so that sag and stretch are small
    assert wider.demand > asked.demand + 1.0
    assert wider.demand == pytest.approx(np.ptp(lengths_m, axis=0).max(), rel=0.1)


@pytest.mark.slow
def test_page_and_file_tell_turns_and_layers(tmp_path: Path) -> None:
    analysis = analysed(crane(drum_diameter=0.12, layers=2, drum=DRUM), tmp_path)
    winches = json.loads(analysis.to_json())["winches"]
    assert [row["cable"] for row in winches] == [1, 2, 3]
    assert winches[0]["layers"] == 2
    html = render_html(design_report(analysis))
    assert "on the drum of the study" in html
    assert "Drum capacity" in html
    assert f"{winches[0]['turns']:.1f}" in html


def test_window_edits_the_drum_and_what_is_attached(tmp_path: Path) -> None:
    path = tmp_path / "crane.yaml"
    study = crane(drum_diameter=0.12, layers=2, drum=DRUM)
    study["robot"]["attached"] = {"linear_mass": 0.3, "diameter": 0.01}
    study["selection"] = study["selection"] | {"grades": ["unirope-7x19-galvanised"]}
    path.write_text(yaml.safe_dump(study), encoding="utf-8")
    session = Session.open(path, find_plugins(with_plugins=False))
    session.edit("robot.winches.drum.length", "0.07 m")
    session.edit("robot.attached.linear_mass", "0.4 kg/m")
    question = session.question()
    assert question is not None
    robot = question.study.robot
    assert robot.winches.drum == Drum(0.12, 0.07, 2, 0.0055)
    assert robot.attached == (Attached(0.4, 0.01),)


def test_window_edits_what_is_attached_to_one_cable(tmp_path: Path) -> None:
    path, study = tmp_path / "crane.yaml", crane()
    n_cables = len(study["robot"]["anchors"])
    line = {"linear_mass": 0.3, "diameter": 0.01}
    study["robot"]["attached"] = [line] * (n_cables - 1) + [None]
    path.write_text(yaml.safe_dump(study), encoding="utf-8")
    session = Session.open(path, find_plugins(with_plugins=False))
    session.edit("robot.attached[1].linear_mass", "0.4 kg/m")
    question = session.question()
    assert question is not None
    assert question.study.robot.attached == (
        Attached(0.3, 0.01),
        Attached(0.4, 0.01),
        *[Attached(0.3, 0.01)] * (n_cables - 3),
        Attached(),
    )
