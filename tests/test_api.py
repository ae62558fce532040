"""The door for Python: every public name is there, documented, and does what the commands do."""

from __future__ import annotations

import gc
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes

import designer
from designer.cli.commands import main
from designer.report.figures.opengl import why_no_scenes
from designer.report.render import REPORT_FILES
from designer.resources import example_file


def small(name: str = "yard", samples: int = 200) -> designer.Study:
    study = designer.read_study(example_file(name), with_plugins=False)
    assert study.workspace is not None
    return replace(study, workspace=replace(study.workspace, samples=samples))


def test_every_public_name_is_listed_once_and_documented() -> None:
    assert sorted(designer.__all__) == designer.__all__
    assert set(designer.__all__) == set(designer._HOME_OF)
    for name in designer.__all__:
        thing = getattr(designer, name)
        assert thing.__doc__, name
        assert thing.__name__ == name
    with pytest.raises(AttributeError, match="no attribute 'analyze'"):
        _ = designer.analyze


def test_the_package_itself_loads_nothing_heavy() -> None:
    code = "import designer, sys; print([m for m in ('numpy', 'numba') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.slow
def test_a_study_made_in_python_is_analysed_without_a_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    robot = designer.Robot(
        exit_points_m=np.array([[0.0, 0, 10], [20, 0, 10], [10, 15, 10]]),
        platform=designer.Platform(mass_kg=100.0),
    )
    steel = designer.Material(7800.0, 100e9, 200e6)
    box = designer.Prism.box((8.0, 12.0), (4.0, 6.0), (1.0, 4.0))
    study = designer.Study("hall", robot, steel, workspace=designer.Workspace(box, samples=100))
    analysis = designer.analyse(study)
    assert analysis.workspace is not None
    assert analysis.workspace.sagging is not None
    samples = analysis.workspace.to_xarray()
    assert samples.sizes["sample"] == 100
    assert samples["diameter"].attrs["units"] == "m"
    assert float(samples["diameter"].max()) <= analysis.workspace.sagging.diameter_m
    assert json.loads(analysis.to_json())["workspace"]["feasible"] is True
    assert list(tmp_path.iterdir()) == []
    file = analysis.sweep_file
    assert file is not None and file.exists()
    del analysis
    gc.collect()
    assert not file.parent.exists()


@pytest.mark.slow
def test_the_readme_does_what_it_shows(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    text = example_file("yard").read_text(encoding="utf-8")
    (tmp_path / "my-crane.yaml").write_text(text.replace("samples: 20000", "samples: 200"))
    readme = Path(__file__).parents[1] / "README.md"
    (snippet,) = re.findall(r"```python\n(.*?)```", readme.read_text(encoding="utf-8"), re.DOTALL)
    exec(snippet, {})
    assert " mm at [" in capsys.readouterr().out
    assert (tmp_path / "my-crane-report" / "report.pdf").stat().st_size > 0


@pytest.fixture(scope="module")
def analysis() -> designer.Analysis:
    study = designer.read_study(example_file("hoist"), with_plugins=False).unproved
    assert study.workspace is not None
    study = replace(study, workspace=replace(study.workspace, samples=200))
    return designer.analyse(study, designer.catalogue(with_plugins=False))


def test_samples_are_labelled(analysis: designer.Analysis) -> None:
    assert analysis.workspace is not None
    samples, table = analysis.workspace.to_xarray(), analysis.workspace.to_dataframe()
    assert [*samples["axis"].values] == ["x", "y", "z"]
    assert [*samples["cable"].values] == [1, 2, 3]
    assert len(table) == 200
    assert (table["position_z"] == samples["position"].sel(axis="z").values).all()
    assert (table["length_2"] == samples["length"].sel(cable=2).values).all()
    assert set(table["verdict"]) == {"solved"}


def test_values_are_shown_in_a_line_and_as_a_table(analysis: designer.Analysis) -> None:
    for value in (
        analysis, analysis.study, analysis.study.robot, analysis.workspace, analysis.selection,
        analysis.chosen, analysis.pose, designer.catalogue(with_plugins=False),
        designer.lengths(analysis, [[25.0, 14.0, 6.0]]), designer.compare(analysis, analysis),
    ):  # fmt: skip
        assert "\n" not in repr(value)
        assert len(repr(value)) < 700, repr(value)
        assert value is not None
        assert value._repr_html_().startswith("<table>")
    assert "answer: yes" in repr(analysis)
    assert "not computed yet" in repr(designer.analysis.analyse.Analysis.begin(analysis.study))


def test_plots_are_axes_and_scenes(analysis: designer.Analysis) -> None:
    charts = set(dir(analysis.plot)) - {"region", "pose"}
    shown = {name: getattr(analysis.plot, name)() for name in charts}
    assert {name for name, axes in shown.items() if axes} >= {"of_ropes", "of_family", "edge"}
    assert all(isinstance(axis, Axes) for axes in shown.values() for axis in axes)
    assert any("utilisation" in axis.get_xlabel() for axis in analysis.plot.of_ropes())
    with pytest.raises(AttributeError, match="no plot 'edges', but of_ropes"):
        analysis.plot.edges  # noqa: B018
    if not why_no_scenes():
        for scene in (analysis.plot.region, analysis.plot.pose):
            plotter = scene(off_screen=True)
            assert len(plotter.actors) > 2
            assert np.ptp(plotter.screenshot()) > 100
            plotter.close()


@pytest.mark.slow
def test_commands_in_python(analysis: designer.Analysis, tmp_path: Path) -> None:
    lengths = designer.lengths(analysis, [[25.0, 14.0, 6.0], [20.0, 10.0, 3.0]])
    back = designer.find_poses(analysis, lengths.statics.length_m)
    assert np.abs(back.place[:, :3] - [[25.0, 14.0, 6.0], [20.0, 10.0, 3.0]]).max() < 1e-6
    lost = designer.export(analysis.study, "moordyn", tmp_path / "hoist.txt")
    assert "LINES" in (tmp_path / "hoist.txt").read_text()
    assert all(isinstance(line, str) for line in lost)
    moved = designer.follow(
        analysis.study, [[20, 10, 3], [28, 16, 6]], speed_max_m_per_s=1.0,
        acceleration_max_m_per_s2=0.5,
    )  # fmt: skip
    motion = moved.robot.platform.motion
    assert motion is not None
    assert np.linalg.norm(motion.velocity[:, :3], axis=1).max() <= 1.0 + 1e-9
    moved = replace(moved, load_cases=())
    assert designer.analyse(moved).path is not None
    assert designer.compare(analysis, analysis).is_same
    file = example_file("hoist")
    assert designer.size(file).sizing.diameter_m == designer.size(str(file)).sizing.diameter_m
    designer.write_report(analysis.study, tmp_path / "page", quick=True)
    assert [path.name for path in (tmp_path / "page").iterdir()] == ["report.html"]


@pytest.mark.slow
def test_sweep_in_python(tmp_path: Path) -> None:
    (tmp_path / "crane.yaml").write_text(example_file("yard").read_text(encoding="utf-8"))
    (tmp_path / "plan.yaml").write_text(
        "study: crane.yaml\nvary: {robot.platform.mass: [100 kg, 200 kg]}\n"
        "keep: [pose.optimum.diameter_m]\n"
    )
    points = designer.sweep(tmp_path / "plan.yaml", workers=1)
    assert points.sizes["point"] == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["crane.yaml", "plan.yaml"]


SCRIPT = """
from dataclasses import replace
from pathlib import Path

import designer

study = designer.read_study("crane.yaml")
wind = designer.Wind(speed_m_per_s=12.0, cable_drag_coefficient=1.2)
case = designer.LoadCase("wind", dynamic_factor=1.2, wind=wind)
limits = designer.RopeLimits(stiffness_N_per_m=1e4)
selection = designer.Selection(grades=("unirope-python-hoist-1960",), limits=limits)
winches = designer.Winches(drum_diameter_m=0.3)
robot = replace(study.robot, winches=winches)
study = replace(study, robot=robot, load_cases=(case,), selection=selection)
study = designer.follow(study, [[0, 0, 1], [1, 0, 2]], [0.0, 4.0])
analysis = designer.analyse(study)
if analysis.chosen is not None and analysis.workspace is not None:
    print(analysis.chosen.name, analysis.workspace.to_xarray()["length"].sel(cable=1))
    print(len(analysis.workspace.to_dataframe()), analysis.plot.edge()[0].figure)
analysis.plot.region(off_screen=True).screenshot("region.png")
print(designer.lengths(analysis, [[0, 0, 1]]).statics.length_m.max())
print(designer.find_poses(study, [[3.0, 3.0, 3.0]]).is_stable.all())
print(designer.compare("a.yaml", Path("b.yaml")).is_same)
print(designer.sweep("plan.yaml", workers=2).sizes["point"])
lost: tuple[str, ...] = designer.export("crane.yaml", "csv", "rows.csv")
try:
    designer.write_report("crane.yaml", "out", quick=True)
except designer.InputError as error:
    print([fault.field for fault in error.faults])
"""


@pytest.mark.slow
def test_a_script_of_a_user_is_typed(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "mypy.ini").write_text(
        "[mypy]\nstrict = true\n[mypy-designer.*]\nfollow_imports = silent\n"
        "[mypy-pandas.*,matplotlib.*,pyvista.*]\nignore_missing_imports = true\n"
    )
    pytest.importorskip("mypy")
    cache = Path(__file__).parents[1] / ".mypy_cache"
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", str(cache), "script.py"],
        cwd=tmp_path, env={**os.environ, "MYPYPATH": str(Path(designer.__file__).parents[1])},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def test_size_gives_what_the_command_prints(capsys, monkeypatch) -> None:
    file = str(example_file("fast"))
    found = designer.size(designer.read_study(file))
    monkeypatch.setattr(sys, "argv", ["designer", "size", file, "--json"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    printed = json.loads(capsys.readouterr().out)
    assert printed["pose"]["optimum"]["diameter_m"] == float(found.sizing.diameter_m)


def test_a_study_without_a_pose_or_measurements_is_refused_in_one_line() -> None:
    study = replace(small(), pose=None, measurements=None)
    with pytest.raises(designer.InputError, match="pose: is missing"):
        designer.size(study)
    with pytest.raises(designer.InputError, match="measurements: is missing"):
        designer.diagnose(study)
    with pytest.raises(designer.InputError, match="nothing to solve"):
        designer.analyse(replace(study, workspace=None, selection=None))


@pytest.mark.slow
def test_a_report_is_written_whole_with_all_results(tmp_path: Path) -> None:
    analysis = designer.analyse(small(), designer.catalogue(with_plugins=False))
    designer.write_report(analysis, tmp_path / "out")
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {*REPORT_FILES} - {"path.csv"}
    written = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert written == json.loads(analysis.to_json())
