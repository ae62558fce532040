"""The search ends, keeps no effect that does not foretell, finds sets that do better together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from twins.dataset import make, size_for
from twins.effects import predict
from twins.robots import HALL8, YARD3

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose_study
from designer.diagnosis.fit import Fit, StartingPoint, _linear_step, huber
from designer.diagnosis.hold import Outcome
from designer.diagnosis.problem import Predictor, Problem
from designer.diagnosis.search import EffectTrial, LinearModel, Searcher, _best, best_sets
from designer.diagnosis.statistics import heldout_rows
from designer.effects.effect import Effect, Setting
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise


@pytest.fixture
def searcher(tmp_path) -> Searcher:
    effect = {"platform_mass": YARD3.draw("platform_mass", size_for(YARD3, "platform_mass", 10.0))}
    make(YARD3, effect, rows=60).write(tmp_path)
    return searcher_of(tmp_path)


def searcher_of(folder: Path) -> Searcher:
    study = read_study(folder / "config.yaml")
    assert study.measurements is not None
    case = case_of(study, study.measurements, read_measured(study))
    predict = Predictor(case.machine, case.measured)
    problem = Problem(case.measured, predict, Noise(YARD3.noise_m, YARD3.noise_N, "declared"))
    return Searcher(problem, case.candidates, (), ~heldout_rows(case.measured.n_rows))


def test_a_step_of_what_does_nothing_goes_nowhere() -> None:
    residual = np.array([1.0, -0.5, 0.25])
    loss, step = _linear_step(residual, np.zeros((3, 2)))
    assert loss == huber(residual).sum()
    assert (step == 0.0).all()


@pytest.mark.slow
def test_it_finds_and_ends(searcher) -> None:
    steps, _, found = searcher.run()
    assert [effect.id for effect in found] == ["platform_mass"]
    assert [step.added.id if step.added else None for step in steps] == ["platform_mass", None]


@pytest.mark.slow
def test_a_constant_and_a_step_are_found_beside_each_other(tmp_path) -> None:
    size_kg = size_for(YARD3, "platform_mass", 10.0)
    heavy = make(YARD3, {"platform_mass": {"offset_kg": size_kg}}, rows=60)
    heavier = {"platform_mass": {"offset_kg": 2.0 * size_kg}}
    late = (np.arange(60) >= 25)[:, None]
    length_m, tension_N = predict(YARD3, heavier, heavy.scene)
    replace(
        heavy,
        length_m=heavy.length_m + late * (length_m - heavy.clean_length_m),
        tension_N=heavy.tension_N + late * (tension_N - heavy.clean_tension_N),
    ).write(tmp_path)
    both = searcher_of(tmp_path)
    found = {s.effect.id: s.values for s in both.run()[1].settings}
    assert set(found) == {"platform_mass", "load_step"}
    assert found["platform_mass"]["offset_kg"] == pytest.approx(size_kg, rel=0.1)
    assert found["load_step"]["offset_kg"] == pytest.approx(size_kg, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "times_noise",
    [
        {"tension_scale": 40.0, "creep": 8.0},  # as a heavier platform stretches its cables
        {"elastic_modulus": 10.0, "anchor_offset": 10.0},
        {"elastic_modulus": 10.0, "winch_zero": 10.0},
    ],
    ids="-".join,
)
def test_a_pair_is_found_though_others_suit_the_average_of_it(times_noise, tmp_path, monkeypatch):
    effects = {e: YARD3.draw(e, size_for(YARD3, e, n, 173), 173) for e, n in times_noise.items()}
    make(YARD3, effects, rows=60, seed=173).write(tmp_path)
    searcher = searcher_of(tmp_path)
    assert sorted(effect.id for effect in searcher.run()[2]) == sorted(effects)
    monkeypatch.setattr(
        searcher, "_with_better_set", lambda effects, present, _: (effects, present)
    )
    assert sorted(effect.id for effect in searcher.run()[2]) != sorted(effects)


@pytest.mark.slow
def test_it_ends_where_pruning_undoes_what_was_added(searcher, monkeypatch) -> None:
    monkeypatch.setattr(searcher, "_pruned", lambda found: [])
    monkeypatch.setattr(
        searcher, "_with_better_set", lambda effects, present, _: (effects, present)
    )
    steps, _, found = searcher.run()
    assert found == ()
    assert len(steps) == 1


def test_what_does_not_foretell_is_left_out(searcher) -> None:
    by_id = {effect.id: effect for effect in searcher.candidates}
    both = [by_id["platform_mass"], by_id["tension_bias"]]
    kept = searcher._without_useless(both, searcher.fit(both))
    assert [effect.id for effect in kept] == ["platform_mass"]


def test_a_model_that_holds_no_pose_is_worse_than_any_error(searcher) -> None:
    problem = searcher.problem
    away = next(e for e in searcher.candidates if e.key == "anchor_offset of cable 1")
    settings = [Setting(away, {"x_m": 1e4, "y_m": 1e4, "z_m": -1e4})]
    assert np.isnan(problem.predicted(settings).length_m).all()
    residual = problem.residual(settings)
    assert (residual > 5.0 * np.abs(problem.measured.readings) / problem.sigma).all()


def test_a_wave_among_thousands_is_no_better_than_the_zero_of_its_winch(searcher) -> None:
    """By chance the best of 2000 waves takes 20 off the loss in one set of three."""
    by_key = {effect.key: effect for effect in searcher.candidates}

    def trial(key: str, loss: float) -> EffectTrial:
        effect = by_key[key]
        values = {p.name: p.neutral for p in effect.parameters}
        vector = np.array([*values.values()])
        model = Fit((Setting(effect, values),), vector, vector, loss, 500, {key: 1.0})
        return EffectTrial(effect, model, 5000.0, 0.0, heldout_gain=4000.0)

    zero, wave = "winch_zero of cable 1", "drum_eccentricity of cable 1"
    order = searcher.candidates
    (best,) = _best([trial(zero, 500.0), trial(wave, 480.0)], order)
    assert best.effect.key == zero
    best, *_ = _best([trial(zero, 500.0), trial(wave, 300.0)], order)
    assert best.effect.key == wave


@pytest.mark.slow
def test_the_rest_without_a_finding_is_fitted_to_the_end(tmp_path) -> None:
    """Creep from another onset does nearly all that a wrong scale beside it does."""
    names = ("creep", "drum_scale")
    make(YARD3, {e: YARD3.draw(e, size_for(YARD3, e, 10.0)) for e in names}).write(tmp_path)
    search = searcher_of(tmp_path)
    both = [effect for effect in search.candidates if effect.key in names]
    outcome = Outcome(search, search.problem, search.rows, (), search.fit(both), tuple(both))
    lost = outcome.fit_without(both[1])
    assert lost.loss < 1.05 * search.fit(both[:1], anew=True).loss


@pytest.mark.slow
@pytest.mark.parametrize("robot", [YARD3, HALL8], ids=lambda robot: robot.name)
def test_a_force_gives_way_to_a_tilt_and_a_mass_that_do_as_well(tmp_path, robot) -> None:
    """Of the latter the tilt is 8°, which is not plausible, and fits better than any force."""
    names = ("base_tilt", "platform_mass")
    make(robot, {e: robot.draw(e, size_for(robot, e, 10.0)) for e in names}).write(tmp_path)
    search = searcher_of(tmp_path)
    (force,) = (e for e in search.candidates if e.id == "platform_force")
    parted = search._split_into_parts([force], search.fit([force]))
    assert {effect.id for effect in parted} == set(names)
    assert [e.id for e in search._split_into_parts([], search.fit([]))] == []


def test_of_laws_that_are_one_the_one_that_acts_first_is_named(searcher) -> None:
    """A hot rope and hot winches, whichever fit ended a hair lower."""
    by_key = {effect.key: effect for effect in searcher.candidates}
    for losses in ((100.0, 100.1), (100.1, 100.0)):
        trials = [
            EffectTrial(
                by_key[key],
                replace(searcher.fit([]), loss=loss, inflation={key: 1.0}),
                5000.0,
                0.0,
                4000.0,
            )
            for key, loss in zip(("thermal_expansion", "winch_expansion"), losses, strict=True)
        ]
        plausible = [replace(t, fit=replace(t.fit, settings=_at(t.effect))) for t in trials]
        best, *_ = _best(sorted(plausible, key=lambda t: t.fit.loss), searcher.candidates)
        assert best.effect.key == "thermal_expansion"


def _at(effect: Effect) -> tuple[Setting, ...]:
    return (Setting(effect, {"coefficient_per_K": 1e-5}),)


def view(key: str, residual, slopes) -> StartingPoint:
    names = [f"p{k}" for k in range(slopes.shape[1])]
    parameters = tuple(SimpleNamespace(name=name, bounds=(-1e6, 1e6)) for name in names)
    effect = SimpleNamespace(key=key, parameters=parameters)
    return StartingPoint(Setting(effect, dict.fromkeys(names, 0.5)), residual, slopes)


def test_what_a_set_leaves_is_that_of_weighted_least_squares() -> None:
    rng = np.random.default_rng(71)
    residual, weight, known = (
        rng.normal(size=40),
        rng.uniform(0.2, 1.0, 40),
        rng.normal(size=(40, 2)),
    )
    views = [
        view(str(p), residual + rng.normal(size=40), rng.normal(size=(40, p))) for p in (1, 3, 2)
    ]
    model = LinearModel(views, residual, known, weight)
    root = np.sqrt(weight)
    start = views[0].residual + views[1].residual - residual
    columns = np.hstack([views[0].slopes, views[1].slopes, known]) * root[:, None]
    step, (left,), *_ = np.linalg.lstsq(columns, -root * start, rcond=None)
    assert model.step((0, 1))[0] == pytest.approx(left, rel=1e-6)
    reached = [value for s in model.settings((0, 1)) for value in s.values.values()]
    assert reached == pytest.approx(0.5 + step[:4], abs=1e-6)


def test_a_pair_is_best_though_another_is_better_than_each_of_it() -> None:
    rng = np.random.default_rng(72)
    first, second, between, *others = np.linalg.qr(rng.normal(size=(60, 9)))[0].T
    residual = 30.0 * (first + second)
    columns = {"first": first, "second": second, "average": first + second + 0.5 * between}
    columns |= {f"other {k}": column for k, column in enumerate(others)}
    views = [view(key, residual, column[:, None]) for key, column in columns.items()]
    model = LinearModel(views, residual, np.empty((60, 0)), np.ones(60))

    def best_beside(*present: str) -> list[set[str]]:
        own = [v.setting.effect for v in views if v.setting.effect.key in present]
        sets = best_sets(model, lambda _: 2.0, own, 2, 4)
        return [{setting.effect.key for setting in together} for together in sets]

    assert best_beside("average")[0] == {"first", "second"}
    assert {"first", "second"} not in best_beside("first", "second")
    assert best_beside()[0] == {"first", "second"}
    assert {"average"} not in best_beside()  # which adds one to none


TOGETHER = "anchor_offset of cable 1 and anchor_offset of cable 3"
TWO_LENGTHS_OFF = {"offset_1_m": 0.08, "offset_2_m": 0.0, "offset_3_m": -0.06}
WITHIN_A_METRE = ((14.0, 15.0), (9.5, 10.5), (4.5, 5.5))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("box_m", "is_told"), [(WITHIN_A_METRE, False), (YARD3.box_m, True)], ids=["near", "all over"]
)
def test_two_exit_points_are_told_from_offsets_of_lengths_by_poses_all_over(
    box_m, is_told, tmp_path
) -> None:
    robot = replace(YARD3, box_m=box_m)
    make(robot, {"length_offset": TWO_LENGTHS_OFF}, rows=60, seed=31).write(tmp_path)
    study = read_study(tmp_path / "config.yaml")
    diagnosis = diagnose_study(study, read_measured(study))
    (finding,) = diagnosis.findings
    assert finding.effect.id == "length_offset"
    assert (TOGETHER not in finding.rivals) is is_told
    assert not any("winch_scale" in rival for rival in finding.rivals)  # which has offsets as well
    told_apart = {proposal.rival for proposal in diagnosis.proposals}
    assert told_apart <= set(finding.rivals)
