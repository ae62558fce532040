"""Nested layers of the region: each size serves its own and those of all thinner ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from figures_cases import STEEL, THREE, maps_of, solved
from report_parts import caption

from designer.analysis.maps import chosen_sizes, layers_of
from designer.arrays import FloatArray
from designer.grades.grade import Grade, Modulus, Reference, Size
from designer.model.robot import Poses
from designer.report.figures.scenes import colours, usable_scene
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX
from designer.selection.result import SizeCoverage, usable
from designer.sizing.newton import size_poses

pytestmark = pytest.mark.slow

SIZES_MM = [10.0, 20.0, 24.0, 28.0, 32.0, 36.0, 40.0, 60.0]


def steel_grade() -> Grade:
    """The configured family in sizes, so that served is where the family needs no more."""
    sizes = []
    for d in SIZES_MM:
        member = STEEL.cable(d / 1e3)
        load = 2.0 * member.allowable_tension_N
        sizes.append(Size(f"{d:g} mm", d / 1e3, load, member.linear_density_kg_per_m))
    modulus = Modulus(STEEL.youngs_modulus_Pa, "nominal", "printed", "by law", 0.1)
    source = Reference("a", "b")
    return Grade(
        id="steel",
        manufacturer="m",
        product="p",
        construction="rod",
        core="-",
        finish="-",
        sizes=tuple(sizes),
        source=source,
        trust="A",
        modulus=modulus,
    )


def usable_of(case: str) -> SizeCoverage:
    workspace = solved(case)[0].study.workspace
    assert workspace is not None
    grade = steel_grade()
    return usable(THREE, workspace, grade, [(s, grade.cable(s, 2.0)) for s in grade.sizes])


def served(positions: FloatArray, diameter_m: float) -> FloatArray:
    return size_poses(THREE, Poses.at(positions), STEEL).diameter_m <= diameter_m


def test_sizes_are_spread_over_what_they_serve() -> None:
    found = usable_of("served")
    shown = chosen_sizes(found)
    assert 2 <= len(shown) <= 5
    fractions = [one.fraction for one in shown]
    assert fractions == sorted(fractions)
    assert fractions[0] > 0.0
    assert fractions[-1] == 1.0
    assert all(fraction < 1.0 for fraction in fractions[:-1])
    assert len(colours_of("served")) == len(shown)


def colours_of(case: str) -> list[tuple[float, ...]]:
    layers = layers_of(maps_of(case), usable_of(case))
    assert layers is not None
    return colours(layers)


def test_layers_are_where_the_family_needs_no_more() -> None:
    layers = layers_of(maps_of("served"), usable_of("served"))
    assert layers is not None
    for one, used in zip(layers.sizes, layers.utilisation, strict=True):
        expected = served(layers.position_m, one.size.diameter_m)
        at_edge = np.isclose(used, 1.0, rtol=1e-6)
        assert np.array_equal((used <= 1.0)[~at_edge], expected[~at_edge])
    for thin, thick in zip(layers.utilisation, layers.utilisation[1:], strict=False):
        assert np.all(thick[thin <= 1.0] <= 1.0)


@pytest.mark.parametrize("case", ["served", "partly", "exclude", "box"])
def test_picture_has_its_size(case: str) -> None:
    image = usable_scene(maps_of(case), usable_of(case))
    assert image is not None
    assert image.shape == (HEIGHT_PX, WIDTH_PX, 3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 20


def test_a_size_that_leaves_nothing_to_those_after_it_is_drawn() -> None:
    found = usable_of("served")
    thickest = replace(found.sizes[-1], fraction=0.9)  # of samples; in the picture it serves all
    odd = replace(found, sizes=(thickest, replace(found.sizes[-2], fraction=0.5), found.sizes[-3]))
    assert usable_scene(maps_of("served"), odd) is not None


def test_points_have_no_layers() -> None:
    assert usable_scene(maps_of("points"), usable_of("points")) is None


def test_sizes_that_are_not_nested_are_said_to_be() -> None:
    found = usable_of("served")
    first, *rest = found.sizes
    weak = replace(rest[0], lost_fraction=0.1)
    odd = replace(found, sizes=(first, weak, *rest[1:]))
    assert "those of all thinner ones" in caption("layers", found)
    assert "the thinnest of them that serves there" in caption("layers", odd)
    assert "those of all thinner ones" not in caption("layers", odd)
    mixed = replace(found, sizes=(*found.sizes[:-1], replace(found.sizes[-1], fraction=0.5)))
    shown = chosen_sizes(mixed)
    diameters = [one.size.diameter_m for one in shown]
    assert diameters == sorted(diameters)
