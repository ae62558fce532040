"""What the figures show: grids on regions, sizing on them, the way to the edge, shares."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from altered import altered
from figures_cases import CASES, SIX, STEEL, THREE, inset, maps_of, pose_at, solved, study_of
from report_parts import caption

from designer.analysis.maps import (
    RegionField,
    as_built,
    cable_curves_m,
    chords_m,
    edge_profile,
    field_at,
    first_failure_m,
    largest_sag,
    workspace_maps,
)
from designer.analysis.pose import analyse_pose
from designer.io.config import read_study
from designer.model import polygon
from designer.model.polygon import outline_m
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.report.figures.canvas import names_of
from designer.report.figures.colours import DIAMETER, RATIO, TENSION, tension_of
from designer.resources import example_file
from designer.sizing.newton import limit_ratio, size_poses
from designer.statics.inverse import sag_m
from designer.study import DeclaredEffect

pytestmark = pytest.mark.slow

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])


def area_m2(grid_m: np.ndarray) -> float:
    """Area of a grid of quadrilaterals (n, m, 3) in plan."""
    first = (grid_m[1:, 1:] - grid_m[:-1, :-1])[..., :2]
    second = (grid_m[:-1, 1:] - grid_m[1:, :-1])[..., :2]
    return float(np.abs(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]).sum() / 2)


class TestGrids:
    def test_centroid_of_a_triangle_is_the_mean_of_its_corners(self) -> None:
        corners = np.array([[0.0, 0.0], [6.0, 0.0], [0.0, 3.0]]) + 1e6
        assert polygon.centroid_m(corners) == pytest.approx(corners.mean(axis=0), abs=1e-9)

    def test_centroid_does_not_care_for_extra_corners_on_an_edge(self) -> None:
        more = np.insert(SQUARE, 1, [1.0, 0.0], axis=0)
        assert polygon.centroid_m(more) == pytest.approx([2.0, 2.0])

    @pytest.mark.parametrize(
        ("azimuth", "reach"), [(0.0, 3.0), (np.pi / 2, 2.0), (np.pi, 1.0), (np.pi / 4, 8**0.5)]
    )
    def test_reach_within_a_square(self, azimuth: float, reach: float) -> None:
        assert polygon.reach_m(SQUARE, np.array([1.0, 2.0]), azimuth) == pytest.approx(reach)

    def test_outline_is_closed_and_has_every_corner(self) -> None:
        outline = outline_m(SQUARE, 30)
        assert (outline[0] == outline[-1]).all()
        for corner in SQUARE:
            assert np.linalg.norm(outline - corner, axis=1).min() == 0.0
        assert np.linalg.norm(np.diff(outline, axis=0), axis=1).sum() == pytest.approx(16.0)

    def test_disc_fills_the_region_to_its_boundary(self) -> None:
        region = inset(10.35)
        disc = region.section_m(1.0, rings=40, spokes=60)
        assert region.contains(disc).all()
        assert area_m2(disc) == pytest.approx(region.area_m2, rel=1e-9)
        assert np.ptp(disc[0], axis=0).max() == 0.0
        assert (disc[..., 2] == -40.0).all()

    def test_one_cut_runs_through_the_pose_it_is_given(self) -> None:
        region, toward = inset(10.35), np.array([256.5, 10.35, -40.0])
        cut = region.cutaway_m(toward)["cut"]
        assert np.linalg.norm(cut - toward, axis=-1).min() == pytest.approx(0.0, abs=1e-9)

    @pytest.mark.parametrize("azimuth", np.radians([-170.0, -90.0, 0.0, 59.9, 60.0, 123.0]))
    def test_a_piece_is_missing_and_nothing_else(self, azimuth: float) -> None:
        region = Prism.box((0.0, 4.0), (0.0, 4.0), (0.0, 1.0))
        centre = np.array([2.0, 2.0])
        toward = centre + 0.5 * np.array([np.cos(azimuth), np.sin(azimuth)])
        top = region.cutaway_m(toward)["top"]
        ends = azimuth, azimuth + np.radians(100.0)
        corners = [a for a in np.radians([45, 135, -135, -45, 225, 315]) if ends[0] < a < ends[1]]
        rays = [
            polygon.reach_m(region.polygon_m, centre, a) * np.array([np.cos(a), np.sin(a)])
            for a in sorted({*ends, *corners})
        ]
        missing = sum(abs(a[0] * b[1] - a[1] * b[0]) / 2 for a, b in pairwise(rays))
        assert area_m2(top) == pytest.approx(16.0 - missing, rel=1e-9)
        wall = region.cutaway_m(toward)["wall"]
        assert wall[0, 0, :2] - centre == pytest.approx(rays[0])
        assert wall[0, -1, :2] - centre == pytest.approx(rays[-1])
        middle = region.opening_azimuth_rad(toward)
        off = np.arctan2(*(wall[0, :, :2] - centre)[:, ::-1].T) - middle
        assert np.cos(off).max() == pytest.approx(np.cos(np.radians(50.0)), abs=1e-9)


class TestField:
    # Along (250, y, -40) of the paper's robot: y, tension [kN], diameter [mm], massless [kN].
    REFERENCE = (
        (40.0, 265.779, 43.359, 114.111),
        (20.0, 306.447, 46.558, 118.818),
        (10.0, 376.520, 51.608, 121.411),
        (8.0, 438.994, 55.725, 121.951),
        (6.0, 711.721, 70.953, 122.498),
    )

    @pytest.mark.parametrize(("y", "tension", "diameter", "massless"), REFERENCE)
    def test_reference_values(
        self, y: float, tension: float, diameter: float, massless: float
    ) -> None:
        field = field_at(study_of("served"), np.array([250.0, y, -40.0]))
        assert TENSION.of(field) == pytest.approx(tension, abs=6e-4)
        assert DIAMETER.of(field) == pytest.approx(diameter, abs=6e-4)
        assert RATIO.of(field) == pytest.approx(tension / massless, rel=2e-5)
        assert not field.is_infeasible
        assert not field.is_left_out

    def test_no_value_beyond_the_limit(self) -> None:
        field = field_at(study_of("served"), np.array([[250.0, 3.0, -40.0], [250.0, -9.0, -40.0]]))
        assert np.isnan(DIAMETER.of(field)).all()
        assert field.is_infeasible.all()
        assert field.why_infeasible == "no cable holds the platform"
        assert (
            field_at(study_of("served"), field.position_m[:1]).why_infeasible == "no finite cable"
        )

    @pytest.mark.parametrize("name", ["exclude", "partly_exclude"])
    def test_left_out_is_where_the_uplift_is(self, name: str) -> None:
        section = maps_of(name).section
        assert section.is_left_out.any()
        assert not (section.is_left_out & section.is_infeasible).any()
        held = section.is_solved
        assert ((section.uplift > 0.0) == section.is_left_out)[held].all()
        assert np.isnan(DIAMETER.of(section)[section.is_left_out]).all()
        assert np.isfinite(DIAMETER.everywhere(section)[held]).all()

    def test_thinning_keeps_the_rim(self) -> None:
        top = maps_of("served").shell["top"]
        thin = top.every_second()
        assert thin.diameter_m[-1, -1] == top.diameter_m[-1, -1]
        assert thin.diameter_m.shape == (top.diameter_m.shape[0] // 2 + 1, *thin.verdict.shape[1:])
        assert thin.position_m.shape == (*thin.verdict.shape, 3)
        assert maps_of("served").thinned().shell["top"].verdict.shape == thin.verdict.shape


class TestCables:
    @pytest.mark.parametrize("name", ["served", "six"])
    def test_true_shape_joins_exit_points_and_platform(self, name: str) -> None:
        analysis, _ = solved(name)
        assert analysis.pose is not None
        statics = analysis.pose.sizing.statics
        curves, chords = cable_curves_m(statics), chords_m(statics)
        assert curves[:, 0] == pytest.approx(statics.robot.exit_points_m, abs=1e-9)
        assert curves[:, -1] == pytest.approx(chords[:, 1], abs=1e-6)
        strain = statics.largest_tension_N / statics.axial_stiffness_N
        arc = np.linalg.norm(np.diff(cable_curves_m(statics, 4001), axis=1), axis=2).sum(axis=1)
        assert (arc >= statics.length_m * (1 - 1e-7)).all()
        assert (arc <= statics.length_m * (1.0 + strain)).all()

    def test_largest_sag_is_that_of_a_parabola_where_it_is_small(self) -> None:
        statics = size_poses(THREE, Poses.at([250.0, 200.0, -120.0]), STEEL).statics
        sag = largest_sag(statics)
        geometry = statics.geometry()
        span, chord = geometry.horizontal_distance_m[sag.cable], geometry.chord_m[sag.cable]
        along = np.subtract.reduce(chords_m(statics)[sag.cable])
        # Of the weight per chord the part across it, w X / l, over the pull along it, H l / X.
        parabola = statics.weight_N_per_m[0] * span**2 / (8.0 * statics.force_x_N[sag.cable])
        assert sag.depth_m == pytest.approx(parabola, rel=2e-2)
        assert sag.depth_m == pytest.approx(sag_m(statics).max(), rel=1e-5)
        assert (sag.on_cable_m - sag.on_chord_m) @ along == pytest.approx(0.0, abs=1e-9 * chord**2)

    def test_tilted_base_keeps_the_cables_on_its_exit_points(self) -> None:
        tilted = replace(THREE, tilt_rad=np.array([0.02, -0.01]))
        statics = size_poses(tilted, Poses.at([250.0, 200.0, -50.0]), STEEL).statics
        curves = cable_curves_m(statics)
        assert curves[:, 0] == pytest.approx(THREE.exit_points_m, abs=1e-9)
        assert curves[:, -1] == pytest.approx(np.tile([250.0, 200.0, -50.0], (3, 1)), abs=1e-6)

    def test_names_are_joined_where_exit_points_are_close(self) -> None:
        assert [name for name, _ in names_of(SIX.exit_points_m, 20.0)] == [
            "A1, A2",
            "A3, A4",
            "A5, A6",
        ]
        assert len(names_of(SIX.exit_points_m, 1.0)) == 6


class TestEdge:
    def test_limit_is_where_the_limit_ratio_is_one(self) -> None:
        study = study_of("served")
        profile = edge_profile(study, np.array([250.0, 10.35, -40.0]))
        assert profile is not None
        assert profile.limit_distance_m is not None
        assert 4.0 < profile.limit_distance_m < 5.0
        at = Poses.at([250.0, profile.limit_distance_m, -40.0])
        assert float(limit_ratio(THREE, at, STEEL)) == pytest.approx(1.0, abs=1e-6)

    def test_line_is_level_and_ends_on_the_hull(self) -> None:
        profile = maps_of("served").edge
        assert profile is not None
        line = profile.field.position_m
        assert np.ptp(line[:, 2]) == 0.0
        assert line[-1, 1] == pytest.approx(0.0, abs=1e-9)
        assert (np.diff(profile.distance_m) < 0.0).all()
        steps = np.linalg.norm(line - line[-1], axis=1)
        assert steps == pytest.approx(profile.distance_m, abs=1e-9)

    def test_worst_pose_is_where_the_region_ends(self) -> None:
        profile = maps_of("served").edge
        assert profile is not None
        assert profile.region_distance_m == pytest.approx(profile.focus_distance_m, abs=1e-9)
        assert profile.region_distance_m == pytest.approx(10.35, abs=0.05)

    def test_focus_in_the_centre_goes_to_the_nearest_edge(self) -> None:
        profile = edge_profile(study_of("served"), np.array([250.0, 433.01 / 3.0, -60.0]))
        assert profile is not None
        assert profile.distance_m[0] == pytest.approx(433.01 / 3.0, rel=1e-4)

    def test_none_where_the_region_lies_outside(self) -> None:
        assert maps_of("outside").edge is None

    def test_no_limit_where_nothing_can_be_held(self) -> None:
        profile = edge_profile(study_of("served"), np.array([250.0, 10.35, 5.0]))
        assert profile is not None
        assert not profile.field.is_solved.any()
        assert profile.limit_distance_m is None

    def test_limit_is_the_first_failure_on_the_way_out(self) -> None:
        """Farther out poses are held again, twice."""
        profile = maps_of("served").edge
        assert profile is not None

        def at(distance_m: np.ndarray) -> RegionField:
            lost = (distance_m < 0.1) | ((distance_m > 0.2) & (distance_m < 0.3211))
            verdict = np.where(lost, np.int8(Verdict.OUTSIDE_HULL), np.int8(Verdict.SOLVED))
            blank = np.zeros(len(distance_m))
            return RegionField(
                np.zeros((len(distance_m), 3)), *[blank] * 5, verdict, np.zeros(len(lost), bool)
            )

        distance = np.linspace(1.0, 0.0, 101)
        limit = first_failure_m(at, distance, at(distance), lambda some: some.is_solved)
        assert limit == pytest.approx(0.3211, abs=1e-7)
        again = replace(profile, distance_m=distance, field=at(distance), limit_distance_m=limit)
        assert again.holds_again
        outer, inner = again.stretches_not_held_m
        assert outer == pytest.approx((0.3211, 0.2), abs=0.011)
        assert inner == pytest.approx((0.1, 0.0), abs=0.011)

    def test_where_straight_cables_end_is_told_apart_from_where_all_cables_do(self) -> None:
        """With cables to spare both are one; a sagging cable of others may hold further out."""
        study = read_study(example_file("falcon"))
        assert study.workspace is not None
        low, high = study.workspace.region.bounds_m
        profile = edge_profile(study, np.array([low[0], high[1], low[2]]))
        assert profile is not None and profile.straight_distance_m is not None
        assert profile.straight_distance_m == pytest.approx(0.32, abs=0.01)
        assert profile.limit_distance_m == pytest.approx(profile.straight_distance_m, abs=1e-3)
        assert "counterweight" not in caption("edge", profile)
        text = caption("edge", replace(profile, limit_distance_m=0.05))
        assert "within 0.3" in text and "counterweight" in text

    def test_only_a_proof_is_called_impossible(self) -> None:
        profile = maps_of("served").edge
        assert profile is not None
        assert profile.is_proved and not profile.holds_again
        assert "no cable holds, however thick" in caption("edge", profile)
        verdict = profile.field.verdict.copy()
        verdict[-1] = Verdict.NOT_CONVERGED
        unsure = replace(profile, field=replace(profile.field, verdict=verdict))
        assert not unsure.is_proved
        text = caption("edge", unsure)
        assert "no cable was found that holds" in text


class TestServed:
    def test_all_is_served_by_the_optimum(self) -> None:
        served = maps_of("served").coverage
        assert served.share[-1] == served.massless_share[-1] == 1.0
        assert served.unserved == 0.0
        assert (np.diff(served.share) > 0.0).all()
        assert (np.diff(served.diameter_m) >= 0.0).all()
        assert served.diameter_m[-1] <= served.needed_m == pytest.approx(51.230e-3, abs=1e-6)
        assert served.massless_needed_m == pytest.approx(29.304e-3, abs=1e-6)

    def test_share_that_no_cable_serves_is_that_of_the_census(self) -> None:
        analysis, maps = solved("partly")
        assert analysis.workspace is not None
        fraction = analysis.workspace.census.fraction("no_finite_cable")
        assert 0.02 < fraction < 0.06
        assert maps.coverage.unserved == pytest.approx(fraction)
        assert maps.coverage.share[-1] == pytest.approx(1.0 - fraction)
        assert np.isnan(maps.coverage.needed_m)

    def test_only_what_is_not_left_out_counts(self) -> None:
        analysis, maps = solved("exclude")
        assert analysis.workspace is not None
        census = analysis.workspace.census
        assert maps.coverage.samples == census.samples - census.excluded
        assert maps.coverage.share[-1] == 1.0
        assert maps_of("all_left_out").coverage.samples == 0


class TestMaps:
    @pytest.mark.parametrize("name", CASES)
    def test_every_position_has_a_verdict_and_its_value(self, name: str) -> None:
        maps = maps_of(name)
        fields = [maps.section, *maps.shell.values()]
        for field in fields:
            solved_here = field.verdict == Verdict.SOLVED
            assert (np.isfinite(field.diameter_m) == solved_here).all()
            assert (field.counts | field.is_left_out | field.is_infeasible).all()
        assert maps.has_area == isinstance(maps.region, Prism)

    @pytest.mark.parametrize(
        ("name", "label"),
        [
            ("served", "worst pose"),
            ("exclude", "worst pose"),
            ("partly", "no finite cable, for example here"),
            ("found_by_search", "no finite cable, for example here"),
            ("outside", "no taut cables hold it, for example here"),
            ("all_left_out", "left out"),
        ],
    )
    def test_what_the_figures_turn_to(self, name: str, label: str) -> None:
        focus = maps_of(name).focus
        assert focus.label == label
        assert (focus.statics is None) == (not focus.field.is_solved)

    def test_text_of_the_worst_pose(self) -> None:
        focus = maps_of("served").focus
        assert DIAMETER.text_of(focus) == "worst pose, 51.2 mm"
        assert TENSION.text_of(focus) == "worst pose, 371.0 kN"
        assert RATIO.text_of(focus) == "worst pose, 3.06"

    def test_forces_below_a_kilonewton_are_shown_in_newtons(self) -> None:
        field = maps_of("served").section
        assert tension_of(field) == TENSION
        light = replace(field, tension_N=1e-4 * field.tension_N)
        assert tension_of(light).label == "largest tension [N]"
        assert tension_of(light).of(light) == pytest.approx(0.1 * TENSION.of(field), nan_ok=True)

    def test_section_is_the_top(self) -> None:
        section = maps_of("served").section
        assert (section.position_m[..., 2] == -40.0).all()
        assert np.nanmax(section.diameter_m) == pytest.approx(51.230e-3, rel=1e-4)

    def test_declared_effects_act(self) -> None:
        heavy = (DeclaredEffect("linear_mass", None, {"scale": 1.5}),)
        study = replace(study_of("served"), effects=heavy)
        built = as_built(study)
        assert built.material.density_kg_per_m3 == pytest.approx(1.5 * 7800.0)
        assert as_built(built).material == built.material
        pose = analyse_pose(study)
        assert pose is not None
        field = field_at(built, np.array([250.0, 200.0, -50.0]))
        assert field.diameter_m == pytest.approx(float(pose.sizing.diameter_m), rel=1e-12)

    def test_a_study_without_a_workspace_has_no_maps(self) -> None:
        analysis, _ = solved("served")
        with pytest.raises(ValueError, match="no workspace"):
            workspace_maps(altered(analysis, workspace=None))

    def test_unsolved_pose_keeps_its_chords(self) -> None:
        pose = analyse_pose(pose_at("served", [250.0, -20.0, -50.0]))
        assert pose is not None
        assert chords_m(pose.sizing.statics).shape == (3, 2, 3)
        assert np.isfinite(chords_m(pose.sizing.statics)).all()
