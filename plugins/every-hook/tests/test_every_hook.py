"""Each hook does what it says, by the commands of designer."""

from __future__ import annotations

import sys
from pathlib import Path

import every_hook
import pytest

from designer.cli.commands import main
from designer.plugins import HOOKS

STUDY = """\
name: Hall crane
robot:
  anchors: [[0, 0, 9], [12, 0, 9], [6, 9, 8.5]]
  platform: {mass: 300 kg}
cable: {grade: unirope-7x19-galvanised, safety_factor: 5}
pose: [6, 3, 3]
"""


@pytest.fixture
def designer(tmp_path, monkeypatch, capsys):
    """Run a command in a folder with a study, where the plugin is loaded; return what it prints."""
    (tmp_path / "hall.yaml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    info = tmp_path / "site" / "every_hook-0.1.0.dist-info"  # as an installer writes it
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: every-hook\nVersion: 0.1.0\n")
    (info / "entry_points.txt").write_text("[designer.plugins]\nevery-hook = every_hook\n")
    monkeypatch.syspath_prepend(info.parent)

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["designer", *arguments])
        with pytest.raises(SystemExit) as stop:
            main()
        printed = capsys.readouterr()
        return int(stop.value.code or 0), printed.out, printed.err

    return run


def test_a_command(designer) -> None:
    assert designer("anchor-span", "hall.yaml") == (0, "12.000 m\n", "")
    assert "anchor-span" in designer("--help")[1]


def test_a_command_of_the_catalogue(designer) -> None:
    status, printed, notes = designer("catalog", "longest", "Unirope")
    assert (status, notes) == (0, "")
    assert printed.startswith("unirope-")
    assert "longest" in designer("catalog", "--help")[1]


def test_an_exporter_and_an_importer(designer) -> None:
    status, printed, notes = designer("export", "hall.yaml", "--to", "points")
    assert (status, printed) == (0, "hall.points written\n")
    assert notes == "Not in it: all but the exit points\n"
    assert Path("hall.points").read_text(encoding="utf-8") == "0 0 9\n12 0 9\n6 9 8.5\n"
    mass = ("--mass", "300 kg", "--pose", "6,3,3", "--grade", "unirope-7x19-galvanised")
    arguments = ("import", "hall.points", *mass, "--safety-factor", "5", "-o", "back.yaml")
    assert designer(*arguments)[0] == 0
    assert designer("size", "back.yaml")[0] == designer("size", "hall.yaml")[0] == 0


def test_a_faulty_file_is_refused_in_one_line(designer) -> None:
    Path("bad.points").write_text("0 0 9\n1 2\n", encoding="utf-8")
    status, _, notes = designer("import", "bad.points")
    assert (status, notes) == (2, "bad.points:2: is no point (expected x y z in metres)\n")


def test_a_section_of_the_report(designer) -> None:
    status, _, notes = designer("report", "hall.yaml", "-o", "report")
    assert status == 0
    assert "left out" not in notes
    page = Path("report/report.html").read_text(encoding="utf-8")
    assert '<h2 id="anchor-heights"' in page
    assert "<li>9.00 m</li><li>9.00 m</li><li>8.50 m</li>" in page


def test_a_filter_of_templates(designer) -> None:
    Path("acme").mkdir()
    footer = "{% block footer %}<footer>{{ 3.048 | in_feet }}</footer>{% endblock %}"
    page = '{% extends "default/page.html.j2" %}' + footer
    Path("acme/page.html.j2").write_text(page, encoding="utf-8")
    arguments = ("report", "hall.yaml", "--quick", "--template", "acme", "-o", "report")
    assert designer(*arguments)[0] == 0
    assert "<footer>10.0 ft</footer>" in Path("report/report.html").read_text(encoding="utf-8")
    status, _, notes = designer(*arguments, "--no-plugins")
    assert (status, "acme/page.html.j2:1: No filter named 'in_feet'" in notes) == (2, True)


def test_it_shows_every_hook_but_grades_and_effects() -> None:
    shown = {name for name in HOOKS if hasattr(every_hook, name)}
    assert {*HOOKS} - shown == {"register_grades", "register_effects"}
