"""The elastic catenary against published numbers, quadrature, and its own inverse."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import root

from designer.physics import catenary

# Span X, rise Z, unstrained length L [m], EA [N], weight w [N/m] -> H, V at the upper end [N].
# From the closed form in 40 digits; V counts the whole weight of the cable.
SUSPENDED = [
    (400, 200, 500, 7.51e12, 200, 43694.6046221, 77634.4105458),
    (89.9, 59.2, 130, 7.51e8, 881.05, 31373.2348763, 87886.1613),
    (246.22420940032947, 263.55766330843164, 360.62566262396927, 7e8, 3.08735, 71116.8171986,
     76680.6434641),
    (246.22420940032947, 263.55766330843164, 360.63566262396927, 7e8, 3.08735, 58377.2414227,
     63044.4129559),
    (246.22420940032947, 263.55766330843164, 360.64566262396927, 7e8, 3.08735, 46077.2711724,
     49878.8124286),
    (119.3237383002058, 52.49668849178113, 130.36140355177318, 7e8, 34.91060469991227,
     72694.6498942, 34266.3849557),
    (800, 100, 1000, 64e9, 1962, 671447.442408, 1100067.36332),
]  # fmt: skip


@pytest.mark.parametrize(("X", "Z", "L", "EA", "w", "H", "V"), SUSPENDED)
def test_forces_of_published_cables(X, Z, L, EA, w, H, V) -> None:
    force_x, force_z = catenary.forces_from_length(L, X, Z, EA, w)
    assert force_x == pytest.approx(H, rel=1e-9)
    assert w * L - force_z == pytest.approx(V, rel=1e-9)


@pytest.mark.parametrize(("X", "Z", "L", "EA", "w", "H", "V"), SUSPENDED)
def test_length_from_horizontal_force_inverts_forces_from_length(X, Z, L, EA, w, H, V) -> None:
    force_x, force_z = catenary.forces_from_length(L, X, Z, EA, w)
    length, again_z = catenary.length_and_force_z(force_x / X, X, Z, EA, w)
    assert length == pytest.approx(L, rel=1e-13)
    assert again_z == pytest.approx(force_z, rel=1e-12)


def integrated_end(length, force_x, force_z, EA, w):
    """End of the cable by integrating its differential equation; shares no code with ours."""

    def slope(s, _):
        vertical = force_z - w * (length - s)
        tension = np.sqrt(force_x**2 + vertical**2)
        stretch = 1.0 + tension / EA
        return [force_x / tension * stretch, vertical / tension * stretch]

    answer = solve_ivp(slope, (0.0, length), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-12)
    return answer.y[:, -1]


@pytest.mark.parametrize(("X", "Z", "L", "EA", "w", "H", "V"), SUSPENDED)
def test_shape_agrees_with_integration_of_the_cable_equation(X, Z, L, EA, w, H, V) -> None:
    force_x, force_z = catenary.forces_from_length(L, X, Z, EA, w)
    assert integrated_end(L, force_x, force_z, EA, w) == pytest.approx([X, -Z], rel=1e-9)
    for share in (0.2, 0.7):
        # The part from the exit point to s is a cable that carries the weight of the rest.
        s = share * L
        part = integrated_end(s, force_x, force_z - w * (L - s), EA, w)
        assert catenary.position_m(s, L, force_x, force_z, EA, w) == pytest.approx(part, rel=1e-9)


def test_cable_with_a_point_load() -> None:
    """Isolated cable of Michalos and Birnstiel; figures of Jayaraman and Knudson (1981)."""
    span, w, EA = 304.8, 46.12, 131e9 * 5.484e-4
    lengths = np.array([125.84695, 186.85526])

    def pulls(node):
        x, z = node
        return catenary.forces_from_length(lengths, [x, span - x], [-z, -z], EA, w)

    def unbalanced(node, load):
        force_x, force_z = pulls(node)
        return [force_x[1] - force_x[0], -force_z.sum() - load]

    hanging = root(unbalanced, [120.0, -30.0], args=(0.0,), tol=1e-13).x
    loaded = root(unbalanced, hanging, args=(35586.0,), tol=1e-13).x
    assert hanging == pytest.approx([121.91997, -29.27588], abs=1e-4)
    assert pulls(hanging)[0][0] == pytest.approx(17796.7, rel=1e-5)
    assert loaded - hanging == pytest.approx([-0.85936, -5.62559], abs=2e-5)


CABLE = st.tuples(
    st.floats(0.01, 1e3),  # horizontal distance
    st.floats(-300.0, 300.0),  # drop
    st.one_of(st.floats(-1e-3, 1e-3), st.floats(0.0, 10.0)),  # excess of length over chord
    st.floats(1e5, 1e9),  # EA
    st.floats(0.1, 100.0),  # weight
)


@settings(max_examples=300)
@given(CABLE)
def test_forces_place_the_end_where_it_is(cable) -> None:
    X, D, excess, EA, w = cable
    length = np.hypot(X, D) * (1.0 + excess)
    force_x, force_z = catenary.forces_from_length(length, X, D, EA, w)
    x, z = catenary.end_position_m(length, force_x, force_z, EA, w)
    assert np.hypot(x - X, z + D) <= 1e-12 * max(length, np.hypot(X, D))


@settings(max_examples=300)
@given(CABLE, st.floats(-6.0, 6.0))
def test_length_places_the_end_where_it_is(cable, magnitude) -> None:
    X, D, _, EA, w = cable
    density = w * 10.0 ** max(magnitude, -1.2)
    if density * np.hypot(X, D) > 0.3 * EA:
        return  # stretched beyond any real cable
    length, force_z = catenary.length_and_force_z(density, X, D, EA, w)
    x, z = catenary.end_position_m(length, density * X, force_z, EA, w)
    assert np.hypot(x - X, z + D) <= 1e-10 * max(length, np.hypot(X, D))


def test_near_taut_inextensible_cable_follows_the_parabola() -> None:
    """For an excess e of length over a level chord X, H → w X / √(24 e)."""
    X, w = 100.0, 5.0
    excess = np.array([1e-6, 1e-8, 1e-10])
    force_x, _ = catenary.forces_from_length(X * (1 + excess), X, 0.0, np.inf, w)
    deviation = np.abs(force_x / (w * X / np.sqrt(24 * excess)) - 1)
    assert np.all(deviation < [1e-6, 1e-8, 1e-6])  # rounding of the length takes over at last


def test_vertical_cable_hangs_stretched_or_folded() -> None:
    EA, w = 1e6, 10.0
    # Longer than the drop: two branches hang from the ends, each with its own weight.
    force_x, force_z = catenary.forces_from_length(120.0, 0.0, 100.0, np.inf, w)
    assert force_x == 0.0
    assert force_z == pytest.approx(w * 10.0)
    # Shorter: V follows from Hooke's law with its own weight.
    pull = 2000.0
    drop = 100.0 * (1 + pull / EA) + w * 100.0**2 / (2 * EA)
    force_x, force_z = catenary.forces_from_length(100.0, 0.0, drop, EA, w)
    assert force_x == pytest.approx(0.0, abs=1e-9)
    assert -force_z == pytest.approx(pull, rel=1e-9)


def test_no_solution_is_nan() -> None:
    force_x, force_z = catenary.forces_from_length(99.0, 100.0, 0.0, np.inf, 1.0)
    assert np.isnan(force_x)
    assert np.isnan(force_z)
    assert np.isnan(catenary.length_and_force_z(-1.0, 100.0, 10.0, 1e6, 1.0)[0])


def test_batch_equals_loop() -> None:
    rng = np.random.default_rng(4)
    X, D = rng.uniform(1, 300, (2, 50))
    length = np.hypot(X, D) * rng.uniform(0.999, 2, 50)
    batch = catenary.forces_from_length(length, X, D, 1e7, 3.0)
    single = [catenary.forces_from_length(*one, 1e7, 3.0) for one in zip(length, X, D, strict=True)]
    assert np.array(single) == pytest.approx(np.array(batch).T, rel=1e-11)


def test_massless_is_the_limit_of_no_weight() -> None:
    """First order: halving the weight halves the difference of the vertical force."""
    X, D, density, EA = 80.0, 30.0, 400.0, 1e12
    weights = np.array([1.0, 0.5, 0.25])
    _, force_z = catenary.length_and_force_z(density, X, D, EA, weights)
    difference = force_z + density * D
    assert difference[:-1] / difference[1:] == pytest.approx(2.0, rel=2e-3)
