from __future__ import annotations

import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from grade_samples import GRADE_TEXT, write_grade
from plugin_samples import hook, install_plugin

import designer
from designer import plugins
from designer.cli.commands import main
from designer.grades import registry
from designer.grades.registry import CatalogueSource, load_catalogue


@cache
def n_shipped() -> int:
    return len(load_catalogue(with_plugins=False).grades)


def _folder_hook(folder: Path) -> str:
    return hook(f"return [{str(folder)!r}]")


def test_a_plugin_brings_a_folder_of_grades(site, tmp_path):
    write_grade(tmp_path / "ropes" / "a.yaml", grade_id="acme-a")
    write_grade(tmp_path / "ropes" / "b.yaml", grade_id="acme-b")
    install_plugin(site, "acme-folder", _folder_hook(tmp_path / "ropes"))

    catalogue = load_catalogue()

    assert catalogue.problems == ()
    assert catalogue.grade("acme-b").origin == "acme-folder"
    assert CatalogueSource("acme-folder", "acme-folder 1.2", 2) in catalogue.sources
    assert catalogue.grade("unirope-7x19-galvanised").origin == "builtin"


def test_a_plugin_may_give_files_and_grades_made_in_python(site, tmp_path):
    path = write_grade(tmp_path / "a.yaml", grade_id="acme-file")
    code = hook(
        "from dataclasses import replace; from pathlib import Path; "
        f"from designer.grades.registry import read_grade; path = Path({str(path)!r}); "
        "return [path, replace(read_grade(path), id='acme-python', file='')]"
    )
    install_plugin(site, "acme-mixed", code)

    catalogue = load_catalogue()

    assert catalogue.problems == ()
    assert {grade.id for grade in catalogue.grades if grade.origin == "acme-mixed"} == {
        "acme-file",
        "acme-python",
    }


@pytest.mark.cases_by_default(5)
@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("acme-import", "raise RuntimeError('no licence')", "cannot be loaded: RuntimeError: no"),
        ("acme-syntax", "def :", "cannot be loaded: SyntaxError"),
        ("acme-exit", "raise SystemExit(3)", "cannot be loaded: SystemExit: 3"),
        ("acme-hook", hook("raise KeyError('rope')"), "fails in register_grades(): KeyError"),
        ("acme-quit", hook("import sys; sys.exit(0)"), "register_grades(): SystemExit: 0"),
        ("acme-end", hook("raise GeneratorExit"), "register_grades(): GeneratorExit: left out"),
        ("acme-misspelt", hook("return []", "register_grade"), "unknown hook 'register_grade'"),
        ("acme-number", hook("return 7"), "it returned int, not a list"),
        ("acme-nothing", hook("return None"), "it returned NoneType, not a list"),
        ("acme-items", hook("return [7]"), "gave int, not a path or a Grade"),
        ("acme-relative", hook("return ['ropes']"), "gave the relative path 'ropes'"),
        ("acme-absent", hook("return ['/no/such/folder/of/ropes']"), "there is no such file"),
        ("acme-hookless", "x = 1", "it has no hook such as register_grades(): left out"),
        ("acme-lazy", hook("yield 'a rope'"), "it returned generator, not a list"),
        (
            "acme-arguments",
            hook("return []").replace("register_grades()", "register_grades(colour)"),
            "cannot be loaded: PluginValidationError",
        ),
        (
            "acme-coloured",
            hook("raise type('Bad\\x1b[31m', (Exception,), {})('red \\x1b[31m text')"),
            "fails in register_grades(): Bad?[31m: red ?[31m text",
        ),
        (
            "acme-unreadable",
            "class Bad(Exception):\n    def __str__(self):\n        raise ValueError\nraise Bad",
            "an error without a readable message",
        ),
    ],
)
def test_a_broken_plugin_is_one_line_with_its_name_and_the_rest_works(site, name, code, words):
    install_plugin(site, name, code)

    catalogue = load_catalogue()

    (problem,) = catalogue.problems
    assert problem.startswith(f"plugin {name} ({name} 1.2)")
    assert words in problem
    assert problem.endswith(": left out")
    assert "\n" not in problem
    assert len(catalogue.grades) == n_shipped()


def test_an_entry_point_that_leads_nowhere_is_reported(site):
    install_plugin(site, "acme-lost", "x = 1", entry="acme_lost_module")

    (problem,) = load_catalogue().problems

    assert problem.startswith("plugin acme-lost (acme-lost 1.2) cannot be loaded: ModuleNotFound")


def test_an_entry_point_that_is_none_is_reported(site):
    install_plugin(site, "acme-lost", "x = 1", entry="no such thing!")

    (problem,) = load_catalogue().problems

    assert problem.endswith("its entry point 'no such thing!' names no module: left out")


def test_an_entry_point_to_what_a_module_has_not_is_reported(site):
    install_plugin(site, "acme-lost", "x = 1", entry="acme_lost:plugin")

    (problem,) = load_catalogue().problems

    assert problem.startswith("plugin acme-lost (acme-lost 1.2) cannot be loaded: AttributeError")


def test_a_folder_of_thousands_of_files_is_one_line_and_none_is_read(site, tmp_path, monkeypatch):
    ropes = tmp_path / "ropes"
    ropes.mkdir()
    for number in range(registry.MAX_FILES + 500):
        (ropes / f"{number}.yaml").touch()
    install_plugin(site, "acme-many", _folder_hook(ropes))
    read = []
    monkeypatch.setattr(registry, "read_document", read.append)

    (problem,) = load_catalogue(plugins=_only("acme-many")).problems

    assert problem.startswith(f"plugin acme-many (acme-many 1.2): {ropes}: the folder holds too")
    assert read == []


def test_links_in_a_circle_trap_nobody(site, tmp_path):
    ropes = tmp_path / "ropes"
    write_grade(ropes / "a.yaml", grade_id="acme-a")
    (ropes / "round").symlink_to(ropes, target_is_directory=True)
    (ropes / "b.yaml").symlink_to(ropes / "c.yaml")
    (ropes / "c.yaml").symlink_to(ropes / "b.yaml")
    install_plugin(site, "acme-circle", _folder_hook(ropes))

    catalogue = load_catalogue()

    assert catalogue.grade("acme-a").origin == "acme-circle"
    assert CatalogueSource("acme-circle", "acme-circle 1.2", 1) in catalogue.sources
    for name, problem in zip(("b.yaml", "c.yaml"), catalogue.problems, strict=True):
        assert problem.startswith(f"plugin acme-circle (acme-circle 1.2): {ropes / name}: ")


def _only(name: str) -> plugins.Plugins:
    loaded = plugins.find_plugins().loaded
    return plugins.Plugins(tuple(plugin for plugin in loaded if plugin.name == name))


def test_a_faulty_grade_is_left_out_and_its_neighbours_stay(site, tmp_path):
    write_grade(tmp_path / "ropes" / "good.yaml", grade_id="acme-good")
    bad = write_grade(tmp_path / "ropes" / "bad.yaml", grade_id="acme-bad")
    bad.write_text(bad.read_text().replace("0.244", "0.164"))
    install_plugin(site, "acme-half", _folder_hook(tmp_path / "ropes"))

    catalogue = load_catalogue()

    (problem,) = catalogue.problems
    assert problem.startswith(f"plugin acme-half (acme-half 1.2): {bad}:21: sizes[2].linear_mass")
    assert CatalogueSource("acme-half", "acme-half 1.2", 1) in catalogue.sources


@pytest.mark.cases_by_default(2)
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("sizes=()", "sizes: there is no size"),
        ("sizes='thick'", "a Grade is not usable"),
        ("notes=['a list']", "a Grade is not usable: TypeError: unhashable type: 'list'"),
        ("product=None", "product: is NoneType (expected a text)"),
        ("trust='Z'", "trust: 'Z' is not known"),
        ("product='a' + chr(27)", "not printable"),
    ],
)
def test_a_grade_made_in_python_passes_the_same_checks(site, tmp_path, change, words):
    path = write_grade(tmp_path / "a.yaml")
    code = hook(
        "from dataclasses import replace; from pathlib import Path; "
        "from designer.grades.registry import read_grade; "
        f"return [replace(read_grade(Path({str(path)!r})), {change})]"
    )
    install_plugin(site, "acme-values", code)

    (problem,) = load_catalogue().problems

    assert problem.startswith("plugin acme-values (acme-values 1.2): ")
    assert words in problem


def test_one_id_of_two_plugins_names_both_and_keeps_the_first(site, tmp_path):
    for name in ("acme-one", "acme-two"):
        write_grade(tmp_path / name / f"{name}.yaml", grade_id="acme-same")
        install_plugin(site, name, _folder_hook(tmp_path / name))

    catalogue = load_catalogue()

    assert catalogue.problems == (
        "plugin acme-two (acme-two 1.2): grade 'acme-same' of 'acme-two' (acme-two.yaml) is in "
        "'acme-one' (acme-one.yaml) already: left out",
    )
    assert catalogue.grade("acme-same").origin == "acme-one"


def test_a_plugin_cannot_replace_a_shipped_grade_nor_our_own_plugin(site, tmp_path):
    write_grade(tmp_path / "ropes" / "a.yaml", grade_id="unirope-7x19-galvanised")
    install_plugin(site, "builtin", _folder_hook(tmp_path / "ropes"))

    install_plugin(site, "acme-thief", _folder_hook(tmp_path / "ropes"))

    catalogue = load_catalogue()

    name, grade = catalogue.problems
    assert name == (
        f"plugin builtin (builtin 1.2) has the name of cdpr-designer {designer.__version__}: "
        "left out"
    )
    assert "grade 'unirope-7x19-galvanised' of 'acme-thief' (a.yaml) is in 'builtin'" in grade
    assert catalogue.grade("unirope-7x19-galvanised").file == "unirope-7x19-galvanised.yaml"


def test_prints_of_a_plugin_stay_off_standard_output(site, tmp_path, capsys):
    write_grade(tmp_path / "ropes" / "a.yaml", grade_id="acme-loud-7x19")
    body = f"print('buy now'); return [{str(tmp_path / 'ropes')!r}]"
    install_plugin(site, "acme-loud", "print('hello from import')\n" + hook(body))

    catalogue = load_catalogue()

    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == "hello from import\nbuy now\n"
    assert catalogue.problems == ()
    assert catalogue.grade("acme-loud-7x19").origin == "acme-loud"


def test_ctrl_c_in_a_plugin_ends_the_command(site):
    install_plugin(site, "acme-slow", hook("raise KeyboardInterrupt"))
    with pytest.raises(KeyboardInterrupt):
        load_catalogue()


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("file", ["METADATA", "entry_points.txt"])
def test_damaged_metadata_is_one_line_and_the_rest_works(site, tmp_path, file):
    write_grade(tmp_path / "ropes" / "a.yaml", grade_id="acme-a")
    install_plugin(site, "acme-bad", hook("return []"))
    install_plugin(site, "acme-good", _folder_hook(tmp_path / "ropes"))
    (site / "acme_bad-1.2.dist-info" / file).write_bytes(b"\xff\xfe\x1b[31m")

    catalogue = load_catalogue()

    (problem,) = catalogue.problems
    assert "acme_bad" in problem
    assert "its metadata cannot be read: UnicodeDecodeError" in problem
    assert problem.isprintable()
    assert catalogue.grade("acme-a").origin == "acme-good"


def test_markup_in_a_grade_is_listed_as_text(site, tmp_path, capsys, monkeypatch):
    text = GRADE_TEXT.replace("construction: 7x19", 'construction: "[red]<b>7x19</b>"')
    write_grade(tmp_path / "ropes" / "a.yaml", text, grade_id="acme-a")
    install_plugin(site, "acme-markup", _folder_hook(tmp_path / "ropes"))
    monkeypatch.setattr(sys, "argv", ["designer", "catalog", "list", "--construction", "[red]"])

    with pytest.raises(SystemExit) as stop:
        main()

    assert stop.value.code == 0
    assert "[red]<b>7x19</b>" in capsys.readouterr().out


def test_without_plugins_only_the_shipped_grades_remain(site, tmp_path, user_folder):
    write_grade(tmp_path / "ropes" / "a.yaml", grade_id="acme-a")
    install_plugin(site, "acme-folder", _folder_hook(tmp_path / "ropes"))
    install_plugin(site, "acme-broken", "raise RuntimeError")
    write_grade(user_folder / "mine.yaml", grade_id="mine")

    catalogue = load_catalogue(with_plugins=False)

    assert [source.name for source in catalogue.sources] == ["builtin"]
    assert catalogue.problems == ()


@pytest.mark.parametrize("with_plugins", [True, False])
def test_the_shipped_grades_come_in_where_nothing_is_installed(monkeypatch, with_plugins):
    monkeypatch.setattr(plugins, "distributions", lambda: ())

    catalogue = load_catalogue(with_plugins=with_plugins)

    assert [source.name for source in catalogue.sources] == ["builtin"]
    assert catalogue.problems == ()
    assert catalogue.grade("unirope-7x19-galvanised").origin == "builtin"


def test_our_entry_points_are_those_that_pyproject_declares():
    pyproject = Path(__file__).parents[2] / "pyproject.toml"
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]

    declared = project["entry-points"][plugins.ENTRY_POINT_GROUP]

    assert declared == {entry.name: entry.value for entry in plugins.OWN_ENTRIES}
