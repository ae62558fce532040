"""Agreement is not said of a fit that gives up what speaks against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from twins.logs import write_printer

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import DiagnosisVerdict
from designer.diagnosis.structure import Event, Structure, with_gross_errors, wrong_poses
from designer.effects.effect import frame_size_m
from designer.io.config import read_study
from designer.measured.read import read_measured

NOTHING = Structure((), 1.0)


def texts(residual: np.ndarray, unfitted: np.ndarray | None = None) -> list[str]:
    rows = np.arange(1, len(residual) + 1)
    before = 10.0 * residual if unfitted is None else unfitted
    return [e.text for e in with_gross_errors(NOTHING, residual, before, rows).events]


def noise(rows: int = 40) -> np.ndarray:
    residual = np.random.default_rng(0).normal(size=(rows, 6))
    residual[:, 4] = np.nan
    return residual


def test_readings_of_a_cable_far_off_are_named_with_their_rows() -> None:
    residual = noise()
    residual[6, 1], residual[9, 1] = 424.0, -155.0
    (text,) = texts(residual)
    assert (
        text == "cable 2, off by 155 to 424 times the noise in rows 7, 10: its winch or its sensors"
    )


@pytest.mark.parametrize(
    "off", [[], [(3, 1)], [(3, 1), (5, 2)], [(3, 1), (5, 1), (8, 0), (9, 2), (20, 5)]]
)
def test_accidents_here_and_there_are_none(off: list[tuple[int, int]]) -> None:
    residual = noise()
    for place in off:
        residual[place] = 60.0
    assert texts(residual) == []


def test_rows_in_which_all_cables_stand_off_have_wrong_poses() -> None:
    residual = noise()
    residual[[4, 20, 21], :4] = 90.0
    residual[9, 5] = 300.0  # one cell
    residual[12, [3, 5]] = 50.0  # a load that all cells feel
    assert np.flatnonzero(wrong_poses(residual)).tolist() == [4, 20, 21]
    (text,) = texts(residual)
    assert text == (
        "15 of 200 readings that stand off, by up to 300 times the noise, "
        "of rows with wrong poses: 5, 21 to 22"
    )
    tensions = np.where(np.arange(6) < 3, np.nan, noise(40))
    tensions[7, [3, 5]] = 40.0  # the only readings
    assert np.flatnonzero(wrong_poses(tensions)).tolist() == [7]


def test_plugs_that_are_exchanged_are_told_alone() -> None:
    exchanged = Structure((), 1.0, events=(Event("length 1 and …", 1.0, 0.0, "mistake"),))
    residual = noise()
    residual[:, 1] = 500.0
    structure = with_gross_errors(exchanged, residual, residual, np.arange(1, 41))
    assert structure is exchanged


def test_a_fit_that_makes_all_rows_together_worse_is_told() -> None:
    residual = noise()
    residual[3, 1], residual[5, 2] = 60.0, 60.0
    better = np.where(np.abs(residual) > 50.0, 40.0, 3.0 * residual)
    assert texts(residual, better)[0].endswith("all that was fitted helps nothing")


def doubled(folder, factor: float):
    """Return the case of a printer whose fourth line moves by a multiple of what is counted."""
    path = write_printer(folder, drum_scale=1.0, rows=22, seed=1)
    lines = (folder / "log.csv").read_text().splitlines()
    cells = [line.split(",") for line in lines]
    at = cells[0].index("motorD_deg")
    heights = [float(row[3]) for row in cells[1:-2]]
    # Nearly all poses are on the bed, as in that log: two alone tell.
    low = sorted(range(len(heights)), key=heights.__getitem__)
    for row in cells[1:]:
        row[at] = str(factor * float(row[at]))
    kept = [cells[0], *(cells[1 + k] for k in sorted([*low[:14], *low[-2:]]))]
    (folder / "log.csv").write_text("\n".join(map(",".join, kept)) + "\n")
    text = path.read_text().replace("[length_offset]", "[anchors, length_offset]")
    path.write_text(text)
    study = read_study(path)
    assert study.measurements is not None
    return case_of(study, study.measurements, read_measured(study))


@pytest.mark.slow
def test_a_line_of_double_advantage_is_no_agreement(tmp_path) -> None:
    case = doubled(tmp_path, 2.0)
    found = diagnose(replace(case, candidates=()))
    assert not found.is_positive
    assert found.verdict in (DiagnosisVerdict.UNEXPLAINED, DiagnosisVerdict.IMPLAUSIBLE)
    told = " ".join([*found.doubts, *(e.text for e in found.structure_after.events)])
    assert "cable 4" in told


def test_what_is_plausible_of_unknowns(tmp_path) -> None:
    """A tenth of the frame and 0.1 m, or what the study says."""
    case = doubled(tmp_path, 1.0)
    limit = 0.1 * frame_size_m(case.machine) + 0.1
    for effect in case.given:
        assert {p.plausible for p in effect.parameters} == {(-limit, limit)}
    path = tmp_path / "study.yaml"
    own = "[anchors, length_offset]\n  plausible: {anchors: 30 cm, length_offset: 2 m}"
    path.write_text(path.read_text().replace("[anchors, length_offset]", own))
    study = read_study(path)
    assert study.measurements is not None
    given = case_of(study, study.measurements, read_measured(study)).given
    ends = {(e.id, p.plausible[1]) for e in given for p in e.parameters}
    assert ends == {("anchor_offset", 0.3), ("length_offset", 2.0)}
