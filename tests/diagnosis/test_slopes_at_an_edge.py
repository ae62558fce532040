"""Slopes of a residual where the model holds a row on one side of a value only."""

from types import SimpleNamespace

import numpy as np

from designer.diagnosis.fit import jacobian
from designer.diagnosis.problem import SlopeCache
from designer.effects.effect import Effect, Parameter, Size
from designer.units import LENGTH

STRETCH = Effect(
    id="stretch",
    summary="each length is so many times the value",
    law="length is slope times value",
    source="made for this test",
    parameters=(Parameter("x_m", LENGTH, Size(0.1, (-2.0, 2.0), (-2.0, 2.0))),),
    on_readings=lambda readings, values, measured: readings,
)


def in_noise(settings):
    (setting,) = settings
    x = setting.values["x_m"]
    rows = np.array([[3.0 * x, 0.0], [5.0 * x, 0.0], [7.0 * x, 0.0], [9.0 * x, 0.0]])
    rows[1, x > 1.0] = np.nan  # held up to 1
    rows[2, x < 1.0] = np.nan  # held from 1 on
    rows[3] = np.nan
    return rows / [0.5, 1.0]


def test_a_row_tells_its_slope_from_the_side_on_which_it_is_held():
    readings = np.array([[0.0, np.nan]] * 4)
    problem = SimpleNamespace(
        noise=None,
        measured=SimpleNamespace(is_read=~np.isnan(readings)),
        in_noise=in_noise,
        predicted=in_noise,
        predict=SimpleNamespace(
            slopes=SlopeCache(), distrust=lambda settings, noise: (1.0, 1.0), row_unknowns=0
        ),
    )
    slopes = jacobian(problem, [STRETCH], np.array([1.0]))
    # A residual is (measured - predicted) / noise; a row that is held on neither side has no slope.
    assert np.allclose(slopes[:, 0, 0], [-6.0, -10.0, -14.0, 0.0])
    assert np.isnan(slopes[:, 1]).all()
