"""The grade files are sound, and agree with what the standard and physics say."""

from __future__ import annotations

import guy_strand
import pytest

from designer.grades.grade import Grade
from designer.grades.registry import read_grades


@pytest.fixture(scope="module")
def grades() -> dict[str, Grade]:
    (folder,) = guy_strand.register_grades()
    found, faults = read_grades(folder)
    assert faults == []
    return {one.grade.id: one.grade for one in found}


def test_there_are_two_grades_of_the_same_sizes(grades) -> None:
    high, extra_high = grades["astm-a475-7-wire-hs"], grades["astm-a475-7-wire-ehs"]
    for weak, strong in zip(high.sizes, extra_high.sizes, strict=True):
        assert weak.id == strong.id
        assert weak.linear_density_kg_per_m == strong.linear_density_kg_per_m
        assert 1.3 < strong.minimum_breaking_load_N / weak.minimum_breaking_load_N < 1.45


def test_a_quarter_inch_is_what_the_standard_says(grades) -> None:
    """ASTM A475, 1/4 in of seven wires: 4750 lbf High-Strength, 6650 lbf Extra High-Strength."""
    for name, load_lbf in (("hs", 4750.0), ("ehs", 6650.0)):
        sizes = {size.id: size for size in grades[f"astm-a475-7-wire-{name}"].sizes}
        load_N = sizes["1/4 in"].minimum_breaking_load_N
        assert load_N == pytest.approx(load_lbf * 4.4482216, rel=1e-4)


def test_mass_over_metallic_area_is_that_of_steel(grades) -> None:
    for grade in grades.values():
        for size in grade.sizes:
            assert size.metallic_area_m2 is not None
            density = size.linear_density_kg_per_m / size.metallic_area_m2
            assert density == pytest.approx(7850.0, rel=0.03)
