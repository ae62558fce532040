"""The door for Python: every public name is there, documented, and does what the commands do."""

from __future__ import annotations

import gc
import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import designer
from designer.cli.commands import main
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


@pytest.mark.slow
def test_the_notebook_runs(monkeypatch, capsys) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    file = example_file("yard").with_name("first-steps.ipynb")
    cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    space: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), space)
    diameters = re.findall(r"kg: (\d\.\d+) mm", capsys.readouterr().out)
    assert len(diameters) == 5
    assert diameters == sorted(diameters)


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
