"""Every option of a study with every other, four at a time: as the reference has it, or told."""

from __future__ import annotations

from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from pairs.covering import covering_sets
from pairs.options import BY_ID, OPTIONS, base_of, study_of
from pairs.table import (
    COMPUTED,
    NOT_COVERED,
    REFUSED,
    analysed,
    outcome_of,
    read_table,
    wrong_with,
)

from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.render import rendered

TABLE = read_table()
PAIRS = list(combinations(OPTIONS, 2))
SETS = covering_sets(TABLE)
QUICK = (
    ("wrench", "case_mass", "dynamic_factor", "case_factor"),
    ("case_mass", "wind_along", "ice", "platform_mass"),
    ("case_wrench", "case_region", "base_tilt", "gravity"),
    ("pulleys", "elastic_modulus"),
    ("anchor_offset", "linear_mass"),
    ("case_fitting", "fibre", "exclude", "drum"),
    ("floor", "excitation", "sheave", "fitting"),
    ("pulleys", "platform_frequency", "duty_class", "winch_tension"),
    ("cable_lost", "winch_tension_each"),
    ("wrench_box", "dynamic_factor", "ice", "attached_each"),
    ("wrench_list", "platform_mass", "sheave_losses", "motor"),
    ("case_mass", "winch_tension", "winch_positions", "poses_of_case"),
    ("fitting", "rope_life"),
)
"""Sets on the robot of three cables, which is quick, of as many options as there are."""


def test_table_has_every_pair() -> None:
    assert list(TABLE) == [(first.id, second.id) for first, second in PAIRS]
    assert Counter(one.kind for one in TABLE.values())[COMPUTED] > 920


def test_what_is_not_computed_has_a_reason() -> None:
    for pair, one in TABLE.items():
        assert bool(one.why) == (one.kind in (REFUSED, NOT_COVERED)), pair
        assert "\n" not in one.why


def test_table_is_what_studies_are_read_as(tmp_path: Path) -> None:
    some = np.random.default_rng(0).choice(len(PAIRS), 25, replace=False)
    refused = [k for k, pair in enumerate(TABLE) if TABLE[pair].kind == REFUSED]
    for first, second in (PAIRS[k] for k in (*some, *refused)):
        assert outcome_of((first, second), tmp_path) == TABLE[first.id, second.id]


def test_effect_on_readings_is_told_as_not_covered(tmp_path: Path) -> None:
    analysis = analysed(study_of("crane", BY_ID["reading_effect"], BY_ID["pulleys"]), tmp_path)
    page = rendered(section(Drawings(analysis), "answer")).body
    declared, idle = (
        page.partition(title)[2].partition("</p>")[0]
        for title in ("Declared effects.", "Effects not covered.")
    )
    assert "drum_scale" in idle
    assert "pulley_radius" in declared
    assert "drum_scale" not in declared


@pytest.mark.parametrize("names", QUICK, ids="-".join)
def test_quick_set_matches_reference(names: tuple[str, ...], tmp_path: Path) -> None:
    assert list(wrong_with([BY_ID[name] for name in names], tmp_path)) == []


def test_sets_have_every_pair_on_its_own_robot() -> None:
    of_sets = set()
    for names in SETS:
        options = [BY_ID[name] for name in names]
        pairs = combinations(options, 2)
        of_sets |= {(a.id, b.id) for a, b in pairs if base_of(a, b) == base_of(*options)}
    read = {pair for pair, one in TABLE.items() if one.kind in (COMPUTED, NOT_COVERED)}
    assert of_sets == read


@pytest.mark.slow
@pytest.mark.parametrize("names", SETS, ids="-".join)
def test_every_pair_matches_reference(names: tuple[str, ...], tmp_path: Path) -> None:
    assert list(wrong_with([BY_ID[name] for name in names], tmp_path)) == []
