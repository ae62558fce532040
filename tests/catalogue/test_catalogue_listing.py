from __future__ import annotations

import pytest
from grade_samples import GRADE_TEXT, write_grade

from designer.catalogue.listing import check_path, facts, list_rows, size_rows
from designer.catalogue.registry import load_catalogue


def test_each_grade_is_one_row_with_its_ranges(tmp_path):
    catalogue = load_catalogue([write_grade(tmp_path / "acme.yaml")])

    rows = {row.id: row for row in list_rows(catalogue)}
    row = rows["acme-7x19"]

    assert len(rows) == len(catalogue.grades)
    assert (row.manufacturer, row.construction, row.trust) == ("Acme", "7x19", "A")
    assert (row.n_sizes, row.n_doubtful, row.origin) == (4, 0, "acme.yaml")
    assert row.diameter_m == pytest.approx((0.004, 0.010))
    assert row.minimum_breaking_load_N == pytest.approx((11.2e3, 68.6e3))
    assert row.youngs_modulus_Pa == pytest.approx(60e9)
    assert rows["unirope-7x19-galvanised"].n_doubtful == 3


def test_the_table_of_a_grade_has_stiffness_and_doubts():
    grade = load_catalogue().grade("unirope-6x36-iwrc-1960")

    rows = {row.id: row for row in size_rows(grade)}

    assert len(rows) == 17
    assert "misprint" in rows["12 mm"].doubt
    assert rows["10 mm"].doubt == ""
    assert rows["10 mm"].axial_stiffness_N == pytest.approx(61.0e9 * 7.853982e-5, rel=1e-6)


def test_facts_name_the_lender_of_a_borrowed_figure_and_the_gaps():
    galvanised = dict(facts(load_catalogue().grade("unirope-7x19-galvanised")))
    stainless = dict(facts(load_catalogue().grade("unirope-6x19-iwrc-stainless-316")))

    assert "62.7 GPa ± 15% on the nominal circle, borrowed: Strand Core" in galvanised["modulus"]
    assert galvanised["wire grade"] == "not given"
    assert galvanised["came in by"] == "builtin (unirope-7x19-galvanised.yaml)"
    assert stainless["thermal expansion"] == "not given"
    assert stainless["standard"] == "not given"


def test_checking_a_sound_file_finds_nothing(tmp_path):
    assert check_path(write_grade(tmp_path / "acme.yaml")) == []


def test_checking_a_folder_finds_the_faults_of_every_file(tmp_path):
    write_grade(tmp_path / "a.yaml", GRADE_TEXT.replace("60 GPa", "60 mm"))
    write_grade(tmp_path / "b.yaml", GRADE_TEXT.replace("0.244", "0.164"))

    faults = check_path(tmp_path)

    assert [fault.field for fault in faults] == ["modulus.value", "sizes[2].linear_mass"]


def test_checking_a_folder_without_grades_does_not_pass(tmp_path):
    (fault,) = check_path(tmp_path)

    assert "no grade file" in fault.problem
