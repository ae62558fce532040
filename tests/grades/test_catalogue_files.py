from __future__ import annotations

import os
from pathlib import Path

import pytest
from grade_samples import GRADE_TEXT, write_grade

from designer.errors import InputError
from designer.grades import registry
from designer.grades.grade import ComputedFigure, RelativeStiffness
from designer.grades.registry import grade_files, read_grade, read_grades


def _faults(path: Path, text: str):
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_grade(path)
    return caught.value.faults


def test_a_grade_file_is_read_into_si(tmp_path):
    grade = read_grade(write_grade(tmp_path / "acme.yaml"))

    assert (grade.id, grade.manufacturer, grade.file) == ("acme-7x19", "Acme", "acme.yaml")
    assert grade.modulus.value_Pa == 60e9
    assert grade.sizes[1].id == "6 mm"
    assert grade.sizes[1].diameter_m == pytest.approx(0.006)
    assert grade.sizes[1].minimum_breaking_load_N == pytest.approx(25_000.0)
    assert grade.sizes[1].linear_density_kg_per_m == pytest.approx(0.137)
    assert grade.standard is None
    assert grade.thermal_expansion is None


def test_optional_parts_are_read(tmp_path):
    extra = (
        "area_factor: {value: 0.472, basis: borrowed, source: a rule}\n"
        "thermal_expansion: {value: 12.5e-6 /K, basis: borrowed, source: a sheet}\n"
        "sheave_ratio: {suggested: 24, minimum: 18, source: a table}\n"
        "notes:\n  - one\n  - >-\n    two\n    lines\n"
    )
    grade = read_grade(write_grade(tmp_path / "acme.yaml", GRADE_TEXT + extra))

    assert grade.area_factor is not None
    assert grade.area_factor.value == 0.472
    assert grade.thermal_expansion is not None
    assert grade.thermal_expansion.coefficient_per_K == pytest.approx(12.5e-6)
    assert grade.sheave_ratio is not None
    assert (grade.sheave_ratio.suggested, grade.sheave_ratio.minimum) == (24.0, 18.0)
    assert grade.notes == ("one", "two lines")


def test_material_limits_prices_and_computed_columns_are_read(tmp_path):
    text = GRADE_TEXT.replace("trust: A", "trust: A\nmaterial: stainless steel\ncurrency: EUR")
    text = text.replace("0.137}", "0.137, price_per_m: 4.2}")
    extra = (
        "limits: {temperature_C: [-40, 80], creep: none, source: a sheet}\n"
        "computed:\n  linear_mass: a rule of thumb\n"
    )
    grade = read_grade(write_grade(tmp_path / "acme.yaml", text + extra))

    assert grade.material == "stainless steel"
    assert (grade.currency, grade.sizes[0].price_per_m, grade.sizes[1].price_per_m) == (
        "EUR",
        None,
        4.2,
    )
    assert grade.limits is not None
    assert (grade.limits.temperature_C, grade.limits.creep) == ((-40.0, 80.0), "none")
    assert grade.computed == (ComputedFigure("linear_mass", "a rule of thumb"),)


def test_a_fibre_rope_has_one_stiffness_or_a_table_of_it(tmp_path):
    head, tail = GRADE_TEXT.split("modulus:")
    rest = tail[tail.index("units:") :]
    about = "basis: printed, uncertainty: 0.1, source: a sheet"
    one, table = (
        read_grade(
            write_grade(tmp_path / "acme.yaml", f"{head}stiffness: {{{ratio}, {about}}}\n{rest}")
        )
        for ratio in (
            "ea_over_breaking_load: 56, at_load_fraction: 0.2",
            "by_load_fraction: [[0.1, 40], [0.3, 60]]",
        )
    )

    assert one.modulus is None
    assert one.stiffness == RelativeStiffness((56.0,), (0.2,), "printed", "a sheet", 0.1)
    assert table.stiffness == RelativeStiffness((40.0, 60.0), (0.1, 0.3), "printed", "a sheet", 0.1)


def test_a_figure_may_carry_its_own_unit(tmp_path):
    text = GRADE_TEXT.replace("diameter:  6", "diameter: 0.6 cm").replace("25.0", "25000 N")
    size = read_grade(write_grade(tmp_path / "acme.yaml", text)).sizes[1]

    assert size.diameter_m == pytest.approx(0.006)
    assert size.minimum_breaking_load_N == pytest.approx(25_000.0)


@pytest.mark.parametrize("quoted", ["'25.0'", '" 25.0 "', "'2.5e1'"])
def test_a_quoted_figure_has_the_declared_unit(tmp_path, quoted):
    text = GRADE_TEXT.replace("25.0", quoted)
    size = read_grade(write_grade(tmp_path / "acme.yaml", text)).sizes[1]

    assert size.minimum_breaking_load_N == pytest.approx(25_000.0)


def test_units_of_rope_tables(tmp_path):
    text = GRADE_TEXT.replace("kN, linear_mass: kg/m", "tonf, linear_mass: kg/100m")
    for shown, in_table in (("11.2", "1.142"), ("25.0", "2.549"), ("43.9", "4.477"), ("68.6", "7")):
        text = text.replace(shown, in_table)
    for shown in ("0.061", "0.137", "0.244", "0.381"):
        text = text.replace(shown, f"{100 * float(shown):.1f}")
    size = read_grade(write_grade(tmp_path / "acme.yaml", text)).sizes[0]

    assert size.minimum_breaking_load_N == pytest.approx(1.142 * 9806.65)
    assert size.linear_density_kg_per_m == pytest.approx(0.061)


def test_without_declared_units_bare_numbers_are_si(tmp_path):
    lines = [line for line in GRADE_TEXT.splitlines() if not line.startswith(("units", "  - "))]
    rows = ["  - {id: 6 mm, diameter: 0.006, minimum_breaking_load: 25e3, linear_mass: 0.137}"]
    grade = read_grade(write_grade(tmp_path / "acme.yaml", "\n".join(lines + rows)))

    assert grade.sizes[0].diameter_m == 0.006
    assert grade.sizes[0].minimum_breaking_load_N == 25_000.0


@pytest.mark.parametrize(
    ("old", "new", "line", "field", "words"),
    [
        # mass in another unit than declared: lb/ft printed, kg/m declared
        ("0.244", "0.164", 21, "sizes[2].linear_mass", "the neighbouring sizes"),
        ("0.244", "0.363", 21, "sizes[2].linear_mass", "the neighbouring sizes"),
        ("linear_mass: kg/m}", "linear_mass: lb}", 17, "units.linear_mass", "does not fit"),
        ("linear_mass: kg/m}", "linear_mass: g/mm^2}", 17, "units.linear_mass", "does not fit"),
        ("linear_mass: kg/m}", "linear_mass: t/m}", 18, "sizes", "over the nominal circle"),
        ("43.9", "9.87", 21, "sizes[2].minimum_breaking_load", "% below"),
        ("43.9", "43.9 kg", 21, "sizes[2].minimum_breaking_load", "has the unit"),
        ("43.9", "-43.9", 21, "sizes[2].minimum_breaking_load", "out of range"),
        ("43.9", "much", 21, "sizes[2].minimum_breaking_load", "is not a number"),
        ("43.9", ".nan", 21, "sizes[2].minimum_breaking_load", "not a finite number"),
        ("minimum_breaking_load: kN", "minimum_breaking_load: N", 18, "sizes", "check the units"),
        ("diameter:  8,", "diameter:  5,", 21, "sizes[2].diameter", "5 mm follows 6 mm"),
        ("diameter:  8,", "diameter:  6,", 21, "sizes[2].diameter", "ascending"),
        ("id: 8 mm", "id: 6 mm", 21, "sizes[2].id", "given twice"),
        ("id: 8 mm", "id: 8", 21, "sizes[2].id", "is not a text"),
        (", linear_mass: 0.244", "", 21, "sizes[2].linear_mass", "is missing"),
        ("linear_mass: 0.244", "lineer_mass: 0.244", 21, "sizes[2].lineer_mass", "'linear_mass'"),
        ("manufacturer:", "manufacturr:", 2, "manufacturr", "did you mean 'manufacturer'"),
        ("construction: 7x19", "colour: red", 4, "colour", "unknown field 'colour'"),
        ("value: 60 GPa", "value: 60 kN", 12, "modulus.value", "a stress or a modulus"),
        ("value: 60 GPa", "value: 600 GPa", 12, "modulus.value", "no rope's"),
        ("nominal", "metallic", 13, "modulus.reference_area", "4 of 4 sizes"),
        ("nominal", "gross", 13, "modulus.reference_area", "'nominal' or 'metallic'"),
        ("basis: printed", "basis: guessed", 14, "modulus.basis", "'guessed' is not known"),
        ("uncertainty: 0.05", "uncertainty: 15", 15, "modulus.uncertainty", "a fraction"),
        ("trust: A", "trust: D", 7, "trust", "'D' is not known"),
        ("id: acme-7x19", "id: Acme 7x19", 1, "id", "no grade id"),
        ("product: Hoistline", 'product: "a\\eb"', 3, "product", "not printable"),
        ("product: Hoistline", 'product: "  "', 3, "product", "0 characters"),
        ("diameter: mm", "diameter: m", 19, "sizes[0].diameter", "0.1 mm to 500 mm"),
    ],
)
def test_a_fault_is_named_with_line_and_field(tmp_path, old, new, line, field, words):
    assert old in GRADE_TEXT

    faults = _faults(tmp_path / "acme.yaml", GRADE_TEXT.replace(old, new))

    named = [str(fault) for fault in faults if fault.field == field and fault.line == line]
    assert len(named) == 1
    assert words in named[0]
    assert named[0].startswith(f"{tmp_path / 'acme.yaml'}:{line}: {field}: ")


def test_all_faults_of_a_file_come_at_once_in_the_order_of_lines(tmp_path):
    text = (
        GRADE_TEXT.replace("core:", "coar:")
        .replace("60 GPa", "60 m")
        .replace("11.2", "heavy")
        .replace("id: 10 mm", "id: 10 mm, id: 12 mm")
    )

    faults = _faults(tmp_path / "acme.yaml", text)

    assert [fault.field for fault in faults] == [
        "coar",
        "modulus.value",
        "sizes[0].minimum_breaking_load",
        "sizes[3].id",
    ]


def test_a_wrong_unit_of_a_column_is_one_fault_not_one_for_each_row(tmp_path):
    faults = _faults(tmp_path / "acme.yaml", GRADE_TEXT.replace("kN,", "kNm,"))

    assert [fault.field for fault in faults] == ["units.minimum_breaking_load"]


@pytest.mark.parametrize(
    ("sizes", "words"),
    [("[]", "0 values"), ("6 mm", "is not a list"), ("[6]", "is not a mapping")],
)
def test_a_table_that_is_none_is_refused(tmp_path, sizes, words):
    head = GRADE_TEXT[: GRADE_TEXT.index("sizes:")]

    (fault,) = _faults(tmp_path / "acme.yaml", f"{head}sizes: {sizes}\n")

    assert fault.field.startswith("sizes")
    assert words in fault.problem


def test_a_metallic_area_is_checked_against_the_circle(tmp_path):
    text = GRADE_TEXT.replace("linear_mass: 0.244", "linear_mass: 0.244, metallic_area: 23 cm^2")

    (fault,) = _faults(tmp_path / "acme.yaml", text)

    assert fault.field == "sizes[2].metallic_area"
    assert "of the nominal circle" in fault.problem


@pytest.mark.parametrize(
    ("text", "expected"),
    [("", "(expected a grade,"), ("- 1\n", "(expected fields such as 'id: …')")],
)
def test_a_file_that_holds_no_grade_is_not_called_a_study(tmp_path, text, expected):
    (fault,) = _faults(tmp_path / "rope.yaml", text)
    assert expected in str(fault)
    assert "study" not in str(fault)


def test_a_folder_gives_all_its_grades_and_the_faults_of_the_others(tmp_path):
    write_grade(tmp_path / "b.yaml", grade_id="b")
    write_grade(tmp_path / "deeper" / "a.yml", grade_id="a")
    write_grade(tmp_path / "broken.yaml", GRADE_TEXT.replace("60 GPa", "60"), grade_id="c")
    (tmp_path / "empty.yaml").write_text("")
    (tmp_path / "binary.yaml").write_bytes(b"\x00\x01\x02")
    (tmp_path / "README.md").write_text("not a grade")
    (tmp_path / ".hidden.yaml").write_text("not a grade")

    found, faults = read_grades(tmp_path)

    assert [one.grade.id for one in found] == ["b", "a"]
    assert sorted({Path(fault.file).name for fault in faults}) == [
        "binary.yaml",
        "broken.yaml",
        "empty.yaml",
    ]


def test_one_id_in_two_files_of_a_folder_is_a_fault_that_names_both(tmp_path):
    first = write_grade(tmp_path / "first.yaml")
    second = write_grade(tmp_path / "second.yaml")

    found, faults = read_grades(tmp_path)

    assert [one.path for one in found] == [first]
    assert [(fault.file, fault.line, fault.field) for fault in faults] == [(str(second), 1, "id")]
    assert str(first) in faults[0].problem


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs links and pipes of a Unix")
def test_loops_of_links_and_pipes_do_not_trap_the_reader(tmp_path):
    write_grade(tmp_path / "good.yaml")
    (tmp_path / "loop").symlink_to(tmp_path, target_is_directory=True)
    (tmp_path / "itself.yaml").symlink_to(tmp_path / "itself.yaml")
    (tmp_path / "nowhere.yaml").symlink_to(tmp_path / "absent.yaml")
    os.mkfifo(tmp_path / "pipe.yaml")

    found, faults = read_grades(tmp_path)

    assert [one.path.name for one in found] == ["good.yaml"]
    assert sorted(Path(fault.file).name for fault in faults) == ["itself.yaml", "nowhere.yaml"]


def test_a_folder_with_thousands_of_files_is_one_fault(tmp_path):
    for number in range(registry.MAX_FILES + 1):
        (tmp_path / f"{number}.yaml").touch()

    found, faults = read_grades(tmp_path)

    assert found == []
    assert [fault.problem for fault in faults] == ["the folder holds too many files"]


def test_listing_stops_at_the_limit_of_entries(tmp_path, monkeypatch):
    monkeypatch.setattr(registry, "MAX_ENTRIES", 5)
    for number in range(6):
        (tmp_path / f"{number}.txt").touch()

    with pytest.raises(InputError, match="too many files"):
        grade_files(tmp_path)


def test_a_path_that_does_not_exist_is_a_fault(tmp_path):
    found, faults = read_grades(tmp_path / "absent")

    assert found == []
    assert [fault.problem for fault in faults] == ["there is no such file"]
