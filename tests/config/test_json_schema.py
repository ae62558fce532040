"""The schema for editors: it knows every field, takes what the program takes, and refuses slips."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

from designer.documents.document import document_of, read_document
from designer.effects.registry import SHIPPED
from designer.io.config.json_schema import study_schema
from designer.io.config.moved import SCHEMA_FILE, with_modeline, with_schema_moved
from designer.resources import example_file, example_names

SCHEMA = study_schema(SHIPPED.by_id)
EDITOR = Draft7Validator(SCHEMA)


def faults(text: str) -> list[str]:
    data = document_of(text.encode(), "study.yaml").root.data()
    return [error.json_path for error in EDITOR.iter_errors(data)]


def fields(node: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every field with its path, within lists and alternatives too."""
    parts = [*node.get("anyOf", ()), *node.get("oneOf", ())]
    for part in [*parts, node["items"]] if "items" in node else parts:
        yield from fields(part, path)
    for name, field in node.get("properties", {}).items():
        yield f"{path}.{name}", field
        yield from fields(field, f"{path}.{name}")


def test_it_is_a_schema_of_a_draft_that_all_editors_know() -> None:
    Draft7Validator.check_schema(SCHEMA)
    assert "prefixItems" not in json.dumps(SCHEMA)
    assert "$ref" not in json.dumps(SCHEMA)


def test_every_field_says_what_it_means() -> None:
    known = {path: field for path, field in fields(SCHEMA) if not path.startswith(".effects.")}
    assert len(known) > 90
    assert [path for path, field in known.items() if not field["description"]] == []


@pytest.mark.parametrize("name", example_names())
def test_shipped_studies_pass(name: str) -> None:
    assert list(EDITOR.iter_errors(read_document(example_file(name)).root.data())) == []


def test_the_studies_of_the_guide_pass() -> None:
    guide = example_file("fast").with_name("measured-logs.md").read_text(encoding="utf-8")
    studies = re.findall(r"```yaml\n(.*?)```", guide, re.DOTALL)
    assert [faults(study) for study in studies] == [[], []]


def test_options_of_the_starter_study_pass() -> None:
    text = example_file("fast").read_text(encoding="utf-8")
    assert faults(text.replace("  # tension_min", "  tension_min")) == []
    assert faults(f"{text}\nsurroundings: {{temperature: -10 degC}}\nformat: 1") == []


STUDY = """
robot: {anchors: [[0, 0, 0], [50, 0, 0], [25, 43 m, 0]], platform: {mass: 400 kg}}
cable: {grade: unirope-7x19-galvanised}
"""


@pytest.mark.parametrize(
    "more",
    [
        "pose: [25, 20, -5]",
        "pose: {position: [25, 20, -5], euler: {convention: XYZ, angles: [10 deg, 0, 0]}}",
        "workspace: {region: {box: [[1, 2], [1, 2], [-9, -5]]}, samples: null}",
        "workspace: {region: {points: [[1, 2, -3]]}, orientations: [[0, 0, 0.1]]}",
        "load_cases: [{name: storm, wind: {speed: 20 m/s}, cable_lost: each}]",
        "selection: {groups: {west: [1], rest: [2, 3]}, grades: [a, b]}",
        "effects: {anchor_offset: [{cable: 1, z_m: 20 mm}], length_offset: {offset_1_m: 1 mm}}",
        "measurements: {file: a.csv, cable: {linear_mass: 1, axial_stiffness: 1e6},"
        " columns: {t: time_s, x: {to: x_m, unit: mm}}}",
    ],
)
def test_what_the_program_reads_passes(more: str) -> None:
    assert faults(f"{STUDY}{more}") == []


@pytest.mark.parametrize(
    ("more", "place"),
    [
        ("pose: [25, 20]", "$.pose"),
        ("pose: {position: [25, 20, -5], turn: 3}", "$.pose"),
        ("workspace: {region: {prizm: anchors, z: [-9, -5]}}", "$.workspace"),
        ("workspace: {region: {box: [[1, 2], [1, 2], [-9, -5]]}, samples: many}", "$.workspace"),
        ("selection: {safety_factor: 0.5}", "$.selection"),
        ("selection: {objectives: [weight]}", "$.selection"),
        ("load_cases: [{wind: {speed: 20 m/s}}]", "$.load_cases"),
        ("effects: {pulley_radus: {radius_m: 1}}", "$.effects"),
        ("effects: {pulley_radius: {}}", "$.effects.pulley_radius"),
        ("measurement: {file: a.csv}", "$"),
        ("name: 12", "$.name"),
    ],
)
def test_slips_are_refused_where_they_are(more: str, place: str) -> None:
    assert set(faults(f"{STUDY}{more}")) == {place}


def test_a_missing_part_is_told() -> None:
    assert faults("cable: {grade: x}") == ["$"]
    assert faults(STUDY.replace("grade:", "grad:")) == ["$.cable"]


def test_a_study_that_moves_still_names_its_schema() -> None:
    text = with_modeline("name: a\n")
    there = with_schema_moved(text, Path("here"), lambda path: f"../{path.as_posix()}")
    assert there == f"# yaml-language-server: $schema=../here/{SCHEMA_FILE}\nname: a\n"
    for absolute in ("https://example.org/s.json", "/s.json"):
        head = f"# yaml-language-server: $schema={absolute}\n"
        assert with_schema_moved(head, Path("here"), str) == head
