"""A study's own price list: how it is read, and what is wrong with it."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from test_cli import STUDY, WORKSPACE

from designer.documents.document import read_document
from designer.errors import InputError
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.io.config.moved import moved_to
from designer.model.cable import PriceList, RopePrice

GRADE = "unirope-6x36-iwrc-1960"
HEAD = "grade,size,price_per_m,currency,date\n"


def price_list(folder: Path, text: str, study_text: str = STUDY + WORKSPACE) -> PriceList:
    """Return the price list of a study with this text in it."""
    (folder / "prices.csv").write_text(text, encoding="utf-8")
    study = folder / "crane.yaml"
    study.write_text(study_text.replace("{grades:", "{prices: prices.csv, grades:"))
    selection = read_study(study).selection
    assert selection is not None
    assert selection.price_list is not None
    return selection.price_list


def test_rows_are_offers(tmp_path: Path) -> None:
    found = price_list(
        tmp_path, f"{HEAD}{GRADE},12 mm,1.5,EUR,2026-03\n{GRADE},13  mm,2,EUR,2025\n"
    )
    assert (found.name, found.currency, found.dates) == ("prices.csv", "EUR", ("2025", "2026-03"))
    first, second = found.offers
    assert (first.grade, first.size, first.price_per_m, first.line) == (GRADE, "12 mm", 1.5, 2)
    assert second.size_id == "13 mm"
    assert read_study(tmp_path / "crane.yaml").source.tables[0][0] == "prices.csv"


def test_a_table_with_semicolons_decimal_commas_and_diameters_is_read(tmp_path: Path) -> None:
    text = f"Date;Currency;Price_per_m;diameter_mm;grade\n2026-03-31;EUR;1,25;9,53;{GRADE}\n"
    (offer,) = price_list(tmp_path, text).offers
    assert (offer.price_per_m, offer.date) == (1.25, "2026-03-31")
    assert offer.diameter_m == pytest.approx(9.53e-3)
    assert offer.is_for("3/8 in", 9.525e-3)
    assert not offer.is_for("10 mm", 10e-3)


def test_a_size_is_named_as_its_table_names_it() -> None:
    offer = RopePrice("a", "1/4 IN", 0.0, 1.0, "2026", 2)
    assert offer.is_for("1/4 in", 1.0)
    assert not offer.is_for("5/16 in", 1.0)


@pytest.mark.parametrize(
    ("text", "line", "column", "problem", "expected"),
    [
        ("", 1, "grade", "there is no such column", "grade, size or diameter_mm"),
        (HEAD, None, "", "there is no price", "a row for each size"),
        (
            HEAD.replace("size", "sise") + "a,b,1,EUR,2026\n",
            1, "size", "there is no such column", "one column size",
        ),
        (
            HEAD.replace("size", "size,diameter_mm") + "a,b,6,1,EUR,2026\n",
            1, "size", "there are size and diameter_mm", "one column",
        ),
        (
            HEAD.replace("size", "diameter_kN") + "a,6,1,EUR,2026\n",
            1, "diameter_kn", "'kn' is no unit of length", "diameter_mm",
        ),
        (HEAD.replace("date", "date,note") + "a,b,1,EUR,2026,x\n", 1, "note", "is not known", ""),
        (HEAD.replace("date", "date,date") + "a,b,1,EUR,2026,1\n", 1, "date", "is there twice", ""),
        (HEAD + "a,b,1,EUR\n", 2, "", "has 4 values", "5, as the first line"),
        (HEAD + "a,b,1,EUR,2026\na,,1,EUR,2026\n", 3, "size", "holds nothing", "a value"),
        (HEAD + "a,b,cheap,EUR,2026\n", 2, "price_per_m", "holds 'cheap'", "a number"),
        (HEAD + "a,b,0,EUR,2026\n", 2, "price_per_m", "holds '0'", "a number from"),
        (HEAD + "a,b,nan,EUR,2026\n", 2, "price_per_m", "holds 'nan'", "a number from"),
        (HEAD + "a,b,1,euro,2026\n", 2, "currency", "holds 'euro'", "three capitals"),
        (HEAD + "a,b,1,EUR,2026\na,c,1,USD,2026\n", 3, "currency", "holds 'USD'", "line 2"),
        (HEAD + "a,b,1,EUR,31.3.2026\n", 2, "date", "holds '31.3.2026'", "2026-03-31"),
        (HEAD + "a,b,1,EUR,2026-13\n", 2, "date", "holds '2026-13'", "2026-03-31"),
        (HEAD + "a,b,1,EUR,2026\na,B,2,EUR,2026\n", 3, "size", "line 2 has a price", "one row"),
        (
            HEAD.replace("size", "diameter_mm") + "a,6000,1,EUR,2026\n",
            2, "diameter_mm", "holds '6000'", "a number from 0.1 to 500",
        ),
    ],
)  # fmt: skip
def test_faults_name_file_line_and_column(
    tmp_path: Path, text: str, line: int | None, column: str, problem: str, expected: str
) -> None:
    with pytest.raises(InputError) as error:
        price_list(tmp_path, text)
    fault = error.value.faults[0]
    assert Path(fault.file).name == "prices.csv"
    assert (fault.line, fault.field) == (line, column)
    assert problem in fault.problem
    assert expected in fault.expected


def test_a_missing_file_is_a_fault_of_the_study(tmp_path: Path) -> None:
    study = tmp_path / "crane.yaml"
    study.write_text(STUDY + WORKSPACE.replace("{grades:", "{prices: none.csv, grades:"))
    with pytest.raises(InputError, match=r"crane.yaml:12: selection.prices: .*none.csv: no such"):
        read_study(study)


def test_of_many_faults_the_first_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        price_list(tmp_path, HEAD + "a,b,c,EUR,2026\n" * 50)
    assert len(error.value.faults) == 21
    assert "30 more" in error.value.faults[-1].problem


@pytest.mark.parametrize(
    ("rows", "grades", "told"),
    [
        ("unirope-6x63,12 mm,1,EUR,2026\n", GRADE, ":2: grade: there is no grade 'unirope-6x63'"),
        (
            f"{GRADE},12.5 mm,1,EUR,2026\n",
            GRADE,
            f":2: size: the grade '{GRADE}' has no size 12.5 mm",
        ),
        (
            "superline-hmpe,6 mm,1,EUR,2026\n",
            GRADE,
            "selection.prices: prices.csv has no price of a grade that the study allows",
        ),
    ],
)
def test_what_no_grade_is_is_refused_with_the_catalogue(
    tmp_path: Path, rows: str, grades: str, told: str
) -> None:
    price_list(tmp_path, HEAD + rows)
    catalogue = load_catalogue(with_plugins=False)
    with pytest.raises(InputError) as error:
        catalogue.require_grades_of(read_study(tmp_path / "crane.yaml"))
    assert told in str(error.value)


def test_a_study_that_moves_still_finds_its_list(tmp_path: Path) -> None:
    price_list(tmp_path, f"{HEAD}{GRADE},12 mm,1,EUR,2026\n")
    study = tmp_path / "crane.yaml"
    text = moved_to(tmp_path / "sub", study.read_text(), read_document(study), tmp_path)
    assert yaml.safe_load(text)["selection"]["prices"] == "../prices.csv"
