"""Effects of several cables that stand together in place of one that has a number for each."""

from __future__ import annotations

from dataclasses import replace

import pytest
from twins.dataset import make
from twins.robots import YARD3

from designer.diagnosis.diagnose import diagnose_study
from designer.io.config import read_study
from designer.measured.read import read_measured

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
