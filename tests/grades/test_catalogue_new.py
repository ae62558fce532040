"""`designer catalog new`: from a maker's table to a grade file."""

from __future__ import annotations

import importlib
import os
import re
import sys
import zlib
from pathlib import Path

import pytest
from matplotlib import rc_context
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from typer.testing import CliRunner, Result

from designer.cli import terminal
from designer.cli.commands import app
from designer.drafting import command, pdf_table
from designer.drafting.maker_table import known_unit, read_maker_table
from designer.errors import InputError
from designer.grades.registry import load_catalogue, read_grade

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
    assert (grade.id, grade.product, grade.trust) == ("acme", "Quarry: 'heavy'", "C")
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


def pdf_of(*objects: bytes) -> str:
    """Write a PDF of such objects, the catalogue first; returns its name."""
    content, places = b"%PDF-1.4\n", []
    for number, each in enumerate(objects, start=1):
        places.append(len(content))
        content += b"%d 0 obj\n%b\nendobj\n" % (number, each)
    table = b"".join(b"%010d 00000 n \n" % place for place in places)
    size = len(objects) + 1
    table = b"xref\n0 %d\n0000000000 65535 f \n%b" % (size, table)
    end = b"trailer<</Size %d/Root 1 0 R>>\nstartxref\n%d\n%%%%EOF" % (size, len(content))
    Path("acme.pdf").write_bytes(content + table + end)
    return "acme.pdf"


def stream(content: bytes, head: bytes = b"") -> bytes:
    return b"<<%b/Length %d>>stream\n%b\nendstream" % (head, len(content), content)


def with_forms(n_levels: int) -> list[bytes]:
    """Return a page whose forms each show the next one ten times."""
    form = b"/Type/XObject/Subtype/Form/BBox[0 0 9 9]/Resources<</XObject<</F %d 0 R>>>>"
    forms = [stream(b"/F Do " * 10, form % (number + 6)) for number in range(n_levels)]
    return [stream(b"/F Do " * 10), *forms, stream(b"0 0 m 9 9 l S", form % 5)]


def unpacked(n_megabytes: int) -> list[bytes]:
    packer = zlib.compressobj(9)
    blocks = [packer.compress(bytes(1 << 20)) for _ in range(n_megabytes)]
    content = zlib.compress(b"".join(blocks) + packer.flush(), 9)
    return [stream(content, b"/Filter[/FlateDecode/FlateDecode]"), b"null"]


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
@pytest.mark.parametrize("contents", [with_forms(8), unpacked(4000)], ids=["work", "memory"])
def test_a_small_pdf_that_unpacks_without_end(
    monkeypatch: pytest.MonkeyPatch, contents: list[bytes]
) -> None:
    pytest.importorskip("pdfplumber")
    monkeypatch.setattr(pdf_table, "_LONGEST_S", 3)
    resources = b"/Resources<</XObject<</F 5 0 R>>>>/MediaBox[0 0 600 800]/Contents 4 0 R"
    name = pdf_of(
        b"<</Type/Catalog/Pages 2 0 R>>",
        b"<</Type/Pages/Kids[3 0 R]/Count 1>>",
        b"<</Type/Page/Parent 2 0 R%b>>" % resources,
        *contents,
    )
    assert Path(name).stat().st_size < 10_000
    result = CliRunner().invoke(app, ["catalog", "new", name])
    assert isinstance(result.exception, InputError), result.output
    (fault,) = result.exception.faults
    assert re.search("reading it takes over 60 s or 2 GB|Unable to allocate", fault.problem)
    resource = importlib.import_module("resource")
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 2.2e6


def test_heads_command_no_terminal() -> None:
    result = new(GERMAN.replace("Preis", "Preis\x9b31m"), *LIKE, *SAID)
    assert "left out: Preis?31m" in result.output


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
    assert [line.partition("expected ")[2].partition(",")[0] for line in lines] == [
        f"--unit {figure}=UNIT" for figure in ("minimum_breaking_load", "diameter", "linear_mass")
    ]
    assert "short_ton_force (2000 lb), tonf (1000 kg), long_ton_force (2240 lb)" in lines[0]
    units = ("diameter=mm", "minimum_breaking_load=kN", "linear_mass=kg/m")
    options = [part for unit in units for part in ("--unit", unit)]
    result = new(ASKED, *LIKE, *SAID, *named, *options)
    assert result.exit_code == 0, result.output
    assert read_grade(Path("acme.yaml")).sizes[0].minimum_breaking_load_N == pytest.approx(70.4e3)


def test_what_is_in_doubt_is_asked_for_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "can_ask", lambda: True)
    answers = [
        *("2", "mm", "tons", "kN", "kg/m"),  # which tons, is asked again
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


COLUMNS = "diameter_mm,diameter_nominal_text,min_breaking_load_kN,linear_mass_kg_per_m,notes"
NO_MASS = f"{COLUMNS}\n10,10 mm,70.4,,a\n12,12 mm,101,,b\n"
RANGES = "Diameter mm,MBL kN,Mass kg/m\n9-10,70 to 75,~0.4\n11-12,100 to 110,~0.6\n"


def test_heads_that_are_names_of_variables() -> None:
    rows = "6.35,1/4 in,31.1,0.16,\n10,10 mm,70.4,0.409,\n12,12 mm,101,0.589,\n"
    result = new(f"{COLUMNS}\n{rows}", *LIKE, *SAID)
    assert result.exit_code == 0, result.output
    grade = read_grade(Path("acme.yaml"))
    assert [size.id for size in grade.sizes] == ["1/4 in", "10 mm", "12 mm"]
    assert grade.sizes[1].minimum_breaking_load_N == pytest.approx(70.4e3)
    assert grade.sizes[1].linear_density_kg_per_m == pytest.approx(0.409)


TWO_UNITS = """Rope diameter {d},Mass {m},Minimum breaking force {F}
9.5 (3/8),31.3 (0.21),52.1 (5.86)
12.7 (1/2),55.1 (0.37),91.6 (10.3)
15.9 (5/8),86.3 (0.58),141 (15.9)
"""


def test_second_figures_in_brackets_are_left_out() -> None:
    text = TWO_UNITS.format(d="mm (in.)", m="kg/100 m (lb/ft)", F="kN (short tons)")
    result = new(text, *LIKE, *SAID)
    assert result.exit_code == 0, result.output
    assert "in kN, without the figures in brackets" in result.output
    size = read_grade(Path("acme.yaml")).sizes[0]
    assert size.id == "9.5 mm"
    assert size.diameter_m == pytest.approx(9.5e-3)
    assert size.minimum_breaking_load_N == pytest.approx(52.1e3)
    assert size.linear_density_kg_per_m == pytest.approx(0.313)


def test_the_unit_in_brackets_is_none_of_the_first_figure() -> None:
    text = TWO_UNITS.format(d="mm (in.)", m="kg/100 m (lb/ft)", F="tons (short tons)")
    (line,) = refused(text, *LIKE, *SAID)
    assert line.startswith("acme.csv:1: Minimum breaking force tons (short tons): the unit is not")


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("MBL kN (short tons)", None),  # which of the two a single figure is in
        ("MBL (short tons)", "short_ton_force"),
        ("MBL in tons of 2000 lbs", "short_ton_force"),
        ("MBL, tons (2240 lb)", "long_ton_force"),
        ("MBL [kN]", "kN"),
        ("min_mbl_kN", "kN"),
    ],
)
def test_the_unit_of_a_head(head: str, unit: str | None) -> None:
    Path("head.csv").write_text(f'Diameter in (mm),"{head}",Mass kg per 100 m\n10,70.4,40.9\n')
    columns = read_maker_table(Path("head.csv"), {}).columns
    assert columns["minimum_breaking_load"].unit == unit
    assert (columns["diameter"].unit, columns["linear_mass"].unit) == ("mm", "kg/100m")


TONS = """Diameter in,Breaking strength tons,Weight lb/ft
3/8,5.86,0.21
1/2,10.3,0.37
5/8,15.9,0.58
3/4,22.7,0.84
"""
SIX_BY_19 = ("--like", "unirope-6x19-fc-eips", "--no-plugins")


def in_tons(name: str) -> tuple[float, str]:
    """Return the thickest size's breaking load with these tons [N], and what was printed."""
    result = new(TONS, *SIX_BY_19, *SAID, "--unit", f"minimum_breaking_load={name}")
    assert result.exit_code == 0, result.output
    return read_grade(Path("acme.yaml")).thickest.minimum_breaking_load_N, result.output


def test_which_ton_is_asked_for() -> None:
    (line,) = refused(TONS, *SIX_BY_19, *SAID)
    assert "--unit minimum_breaking_load=UNIT" in line
    assert "short_ton_force (2000 lb), tonf (1000 kg), long_ton_force (2240 lb)" in line


def test_tons_of_2000_lb() -> None:
    load_N, output = in_tons("short tons")
    assert load_N == pytest.approx(22.7 * 2000 * 4.4482216152605)
    assert "remark" not in output
    assert "lies between" not in output


def test_metric_tons_beside_inches_get_remarks() -> None:
    load_N, output = in_tons("tonf")
    assert load_N == pytest.approx(22.7e3 * 9.80665)
    remarks = [
        "tonf is 1000 kgf; beside in and lb/ft most tons are of 2000 lb, short_ton_force",
        "the breaking load lies between those of known 6x19 FC ropes",
    ]
    assert all(remark in output for remark in remarks)
    checked = CliRunner().invoke(app, ["catalog", "check", "acme.yaml"]).output
    assert all(remark in checked for remark in remarks)
    assert "acme.yaml: no fault found" in checked


def test_metric_tons_of_a_metric_table_get_none() -> None:
    rows = "".join(f"{d},{0.33 * 1770 * d * d / 9806.65},{0.359 * d * d}\n" for d in (10, 12, 16))
    text = f"Diameter mm,MBL t,Mass kg/100m\n{rows}"
    result = new(text, *SIX_BY_19, *SAID)
    assert result.exit_code == 0, result.output
    assert "remark" not in result.output


def test_what_is_copied_is_listed() -> None:
    result = new(GERMAN, *LIKE, *SAID, "--set", "finish=galvanised")
    (line,) = [line for line in result.output.splitlines() if "copied from" in line]
    lender = load_catalogue(with_plugins=False).grade("unirope-6x36-iwrc-1960")
    modulus = f"modulus {lender.modulus.value_Pa / 1e9:g} GPa"
    for copied in (f"construction {lender.construction}", "core IWRC", "material steel", modulus):
        assert copied in line
    assert "finish" not in line
    assert f"sheave_ratio {lender.sheave_ratio.suggested:g}" in line
    assert read_grade(Path("acme.yaml")).notes[0].endswith(line.partition(": ")[2])


def test_trust_is_never_the_makers_unless_said() -> None:
    result = new(GERMAN, *LIKE, *SAID)
    assert read_grade(Path("acme.yaml")).trust == "C"
    assert "trust: C, third hand; --set trust=A" in result.output
    Path("acme.yaml").unlink()
    result = new(GERMAN, *LIKE, *SAID, "--set", "trust=A")
    assert read_grade(Path("acme.yaml")).trust == "A"
    assert "trust" not in result.output


@pytest.mark.parametrize(
    ("text", "options", "told"),
    [
        ("", (), "acme.csv: the file is empty"),
        ("a,b\n1,2\n", (), "acme.csv:1: diameter: no column is known to be it, of a, b"),
        (GERMAN, ("--page", "2"), "--page: acme.csv is no PDF"),
        (GERMAN.replace("70,4", "x"), (), "acme.csv:3: Mindestbruchkraft (kN): holds 'x'"),
        (GERMAN.replace("70,4", "1/" + "9" * 400), (), "holds '1/9999"),
        (GERMAN.replace("70,4", "9" * 4400), (), "holds '9999"),
        (GERMAN.replace("70,4", "1/0"), (), "holds '1/0'"),
        (RANGES, (), "acme.csv:2: Diameter mm: holds '9-10' (expected a number, the diameter; or"),
        (NO_MASS, (), "acme.csv:1: linear_mass_kg_per_m: the column is empty (expected the linear"),
        (GERMAN, ("--unit", "minimum_breaking_load=ton"), "lbf, kip, short_ton_force (2000 lb), "),
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


def test_sizes_that_lack_a_figure_are_left_out_and_named() -> None:
    result = new(GERMAN.replace("70,4", ""), *LIKE, *SAID)
    assert "left out: line 3, 10 10: no minimum_breaking_load" in result.output
    sizes = read_grade(Path("acme.yaml")).sizes
    Path("acme.yaml").unlink()
    new(GERMAN, *LIKE, *SAID)
    assert len(sizes) == len(read_grade(Path("acme.yaml")).sizes) - 1


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
        ("minimum_breaking_load", "TON", None),
        ("minimum_breaking_load", "ton_force", None),
        ("minimum_breaking_load", "short ton", "short_ton_force"),
        ("minimum_breaking_load", "US tons", "short_ton_force"),
        ("minimum_breaking_load", "U.S. tons", "short_ton_force"),
        ("minimum_breaking_load", "tons of 2,000 lbs", "short_ton_force"),
        ("minimum_breaking_load", "tons (2000 lb)", "short_ton_force"),
        ("minimum_breaking_load", "Long Tons", "long_ton_force"),
        ("minimum_breaking_load", "tons of 2240 lb", "long_ton_force"),
        ("minimum_breaking_load", "metric tons", "tonf"),
        ("minimum_breaking_load", "tonnes", "tonf"),
        ("minimum_breaking_load", "t", "tonf"),
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
