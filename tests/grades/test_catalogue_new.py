"""`designer catalog new`: from a maker's table to a grade file."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from matplotlib import rc_context
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from typer.testing import CliRunner, Result

from designer.cli import catalog_new, terminal
from designer.cli.commands import app
from designer.errors import InputError
from designer.grades.files import read_grade
from designer.grades.registry import load_catalogue
from designer.io.maker_table import known_unit, read_maker_table

GERMAN = """Acme Seile; Ausgabe 2024;;;
Nenngröße;Ø [mm];Mindestbruchkraft (kN);Gewicht kg/100m;Preis
10;10;70,4;40,9;1,95
12;12;101;58,9;2,6
verdichtet;;;;
16;16;180;105;4
20;20;282;164;7
"""
INCHES = (
    'Size,Rope Dia,"Min. Breaking Strength (lbs)",Average Strength (lbs),Weight lbs/100ft\n'
    '1/4,"1/4""","7,000","7,600",11\n'
    '3/8,"3/8""","15,100","16,000",24\n'
    '1/2,"1/2""","26,600","28,000",46\n'
    '1-1/8,"1-1/8""","130,000","141,000",226\n'
)
LIKE = ("--like", "unirope-6x36-iwrc-1960", "--no-plugins")
SAID = (
    *("--set", "manufacturer=Acme", "--set", "product=Quarry: 'heavy'"),
    *("--set", "source.publisher=Acme", "--set", "source.date=2024"),
)
PRINTED = (
    *("--set", "construction=6x36", "--set", "core=IWRC", "--set", "finish=bright"),
    *("--set", "material=steel", "--set", "modulus.value=62 GPa"),
    *("--set", "modulus.source=page 3", "--set", "modulus.uncertainty=0.1"),
)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each test has a folder of its own; tables print unbroken."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(terminal, "_out", terminal.Console(highlight=False, width=200))


def new(text: str, *options: str, answers: str = "", name: str = "acme.csv") -> Result:
    """Return what the command makes of a table."""
    Path(name).write_text(text, encoding="utf-8")
    return CliRunner().invoke(app, ["catalog", "new", name, *options], input=answers)


def refused(text: str, *options: str) -> list[str]:
    """Return the faults of a table that is refused, of which nothing is written."""
    result = new(text, *options)
    assert isinstance(result.exception, InputError), result.output
    assert not Path("acme.yaml").exists()
    return [str(fault) for fault in result.exception.faults]


def test_a_table_with_decimal_commas_becomes_a_checked_grade() -> None:
    result = new(GERMAN, *LIKE, *SAID)
    assert result.exit_code == 0, result.output
    assert "left out: Preis" in result.output
    grade = read_grade(Path("acme.yaml"))
    assert (grade.id, grade.product, grade.trust) == ("acme", "Quarry: 'heavy'", "A")
    assert (grade.source.document, grade.source.date) == ("acme.csv", "2024")
    assert [size.id for size in grade.sizes] == ["10", "12", "16", "20"]
    assert grade.sizes[0].diameter_m == pytest.approx(0.01)
    assert grade.sizes[0].minimum_breaking_load_N == pytest.approx(70.4e3)
    assert grade.sizes[0].linear_density_kg_per_m == pytest.approx(0.409)
    assert grade.elasticity.basis == "borrowed"
    assert "unirope-6x36-iwrc-1960" in grade.elasticity.source
    assert grade.elasticity.uncertainty >= 0.15
    assert grade.sheave_ratio is not None


def test_fractions_of_inches_and_thousands_are_read_and_averages_are_no_minimum() -> None:
    result = new(INCHES, *SAID, *PRINTED)
    assert result.exit_code == 0, result.output
    assert "left out: Average Strength (lbs)" in result.output
    grade = read_grade(Path("acme.yaml"))
    thickest = grade.sizes[-1]
    assert thickest.id == "1-1/8"
    assert thickest.diameter_m == pytest.approx(1.125 * 0.0254)
    assert thickest.minimum_breaking_load_N == pytest.approx(130e3 * 4.4482216)
    assert thickest.linear_density_kg_per_m == pytest.approx(2.26 * 1.4881639)
    assert grade.modulus is not None
    assert (grade.modulus.value_Pa, grade.modulus.basis) == (62e9, "printed")


def test_the_stiffness_of_a_fibre_rope_is_borrowed_with_its_table() -> None:
    rows = "".join(f"{d},{19.5 * d * d},{0.68 * d * d}\n" for d in (10, 12, 16, 20))
    text = f"Diameter mm,MBL daN,Mass g/m\n{rows}"
    result = new(text, "--like", "robline-rapallo-polyester", "--no-plugins", *SAID)
    assert result.exit_code == 0, result.output
    lender = load_catalogue(with_plugins=False).grade("robline-rapallo-polyester")
    stiffness = read_grade(Path("acme.yaml")).stiffness
    assert stiffness is not None
    assert lender.stiffness is not None
    assert stiffness.ea_over_breaking_load == lender.stiffness.ea_over_breaking_load
    assert stiffness.load_fraction == lender.stiffness.load_fraction
    assert stiffness.basis == "borrowed"


def test_a_row_of_units_and_tabs() -> None:
    rows = ("d,MBL,mass,metallic area", "mm,t,kg/m,mm²", "10,7.18,0.409,46", "12,10.3,0.589,66")
    text = "\n".join(rows).replace(",", "\t")
    result = new(text, *LIKE, *SAID)
    assert result.exit_code == 0, result.output
    size = read_grade(Path("acme.yaml")).sizes[0]
    assert size.id == "10 mm"
    assert size.minimum_breaking_load_N == pytest.approx(7.18e3 * 9.80665)
    assert size.metallic_area_m2 == pytest.approx(46e-6)


def test_what_nobody_says_is_left_to_fill_in() -> None:
    result = new(GERMAN)
    assert result.exit_code == 1
    assert "Fill in what is missing" in result.output
    with pytest.raises(InputError) as error:
        read_grade(Path("acme.yaml"))
    missing = {fault.field for fault in error.value.faults}
    assert {"manufacturer", "product", "construction", "core", "finish"} <= missing
    text = Path("acme.yaml").read_text(encoding="utf-8")
    assert "# manufacturer:  # fill in: who makes the rope" in text


def test_a_workbook_is_a_table() -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["Diameter mm", "MBL kN", "kg/m mass"], [10, 70.4, 0.409], [12, 101, 0.589]):
        book.active.append(row)
    book.save("acme.xlsx")
    result = CliRunner().invoke(
        app, ["catalog", "new", "acme.xlsx", *LIKE, *SAID, "--unit", "linear_mass=kg/m"]
    )
    assert result.exit_code == 0, result.output
    assert len(read_grade(Path("acme.yaml")).sizes) == 2


ROPES = ("8,45.1,48,.262", "10,70.4,75,.409", "12,101,108,.589", "16,180,192,1.05")


def pdf(*, pages: int = 1, lines: bool = True, comma: bool = False) -> str:
    """Write a PDF with a title and a table of ropes on each page; returns its name."""
    pytest.importorskip("pdfplumber")
    rows = [["Diameter mm", "Min. breaking\nload kN", "Average kN", "Mass kg/m"]]
    rows += [row.replace(",.", ",0.").split(",") for row in ROPES]
    if comma:
        rows[1:] = [[cell.replace(".", ",") for cell in row] for row in rows[1:]]
    style = {"pdf.fonttype": 42, "font.family": "DejaVu Sans", "text.parse_math": False}
    with rc_context(style), PdfPages("acme.pdf") as book:
        for _ in range(pages):
            sheet = Figure(figsize=(8.3, 11.7))
            sheet.text(0.1, 0.95, "Acme")
            sheet.text(0.1, 0.92, "Ropes, and words.")
            for number, row in enumerate(rows):
                for column, cell in enumerate(row):
                    sheet.text(0.11 + 0.2 * column, 0.86 - 0.05 * number, cell, va="center")
            if lines:
                edges = [([0.1, 0.9], [0.885 - 0.05 * k] * 2) for k in range(len(rows) + 1)]
                edges += [
                    ([0.1 + 0.2 * k] * 2, [0.885, 0.885 - 0.05 * len(rows)]) for k in range(5)
                ]
                for x, y in edges:
                    sheet.add_artist(Line2D(x, y, color="black", linewidth=0.8))
            sheet.text(0.1, 0.5, "0 to 5 %.")
            book.savefig(sheet)
    return "acme.pdf"


@pytest.mark.parametrize(
    ("options", "page"), [({}, ()), ({"comma": True}, ()), ({"pages": 2}, ("--page", "2"))]
)
def test_a_table_of_a_pdf_becomes_a_checked_grade(options: dict, page: tuple[str, ...]) -> None:
    command = ["catalog", "new", pdf(**options), *page, *LIKE, *SAID]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.output
    assert "left out: Average kN" in result.output
    grade = read_grade(Path("acme.yaml"))
    assert [size.id for size in grade.sizes] == ["8 mm", "10 mm", "12 mm", "16 mm"]
    assert grade.sizes[1].minimum_breaking_load_N == pytest.approx(70.4e3)
    assert grade.sizes[1].linear_density_kg_per_m == pytest.approx(0.409)
    assert grade.source.document == "acme.pdf"


@pytest.mark.parametrize(
    ("options", "page", "told"),
    [
        ({"lines": False}, (), "there is no table in it whose head names a breaking load"),
        ({"pages": 2}, (), "on the pages 1, 2 (expected --page N)"),
        ({}, ("--page", "2"), "there is no table in page 2"),
    ],
)
def test_a_pdf_that_cannot_be_trusted_is_refused(
    options: dict, page: tuple[str, ...], told: str
) -> None:
    result = CliRunner().invoke(app, ["catalog", "new", pdf(**options), *page, *LIKE, *SAID])
    assert isinstance(result.exception, InputError), result.output
    (fault,) = result.exception.faults
    assert told in str(fault)
    assert not Path("acme.yaml").exists()


def test_a_damaged_pdf_gets_a_line() -> None:
    pytest.importorskip("pdfplumber")
    (line,) = refused("%PDF-1.7\n")
    assert line.startswith("acme.csv: this is no PDF that can be read")


def test_the_library_for_pdfs_is_named_where_it_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "pdfplumber", None)
    (line,) = refused("%PDF-1.7\n")
    assert "pip install 'cdpr-designer[pdf-tables]', or a CSV file" in line


OFF = GERMAN.replace("12;12;101;58,9", "12;12;85;58,9")


def test_a_row_off_the_law_is_shown_beside_it_and_refused() -> None:
    result = new(OFF, *LIKE, *SAID)
    assert "101.3 kN" in result.output  # the median of the others: 0.7036 d²
    assert "-16%" in result.output
    (line,) = refused(OFF, *LIKE, *SAID)
    assert line.startswith("acme.csv:4: Mindestbruchkraft (kN): 85 is -16% off the law of d²")
    assert "--doubt WHY" in line


def test_a_row_off_the_law_may_stay_with_a_doubt() -> None:
    result = new(OFF, *LIKE, *SAID, "--doubt", "so in the sheet")
    assert result.exit_code == 0, result.output
    doubts = [size.doubt for size in read_grade(Path("acme.yaml")).sizes]
    assert doubts == [None, "so in the sheet", None, None]


def test_a_column_in_another_unit_is_refused_whole() -> None:
    (line,) = refused(GERMAN, *LIKE, *SAID, "--unit", "linear_mass=kg/m")
    assert "over the nominal circle" in line
    assert "check the units" in line


ASKED = "Diameter,MBL 1770,MBL 1960,Weight\n10,63.6,70.4,0.409\n12,91.6,101,0.589\n"


def test_what_is_in_doubt_is_asked_for_by_options() -> None:
    (line,) = refused(ASKED, *LIKE, *SAID)
    assert line.startswith("acme.csv:1: minimum_breaking_load: may be 'MBL 1770' or 'MBL 1960'")
    assert "--column minimum_breaking_load=HEAD" in line
    named = ("--column", "minimum_breaking_load=mbl 1960")
    lines = refused(ASKED, *LIKE, *SAID, *named)
    assert [line.partition("expected ")[2] for line in lines] == [
        f"--unit {figure}=UNIT)" for figure in ("minimum_breaking_load", "diameter", "linear_mass")
    ]
    units = ("diameter=mm", "minimum_breaking_load=kN", "linear_mass=kg/m")
    options = [part for unit in units for part in ("--unit", unit)]
    result = new(ASKED, *LIKE, *SAID, *named, *options)
    assert result.exit_code == 0, result.output
    assert read_grade(Path("acme.yaml")).sizes[0].minimum_breaking_load_N == pytest.approx(70.4e3)


def test_what_is_in_doubt_is_asked_for_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalog_new, "_asks", lambda: True)
    answers = [
        *("2", "mm", "kN", "kg/m"),
        *("", "Acme", "Quarry", "6x36", "IWRC", "bright", "steel", "", "", "", "", "", "", ""),
        "unirope-6x36-iwrc-1960",
    ]
    units = "\n".join(answers) + "\n"
    result = new(ASKED, "--no-plugins", answers=units)
    assert result.exit_code == 0, result.output
    grade = read_grade(Path("acme.yaml"))
    assert grade.sizes[0].minimum_breaking_load_N == pytest.approx(70.4e3)
    assert (grade.manufacturer, grade.source.publisher) == ("Acme", "Acme")
    assert grade.elasticity.basis == "borrowed"


@pytest.mark.parametrize(
    ("text", "options", "told"),
    [
        ("", (), "acme.csv: the file is empty"),
        ("a,b\n1,2\n", (), "acme.csv:1: diameter: no column is known to be it, of a, b"),
        (GERMAN, ("--page", "2"), "--page: acme.csv is no PDF"),
        (GERMAN.replace("70,4", "x"), (), "acme.csv:3: Mindestbruchkraft (kN): holds 'x'"),
        (GERMAN.replace("70,4", ""), (), "acme.csv:3: Mindestbruchkraft (kN): holds nothing"),
        (GERMAN.partition("10;10")[0], (), "acme.csv: there is no size below the head"),
        (GERMAN, ("--column", "diameter"), "--column: 'diameter' has no value"),
        (GERMAN, ("--column", "weight=3"), "--column: 'weight' is not known"),
        (GERMAN, ("--column", "diameter=x"), "acme.csv:2: diameter: 'x' is the head of no column"),
        (GERMAN, ("--unit", "diameter=kN"), "--unit: diameter: 'kN' does not fit"),
        (GERMAN, ("--unit", "metallic_area=mm2"), "--unit: metallic_area: no column is known"),
        (GERMAN, ("--unit", "diameter=mm", "--unit", "diameter=in"), "diameter is given twice"),
        (GERMAN, ("--set", "colour=red"), "--set: 'colour' is not known"),
        (GERMAN, ("--like", "nothing-so"), "there is no grade 'nothing-so'"),
        (GERMAN, (*LIKE, *SAID, "--set", "material=iron"), "acme.csv: material:"),
        (GERMAN, (*LIKE, *SAID, "--set", "trust=D"), "acme.csv: trust:"),
    ],
)
def test_mistakes_get_a_line_and_nothing_is_written(
    text: str, options: tuple[str, ...], told: str
) -> None:
    assert told in refused(text, *options)[0]


def test_a_file_that_exists_stays() -> None:
    Path("acme.yaml").write_text("mine")
    result = new(GERMAN)
    assert "exists already" in str(result.exception)
    assert Path("acme.yaml").read_text() == "mine"


@pytest.mark.parametrize(
    ("figure", "text", "unit"),
    [
        ("diameter", "Inches", "in"),
        ("diameter", "d", None),
        ("minimum_breaking_load", "kg", "kgf"),
        ("minimum_breaking_load", "tons", None),  # of 1000 kg, 2000 lb or 2240 lb
        ("minimum_breaking_load", "Load", None),
        ("linear_mass", "kg/%m", "kg/100m"),
        ("linear_mass", "lbs/ft", "lb/ft"),
        ("metallic_area", "mm²", "mm^2"),
    ],
)
def test_units_as_tables_write_them(figure: str, text: str, unit: str | None) -> None:
    assert known_unit(figure, text) == unit


def test_a_figure_in_two_units_is_taken_from_the_first_that_is_known() -> None:
    text = "Diameter inch,Diameter mm,MBL kN,MBL lbs,kg/m mass\n0.5,12.7,118,26600,0.68\n"
    Path("two.csv").write_text(text)
    table = read_maker_table(Path("two.csv"), {})
    columns = {figure: (column.head, column.unit) for figure, column in table.columns.items()}
    assert columns["diameter"] == ("Diameter inch", "inch")
    assert columns["minimum_breaking_load"] == ("MBL kN", "kN")
