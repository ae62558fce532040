"""`designer catalog list`, `show` and `check`, from the command line."""

from __future__ import annotations

import re

import pytest
from grade_samples import GRADE_TEXT, write_grade
from typer.testing import CliRunner, Result

from designer.cli import terminal
from designer.cli.commands import app
from designer.errors import InputError


def _run(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["catalog", *arguments])


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables print to whatever standard output is at the time, unbroken."""
    monkeypatch.setattr(terminal, "_out", terminal.Console(highlight=False, width=300))


def test_the_list_has_products_by_publisher_and_only_counts_nominal_grades():
    result = _run("list", "--no-plugins")

    assert result.exit_code == 0
    assert "Robline" in result.stdout
    assert "unirope-7x19-galvanised" in result.stdout
    assert "en12385-" not in result.stdout
    assert re.search(r"^\d+ nominal grades, computed", result.stdout, re.MULTILINE)


def _rows(*arguments: str) -> dict[str, list[str]]:
    """Return the cells of each row of a table, by the first of them."""
    lines = _run(*arguments).stdout.splitlines()
    cells = [[cell.strip() for cell in line.strip("│").split("│")] for line in lines]
    return {row[0]: row[1:] for row in cells}


def test_each_grade_is_one_row_with_its_ranges(user_folder):
    write_grade(user_folder / "acme.yaml")

    rows = _rows("list")

    figures = ["4", "4–10", "11.2–68.6", "A", "user folder"]
    assert rows["acme-7x19"] == ["7x19, WSC", "galvanised", *figures]
    assert rows["unirope-7x19-galvanised"][2].endswith("(3?)")


def test_the_table_of_a_grade_has_stiffness_and_doubts():
    rows = _rows("show", "unirope-6x36-iwrc-1960", "--no-plugins")

    assert "misprint" in rows["12 mm"][-1]
    assert rows["10 mm"] == ["10", "69.8", "0.42", "4.791", ""]  # 61 GPa on the circle


def test_nominal_grades_are_listed_when_asked_for():
    result = _run("list", "--nominal", "--construction", "34x7", "--no-plugins")

    assert result.exit_code == 0
    assert "en12385-34x7-wsc-1960" in result.stdout
    assert "unirope" not in result.stdout


def test_a_list_that_comes_out_empty_is_a_negative_answer():
    result = _run("list", "--construction", "9x99", "--no-plugins")

    assert result.exit_code == 1
    assert "no grade is like that" in result.stderr


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--diameter", "3 kg", "has the unit kilogram"),
        ("--diameter", "-3 mm", "no rope has"),
        ("--material", "wood", "no grade is of 'wood'"),
    ],
)
def test_a_wish_that_makes_no_sense_is_wrong_input(option, value, words):
    result = _run("list", option, value, "--no-plugins")

    assert isinstance(result.exception, InputError)
    assert words in str(result.exception)


def test_show_has_units_in_the_head_of_the_table():
    result = _run("show", "gost-6x19s-iwrc-1960", "--no-plugins")

    assert result.exit_code == 0
    for head in ("d [mm]", "MBL [kN]", "mass [kg/m]", "A [mm²]", "EA [MN]"):
        assert head in result.stdout
    assert "price" not in result.stdout


def test_show_has_prices_where_there_are_some(tmp_path, user_folder):
    text = GRADE_TEXT.replace("0.137}", "0.137, price_per_m: 4.2}") + "currency: EUR\n"
    write_grade(user_folder / "acme.yaml", text)

    result = _run("show", "acme-7x19")

    assert "price [EUR/m]" in result.stdout
    assert "4.2" in result.stdout


def test_checking_without_a_path_checks_all_that_is_loaded():
    result = _run("check", "--no-plugins")

    assert result.exit_code == 0
    assert re.search(r"^\d+ grades of products and \d+ nominal", result.stdout)
    assert "no fault found" in result.stdout


def test_checking_all_names_a_faulty_file_of_the_user_s(user_folder):
    write_grade(user_folder / "acme.yaml", GRADE_TEXT.replace("60 GPa", "60 mm"))

    result = _run("check")

    assert result.exit_code == 2
    assert "no fault found" not in result.stdout
