"""A diagnosed config is the model that was found: it predicts the same residuals."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import yaml
from twins.dataset import make, size_for
from twins.robots import HALL6, HALL8, YARD3

from designer.diagnosis.case import case_of
from designer.diagnosis.check import check
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.study import diagnosed_config
from designer.io.config import read_study
from designer.io.config.moved import SCHEMA_FILE, with_modeline
from designer.measured.read import read_measured


def diagnosed(folder, robot, effects, unknown, candidates, *, noise=True, declared=None):
    """Diagnose a twin with a few candidates; return the diagnosis and the diagnosed study."""
    path = make(robot, effects, rows=32, seed=5).write(folder)
    config = yaml.safe_load(path.read_text())
    config["measurements"]["unknown"] = list(unknown)
    config["effects"] = declared or {}
    if not noise:
        del config["measurements"]["noise"]
    path.write_text(yaml.safe_dump(config))
    study = read_study(path)
    case = case_of(study, study.measurements, read_measured(study))
    wanted = tuple(
        effect
        for effect in case.candidates
        if effect.id in candidates and effect.cable == candidates[effect.id].get("cable")
    )
    found = diagnose(replace(case, candidates=wanted))
    target = folder / "out" / "config.diagnosed.yaml"
    target.parent.mkdir()
    target.write_text(diagnosed_config(found, target.parent))
    return found, read_study(target)


def drawn(robot, *effects):
    return {effect: robot.draw(effect, size_for(robot, effect, 12.0), 0) for effect in effects}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "effects", "unknown", "noise"),
    [
        (YARD3, ("drum_scale", "pulley_radius"), ("length_offset",), True),
        (YARD3, ("platform_mass",), ("anchors",), True),
        (YARD3, ("tension_gain", "tension_bias"), ("tension_bias",), False),
        (HALL6, ("drum_scale", "centre_of_mass_offset"), ("drum_scale",), True),
        (HALL8, ("drum_scale", "platform_mass"), ("drum_scale",), True),
    ],
    ids=["point", "exit points", "noise estimated", "platform", "redundant"],
)
def test_it_predicts_the_same_residuals(robot, effects, unknown, noise, tmp_path) -> None:
    truth = drawn(robot, *effects)
    found, better = diagnosed(tmp_path, robot, truth, unknown, truth, noise=noise)
    wanted = {s.effect.key for s in (*found.given, *found.settings)}
    assert wanted > {s.effect.key for s in found.given} > set()
    told = check(better, read_measured(better))
    assert {s.effect.key for s in told.declared.settings} == wanted
    scale = np.repeat([found.noise.length_m, found.noise.tension_N], robot.cables)
    off = np.abs(told.declared.residual / scale - found.residual_after)
    assert np.nanmax(off) < 1e-9
    assert told.noise.length_m == found.noise.length_m
    assert told.noise.tension_N == found.noise.tension_N
    assert told.helps


def test_what_is_declared_and_found_acts_in_one_order(tmp_path) -> None:
    """An offset is read through the drum's scale or not: that depends on the order alone."""
    effects = {
        "drum_scale": {"scale": 1.01},
        "length_offset": {f"offset_{k}_m": 0.3 for k in (1, 2, 3)},
    }
    found, _ = diagnosed(
        tmp_path, YARD3, effects, (), {"drum_scale": {}},
        declared={"length_offset": effects["length_offset"]},
    )  # fmt: skip
    assert found.settings[0].values["scale"] == pytest.approx(1.01, rel=1e-5)
    assert found.final.length_m.heldout.value < 1.2 * YARD3.noise_m


def test_it_names_the_files_from_where_it_lies(tmp_path) -> None:
    path = make(YARD3, rows=32).write(tmp_path)
    (tmp_path / "logo.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    more = "document: {logo: logo.svg}\n"
    path.write_text(with_modeline(f"{path.read_text(encoding='utf-8')}\n{more}"), encoding="utf-8")
    (tmp_path / "measured.csv").rename(tmp_path / "new.csv")
    study = read_study(path)
    study = replace(study, measurements=replace(study.measurements, file=tmp_path / "new.csv"))
    case = case_of(study, study.measurements, read_measured(study))
    text = diagnosed_config(diagnose(replace(case, candidates=())), tmp_path / "out")
    assert yaml.safe_load(text)["measurements"]["file"] == "../new.csv"
    assert yaml.safe_load(text)["document"]["logo"] == "../logo.svg"
    assert text.startswith(f"# yaml-language-server: $schema=../{SCHEMA_FILE}\n")


@pytest.mark.parametrize(
    "files", ["[measured.csv, air.csv]", "\n    - measured.csv\n    - air.csv"]
)
def test_it_names_all_files_of_a_log(files, tmp_path) -> None:
    path = make(YARD3, rows=32).write(tmp_path)
    times = [row.split(",")[0] for row in (tmp_path / "measured.csv").read_text().splitlines()]
    assert times[0] == "time_s"
    rows = [f"{time},{k % 7}\n" for k, time in enumerate(times[1:])]
    (tmp_path / "air.csv").write_text("".join(["time_s,humidity\n", *rows]))
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"file: .*", lambda _: f"file: {files}", text), encoding="utf-8")
    study = read_study(path)
    case = case_of(study, study.measurements, read_measured(study))
    assert case.measured.covariates.keys() == {"humidity"}
    target = tmp_path / "out" / "config.diagnosed.yaml"
    target.parent.mkdir()
    target.write_text(diagnosed_config(diagnose(replace(case, candidates=())), target.parent))
    assert [path.resolve() for path in read_study(target).measurements.files] == [
        tmp_path / "measured.csv",
        tmp_path / "air.csv",
    ]


@pytest.mark.slow
def test_what_is_unknown_stays_so_and_is_fitted_again(tmp_path) -> None:
    effects = drawn(YARD3, "pulley_radius", "length_offset")
    _, better = diagnosed(tmp_path, YARD3, effects, ["length_offset"], {"pulley_radius": {}})
    case = case_of(better, better.measurements, read_measured(better))
    assert [e.id for e in case.given] == ["length_offset"]
    assert [s.effect.id for s in case.fixed] == ["pulley_radius"]
