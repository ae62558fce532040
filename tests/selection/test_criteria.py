"""What is told of a quantity that is held against a limit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from sample_robots import ROPE

from designer.model.load_case import STATIC, Loaded
from designer.model.region import Prism
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.criteria import ROUNDING, Criterion, criteria_of
from designer.statics.inverse import solve_sagging
from designer.statics.stiffness import platform_stiffness

NAN = math.nan
AT_MOST = Criterion("a", "A", "a ≤ 4", "a test", "N", lambda _, __: np.empty(0), (4.0,), "at_most")
BAND = replace(AT_MOST, kind="outside", limits=(2.0, 8.0))
AT_LEAST, ABOVE = replace(AT_MOST, kind="at_least"), replace(AT_MOST, kind="above")


@pytest.mark.parametrize(
    ("criterion", "quantity", "demand", "capacity", "utilisation", "holds"),
    [
        (AT_MOST, 3.0, 3.0, 4.0, 0.75, True),
        (AT_MOST, 5.0, 5.0, 4.0, 1.25, False),
        (AT_MOST, 4.0 * (1.0 + 0.5 * ROUNDING), 4.0, 4.0, 1.0, True),
        (AT_LEAST, 5.0, 4.0, 5.0, 0.8, True),
        (AT_LEAST, 2.0, 4.0, 2.0, 2.0, False),
        (AT_LEAST, 0.0, 4.0, 0.0, math.inf, False),
        (AT_LEAST, 4.0 * (1.0 - 0.5 * ROUNDING), 4.0, 4.0, 1.0, True),
        (replace(AT_LEAST, has_ratio=False), 5.0, 4.0, 5.0, NAN, True),
        (ABOVE, 5.0, 4.0, 5.0, NAN, True),
        (ABOVE, 4.0, 4.0, 4.0, NAN, False),
        (BAND, 1.0, 1.0, 2.0, 0.5, True),
        (BAND, 16.0, 8.0, 16.0, 0.5, True),
        (BAND, 3.0, 3.0, 2.0, 1.5, False),
        (BAND, 6.0, 8.0, 6.0, 4.0 / 3.0, False),
    ],
)
def test_figures(
    criterion: Criterion,
    quantity: float,
    demand: float,
    capacity: float,
    utilisation: float,
    holds: bool,
) -> None:
    figures = criterion.figures(quantity)
    assert figures[:3] == pytest.approx((demand, capacity, utilisation), nan_ok=True)
    assert figures[3] is holds


def test_instability_is_told_by_the_lowest_eigenvalue(six_cable_robot: Robot) -> None:
    """A mast on the platform: as it gets heavier at the top the stiffness falls below zero."""
    workspace = Workspace(Prism.box((-5, 5), (-5, 5), (-80, -70)))
    stability = {each.id: each for each in criteria_of(six_cable_robot, workspace, None)}[
        "stability"
    ]
    values, heights = [], np.array([-1.0, 40.0, 60.0])
    for height_m in heights:
        body = replace(six_cable_robot.platform, centre_of_mass_m=np.array([0.0, 0.0, height_m]))
        robot = replace(six_cable_robot, platform=body)
        loaded = Loaded(STATIC, (robot, ROPE), robot, ROPE)
        statics = solve_sagging(robot, Poses.at([[0.0, 0.0, -75.0]]), ROPE)
        (quantity,) = stability.quantity(loaded, statics)
        # About the vertical axis nothing is softened; about the others by m g h over the reach².
        K, reach = platform_stiffness(statics)[0], 5.0
        scale = np.array([1.0, 1.0, 1.0, *[1.0 / reach] * 3])
        eigenvalues = np.linalg.eigvalsh(0.5 * (K + K.T) * scale * scale[:, None])
        assert quantity == pytest.approx(eigenvalues[0], rel=1e-6)
        values.append(float(quantity[0]))
        demand, capacity, _, holds = stability.figures(values[-1])
        assert (demand, capacity, holds) == (0.0, values[-1], values[-1] > 0.0)
    assert values[0] > 0.0 > values[1] > values[2]
    # The weight's moment m g h grows linearly with the height, and so does what is missing.
    softer = -4000.0 * 9.81 * np.diff(heights)[1] / 5.0**2
    assert values[2] - values[1] == pytest.approx(softer, rel=0.1)


def test_what_is_nearer_to_failing_is_more_severe() -> None:
    for criterion, better in ((AT_MOST, 3.0), (AT_LEAST, 5.0), (ABOVE, 5.0), (BAND, 1.0)):
        severity = criterion.severity(np.array([better, 4.0, NAN]))
        assert severity[0] < severity[1]
        assert np.isnan(severity[2])
