"""What the window shows is what the commands print and the report says; and two states compared."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designer.analysis.analyse import Analysis, analyse
from designer.analysis.pose import analyse_pose
from designer.cli.commands import main
from designer.explore.answers import (
    Pin,
    compare,
    full_ropes,
    map_answer,
    pose_answer,
    quick_ropes,
    ropes_of,
    unserved,
    values_at,
    worst_answer,
)
from designer.explore.export import rope_table
from designer.explore.quantities import CHEAP, QUANTITIES, category_labels
from designer.explore.question import Question, Rope, RopePerCable
from designer.explore.session import Session
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.plugins import Plugins
from designer.proof.prove import WITHIN
from designer.sizing.newton import size_poses
from designer.statics import modes
from designer.statics.inverse import solve_sagging
from designer.statics.modes import platform_modes

WIRE = "unirope-7x19-galvanised"
ALL = CHEAP | {"stiffness", "frequency", "unserved"}


def question_of(session: Session) -> Question:
    question = session.question()
    assert question is not None
    return question


@pytest.fixture
def edited(yard: Session) -> Question:
    """The yard crane with another load, region and pose, on fewer samples."""
    yard.edit("robot.platform.mass", "260 kg")
    yard.edit("workspace.region.inset", "4 m")
    yard.edit("workspace.samples", "900")
    yard.edit("pose.position[2]", "7.5 m")
    return question_of(yard)


@pytest.mark.parametrize("name", ["yard", "stadium", "ipanema", "robocrane"])
def test_the_pose_is_that_of_size(name: str, example: Any) -> None:
    session: Session = example(name)
    session.edit("robot.platform.mass", "33 kg")
    found, pose = (
        pose_answer(question_of(session), settled=True),
        analyse_pose(question_of(session).study),
    )
    assert pose is not None
    statics = pose.sizing.statics
    assert found.is_solved
    assert found.diameter_m == float(pose.sizing.diameter_m)
    assert found.max_tension_N == float(statics.largest_tension_N)
    assert [one.length_m for one in found.cables] == statics.length_m.tolist()
    assert [one.exit_tension_N for one in found.cables] == statics.exit_tension_N.tolist()
    assert [one.platform_tension_N for one in found.cables] == statics.platform_tension_N.tolist()
    assert found.utilisation == pytest.approx(1.0)
    assert pose.rest is not None
    assert (found.is_stable, found.stability) == (pose.rest.is_stable, pose.rest.sentence)


@pytest.mark.parametrize("name", ["stadium", "ipanema"])
def test_the_command_prints_what_the_window_shows(
    name: str, example: Any, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    session: Session = example(name)
    session.edit("robot.platform.mass", "31 kg")
    session.move(session.state.place + np.array([0.1, -0.05, 0.02, 0.0, 0.0, 0.0]))
    session.keep_pose()
    session.save_as(tmp_path / "mine.yaml")
    command = ["designer", "size", "--json", "--no-plugins", str(tmp_path / "mine.yaml")]
    monkeypatch.setattr("sys.argv", command)
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    printed = json.loads(capsys.readouterr().out)["pose"]["sagging"]
    found = pose_answer(question_of(session))
    assert printed["diameter_m"] == found.diameter_m
    assert printed["lengths_m"] == [one.length_m for one in found.cables]
    assert printed["tensions_N"] == [one.exit_tension_N for one in found.cables]


def test_a_place_beside_the_pose_is_as_if_it_were_the_pose(yard: Session) -> None:
    yard.move([14.0, 10.0, 3.0])
    found = pose_answer(question_of(yard))
    study = replace(question_of(yard).study, pose=Poses.at([14.0, 10.0, 3.0]))
    pose = analyse_pose(study)
    assert pose is not None
    assert found.diameter_m == float(pose.sizing.diameter_m)
    yard.keep_pose()
    assert pose_answer(question_of(yard)).diameter_m == found.diameter_m


@pytest.mark.slow
def test_the_map_has_the_values_of_the_report(edited: Question) -> None:
    analysis = analyse(edited.study, edited.catalogue)
    assert analysis.workspace is not None
    assert edited.workspace is not None
    samples = analysis.workspace.to_xarray()
    found = values_at(edited, edited.workspace, samples["position"].to_numpy(), ALL)
    assert np.array_equal(found["diameter"], samples["diameter"])
    assert np.array_equal(found["tension"], samples["max_tension"])
    assert np.array_equal(found["verdict"], samples["verdict"])
    tensions = samples["exit_tension"].to_numpy()
    assert np.array_equal(found["governing"], tensions.argmax(axis=1) + 1)


@pytest.mark.slow
def test_worst_pose_and_ropes_are_those_of_the_report(edited: Question) -> None:
    analysis = analyse(edited.study, edited.catalogue)
    worst = worst_answer(edited)
    assert worst is not None
    assert analysis.workspace is not None
    assert analysis.workspace.sagging is not None
    assert worst.workspace.sagging is not None
    assert worst.workspace.sagging.diameter_m == analysis.workspace.sagging.diameter_m
    assert np.array_equal(worst.place, analysis.workspace.sagging.place)
    assert worst.workspace.census == analysis.workspace.census
    ropes = full_ropes(edited)
    assert ropes is not None
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    rows = {row.rope: row for row in ropes.rows}
    for one in analysis.selection.candidates:
        row = rows[Rope(one.grade.id, one.size.id)]
        assert (row.standing, row.reason) == (one.standing, one.reason)
        assert row.verification.utilisation == one.verification.utilisation
        assert row.figures.mass_kg == one.total_mass_kg
    chosen = analysis.selection.chosen
    assert ropes.best == Rope(chosen.grade.id, chosen.size.id)
    with_rope = worst_answer(replace_rope(edited, ropes.best))
    assert with_rope is not None
    assert with_rope.rope is not None
    assert with_rope.rope.utilisation == pytest.approx(chosen.verification.utilisation, rel=1e-9)
    assert np.allclose(with_rope.place[:3], chosen.verification.worst_place, atol=1e-3)


def replace_rope(question: Question, rope: Rope | None) -> Question:
    return Question(
        question.study, question.place, rope, question.text, question.path, question.plugins
    )


@pytest.mark.slow
def test_quick_ropes_hold_no_less_than_the_full_selection(edited: Question) -> None:
    quick, full = quick_ropes(edited), full_ropes(edited)
    assert quick is not None
    assert full is not None
    assert not quick.is_final
    for row in quick.rows:
        whole = full.row(row.rope)
        assert whole is not None
        sampled, searched = row.verification.utilisation, whole.verification.utilisation
        assert sampled <= searched * (1.0 + 1e-9) or not row.holds
    assert quick.best == full.best


@pytest.mark.slow
def test_the_best_rope_is_proved_as_in_the_report(yard: Session) -> None:
    yard.edit("robot.platform.mass", "260 kg")
    yard.edit("workspace.samples", "200")
    yard.edit("workspace.proof", "60 s")
    question = question_of(yard)
    quick, full = quick_ropes(question), full_ropes(question)
    analysis = Analysis.begin(question.study, question.catalogue)
    assert quick is not None
    assert quick.proof is None
    assert full is not None
    assert full.proof is not None
    assert analysis.selection is not None
    assert analysis.selection.proof is not None
    ours, theirs = full.proof, analysis.selection.proof
    assert ours.status == theirs.status == "proved"
    assert ours.found == theirs.found <= ours.bound <= 1.0
    assert ours.bound == pytest.approx(theirs.bound, rel=WITHIN)  # batches depend on the machine
    best = full.row(full.best)
    assert best is not None
    assert best.verification.utilisation == ours.found


def test_a_rope_that_is_too_thick_for_the_sheave_does_not_count_as_holding(yard: Session) -> None:
    yard.edit("workspace.samples", "100")
    yard.edit("selection.sheave_diameter", "90 mm")
    quick = quick_ropes(question_of(yard))
    assert quick is not None
    rejected = [row for row in quick.rows if row.standing == "rejected"]
    assert rejected
    assert all(row.verification.holds and not row.holds for row in rejected)
    assert {row.reason.split()[0] for row in rejected} == {"sheave"}
    best = quick.row(quick.best)
    assert best is None or best.holds


@pytest.mark.slow
def test_what_falls_out_is_there_with_its_reason(yard: Session) -> None:
    yard.edit("selection.sheave_diameter", "5 mm")
    yard.edit("workspace.samples", "100")
    ropes = full_ropes(question_of(yard))
    assert ropes is not None
    gone = [row for row in ropes.rows if row.standing == "not_tried"]
    assert gone
    assert all("sheave" in row.reason for row in gone)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("name", "grids"),
    [
        ("yard", {"top", "bottom", "wall", "slice"}),
        ("stadium", {"top", "bottom", "wall", "slice"}),
        ("ipanema", {"top", "bottom", "wall", "slice"}),
    ],
)
def test_every_value_of_the_map_with_a_rope_is_that_of_its_pose(
    name: str, grids: set[str], example: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Else the map, which takes many poses together, and one pose differ in their elements.
    monkeypatch.setattr(modes, "_MOST", modes._FEWEST)
    session: Session = example(name)
    session.choose(Rope(WIRE, "5/32 in"))
    found = map_answer(question_of(session), quantities=CHEAP | {"stiffness", "frequency"})
    robot = question_of(session).robot
    rng = np.random.default_rng(3)
    assert grids == set(found.grids)
    for part, grid in found.grids.items():
        i, j = (int(rng.integers(n)) for n in grid.shape[:2])
        session.move(grid[i, j])
        one, values = (
            pose_answer(question_of(session)),
            {key: found.on(part, key) for key in found.values},
        )
        assert one.utilisation == pytest.approx(values["utilisation"][i, j], rel=1e-9)
        assert one.max_tension_N == pytest.approx(values["tension"][i, j], rel=1e-9)
        assert one.diameter_m == pytest.approx(values["diameter"][i, j], rel=1e-9)
        assert one.stiffness_N_per_m == pytest.approx(values["stiffness"][i, j], rel=1e-6)
        lowest_Hz = values["frequency"][i, j]
        if robot.is_point_mass:
            cable = question_of(session).cable
            alone = solve_sagging(robot, question_of(session).pose, cable)
            lowest = platform_modes(alone, robot.platform, cable.linear_density_kg_per_m)[0]
            assert lowest_Hz == pytest.approx(lowest.frequency_Hz, rel=1e-6)
            without_cables = np.sqrt(one.stiffness_N_per_m / robot.platform.mass_kg) / (2.0 * np.pi)
            assert 0.0 < lowest_Hz <= without_cables * (1.0 + 1e-9)
        else:
            assert np.isnan(lowest_Hz)  # its inertia is not given
        sag = max(cable.sag_m / cable.chord_m for cable in one.cables)
        assert sag == pytest.approx(values["sag"][i, j], rel=1e-6)
        used = [cable.utilisation for cable in one.cables]
        assert used[int(values["governing"][i, j]) - 1] == pytest.approx(max(used), rel=1e-9)


def test_without_a_rope_the_frequency_is_that_of_the_thinnest_cable(yard: Session) -> None:
    question = question_of(yard)
    found = map_answer(question, quantities=CHEAP | {"frequency"})
    grid, lowest_Hz = found.grids["slice"], found.on("slice", "frequency")
    sizing = size_poses(question.robot, Poses.at(grid[3, 5, :3]), question.material)
    assert sizing.diameter_m == pytest.approx(found.on("slice", "diameter")[3, 5], rel=1e-9)
    density = question.material.cable(float(sizing.diameter_m)).linear_density_kg_per_m
    lowest = platform_modes(sizing.statics, question.robot.platform, density)[0]
    assert lowest_Hz[3, 5] == pytest.approx(lowest.frequency_Hz, rel=1e-6)


@pytest.mark.slow
def test_the_coarse_map_is_every_second_point_of_the_fine_one(example: Any) -> None:
    for name in ("facade", "stadium"):
        question = question_of(example(name))
        coarse, fine = (map_answer(question, fine=is_fine) for is_fine in (False, True))
        assert coarse.grids.keys() == fine.grids.keys()
        for grid in coarse.grids:
            assert coarse.grids[grid].size < fine.grids[grid].size
            assert np.array_equal(coarse.grids[grid][0, 0], fine.grids[grid][0, 0])
            assert coarse.on(grid, "tension")[0, 0] == fine.on(grid, "tension")[0, 0]
            assert np.array_equal(coarse.grids[grid][-1, -1], fine.grids[grid][-1, -1])


def test_only_what_is_asked_for(yard: Session) -> None:
    found = map_answer(question_of(yard), slice_share=1.0)
    assert np.allclose(found.grids["slice"][..., 2], 8.5)
    assert "stiffness" not in found.values
    assert {one.key for one in QUANTITIES} - {"stiffness", "frequency"} <= set(found.values)


@pytest.mark.slow
def test_ropes_for_groups_of_cables(yard: Session) -> None:
    yard.set_text(
        yard.text.replace("samples: 20000", "samples: 100")
        + "  groups: {high: [1, 2], low: [3]}\n  max_distinct_products: 2\n"
    )
    question = question_of(yard)
    analysis, ropes = analyse(question.study, question.catalogue), full_ropes(question)
    assert ropes is not None
    assert analysis.groups is not None
    assert analysis.assignment.has_groups
    assert ropes.groups is not None
    assert [group.cables for group in ropes.groups.groups] == [(1, 2), (3,)]
    products = [Rope(one.grade.id, one.size.id) for one in analysis.assignment.by_cable]
    assert ropes.assignment == RopePerCable(tuple(products))
    assert ropes.groups.chosen.total_mass_kg == analysis.assignment.total_mass_kg
    assert ropes.groups.proof_sentence == analysis.groups.proof_sentence
    yard.choose(ropes.assignment)
    worst = worst_answer(question_of(yard))
    assert worst is not None
    assert worst.rope is not None
    met = analysis.assignment.verification
    assert worst.rope.utilisation == pytest.approx(met.utilisation.max(), rel=1e-6)
    chart, one = map_answer(question_of(yard)), pose_answer(question_of(yard))
    assert chart.values["utilisation"].max() <= met.utilisation.max() * (1.0 + 1e-9)
    assert one.utilisation == max(cable.utilisation for cable in one.cables)


def test_what_no_rope_serves(yard: Session) -> None:
    yard.edit("robot.platform.mass", "1500 kg")
    question = question_of(yard)
    assert question.workspace is not None
    some = question.workspace.thinned(60)
    least = np.full(len(some), np.inf)
    for one in question.candidates:
        statics = solve_sagging(question.robot, Poses.at(some), one.cable)
        used = statics.largest_tension_N / one.cable.allowable_tension_N
        least = np.fmin(least, used)
    found = unserved(question, question.workspace, some)
    assert np.array_equal(found, ~(least <= 1.0))
    assert 0 < found.sum() < len(some)


def test_a_load_that_nothing_bears_is_an_answer_too(yard: Session) -> None:
    yard.edit("workspace.region.z[1]", "60 m")  # above the masts
    yard.edit("workspace.samples", "300")
    yard.move([15.0, 9.0, 40.0])
    question = question_of(yard)
    found = pose_answer(question)
    assert found.verdict is Verdict.OUTSIDE_HULL
    assert (found.cables, found.curves_m, found.is_stable) == ((), None, None)
    assert np.isnan(found.diameter_m)
    assert found.chords_m.shape == (3, 2, 3)
    chart = map_answer(question, quantities=ALL)
    assert chart.values["unserved"].max() == 1.0
    assert np.isnan(chart.values["diameter"]).any()
    worst = worst_answer(question)
    assert worst is not None
    assert "No cable" in worst.sentence
    ropes = quick_ropes(question)
    assert ropes is not None
    assert (ropes.best, ropes.reason) == (None, "none holds at the samples")


def test_shapes_of_cables(yard: Session) -> None:
    yard.choose(Rope(WIRE, "3/8 in"))
    found = pose_answer(question_of(yard))
    assert found.curves_m is not None
    for one, curve, chord in zip(found.cables, found.curves_m, found.chords_m, strict=True):
        line = (chord[1] - chord[0]) / np.linalg.norm(chord[1] - chord[0])
        off = (curve - chord[0]) - np.outer((curve - chord[0]) @ line, line)
        assert one.sag_m == pytest.approx(np.linalg.norm(off, axis=1).max(), rel=1e-3)
        along = np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
        assert one.length_m + one.stretch_m == pytest.approx(along, rel=1e-6)
        first = curve[1] - curve[0]
        assert one.angle_rad == pytest.approx(
            np.arctan2(-first[2], np.hypot(first[0], first[1])), abs=1e-3
        )
    shown = found.curves_exaggerated_m(10.0)
    assert shown is not None
    assert np.allclose(shown[:, [0, -1]], found.curves_m[:, [0, -1]])
    same = found.curves_exaggerated_m(1.0)
    assert same is not None
    assert np.allclose(same, found.curves_m)


def test_a_rope_that_is_too_weak_here_is_told(yard: Session) -> None:
    yard.edit("robot.platform.mass", "2 t")
    yard.choose(Rope(WIRE, "5/32 in"))
    found = pose_answer(question_of(yard))
    assert found.utilisation > 1.0
    assert "too weak here" in found.sentence


def test_outside_the_region_is_told(yard: Session) -> None:
    yard.move([15.0, 9.0, 0.5])
    assert pose_answer(question_of(yard)).outside == "This pose lies outside the region."
    yard.move([15.0, 9.0, 5.0])
    assert pose_answer(question_of(yard)).outside == ""


@pytest.mark.slow
def test_effects_act_as_in_the_report(tmp_path: Path, no_plugins: Plugins, yard: Session) -> None:
    study = tmp_path / "study.yaml"
    text = yard.text.replace("samples: 20000", "samples: 60")
    effects = "effects:\n  pulley_radius: {radius_m: 90 mm}\n  linear_mass: {scale: 1.3}\n"
    study.write_text(text + effects, encoding="utf-8")
    question = question_of(Session.open(study, no_plugins))
    pose = analyse_pose(question.study)
    assert pose is not None
    found = pose_answer(question)
    assert found.diameter_m == float(pose.sizing.diameter_m)
    assert found.cables[0].length_m == float(pose.sizing.statics.length_m[0])
    analysis = analyse(question.study, question.catalogue)
    assert analysis.selection is not None
    ropes = full_ropes(question)
    assert ropes is not None
    assert rope_table(ropes) == rope_table(ropes_of(analysis.selection))


def test_words_for_every_category() -> None:
    assert category_labels("governing", 3) == {1: "cable 1", 2: "cable 2", 3: "cable 3"}
    assert set(category_labels("verdict", 3)) == {int(one) for one in Verdict}


def pin_of(session: Session, **how: Any) -> Pin:
    question = session.question()
    assert question is not None
    parts = {"worst": worst_answer(question), "ropes": quick_ropes(question)} | how
    return Pin(question, session.fields(), pose=pose_answer(question), **parts)


@pytest.fixture
def few(yard: Session) -> Session:
    yard.edit("workspace.samples", "200")
    return yard


@pytest.mark.slow
def test_nothing_differs_from_itself(few: Session) -> None:
    pin = pin_of(few)
    found = compare(pin, pin_of(few))
    assert (found.changes, found.gained, found.lost) == ((), (), ())
    assert all(line.difference == 0.0 for line in found.figures)
    assert found.is_like_with_like


@pytest.mark.slow
def test_a_heavier_load(few: Session) -> None:
    few.choose(Rope(WIRE, "7/32 in"))
    before = pin_of(few)
    few.edit("robot.platform.mass", "0.4 t")
    after = pin_of(few)
    found = compare(before, after)
    changed = {one.title: (one.before, one.after) for one in found.changes}
    assert changed["Platform with payload"] == ("180 kg", "0.4 t")
    assert changed["Best rope"][0] == f"7/32 in of {WIRE}"
    lines = {one.title: one for one in found.figures}
    worse = ["Diameter needed here", "Utilisation at worst", "Diameter needed at worst"]
    assert all(lines[title].difference > 0.0 for title in worse)
    assert "Mass of all cables, best rope" in lines
    in_unit = {
        "Diameter needed here": ("diameter_m", 1e3),
        "Largest tension here": ("max_tension_N", 1e-3),
        "Utilisation here": ("utilisation", 100.0),
        "Stiffness here": ("stiffness_N_per_m", 1e-3),
    }
    for title, (figure, scale) in in_unit.items():
        gain = getattr(after.pose, figure) - getattr(before.pose, figure)
        assert lines[title].difference == pytest.approx(scale * gain)
    assert Rope(WIRE, "7/32 in") in found.lost
    assert found.gained == ()


@pytest.mark.slow
def test_a_full_selection_and_a_quick_one_are_told_apart(few: Session) -> None:
    question = few.question()
    assert question is not None
    found = compare(pin_of(few), pin_of(few, ropes=full_ropes(question)))
    assert not found.is_like_with_like
    unknown = compare(pin_of(few, ropes=None, worst=None), pin_of(few))
    assert {one.title.split()[-1] for one in unknown.figures} == {"here"}


def test_the_map_against_another_state(few: Session) -> None:
    before = few.question()
    few.edit("robot.platform.mass", "0.4 t")
    few.edit("workspace.region.inset", "4 m")  # other positions
    question = few.question()
    assert question is not None
    found = map_answer(question, against=before)
    assert before is not None
    assert np.all(found.difference("diameter") > 0.0)  # type: ignore[operator]
    governing = found.difference("governing")
    assert governing is not None
    assert set(np.unique(governing)) <= {0.0, 1.0}
    assert map_answer(question).difference("diameter") is None
    same = map_answer(question, against=question)
    assert np.all(same.difference("governing") == 0.0)
