"""`designer export`: whole files or none, what they lose told, refusals in one line."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import pytest
from test_cli import STUDY, WORKSPACE, designer

from designer.exports.robot import ExportedRobot
from designer.io.config import read_study

__all__ = ["designer"]

DRUM = (
    "  winches: {drum_diameter: 600 mm, layers: 3, positions: [[0, 0, -9], [500, 0, -9], "
    "[250, 433.01, -9]], drum: {length: 900 mm, groove_pitch: 40 mm, dead_turns: 2}}\n"
)


def test_files_appear_where_they_are_asked_for(designer, tmp_path) -> None:
    Path("crane.yaml").write_text(STUDY)
    told = designer("export", "crane.yaml", "--to", "caspr")
    assert (told.status, told.out.split()[::2]) == (0, ["crane_bodies.xml", "crane_cables.xml"])
    assert "Not in it: mass, sag and stretch" in told.err
    named = tmp_path / "new" / "a_bodies.xml"
    assert designer("export", "crane.yaml", "--to", "caspr", "-o", str(named)).status == 0
    assert sorted(file.name for file in named.parent.iterdir()) == ["a_bodies.xml", "a_cables.xml"]
    assert named.read_bytes() == Path("crane_bodies.xml").read_bytes()
    back = designer("import", str(named), "--grade", "unirope-7x19-galvanised", "-o", "b.yaml")
    assert (back.status, back.err) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--to", "caspr", "-o", "a.xml"), "ends in _bodies.xml"),
        (("--to", "csv"), "selection: is missing"),
        (("--to", "dxf"), "no format 'dxf' (expected one of caspr, moordyn, mujoco, gltf, csv)"),
        ((), "--to"),
    ],
)
def test_wrong_input_writes_nothing(designer, arguments, words: str) -> None:
    Path("crane.yaml").write_text(STUDY)
    told = designer("export", "crane.yaml", *arguments)
    assert told.status == 2
    assert words in told.err
    assert [file.name for file in Path().iterdir()] == ["crane.yaml"]


@pytest.mark.slow
def test_no_cable_is_a_negative_answer(designer) -> None:
    Path("crane.yaml").write_text(STUDY.replace("[250, 200, -50]", "[-10, 0, -50]"))
    assert ExportedRobot.of(read_study(Path("crane.yaml"))).design is None


@pytest.mark.slow
def test_rows_for_the_workshop(designer) -> None:
    text = (STUDY + WORKSPACE).replace("robot:\n", f"robot:\n{DRUM}")
    Path("crane.yaml").write_text(text)
    told = designer("export", "crane.yaml", "--to", "csv")
    assert told.status == 0, told.err
    rows = list(csv.DictReader(io.StringIO(Path("crane.csv").read_text())))
    assert [row["cable"] for row in rows] == ["1", "2", "3"]
    for row in rows:
        number = {key: float(row[key]) for key in row if key.endswith(("_m", "_N")) and row[key]}
        turn_m = math.hypot(math.pi * (0.6 + number["rope_diameter_m"]), 0.04)
        least_m = number["longest_unstrained_m"] + 2 * turn_m
        assert least_m <= number["length_to_cut_m"] < least_m + 0.1 + 1e-9
        assert "2 dead turns" in row["length_to_cut_rule"]
        assert number["winch_to_exit_point_m"] == pytest.approx(9.0)
        assert (row["terminations"], row["termination_efficiency"]) == ("2", "1.0")
        assert (number["drum_diameter_m"], row["drum_is_from"]) == (0.6, "study")
        for pose in ("reference", "worst"):
            length_m = number[f"{pose}_unstrained_length_m"]
            ends = [number[f"{pose}_{axis}_m"] - number[f"exit_{axis}_m"] for axis in "xyz"]
            chord_m = math.hypot(*ends)
            assert 0.99 < length_m / chord_m < 1.2
            shortest_m, longest_m = number["shortest_unstrained_m"], number["longest_unstrained_m"]
            if pose == "worst":
                assert shortest_m - 1e-6 <= length_m <= longest_m + 1e-6
        # The ends of a cable differ by its weight times the height between them, and by its sag.
        drop_m = number["exit_z_m"] - number["reference_z_m"]
        weight_N_per_m = 9.81 * float(row["linear_density_kg_per_m"])
        difference_N = number["reference_exit_tension_N"] - number["reference_platform_tension_N"]
        assert difference_N == pytest.approx(weight_N_per_m * drop_m, rel=0.01)
        assert row["remarks"].startswith("small crane, exported by cdpr-designer")
