"""Cells of our tables are no formulas to a spreadsheet; numbers stay numbers."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
import xarray as xr

from designer.documents.plain import csv_text, harmless
from designer.explore.export import _csv
from designer.sweeps.report import _table

FORMULAS = ["=1+1", "+cmd|' /C calc'!A0", "-1+1", "@SUM(A1)", "\t=1", '=HYPERLINK("a")']
WIDE = ["\uff1d1+1", "\uff0b1+1", "\uff0d1+1", "\uff20SUM(A1)"]


@pytest.mark.parametrize("text", [*FORMULAS, *WIDE])
def test_a_text_that_begins_a_formula_stays_a_text(text: str) -> None:
    ((cell,),) = csv.reader(io.StringIO(csv_text([[text]]), newline=""))
    assert cell == f"'{text}"


@pytest.mark.parametrize("cell", ["-1.5", "+2e-3", -1.5, np.float64(-2.0), "-inf", "a=b", "", 0])
def test_numbers_and_plain_texts_stay_as_they_are(cell: object) -> None:
    assert harmless(cell) is cell


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ("20;=1+1", "20;'=1+1"),
        (";;\uff1d1", ";;'\uff1d1"),
        ("a\t=1", "a\t'=1"),
        ("a\n+1", "a\n'+1"),
        ('a;"=1"', 'a;\'"=1"'),
        ("fits; see -1", "fits; see -1"),
    ],
)
def test_a_cell_that_is_divided_begins_no_formula(text: str, cell: str) -> None:
    assert harmless(text) == cell


def test_a_carriage_return_begins_no_row() -> None:
    assert csv_text([["a\r=1+1", "b"]]) == "a =1+1,b\n"


def test_the_tables_of_the_window_and_of_a_sweep() -> None:
    assert _csv(["=a", "b"], [{"=a": "@b", "b": float("nan")}]) == "'=a,b\n'@b,\n"
    found = xr.Dataset(
        {"=x": ("point", [-1.5, np.nan]), "why": ("point", np.array(["-a", ""], dtype=object))}
    )
    assert _table(found) == "point,'=x,why\n0,-1.5,'-a\n1,,\n"
