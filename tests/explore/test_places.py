"""Lists of poses, paths and orientations that follow the position: what the window says of them.

Against the reference of the pairs, which reads the same files and shares no code with ours.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from pairs.agreement import Situation
from pairs.options import BY_ID, GRADES, PATHS, POSES, file_text, files_of, study_of
from pairs.reference import Pose, solve
from pairs.scenario import turn_at

from designer.explore.answers import full_ropes, values_at, worst_answer
from designer.explore.question import Question, Rope
from designer.explore.session import Session
from designer.plugins import Plugins

WIRE = "pairs-wire"


def asked(option: str, folder: Path, plugins: Plugins) -> tuple[dict, Question]:
    """Return a study with an option, on six cables, and what the window is asked, with its rope."""
    text = study_of("six", BY_ID[option]) | {"catalogues": ["wire.yaml"]}
    for name in files_of(text):
        (folder / name).write_text(file_text(name), encoding="utf-8")
    (folder / "wire.yaml").write_text(yaml.safe_dump(GRADES[WIRE]), encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(text), encoding="utf-8")
    question = Session.open(path, plugins).question()
    assert question is not None
    ropes = full_ropes(question)
    assert ropes is not None and ropes.best is not None
    return text, replace(question, rope=ropes.best)


def situation(text: dict, rope: Rope) -> Situation:
    (size,) = [size for size in GRADES[WIRE]["sizes"] if str(size["id"]) == rope.size_id]
    return Situation(text, [(GRADES[WIRE], size)] * 6, {})


@pytest.mark.slow
@pytest.mark.parametrize("option", ["poses", "path", "toward", "table"])
def test_worst_pose_is_that_of_the_reference(
    option: str, tmp_path: Path, no_plugins: Plugins
) -> None:
    text, question = asked(option, tmp_path, no_plugins)
    assert isinstance(question.rope, Rope)
    worst = worst_answer(question)
    assert worst is not None and worst.rope is not None
    there, pose = situation(text, question.rope), Pose.of(worst.place)
    state = solve(there.problem_at(pose), pose)
    assert state is not None
    assert worst.rope.utilisation == pytest.approx(state.utilisation, rel=1e-6)
    if option == "path":
        first, last = np.array(PATHS[text["workspace"]["path"]])
        along = (worst.place[:3] - first) @ (last - first) / ((last - first) @ (last - first))
        assert worst.place[:3] == pytest.approx(first + along * (last - first), abs=1e-6)
        return
    rows = POSES[text["workspace"]["poses"]] if option == "poses" else []
    poses = [Pose(np.array(at), np.array(turn)) for at, turn, _ in rows]
    for at in text["workspace"].get("region", {}).get("points", ()):
        turn = turn_at(text, np.array(at))
        assert turn is not None
        poses.append(Pose(np.array(at), turn))
    states = [solve(there.problem, each) for each in poses]
    used = [np.inf if state is None else state.utilisation for state in states]
    assert worst.rope.utilisation == pytest.approx(max(used), rel=1e-6)
    assert question.workspace is not None
    if option != "poses":  # of which several may be at one position
        positions = np.array([each.position_m for each in poses])
        values = values_at(question, question.workspace, positions, frozenset({"utilisation"}))
        assert values["utilisation"] == pytest.approx(used, rel=1e-6)
