"""Effects that are not in the list: unexplained, and no listed effect bent to fit them."""

from __future__ import annotations

import pytest
from twins.dataset import DataSet, make, size_for
from twins.robots import YARD3
from twins.troubles import troubled

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis, DiagnosisVerdict, Reason
from designer.io.config import read_study
from designer.measured.read import read_measured

pytestmark = pytest.mark.slow


def diagnosed(dataset: DataSet, folder) -> Diagnosis:
    dataset.write(folder)
    study = read_study(folder / "config.yaml")
    assert study.measurements is not None
    return diagnose(case_of(study, study.measurements, read_measured(study)))


def sized(*effects: str, over_noise: float = 10.0) -> dict[str, dict[str, float]]:
    return {e: YARD3.draw(e, size_for(YARD3, e, over_noise), 0) for e in effects}


@pytest.mark.parametrize(
    ("effect", "carriers"),
    [
        ("tower_settles", {"time_s"}),
        ("cable_mass_drift", {"time_s"}),
    ],
)
def test_what_is_not_in_the_list_is_unexplained(effect, carriers, tmp_path) -> None:
    found = diagnosed(make(YARD3, sized(effect), rows=80), tmp_path)
    assert found.is_unexplained
    assert found.findings == ()
    assert found.structure_after.carriers[0].name in carriers
    assert len(found.stages) == 1
    assert found.verdict is DiagnosisVerdict.UNEXPLAINED


def test_a_winch_that_slips_is_told_with_its_row_and_what_drifts_with_it_is_withdrawn(
    tmp_path,
) -> None:
    found = diagnosed(troubled(YARD3, "slip", 4), tmp_path)
    assert found.findings == ()
    assert found.verdict is DiagnosisVerdict.UNEXPLAINED
    assert "a step at row 40" in [event.text for event in found.structure_after.events]
    assert found.withdrawn
    assert {gone.reason for gone in found.withdrawn} <= {Reason.DRIFTS, Reason.READINGS_DRIFT}


def test_a_listed_effect_beside_it_is_kept(tmp_path) -> None:
    effects = sized("platform_mass", "tower_settles")
    found = diagnosed(make(YARD3, effects), tmp_path)
    assert [finding.effect.id for finding in found.findings] == ["platform_mass"]
    true = effects["platform_mass"]["offset_kg"]
    assert found.findings[0].parameters["offset_kg"].value == pytest.approx(true, rel=0.1)
    assert found.is_unexplained
    assert found.structure_after.carriers[0].name == "time_s"


def test_a_pair_that_the_data_cannot_tell_comes_with_rivals(tmp_path) -> None:
    """Creep from another onset hides a wrong scale, until both are fitted anew together."""
    found = diagnosed(make(YARD3, sized("creep", "drum_scale")), tmp_path)
    assert {finding.effect.id for finding in found.findings} == {"creep", "drum_scale"}
    (scale,) = [finding for finding in found.findings if finding.effect.id == "drum_scale"]
    assert "thermal_expansion" in scale.rivals
