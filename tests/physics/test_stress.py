"""The stress suite on few cables and poses, and that it finds what is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks import stress
from exact_catenary import EPS, forces, length_and_force, pose

from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.statics.inverse import solve_sagging


def test_the_reference_meets_what_is_known() -> None:
    """Span 400, rise 200, length 500 m, of the closed form in 40 digits."""
    found = forces((43000.0, 22000.0), 500, 400, 200, 7.51e12, 200)
    assert found.values == pytest.approx([43694.6046221, 500 * 200 - 77634.4105458], rel=1e-11)
    back = length_and_force((499.0, 22000.0), (found.values[0],), 400, 200, 7.51e12, 200)
    assert back.values == pytest.approx([500.0, found.values[1]], rel=1e-14)


def test_one_rounding_moves_a_taut_cable_far(steel) -> None:
    slack = forces((43000.0, 22000.0), 500, 400, 200, 7.51e12, 200)
    assert (slack.moves / np.abs(slack.values)).max() < 20
    taut = forces((71116.8, -75567.0), 360.62566262396927, 246.22420940032947, 263.55766330843164,
                  7e8, 3.08735)  # fmt: skip
    assert (taut.moves / np.abs(taut.values)).max() > 1e3


def test_the_reference_balances_the_papers_pose(fast_robot) -> None:
    cable = stress.Cable(0.0326, 6.5, 1.67e8, 1e6)
    place = Poses.at([[250.0, 200.0, -50.0]])
    statics = solve_sagging(fast_robot, place, cable)
    start = np.stack([statics.length_m, statics.force_x_N, statics.force_z_N], axis=-1)[0]
    ends = place.position_m.repeat(3, axis=0)
    load = 9.81 * fast_robot.platform.mass_kg
    w = float(statics.weight_N_per_m.flat[0])
    found = pose(1.01 * start.ravel(), fast_robot.exit_points_m, ends, None, load, 1.67e8, w)
    assert found.values.reshape(3, 3) == pytest.approx(start, rel=1e-12)


def test_what_is_off_is_found() -> None:
    tally = stress.Tally("planted")
    tally.hold_error(2e-9, 1.0, "a cable")
    tally.hold_residual(np.array([1e-12, 2e-9]), np.array([True, True]))
    assert len(tally.faults) == 2
    tally = stress.Tally("planted")
    tally.hold_error(5e-10, 1.0, "")
    tally.hold_error(2e-9, 1e-8 / EPS, "a taut cable")
    tally.hold_residual(np.array([1e-12, np.nan]), np.array([True, False]))
    assert not tally.faults
    assert (tally.excused, tally.unsolved, tally.error) == (1, 1, 5e-10)


def test_draws_span_what_they_should() -> None:
    (X, D, EA, w, _), sag = stress.draw(20_000, np.random.default_rng(1))
    for value in (EA, w, sag, np.abs(D) / X):
        assert np.ptp(np.log10(value)) > 9.0


@pytest.mark.slow
def test_nothing_solved_is_wrong(monkeypatch) -> None:
    verdicts: list[np.ndarray] = []

    def solve(*args):
        statics = solve_sagging(*args)
        verdicts.append(statics.verdict)
        return statics

    monkeypatch.setattr(stress, "solve_sagging", solve)
    rng = np.random.default_rng(5)
    tallies = list(stress.try_cables(20_000, 100, rng))
    for n, exact in ((3, 2), (6, 1), (8, 0)):
        verdicts.clear()
        tallies.append(stress.try_poses(n, 5, 200, exact, rng))
        unproved = sum(not Verdict(int(v)).is_proved for v in np.concatenate(verdicts))
        assert unproved < 0.05 * tallies[-1].tried
    tallies += [stress.try_sizes(n, 5, 200, rng) for n in (3, 6)]
    for tally in tallies:
        assert not tally.faults
        assert tally.tried >= 1000
    for tally in tallies[:-4]:
        assert tally.unsolved < 0.1 * tally.tried
    # Many random ropes are too heavy to be taut, or bear no finite cable.
    for tally in tallies[-4:]:
        assert tally.unsolved < 0.7 * tally.tried
    for to_length in tallies[:2]:
        assert to_length.unsolved == 0
        assert to_length.compared >= 100
