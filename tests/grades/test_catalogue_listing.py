from __future__ import annotations

import pytest
from grade_samples import GRADE_TEXT, write_grade

from designer.grades.listing import (
    GradeFilter,
    facts,
    split_nominal,
    summary,
)
from designer.grades.registry import load_catalogue, read_grades


def test_facts_name_the_lender_of_a_borrowed_figure_and_the_gaps():
    galvanised = dict(facts(load_catalogue().grade("unirope-7x19-galvanised")))
    stainless = dict(facts(load_catalogue().grade("unirope-6x19-iwrc-stainless-316")))

    assert "62.7 GPa on the nominal circle, ±15%, borrowed: Strand Core" in galvanised["modulus"]
    assert galvanised["wire grade"] == "not given"
    assert galvanised["came in by"] == "builtin (unirope-7x19-galvanised.yaml)"
    assert stainless["thermal expansion"] == "not given"
    assert stainless["standard"] == "not given"


def test_checking_a_sound_file_finds_nothing(tmp_path):
    assert read_grades(write_grade(tmp_path / "acme.yaml"), needs_any=True)[1] == []


def test_checking_a_folder_finds_the_faults_of_every_file(tmp_path):
    write_grade(tmp_path / "a.yaml", GRADE_TEXT.replace("60 GPa", "60 mm"))
    write_grade(tmp_path / "b.yaml", GRADE_TEXT.replace("0.244", "0.164"))

    faults = read_grades(tmp_path, needs_any=True)[1]

    assert [fault.field for fault in faults] == ["modulus.value", "sizes[2].linear_mass"]


def test_checking_a_folder_without_grades_does_not_pass(tmp_path):
    (fault,) = read_grades(tmp_path, needs_any=True)[1]

    assert "no grade file" in fault.problem


@pytest.mark.parametrize(
    ("wanted", "some", "none"),
    [
        (GradeFilter(construction="7X19"), "lg-7x19-wsc-galvanised-2070", "unirope-19x7-eips"),
        (GradeFilter(construction="9x7"), None, "unirope-19x7-eips"),
        (GradeFilter(construction="6x36ws"), "unirope-6x36-iwrc-1960", "unirope-8x36-iwrc-1960"),
        (GradeFilter(construction="braid"), "yale-ultrex-hmpe", "superline-hmpe"),
        (GradeFilter(material="hmpe"), "superline-hmpe", "yale-pobon-pbo"),
        (GradeFilter(material="steel"), "gost-6x19s-iwrc-1960", "unirope-7x19-stainless-302-304"),
        (GradeFilter(maker="robline"), "robline-rapallo-polyester", "yale-yalon-nylon"),
        (GradeFilter(diameter_m=0.112), "superline-hmpe", "unirope-7x19-galvanised"),
    ],
)
def test_the_list_can_be_narrowed(wanted, some, none):
    found = {grade.id for grade in wanted.among(load_catalogue().grades)}

    assert some is None or some in found
    assert none not in found


def test_a_wanted_diameter_keeps_the_sizes_that_have_it():
    grades = GradeFilter(construction="7x19", diameter_m=0.0032).among(load_catalogue().grades)

    sizes = {grade.id: [size.id for size in grade.sizes] for grade in grades}
    assert sizes == {
        "lg-7x19-wsc-galvanised-2070": ["3.2 mm"],
        "unirope-7x19-galvanised": ["1/8 in"],
        "unirope-7x19-stainless-302-304": ["1/8 in"],
    }


def test_facts_tell_what_is_not_the_source_s_own():
    catalogue = load_catalogue()
    wire = dict(facts(catalogue.grade("unirope-python-power9-v-1960")))
    fibre = dict(facts(catalogue.grade("superline-hmpe")))
    nominal = dict(facts(catalogue.grade("en12385-6x36ws-iwrc-1960")))

    assert wire["borrowed"] == "modulus, thermal expansion"
    assert wire["computed"] == "area factor"
    assert "1.10 times the mass printed" in wire["computed linear mass"]
    assert fibre["stiffness"].startswith("EA is 10.5, 28.6, 30.8, 30.8, 33.3 times the breaking")
    assert "at 0.1, 0.3, 0.5, 0.7, 0.9 of it, ±50%, computed" in fibre["stiffness"]
    assert fibre["creep"].startswith("high;")
    assert fibre["doubtful sizes"] == "120 mm"
    assert "no product" in nominal["by name only"]
    assert "nominal" not in wire


def test_facts_have_what_is_known_of_the_rope_at_work_and_name_the_rest():
    catalogue = load_catalogue((), with_plugins=False)
    running = dict(facts(catalogue.grade("unirope-18x7-2160")))
    guy = dict(facts(catalogue.grade("metalico-1x7-messenger-utilities")))
    fibre = dict(facts(catalogue.grade("liros-dsl-hmpe")))
    nominal = dict(facts(catalogue.grade("en12385-6x19-fc-1770")))

    assert running["rotation"].startswith("category II, rotation-resistant")
    assert running["permanent stretch"].startswith("0.125 % at a safety factor of 8")
    assert running["discard"].startswith("2 visible broken wires over 6 d or 4 over 30 d, on steel")
    assert running["temperature"].startswith("-40 to 100 °C, full load of wire rope slings: Certex")
    assert "not given" not in running
    assert "156.9 GPa on the metallic area, 147.1 GPa when new, ±10%, printed" in guy["modulus"]
    assert guy["fill factor"].startswith("0.717 of")
    assert guy["not given"] == "rotation, permanent stretch, discard, temperature"
    assert fibre["not given"] == "rotation, permanent stretch, discard"
    assert fibre["temperature"].startswith("-150 to 70 °C")
    assert fibre["creep"].startswith("high")
    assert nominal["permanent stretch"].startswith("0.25 %")
    assert nominal["not given"] == "rotation, discard"


def test_products_and_nominal_grades_are_told_apart_and_counted():
    catalogue = load_catalogue()
    products, nominal = split_nominal(catalogue.grades)

    assert {grade.is_nominal for grade in nominal} == {True}
    assert {grade.is_nominal for grade in products} == {False}
    assert summary(catalogue).startswith(
        f"{len(products)} grades of products and {len(nominal)} nominal ones from "
    )
    assert {"steel", "HMPE", "PBO"} <= {grade.material for grade in products}
