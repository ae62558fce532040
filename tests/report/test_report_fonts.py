"""Pages look the same whatever fonts a machine has."""

from __future__ import annotations

import base64
import html
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import platformdirs
import pypdf
import pytest
from fontTools.ttLib import TTFont

from designer.analysis.analyse import Analysis
from designer.report import fonts
from designer.report.design.report import design_report
from designer.report.document import Report
from designer.report.fonts import FACES, with_fonts
from designer.report.render import render_html

PRINT = """
import sys
from pathlib import Path
from designer.report.render import render_pdf
Path(sys.argv[2]).write_bytes(render_pdf(Path(sys.argv[1]).read_text(encoding="utf-8")))
"""
NOWHERE = Path(os.devnull) / "no folder"
NO_FONTS = '<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd"><fontconfig/>'


@pytest.fixture(scope="module")
def report(pose_only: Analysis) -> Report:
    return design_report(pose_only, draws=False)


def fonts_in(page: str) -> list[TTFont]:
    found = re.findall(r"url\(data:font/woff;base64,([^)]+)\)", page)
    return [TTFont(io.BytesIO(base64.b64decode(one))) for one in found]


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="fontconfig's settings")
def test_without_any_font_installed_the_pdf_is_the_same(report: Report, tmp_path: Path) -> None:
    page, none = tmp_path / "page.html", tmp_path / "fonts.conf"
    page.write_text(render_html(report, paged=True), encoding="utf-8")
    none.write_text(NO_FONTS, encoding="utf-8")
    made = []
    for name, settings in (("with", {}), ("without", {"FONTCONFIG_FILE": str(none)})):
        file = tmp_path / f"{name}.pdf"
        environment = {k: v for k, v in os.environ.items() if k != "FONTCONFIG_FILE"} | settings
        command = [sys.executable, "-c", PRINT, str(page), str(file)]
        subprocess.run(command, env=environment, check=True, timeout=900)
        made.append([page.extract_text() for page in pypdf.PdfReader(file).pages])
    assert made[0] == made[1]
    assert "How sure this is" in " ".join(made[1][0].split())


def test_a_page_carries_the_letters_that_it_shows_and_few_others() -> None:
    page = with_fonts("<head></head><p style='font-family: \"Report Sans\"'>a&Sigma;b √</p>")
    fonts = fonts_in(page)
    assert len(fonts) == sum(face[0] == "Report Sans" for face in FACES)
    for font in fonts:
        assert set(map(ord, "abΣ√")) <= set(font.getBestCmap())
        assert ord("Ж") not in font.getBestCmap()
    assert fonts_in(with_fonts("<head></head><p>plain</p>")) == []


@pytest.mark.parametrize("has_folder", [True, False])
def test_the_fonts_of_most_pages_are_made_once_on_a_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_folder: bool
) -> None:
    monkeypatch.setattr(
        platformdirs, "user_cache_path", lambda *_, **__: tmp_path if has_folder else NOWHERE
    )
    page = "<head></head><p style='font-family: \"Report Mono\"'>a b</p>"
    asked = []
    subset = fonts._subset
    monkeypatch.setattr(fonts, "_subset", lambda *what: asked.append(what) or subset(*what))
    made = []
    for shown in (page, page, page.replace("b", "Ж")):
        fonts._letters_of.cache_clear()  # as in another run
        made.append(with_fonts(shown))
    assert made[0] == made[1]
    assert ord("Ж") in fonts_in(made[2])[0].getBestCmap()
    assert len(asked) == (2 if has_folder else 3)
    assert len([*tmp_path.rglob("*")]) == (2 if has_folder else 0)  # a folder and one font


def test_every_letter_of_a_report_is_in_its_fonts(report: Report) -> None:
    page = render_html(report)
    for font in fonts_in(page):
        text = re.sub(r"<(style|svg|script).*?</\1>|<[^>]*>", "", page, flags=re.DOTALL)
        shown = {
            letter
            for letter in html.unescape(text)
            if letter.isprintable() and not letter.isspace()
        }
        assert shown - set(map(chr, font.getBestCmap())) == set()
