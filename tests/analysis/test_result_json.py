"""result.json: the names that scripts rely on, and numbers that are numbers or null."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from designer.analysis.analyse import Analysis, analyse
from designer.analysis.pose import analyse_pose
from designer.analysis.result_json import result_dict, size_dict
from designer.documents.plain import json_text
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.io.results import write_results
from designer.progress import Advance

pytestmark = pytest.mark.slow

CONFIG = """
name: Crane
robot:
  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
  platform: {{mass: 4000 kg}}
cable: {{density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}}
pose: {pose}
workspace:
  region: {{prism: anchors, inset: {inset}, z: [-200, -40]}}
  samples: 200
selection: {{grades: [gost-6x19s-iwrc-1960, unirope-7x19-galvanised], safety_factor: 2}}
"""
POSE_KEYS = {
    "sagging": {"diameter_m", "max_tension_N", "lengths_m", "tensions_N", "status", "thinnest"},
    "massless": {"diameter_m", "max_tension_N"},
    "loop": {"iterates"},
    "optimum": {"diameter_m"},
}
WORKSPACE_KEYS = {"samples", "feasible", "statuses", "sagging", "sampled", "massless"}
CANDIDATE_KEYS = {
    "grade",
    "size_id",
    "diameter_m",
    "continuous_diameter_m",
    "max_tension_N",
    "utilisation",
    "linear_mass_kg_per_m",
    "total_mass_kg",
    "verified",
}


class Silent:
    """A reporter that shows nothing."""

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        yield lambda _: None


def solved(folder: Path, pose: str = "[250, 200, -50]", inset: str = "10.35 m") -> Analysis:
    config = folder / "study.yaml"
    config.write_text(CONFIG.format(pose=pose, inset=inset), encoding="utf-8")
    return analyse(read_study(config), load_catalogue(with_plugins=False), folder, Silent())


@pytest.fixture(scope="module")
def analysis(tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    return solved(tmp_path_factory.mktemp("study"))


@pytest.fixture(scope="module")
def result(analysis: Analysis, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("out")
    write_results(analysis, folder)
    names = {file.name for file in folder.iterdir()}
    assert names == {"result.json", "candidates.csv", "reactions.csv", "workspace.nc"}
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def test_promised_names_are_there(result: Any) -> None:
    for part, names in POSE_KEYS.items():
        assert names <= result["pose"][part].keys()
    assert result["workspace"].keys() >= WORKSPACE_KEYS
    for part in ("sagging", "sampled", "massless"):
        assert result["workspace"][part].keys() == {"diameter_m", "max_tension_N", "pose"}
    for candidate in (*result["selection"]["candidates"], result["selection"]["chosen"]):
        assert candidate.keys() >= CANDIDATE_KEYS
    assert result["provenance"].keys() >= {"version", "config_sha256", "catalogues"}
    assert result["provenance"]["catalogues"][0].keys() >= {"name", "source"}


def test_what_a_reviewer_asks_next_is_there(result: Any, analysis: Analysis) -> None:
    findings, choice = result["findings"], analysis.findings.massless_choice
    assert choice is not None
    assert findings["without_cable_weight"]["size_id"] == choice.size.id
    assert findings["without_cable_weight"]["safety_factor"] == choice.safety_factor
    assert findings["other_hangs_below"]["policy"] == "exclude"
    assert 0.0 < findings["hanging_share"] < 1.0
    assert findings["unserved"] is None
    assert findings["not_in_equilibrium"] == []
    low, high = findings["modulus_utilisation"]
    assert low != high


def test_values_are_the_papers(result: Any) -> None:
    pose = result["pose"]
    assert pose["sagging"]["diameter_m"] == pytest.approx(32.59917e-3, abs=5e-9)
    assert pose["sagging"]["max_tension_N"] == pytest.approx(150236.49, abs=0.01)
    assert pose["sagging"]["status"] == "solved"
    assert pose["sagging"]["tensions_N"] == pytest.approx([119627.982] * 2 + [150236.491], abs=0.01)
    assert pose["massless"]["diameter_m"] == pytest.approx(24.71948e-3, abs=5e-9)
    assert pose["loop"]["iterates"][1]["max_tension_N"] == pytest.approx(123082, abs=1)
    assert pose["optimum"]["diameter_m"] == pose["sagging"]["diameter_m"]
    workspace = result["workspace"]
    assert workspace["feasible"] is True
    assert workspace["sagging"]["diameter_m"] == pytest.approx(51.23e-3, abs=1e-5)
    assert workspace["statuses"]["solved"] == workspace["samples"] == 200


def test_selection_has_its_parts(result: Any) -> None:
    selection = result["selection"]
    assert selection["objectives"] == ["mass", "drum_diameter", "max_tension"]
    assert selection["chosen"] == selection["pareto"][0]
    for usable in selection["usable"]:
        names = {"grade", "size_id", "diameter_m", "volume_m3", "fraction", "lost_fraction"}
        assert usable.keys() == names
        assert usable["grade"] == selection["chosen"]["grade"]
    shares = [usable["fraction"] for usable in selection["usable"]]
    assert shares == sorted(shares)
    for candidate in selection["candidates"]:
        load, share = candidate["minimum_breaking_load_N"], candidate["efficiency"]
        assert candidate["allowable_tension_N"] == pytest.approx(load * share / 2.0)
        assert candidate["why"]
        assert candidate["verified"] == (candidate["refined"] and candidate["utilisation"] <= 1.0)


def test_every_candidate_is_in_the_table(analysis: Analysis, result: Any, tmp_path: Path) -> None:
    assert analysis.selection is not None
    write_results(analysis, tmp_path)
    with (tmp_path / "candidates.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(result["selection"]["candidates"]) > 20
    for row, candidate in zip(rows, result["selection"]["candidates"], strict=True):
        assert row["grade"] == candidate["grade"]
        assert float(row["utilisation"]) == candidate["utilisation"]
        assert float(row["longest_2_m"]) == candidate["longest_m"][1]
        assert float(row["worst_pose_3_m"]) == candidate["worst_pose"][2]
        assert row["standing"] == candidate["standing"]


def test_chosen_is_one_of_the_candidates(result: Any) -> None:
    selection = result["selection"]
    assert selection["chosen"] in selection["candidates"]
    assert (selection["chosen"]["grade"], selection["chosen"]["size_id"]) == (
        "gost-6x19s-iwrc-1960",
        "20.5 mm",
    )
    assert selection["chosen"]["verified"] is True
    assert selection["reason"] is None
    assert {g["grade"]: g["outcome"] for g in selection["grades"]} == {
        "gost-6x19s-iwrc-1960": "rejected",  # its 20.5 mm is strong enough, and sags too far
        "unirope-7x19-galvanised": "too_thin",
    }


def test_negative_answers_are_null_with_a_reason(tmp_path: Path) -> None:
    result = result_dict(solved(tmp_path, pose="[250, -60, -50]", inset="0 m"))
    assert result["positive"] is False
    assert result["pose"]["sagging"]["status"] == "outside_hull"
    assert result["pose"]["sagging"]["diameter_m"] is None
    assert result["pose"]["sagging"]["lengths_m"] == [None, None, None]
    workspace = result["workspace"]
    assert workspace["feasible"] is False
    assert workspace["sagging"] is None
    assert "however thick" in workspace["reason"]
    assert workspace["limit_ratio"] is None
    assert len(workspace["infeasible_example_m"]) == 3
    assert 0.0 < workspace["fraction_no_finite_cable"] < 0.1
    assert result["selection"]["chosen"] is None
    assert result["selection"]["reason"] == "no section of any grade holds the whole workspace"
    json.dumps(result, allow_nan=False)


def test_size_prints_the_pose_under_the_same_names(analysis: Analysis, result: Any) -> None:
    pose = analyse_pose(analysis.study)
    assert pose is not None
    printed = json.loads(json_text(size_dict(analysis.study, pose)))
    assert printed["pose"] == result["pose"]
    assert printed["provenance"]["config_sha256"] == analysis.study.source.sha256


def test_parts_that_were_not_asked_for_are_null(tmp_path: Path) -> None:
    config = tmp_path / "study.yaml"
    text = CONFIG.format(pose="[250, 200, -50]", inset="0 m")
    config.write_text(text[: text.index("workspace:")], encoding="utf-8")
    catalogue = load_catalogue(with_plugins=False)
    result = result_dict(analyse(read_study(config), catalogue, tmp_path, Silent()))
    assert result["workspace"] is None
    assert result["selection"] is None
    assert result["pose"] is not None
    assert result["positive"] is True
