"""A folder of templates of the user's: before ours, in every report, faults in one line."""

from __future__ import annotations

import os
import sys
from datetime import datetime
from pathlib import Path

import platformdirs
import pytest

from designer.analysis.comparison import compare
from designer.cli.commands import main
from designer.errors import InputError
from designer.report.comparison import comparison_report
from designer.report.document import Report
from designer.report.render import render_html, write_pages
from designer.report.templates import check_templates, environment

EXTENDS = '{% extends "default/page.html.j2" %}'


def report() -> Report:
    result = {"name": "Crane", "provenance": {}}
    return comparison_report(compare(result, result), ("a", "b"), datetime(2026, 1, 2))


def page(folder: Path, text: str, name: str = "page.html.j2") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder


def fault(folder: Path, out: Path) -> str:
    with pytest.raises(InputError) as caught:
        write_pages(report(), out, folder)
    assert list(out.iterdir()) == []
    return str(caught.value)


@pytest.fixture
def out(tmp_path: Path) -> Path:
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


@pytest.fixture
def own(tmp_path: Path) -> Path:
    folder = tmp_path / "own"
    folder.mkdir()
    return folder


def test_a_page_and_a_style_of_ones_own_extend_ours(own: Path, out: Path) -> None:
    page(own, EXTENDS + "{% block footer %}<p>Acme Cranes</p>{% endblock %}")
    page(own, '{% include "default/report.css" %}\n:root { --accent: #c00; }', "report.css")
    check_templates(own)
    write_pages(report(), out, own)
    html = (out / "comparison.html").read_text(encoding="utf-8")
    assert "Acme Cranes" in html
    assert html.index("--accent: #1b5e8c") < html.index("--accent: #c00")
    assert (out / "comparison.pdf").stat().st_size > 1000
    assert "Acme Cranes" not in render_html(report())


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("\n{% block %}", 2, "expected token"),
        ("a\n\n{{ 1 + }}", 3, "end of print statement"),
        ("{% if x %}", 1, "end of template"),
    ],
)
def test_what_is_not_well_formed_is_told_before_any_work(
    own: Path, text: str, line: int, problem: str
) -> None:
    page(own, text)
    with pytest.raises(InputError) as caught:
        check_templates(own)
    assert str(caught.value).startswith(f"{own / 'page.html.j2'}:{line}: ")
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_goes_wrong_on_the_way_names_its_line(own: Path, out: Path) -> None:
    page(own, EXTENDS + "\n{% block footer %}\n{{ report.titel }}{% endblock %}")
    assert fault(own, out).startswith(f"{own / 'page.html.j2'}:3: ")
    page(own, EXTENDS + "\n{% block footer %}{{ 1 / 0 }}{% endblock %}")
    assert fault(own, out).startswith(f"{own / 'page.html.j2'}:2: division by zero")
    page(own, '{% extends "defalt/page.html.j2" %}')
    assert "defalt/page.html.j2" in fault(own, out)


def test_a_page_that_loads_from_outside_is_refused(own: Path, out: Path) -> None:
    page(own, EXTENDS + '{% block footer %}<img src="logo.png">{% endblock %}')
    assert "logo.png" in fault(own, out)
    assert "data URI" in fault(own, out)


def test_the_command_refuses_a_folder_that_is_none(
    own: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder, problem in ((own / "x", "there is no such folder"), (own, "holds no template")):
        monkeypatch.setattr(sys, "argv", ["designer", "report", "a", "--template", str(folder)])
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code == 2
        assert capsys.readouterr().err.startswith(f"{folder}: {problem} (expected ")


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda *_, **__: tmp_path / "cache")
    return tmp_path / "cache" / "templates"


def greeting(folder: Path) -> str:
    return environment(folder).get_template("greeting.html.j2").render()


def test_compiled_templates_are_kept(
    own: Path, kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page(own, "Good day", "greeting.html.j2")
    assert greeting(own) == "Good day"
    assert len(list(kept.iterdir())) == 1
    monkeypatch.setattr("jinja2.Environment.compile", None)
    assert greeting(own) == "Good day"


def test_a_template_that_changed_is_compiled_anew(own: Path, kept: Path) -> None:
    for text in ("Good day", "Good night"):
        page(own, text, "greeting.html.j2")
        assert greeting(own) == text
    assert len(list(kept.iterdir())) == 1


def test_a_damaged_kept_template_is_compiled_anew(own: Path, kept: Path) -> None:
    page(own, "Good day", "greeting.html.j2")
    for damage in (
        lambda content: content[:-3],
        lambda content: content[:-1] + b"?",
        lambda _: b"",
    ):
        greeting(own)
        (file,) = kept.iterdir()
        file.write_bytes(damage(file.read_bytes()))
        assert greeting(own) == "Good day"


def test_templates_need_no_folder_to_be_kept_in(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere = Path(os.devnull) / "no folder"
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda *_, **__: nowhere)
    assert greeting(page(own, "Good day", "greeting.html.j2")) == "Good day"
