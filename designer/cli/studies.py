"""From the file that a command names to a study and its catalogue, with what was left out told."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from designer.grades.registry import Catalogue
    from designer.plugins.find import Plugins
    from designer.study import Study


def study_of(config: Path, plugins: Plugins) -> Study:
    """Read a study; names the plugins' effects that could not be used."""
    from designer.cli.terminal import print_left_out
    from designer.effects.load import load_effects
    from designer.io.config import read_study

    effects = load_effects(plugins)
    print_left_out(effects.problems)
    return read_study(config, effects, plugins)


def catalogue_of(study: Study, plugins: Plugins) -> Catalogue:
    """Load all grades; names those that could not be used, and knows those that a study names."""
    from designer.cli.terminal import print_left_out
    from designer.grades.registry import load_catalogue

    catalogue = load_catalogue(study.catalogues, plugins=plugins)
    problems = study.known_effects.problems
    print_left_out(problem for problem in catalogue.problems if problem not in problems)
    catalogue.require_grades_of(study)
    return catalogue
