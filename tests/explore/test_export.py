"""What goes out into files."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from designer.analysis.analyse import analyse
from designer.errors import DesignerError, InputError, OutputError
from designer.explore.answers import map_answer, pose_answer
from designer.explore.export import COLUMNS, ExportContent, export, map_columns
from designer.explore.question import Question, Rope
from designer.explore.session import Session
from designer.exports.formats import FORMATS
from designer.exports.robot import ExportedRobot
from designer.progress import SILENT


@pytest.fixture
def question(yard: Session) -> Question:
    yard.edit("workspace.samples", "200")
    yard.edit("robot.platform.mass", "200 kg")
    yard.choose(Rope("unirope-7x19-galvanised", "7/32 in"))
    found = yard.question()
    assert found is not None
    return found


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_tables(question: Question, tmp_path: Path) -> None:
    written = export(question, SILENT, content="tables", target=tmp_path / "out").files
    assert [path.name for path in written] == ["cables.csv", "map.csv", "ropes.csv"]
    cables = rows_of(written[0])
    assert [float(row["length_m"]) for row in cables] == [
        one.length_m for one in pose_answer(question).cables
    ]
    chart = rows_of(written[1])
    columns = map_columns(map_answer(question, fine=True))
    assert len(chart) == len(columns["x_m"])
    assert {"diameter_m", "stiffness_N_per_m", "unserved", "verdict"} <= set(chart[0])
    assert np.allclose([float(row["diameter_m"]) for row in chart], columns["diameter_m"])
    ropes = rows_of(written[2])
    assert {"grade", "size_id", "utilisation", "reason", "x_m"} <= set(ropes[0])


@pytest.mark.slow
def test_the_map_for_paraview(question: Question, tmp_path: Path) -> None:
    import pyvista as pv

    (path,) = export(question, SILENT, content="vtk", target=tmp_path / "map.vtu").files
    mesh: Any = pv.read(path)
    chart = map_answer(question, fine=True)
    points = map_columns(chart)
    assert mesh.n_points == len(points["x_m"])
    assert set(COLUMNS.values()) <= set(mesh.point_data)
    # In whatever order: at the same position there is the same value.
    i, j = 7, 11
    at = mesh.find_closest_point(chart.grids["wall"][i, j])
    assert np.allclose(mesh.points[at], chart.grids["wall"][i, j])
    value = chart.on("wall", "diameter")[i, j]
    assert mesh.point_data["diameter_m"][at] == pytest.approx(value)
    assert [one.name for one in tmp_path.iterdir()] == ["map.vtu"]


@pytest.mark.slow
def test_nothing_is_written_where_it_cannot_be(question: Question, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x", encoding="utf-8")
    for what, target in (("tables", tmp_path / "file"), ("vtk", tmp_path / "file" / "map.vtu")):
        with pytest.raises(OutputError):
            export(question, SILENT, content=what, target=target)  # type: ignore[arg-type]
    with pytest.raises(OutputError, match=r"\.vtu"):
        export(question, SILENT, content="vtk", target=tmp_path / "map.vtk")


@pytest.mark.slow
def test_the_report_is_that_of_the_command(question: Question, tmp_path: Path) -> None:
    written = export(question, SILENT, content="report", target=tmp_path / "report").files
    assert written[0].name == "report.html"
    result = json.loads((tmp_path / "report" / "result.json").read_text(encoding="utf-8"))
    own = analyse(question.study, question.catalogue).to_dict()
    for part in ("pose", "workspace", "selection", "answer"):
        assert result[part] == json.loads(json.dumps(own[part]))
    assert pose_answer(question).diameter_m == result["pose"]["sagging"]["diameter_m"]


@pytest.mark.slow
def test_a_report_that_is_given_up_leaves_nothing(
    question: Question, tmp_path: Path, asker: Any
) -> None:
    number = asker.ask("export", question, content="report", target=tmp_path / "report")
    while asker.next().is_end:
        pass
    asker.worker.cancel("export")
    assert asker.end_of(number).status == "cancelled"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "target"),
    [("csv", "cables.csv"), ("caspr", "rig_bodies.xml"), ("moordyn", "rig.txt"),
     ("mujoco", "rig.xml"), ("gltf", "rig.glb")],
)  # fmt: skip
def test_formats_are_those_of_the_command(
    question: Question, tmp_path: Path, name: str, target: str
) -> None:
    made = export(question, SILENT, content=name, target=tmp_path / target)  # type: ignore[arg-type]
    robot = ExportedRobot.of(question.study, question.catalogue, with_maps=FORMATS[name].needs_maps)
    own = FORMATS[name].write(robot, target.removesuffix(FORMATS[name].ending))
    assert made.files[0] == tmp_path / target
    assert {file.name: file.read_bytes() for file in made.files} == dict(own.files)
    assert made.remarks == tuple(f"Not in it: {line}" for line in own.lost)
    with pytest.raises(InputError, match=FORMATS[name].ending):
        export(question, SILENT, content=name, target=tmp_path / "rig.odd")  # type: ignore[arg-type]


def test_every_format_of_the_command_can_be_exported() -> None:
    assert set(FORMATS) | {"report", "lengths"} <= set(get_args(ExportContent))


def test_lengths_at_poses_of_a_table(question: Question, tmp_path: Path) -> None:
    poses, target = tmp_path / "poses.csv", tmp_path / "lengths.csv"
    poses.write_text("x_m,y_m,z_m\n15,9,4\n15,9,50\n", encoding="utf-8")
    written = export(question, SILENT, content="lengths", target=target, poses=poses)
    first, last = rows_of(written.files[0])
    assert first["verdict"] == "solved"
    assert float(first["length_1_m"]) == pytest.approx(19.0, abs=0.5)
    assert last["length_1_m"] == ""
    assert any("1 of 2 poses not held" in line for line in written.remarks)
    with pytest.raises(InputError, match=r"no workspace\.path"):
        export(question, SILENT, content="lengths", target=target)


def test_nothing_is_exported_without_a_rope(question: Question, tmp_path: Path) -> None:
    question = replace(
        question,
        study=replace(question.study, selection=replace(question.selection, safety_factor=500.0)),
    )
    with pytest.raises(DesignerError, match="No rope serves this study"):
        export(question, SILENT, content="csv", target=tmp_path / "cables.csv")
    assert not list(tmp_path.iterdir())
