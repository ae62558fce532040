"""Wrenches of load cases, as the report has them."""

from __future__ import annotations

from collections.abc import Callable

from report_parts import said

from designer.analysis.analyse import Analysis
from designer.report.design.drawings import Drawings
from designer.report.design.report import section as section_of

STUDY = """
name: Crane
robot:
  anchors: [[0, 0, 12], [14, 0, 12], [6, 11, 12]]
  platform: {mass: 60 kg}
cable: {grade: unirope-6x36-iwrc-1960}
workspace: {region: {points: [[5, 4, 5]]}}
selection: {grades: [unirope-6x36-iwrc-1960], safety_factor: 5}
load_cases:
  - {name: side, wrench: {force: [10, 0, 0]}}
  - {name: pulled, wrench_set: {force: [[-60, 90], [0, 0], [-900, 250]]}}
  - {name: tool, wrench_set: [{force: [50, 0, -400]}, {force: [-80, 20, 0]}]}
"""


def test_wrenches_are_in_the_load_cases(solve: Callable[[str], Analysis]) -> None:
    page = said(section_of(Drawings(solve(STUDY)), "load-cases"))
    for words in (
        "Wrench (10, 0, 0, 0, 0, 0) N, N·m",
        "Any wrench between (−60, 0, −900, 0, 0, 0) and (90, 0, 250, 0, 0, 0) N, N·m",
        "One wrench at a time of (50, 0, −400, 0, 0, 0), (−80, 20, 0, 0, 0, 0) N, N·m",
        "force (90, 0, −900) N",
        "Of a box of wrenches the corners are held",
    ):
        assert words in page
