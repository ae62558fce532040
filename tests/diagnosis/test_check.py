"""`designer diagnose --check`: the declared model on data, nothing searched, nothing fitted."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from twins.dataset import make
from twins.robots import YARD3

from designer.arrays import frozen_array
from designer.cli.commands import main
from designer.diagnosis.check import Check, check
from designer.io.config import read_study
from designer.measured import rows
from designer.measured.read import read_measured

HEAVIER = {"platform_mass": {"offset_kg": 8.0}}


@pytest.fixture
def config(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return make(YARD3, HEAVIER, rows=48, seed=3).write(tmp_path)


def declare(config: Path, effects: dict, **measurements: object) -> Path:
    document = yaml.safe_load(config.read_text())
    document["effects"] = effects
    document["measurements"].update(measurements)
    config.write_text(yaml.safe_dump(document))
    return config


def checked(config: Path) -> Check:
    study = read_study(config)
    return check(study, read_measured(study))


def run(monkeypatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["designer", "diagnose", "--no-plugins", *arguments])
    try:
        main()
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


def test_it_tells_both_models_and_writes_page_and_numbers(config, monkeypatch, capsys) -> None:
    declare(config, HEAVIER)
    config.with_name("measured.csv").rename("new.csv")
    assert run(monkeypatch, "--check", str(config), "--data", "new.csv") == 0
    assert "with the effects, nothing fitted" in capsys.readouterr().out
    written = sorted(path.name for path in Path("config-check").iterdir())
    assert written == ["check.html", "check.pdf", "diagnosis.json"]
    page = Path("config-check/check.html").read_text(encoding="utf-8")
    assert "The declared model stands" in page
    assert "platform_mass" in page
    answer = json.loads(Path("config-check/diagnosis.json").read_text())
    tension = answer["check"]["tension_N"]
    assert tension["with"]["rms"] < 1.15 * YARD3.noise_N < 3.0 * YARD3.noise_N
    assert tension["without"]["rms"] > 3.0 * tension["with"]["rms"]
    assert tension["with"]["median"] < tension["with"]["rms"]
    assert answer["check"]["stands"] is True
    assert answer["effects"] == HEAVIER
    assert answer["rows"]["compared"] == 48
    assert len(answer["provenance"]["data_sha256"]) == 64


def test_effects_that_make_it_worse_are_a_negative_answer(config, monkeypatch, capsys) -> None:
    declare(config, {"platform_mass": {"offset_kg": -8.0}})
    assert run(monkeypatch, "--check", str(config)) == 1
    assert "The declared effects do not help on these data." in capsys.readouterr().out


def test_data_that_are_not_there(config, monkeypatch, capsys) -> None:
    assert run(monkeypatch, "--check", str(config), "--data", "none.csv") == 2
    assert capsys.readouterr().err == "--data: there is no file none.csv (expected a CSV file)\n"
    assert not Path("config-check").exists()


def test_one_wild_reading_is_counted_and_named(config) -> None:
    study = read_study(declare(config, HEAVIER))
    measured = read_measured(study)
    tension = np.array(measured.tension_N)
    tension[7, 1] += 50.0 * YARD3.noise_N
    wild = replace(measured, tension_N=frozen_array(tension))
    clean, spoilt = (check(study, m) for m in (measured, wild))
    assert spoilt.declared.tension_N.rms.value > 3.0 * clean.declared.tension_N.rms.value
    assert spoilt.declared.tension_N.median < 1.1 * clean.declared.tension_N.median
    assert [(one.row, one.channel) for one in spoilt.outliers] == [(8, "tension 2")]


def test_the_model_without_effects_gets_its_unknowns_fitted(config) -> None:
    """What nobody knows must not make the declared effects look good."""
    offsets = {f"offset_{k}_m": 0.5 for k in (1, 2, 3)}
    declare(config, {"length_offset": offsets}, unknown=["length_offset"])
    told = checked(config)
    assert told.declared.length_m.rms.value > 0.4
    assert told.fitted.length_m.rms.value < 0.1
    assert not told.helps
    assert not told.is_positive


def test_what_cannot_act_is_told(config) -> None:
    clock = {"clock_offset": {"offset_s": 1.0}}
    told = checked(declare(config, {**HEAVIER, **clock}))
    assert [key for key, _ in told.idle] == ["clock_offset"]
    assert [s.effect.id for s in told.declared.settings] == ["platform_mass"]


def test_terminal_page_and_numbers_say_that_a_long_log_was_thinned(
    config, monkeypatch, capsys
) -> None:
    declare(config, HEAVIER)
    monkeypatch.setattr(rows, "MOST_ROWS", 24)
    monkeypatch.setattr(rows, "_RUN", 4)
    assert run(monkeypatch, "--check", str(config)) == 0
    told = "24 of 48 rows are used, 4 rows of each 8"
    assert told in " ".join(capsys.readouterr().out.split())
    assert told in Path("config-check/check.html").read_text(encoding="utf-8")
    numbers = json.loads(Path("config-check/diagnosis.json").read_text(encoding="utf-8"))
    assert told in numbers["rows"]["notes"][0]
    assert numbers["rows"]["all"] == 24


def test_where_no_pdf_can_be_made_the_page_comes_alone_and_says_so(
    config, monkeypatch, capsys
) -> None:
    """As on Linux for arm64, for which PlutoPrint has no wheel."""
    monkeypatch.setitem(sys.modules, "plutoprint", None)
    declare(config, HEAVIER)
    assert run(monkeypatch, "--check", str(config)) == 0
    written = sorted(path.name for path in Path("config-check").iterdir())
    assert written == ["check.html", "diagnosis.json"]
    assert "The PDF is left out" in capsys.readouterr().out
    page = Path("config-check/check.html").read_text(encoding="utf-8")
    assert "The PDF is left out" in page
    assert "plutoprint" not in page
