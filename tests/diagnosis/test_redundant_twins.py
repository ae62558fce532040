"""Machines with cables to spare: winches under force control, whose law the model does not know."""

from __future__ import annotations

from dataclasses import replace

import pytest
from twins.dataset import make, size_for
from twins.robots import HALL8

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.problem import Predictor
from designer.diagnosis.result import Diagnosis
from designer.effects.effect import Setting
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise

pytestmark = pytest.mark.slow


def diagnosed(effects, folder, quantities=("length", "tension"), cables=()) -> Diagnosis:
    """Diagnose a twin; with ``cables``, effects of single cables are tried on these alone."""
    make(HALL8, effects, rows=60, seed=1).write(folder, quantities)
    study = read_study(folder / "config.yaml")
    case = case_of(study, study.measurements, read_measured(study))
    some = tuple(e for e in case.candidates if not cables or e.cable in (None, *cables))
    return diagnose(replace(case, candidates=some))


def test_the_law_of_the_winches_is_no_finding(tmp_path) -> None:
    found = diagnosed({}, tmp_path)
    assert found.findings == ()
    assert not found.is_unexplained
    # Two of sixteen readings of a row went into its internal forces, so that less noise is left.
    assert found.final.tension_N.heldout.value < 1.1 * HALL8.noise_N
    assert found.final.length_m.heldout.value < 1.1 * HALL8.noise_m


def test_forces_read_from_lengths_alone_make_no_structure(tmp_path) -> None:
    found = diagnosed({}, tmp_path, quantities=("length",))
    assert found.findings == ()
    assert not found.is_unexplained


@pytest.mark.parametrize("effect", ["elastic_modulus", "tension_gain"])
def test_an_effect_is_found_first_with_its_size(effect, tmp_path) -> None:
    truth = HALL8.draw(effect, size_for(HALL8, effect, 10.0), 0)
    found = diagnosed({effect: truth}, tmp_path, cables=(truth.get("cable", 1), 5, 8))
    assert [finding.effect.id for finding in found.findings] == [effect]
    assert found.findings[0].effect.cable == truth.get("cable")
    for name, estimate in found.findings[0].parameters.items():
        assert abs(estimate.value - truth[name]) < 4.0 * estimate.std
    seen_in = "position_m" if effect == "elastic_modulus" else "tension_N"
    before, after = found.foretold_before, found.foretold_after
    assert getattr(after, seen_in).value < 0.6 * getattr(before, seen_in).value


def test_what_sensors_add_is_taken_off_before_forces_are_read(tmp_path) -> None:
    """Noise-free readings of the true model leave nothing, whatever the sensors add."""
    effects = {
        "tension_gain": {"cable": 3.0, "gain": 1.15},
        "length_offset": {f"offset_{k}_m": 0.002 * k for k in range(1, 9)},
        "bending_stiffness": {"flexural_rigidity_N_m2": 2.0},
    }
    make(HALL8, effects, rows=40, seed=2, noise=0.0).write(tmp_path)
    study = read_study(tmp_path / "config.yaml")
    measured = read_measured(study)
    case = case_of(study, study.measurements, measured)
    kinds = {e.key: e for e in case.candidates}
    settings = [
        Setting(kinds["bending_stiffness"], effects["bending_stiffness"]),
        Setting(kinds["length_offset"], effects["length_offset"]),
        Setting(kinds["tension_gain of cable 3"], {"gain": 1.15}),
    ]
    noise = Noise(HALL8.noise_m, HALL8.noise_N, "declared")
    shown = Predictor(case.machine, measured)(settings, noise)
    assert abs(shown.length_m - measured.length_m).max() < 5e-6
    assert abs(shown.tension_N - measured.tension_N).max() < 0.05
