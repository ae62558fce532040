"""The plugins in `plugins/` come in by the door once they are installed."""

from __future__ import annotations

from pathlib import Path

import pytest
from wheels import install

from designer.grades.registry import load_catalogue
from designer.plugins import HOOKS, find_plugins

PLUGINS = Path(__file__).parents[2] / "plugins"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("folder", "grade_id"),
    [("guy-strand", "astm-a475-7-wire-ehs"), ("fibre-rope", "hmpe-computed-20c-5y")],
)
def test_an_example_is_installed_and_its_grades_are_known(site, folder, grade_id) -> None:
    assert grade_id not in {grade.id for grade in load_catalogue().grades}

    install(PLUGINS / folder, site)

    catalogue = load_catalogue()
    assert catalogue.problems == ()
    assert catalogue.grade(grade_id).origin == folder


@pytest.mark.slow
def test_the_example_of_every_hook_is_installed_and_loads(site) -> None:
    install(PLUGINS / "every-hook", site)
    (plugin,) = (p for p in find_plugins().loaded if p.name == "every-hook")
    assert plugin.source == "cdpr-designer-every-hook 0.1.0"
    assert {*plugin.hooks} == {*HOOKS} - {"register_grades", "register_effects"}
