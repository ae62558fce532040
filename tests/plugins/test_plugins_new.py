"""A plugin that `designer catalog new-plugin` writes: built, installed, used, removed."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest
from wheels import install

from designer.analysis.analyse import analyse
from designer.cli.catalog import write_plugin
from designer.cli.commands import main
from designer.effects.load import load_effects
from designer.errors import InputError, OutputError
from designer.grades.registry import CatalogueSource, load_catalogue
from designer.io.config import read_study
from designer.model.cable import Cable
from designer.plugins import find_plugins
from designer.progress import Silent
from designer.resources import data_folder
from designer.study import as_built_by

pytestmark = pytest.mark.slow

STUDY = """\
robot:
  anchors: [[0, 0, 12], [30, 0, 12], [15, 26, 12]]
  platform: {mass: 180 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
workspace:
  region: {prism: anchors, inset: 4 m, z: [1, 7]}
  samples: 50
selection: {grades: [acme-ropes-example], safety_factor: 5}
"""


def test_a_new_plugin_is_installed_used_and_removed(site, tmp_path) -> None:
    project = tmp_path / "acme-ropes"
    write_plugin("acme-ropes", project)
    install(project, site)

    catalogue = load_catalogue()
    assert catalogue.problems == ()
    assert CatalogueSource("acme-ropes", "acme-ropes 0.1.0", 1) in catalogue.sources
    assert all(size.doubt for size in catalogue.grade("acme-ropes-example").sizes)

    config = tmp_path / "study.yaml"
    config.write_text(STUDY, encoding="utf-8")
    selection = analyse(read_study(config), catalogue, tmp_path, Silent()).selection
    assert selection is not None
    assert selection.chosen is not None
    assert selection.chosen.grade.origin == "acme-ropes"

    shutil.rmtree(site)
    assert "acme-ropes" not in {source.name for source in load_catalogue().sources}


@pytest.mark.parametrize(("effect", "passed"), [(False, "2 passed"), (True, "4 passed")])
def test_its_own_tests_pass(site, tmp_path, effect, passed) -> None:
    project = tmp_path / "acme-ropes"
    write_plugin("acme-ropes", project, effect=effect)
    install(project, site)
    root = data_folder("catalog").parent  # in a checkout, where designer may not be installed
    code = f"import sys; sys.path[:0] = [{str(site)!r}, {str(root)!r}]; import pytest; "
    code += "sys.exit(pytest.main(['-q', '-p', 'no:cacheprovider', '.']))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=project, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
    assert passed in done.stdout


def test_a_study_may_declare_the_effect_of_a_new_plugin(site, tmp_path) -> None:
    project = tmp_path / "acme-frost"
    write_plugin("acme-frost", project, effect=True)
    install(project, site)
    config = tmp_path / "study.yaml"
    ice = "effects: {acme_frost_ice: {thickness_m: 2 mm}}\nsurroundings: {temperature: -5 degC}\n"
    config.write_text(STUDY.split("workspace:", maxsplit=1)[0] + ice, encoding="utf-8")
    built = as_built_by(read_study(config, load_effects(find_plugins())))
    rope = Cable(0.01, 0.38, 4.7e6, 1.4e4)
    assert built.cable(rope).linear_density_kg_per_m == pytest.approx(0.4479, abs=1e-4)


def test_the_command_says_what_comes_next(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["designer", "catalog", "new-plugin", "acme-ropes"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 0
    assert capsys.readouterr().out.splitlines()[:3] == [
        "acme-ropes written. Next:",
        "  pip install -e acme-ropes",
        "  designer catalog list",
    ]
    assert (tmp_path / "acme-ropes" / "acme_ropes" / "grades").is_dir()


@pytest.mark.parametrize("name", ["README.md", "folder"])
def test_nothing_is_overwritten(tmp_path, name) -> None:
    (tmp_path / "README.md").write_text("mine", encoding="utf-8")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OutputError, match="exists already"):
        write_plugin("acme-ropes", tmp_path / name)
    assert (tmp_path / "README.md").read_text(encoding="utf-8") == "mine"
    assert list((tmp_path / "folder").iterdir()) == []


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("", "cannot be the name"),
        ("Acme", "cannot be the name"),
        ("acme_ropes", "cannot be the name"),
        ("acme--ropes", "cannot be the name"),
        ("acme-", "cannot be the name"),
        ("7x19", "cannot be the name"),
        ("../acme", "cannot be the name"),
        ('acme"', "cannot be the name"),
        ("a" * 61, "cannot be the name"),
        ("class", "is a word of Python's own"),
        ("json", "there is a module 'json' already"),
        ("designer", "there is a module 'designer' already"),
    ],
)
def test_a_name_that_cannot_be_is_one_line(tmp_path, name, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        write_plugin(name, tmp_path / "new")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "new").exists()
