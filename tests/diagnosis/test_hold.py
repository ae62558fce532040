"""What is taken back of a finding."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from designer.diagnosis.hold import Reason, _no_step
from designer.diagnosis.statistics import orthonormal
from designer.diagnosis.structure import Carrier


def test_a_basis_spans_all_columns_whatever_their_sizes() -> None:
    rng = np.random.default_rng(20261125)
    columns = rng.normal(size=(40, 5)) * 10.0 ** np.array([-9.0, -4.0, 0.0, 4.0, 9.0])
    basis = orthonormal(np.column_stack([columns, 3.0 * columns[:, 0], np.zeros(40)]))
    assert basis.shape == (40, 5)
    assert basis.T @ basis == pytest.approx(np.eye(5), abs=1e-12)
    scaled = columns / np.linalg.norm(columns, axis=0)
    assert basis @ (basis.T @ scaled) == pytest.approx(scaled, abs=1e-9)


@pytest.mark.parametrize(
    ("carriers", "is_withdrawn"),
    [((), False), (("x_m",), False), (("row",), True), (("x_m", "row"), True)],
)
def test_what_begins_at_a_time_is_taken_back_where_the_rest_goes_with_time(
    carriers: tuple[str, ...], is_withdrawn: bool
) -> None:
    steps = SimpleNamespace(key="load_step", starts_from=lambda *_: [], needs={"time"})
    lasting = SimpleNamespace(key="creep", starts_from=None, needs={"time"})
    present = tuple(Carrier(name, 0.5, 1e-6) for name in carriers)
    for effects, counts in (((lasting, steps), is_withdrawn), ((lasting,), False)):
        outcome: Any = SimpleNamespace(found=effects, structure=SimpleNamespace(present=present))
        withdrawn = _no_step(outcome)
        assert (withdrawn is not None) == counts
        if withdrawn is not None:
            assert (withdrawn.effect, withdrawn.reason) == ("load_step", Reason.NO_STEP)
