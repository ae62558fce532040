"""Number, revision, names, logo and digests at the head of a report."""

from __future__ import annotations

import base64
import io
import os
import struct
import zlib
from pathlib import Path

import pytest
from PIL import Image
from pypdf import PdfReader

import designer
from designer.errors import InputError
from designer.report.design.report import design_report
from designer.report.document import control_of
from designer.report.render import render_html, render_pdf
from designer.resources import data_folder

STUDY = """
robot:
  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
  platform: {mass: 4000 kg}
cable: {density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: [250, 200, -50]
"""
CONTROL = """
document:
  number: D-102
  revision: <b>B</b>
  checker: C. Checker
  logo: logo.svg
"""
LOGO = b'<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path d="M0 0h9v9z"/></svg>'


def svg(inside: str) -> bytes:
    start = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'
    return f"{start}{inside}</svg>".encode()


def png(side: int) -> bytes:
    stream = io.BytesIO()
    Image.new("1", (side, side)).save(stream, "PNG")
    return stream.getvalue()


def claiming(side: int) -> bytes:
    """Return a picture of a pixel whose head claims more: pixels take long to write."""
    picture = png(1)
    head = b"IHDR" + struct.pack(">II", side, side) + picture[24:29]
    return picture[:12] + head + struct.pack(">I", zlib.crc32(head)) + picture[33:]


def study(tmp_path: Path, logo: bytes | None = LOGO, text: str = STUDY + CONTROL) -> Path:
    if logo is not None:
        (tmp_path / "logo.svg").write_bytes(logo)
    path = tmp_path / "study.yaml"
    path.write_text(text)
    return path


def test_what_is_given_stands_on_the_first_page(tmp_path) -> None:
    analysis = designer.analyse(designer.read_study(study(tmp_path)))
    report = design_report(analysis, draws=False)
    html = render_html(report, paged=True)
    assert "&lt;b&gt;B&lt;/b&gt;" in html
    assert f"data:image/svg+xml;base64,{base64.b64encode(LOGO).decode()}" in html
    (tmp_path / "report.pdf").write_bytes(render_pdf(html))
    words = PdfReader(tmp_path / "report.pdf").pages[0].extract_text()
    for told in ("D-102", "C. Checker", analysis.study.source.sha256[:12], "grades builtin"):
        assert told in words
    assert "Approved" not in words
    assert [box.label for box in report.control.boxes] == ["Document", "Revision", "Checked"]


def test_nothing_is_shown_where_nothing_is_given(tmp_path) -> None:
    given = designer.read_study(study(tmp_path, text=STUDY))
    control = control_of(given)
    assert (control.boxes, control.logo) == ((), "")
    assert control.identity == f"SHA-256 of configuration {given.source.sha256[:12]}"


@pytest.mark.parametrize(
    ("logo", "words"),
    [
        (None, "there is no file"),
        (b"GIF89a", "logo.svg is no such picture (expected a PNG, JPEG or SVG file)"),
        (b"\x89PNG\r\n\x1a\n" + bytes(10**6), "is too large (expected at most 1,000,000 bytes)"),
        (claiming(5000), "has more than 20 million pixels (expected fewer)"),
        (claiming(40_000), "has more than 20 million pixels (expected fewer)"),
        (png(99)[:-30], "cannot be decoded (expected a PNG, JPEG or SVG file)"),
        (svg("<g>" * 60_000 + "</g>" * 60_000), "is no plain SVG in line 1: more than 100000 elem"),
        (svg("<g>" * 65 + "</g>" * 65), "nested more than 64 deep"),
        (b"<!DOCTYPE svg [<!ENTITY a 'x'>]>" + svg("&a;"), "the file declares entities"),
        (svg("<path"), "is no plain SVG in line 1: this is not valid XML"),
        (svg('<image href="http://a.example/a.png"/>'), "refers to 'http://a.example/a.png'"),
        (svg('<use xlink:href="file:///etc/passwd#a"/>'), "refers to 'file:///etc/passwd#a'"),
        (svg('<rect style="fill: url( &quot;a.svg#a&quot;)"/>'), "refers to 'a.svg#a"),
        (svg('<style>@import "a.css";</style>'), "refers to '\"a.css\";'"),
        (b'<?xml-stylesheet href="a.css"?>' + svg(""), "refers to 'a style sheet'"),
    ],
)
def test_a_logo_that_no_page_can_show(tmp_path, logo, words) -> None:
    with pytest.raises(InputError) as caught:
        designer.read_study(study(tmp_path, logo))
    (line,) = str(caught.value).splitlines()
    assert line.startswith(f"{tmp_path / 'study.yaml'}:12: document.logo: ")
    assert words in line


@pytest.mark.parametrize(
    "logo", [png(40), svg('<g id="a"/><use href="#a"/><rect fill="url(#a)"/>'), LOGO]
)
def test_a_picture_that_holds_all_it_shows_is_taken(tmp_path, logo) -> None:
    assert control_of(designer.read_study(study(tmp_path, logo))).logo


@pytest.mark.parametrize("logo", [png(41), svg('<g id="b"/>')])
def test_a_picture_is_taken_where_no_pdf_can_be_made(tmp_path, monkeypatch, logo) -> None:
    (tmp_path / "plutoprint.py").write_text("raise ImportError")
    monkeypatch.syspath_prepend(tmp_path)
    assert control_of(designer.read_study(study(tmp_path, logo))).logo


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
def test_a_picture_that_takes_too_long_or_too_much_is_ended(tmp_path) -> None:
    tenfold = (f'<g id="a{k + 1}">' + f'<use href="#a{k}"/>' * 10 + "</g>" for k in range(9))
    logo = svg(f'<path id="a0" d="M0 0h9v9z"/>{"".join(tenfold)}<use href="#a9"/>')
    with pytest.raises(InputError, match=r"(not drawn within|cannot be drawn).*a simpler picture"):
        designer.read_study(study(tmp_path, logo))


def test_the_digest_of_grades_is_theirs_alone(tmp_path) -> None:
    first, second = designer.catalogue(with_plugins=False), designer.catalogue(with_plugins=False)
    assert [one.sha256 for one in first.sources] == [one.sha256 for one in second.sources]
    shipped = first.grade("unirope-7x19-galvanised")
    folder = tmp_path / "ropes"
    folder.mkdir()
    text = (data_folder("catalog") / shipped.file).read_text().replace(shipped.id, "acme-7x19")
    digests = []
    for product in (text, text.replace("7x19", "7x7")):
        (folder / "acme.yaml").write_text(product.replace("acme-7x7", "acme-7x19"))
        digests.append(designer.catalogue([folder], with_plugins=False).sources[-1].sha256)
    assert digests[0] != digests[1]
