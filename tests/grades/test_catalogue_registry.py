from __future__ import annotations

import pytest
from grade_samples import GRADE_TEXT, write_grade

from designer.errors import InputError
from designer.grades import registry
from designer.grades.registry import CatalogueSource, load_catalogue


def test_the_user_folder_is_loaded(user_folder):
    write_grade(user_folder / "mine.yaml", grade_id="mine")

    catalogue = load_catalogue()

    assert catalogue.grade("mine").origin == "user folder"
    assert CatalogueSource("user folder", str(user_folder), 1) in catalogue.sources


def test_a_fault_in_the_user_folder_is_a_problem_not_an_error(user_folder):
    path = write_grade(user_folder / "mine.yaml", GRADE_TEXT.replace("60 GPa", "60 mm"))

    (problem,) = load_catalogue().problems

    assert problem.startswith(f"user folder ({user_folder}): {path}:12: modulus.value")


def test_many_problems_of_one_source_are_cut_short(user_folder):
    for number in range(registry.MAX_PROBLEMS_OF_A_SOURCE + 5):
        write_grade(user_folder / f"{number}.yaml", "id: x")

    problems = load_catalogue().problems

    assert len(problems) == registry.MAX_PROBLEMS_OF_A_SOURCE + 1
    assert problems[-1].endswith("more problems of this kind")


def test_a_path_of_the_config_may_be_a_file_or_a_folder(tmp_path):
    file = write_grade(tmp_path / "one.yaml", grade_id="one")
    write_grade(tmp_path / "more" / "two.yaml", grade_id="two")

    catalogue = load_catalogue([file, tmp_path / "more"])

    assert catalogue.grade("one").origin == "one.yaml"
    assert catalogue.grade("two").origin == "more"
    assert CatalogueSource("more", str(tmp_path / "more"), 1) in catalogue.sources


def test_all_faults_of_the_config_s_paths_are_fatal_together(tmp_path):
    bad = write_grade(tmp_path / "bad.yaml", GRADE_TEXT.replace("60 GPa", "60 mm"))
    absent = tmp_path / "absent.yaml"
    empty = tmp_path / "empty"
    empty.mkdir()

    with pytest.raises(InputError) as caught:
        load_catalogue([bad, absent, empty])

    assert [(fault.file, fault.line) for fault in caught.value.faults] == [
        (str(bad), 12),
        (str(absent), None),
        (str(empty), None),
    ]


def test_an_id_that_is_taken_is_fatal_in_the_config_s_paths(tmp_path):
    path = write_grade(tmp_path / "mine.yaml", grade_id="unirope-7x19-galvanised")

    with pytest.raises(InputError) as caught:
        load_catalogue([path])

    (fault,) = caught.value.faults
    assert (fault.file, fault.line, fault.field) == (str(path), 1, "id")
    assert "'builtin' (unirope-7x19-galvanised.yaml)" in fault.problem
    assert "'mine.yaml'" in fault.problem


def test_an_unknown_grade_is_answered_with_its_nearest_names():
    with pytest.raises(InputError, match="unirope-7x19-galvanised"):
        load_catalogue().grade("unirope-7x19-galvanized")


def test_a_grade_like_no_other_is_answered_with_the_command_that_lists_them():
    with pytest.raises(InputError, match="designer catalog list"):
        load_catalogue().grade("!")


def test_grades_of_a_construction_are_named_and_those_beyond_a_dozen_counted():
    catalogue = load_catalogue()
    _, few = catalogue.explain_unknown("7x19")
    assert "unirope-7x19-galvanised" in few and "more" not in few
    _, many = catalogue.explain_unknown("iwrc")
    count = sum("iwrc" in f"{g.construction}|{g.id}".casefold() for g in catalogue.grades)
    assert count > 12
    assert many.count(", ") == 11 and f"or one of {count - 12} more" in many
