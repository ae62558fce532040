"""Charts: well-formed, self-contained, the same each time, and they say what they must."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from figures_cases import CASES, THREE, maps_of, pose_at, solved

from designer.analysis.maps import WorkspaceMaps
from designer.analysis.pose import analyse_pose
from designer.grades.registry import load_catalogue
from designer.model.region import Prism
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.report import format as fmt
from designer.report.figures import canvas
from designer.report.figures.charts_edge import edge_chart
from designer.report.figures.charts_pose import loop_chart, shown_turns
from designer.report.figures.charts_selection import candidates_chart, pareto_chart, rank
from designer.report.figures.charts_shares import (
    parts,
    served_chart,
    spread,
    usable_chart,
    verdict_chart,
)
from designer.report.figures.colours import (
    DIAMETER,
    TENSION,
    MapQuantity,
    steps_for,
    steps_over_decades,
)
from designer.report.figures.sections import slice_panels
from designer.selection.result import SelectionResult
from designer.selection.select import select
from designer.study import Selection

pytestmark = pytest.mark.slow


def slice_chart(maps: WorkspaceMaps, quantity: MapQuantity = DIAMETER) -> str:
    """One map alone."""
    return slice_panels(maps, (quantity,))


CHARTS: dict[str, Callable[[WorkspaceMaps], str | None]] = {
    "slice": slice_chart,
    "panels": slice_panels,
    "edge": edge_chart,
    "served": lambda maps: served_chart(maps.coverage),
}


def texts(svg: str) -> set[str]:
    """The texts of a chart: its glyphs are outlines, what they say is in its description."""
    root = ElementTree.fromstring(svg)
    words = root.findtext("{http://www.w3.org/2000/svg}desc")
    assert words is not None
    return set(words.split("; "))


def check(svg: str) -> None:
    """Well-formed, scalable, self-contained, no number missing, ids sound."""
    root = ElementTree.fromstring(svg)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert root.get("viewBox")
    assert root.get("width") is None
    assert "<style" not in svg
    assert root.get("role") == "img"
    assert root.get("aria-label")
    ids = re.findall(r'\bid="([^"]+)"', svg)
    assert len(ids) == len(set(ids))
    used = re.findall(r'(?:href="#|url\(#)([^")]+)', svg)
    assert set(used) <= set(ids)
    addresses = set(re.findall(r'https?://[^"\s]+', svg))
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    for path in re.findall(r' d="([^"]*)"', svg):
        assert "nan" not in path.lower()
        assert "inf" not in path.lower()


@pytest.mark.parametrize("chart", CHARTS)
@pytest.mark.parametrize("name", CASES)
def test_every_chart_of_every_case_is_sound(name: str, chart: str) -> None:
    svg = CHARTS[chart](maps_of(name))
    if svg is None:
        assert chart == "edge"
        assert maps_of(name).edge is None
    else:
        check(svg)


@pytest.mark.parametrize("chart", CHARTS)
def test_drawn_twice_it_is_the_same(chart: str) -> None:
    draw = CHARTS[chart]
    assert draw(maps_of("partly")) == draw(maps_of("partly"))


def test_charts_of_one_page_share_no_id() -> None:
    drawn = [svg for draw in CHARTS.values() if (svg := draw(maps_of("served")))]
    drawn.append(slice_chart(maps_of("served"), TENSION))
    ids = [name for svg in drawn for name in re.findall(r'\bid="([^"]+)"', svg)]
    assert len(ids) == len(set(ids))


class TestSlice:
    def test_served(self) -> None:
        found = texts(slice_chart(maps_of("served")))
        assert {"A1", "A2", "A3", "x [m]", "y [m]", "needed diameter [mm]"} <= found
        assert "top of the region, z = −40 m\n○ worst pose, 51.2 mm" in found
        assert "beyond: a cable hangs below the platform" in found
        assert "no finite cable" not in found

    def test_partly(self) -> None:
        found = texts(slice_chart(maps_of("partly")))
        assert "no finite cable" in found
        assert not any(text.startswith("worst pose") for text in found)

    def test_left_out(self) -> None:
        found = texts(slice_chart(maps_of("exclude")))
        assert "left out: a cable hangs below the platform" in found
        assert "top of the region, z = −40 m\n○ worst pose, 40.4 mm" in found

    def test_nothing_to_colour(self) -> None:
        assert any("no pose can be held" in t for t in texts(slice_chart(maps_of("unheld"))))
        assert any("all left out" in t for t in texts(slice_chart(maps_of("all_left_out"))))

    def test_points(self) -> None:
        found = texts(slice_chart(maps_of("points")))
        assert "all poses, seen from above\n○ worst pose, 46.6 mm" in found

    def test_panels(self) -> None:
        found = texts(slice_panels(maps_of("served")))
        marks = {text.partition("○ ")[2] for text in found}
        assert {"worst pose, 371.0 kN", "worst pose, 3.06"} <= marks
        assert "largest tension [kN]" in found

    def test_neighbours_share_a_name(self) -> None:
        assert {"A1, A2", "A3, A4", "A5, A6"} <= texts(slice_chart(maps_of("six")))


class TestEdge:
    def test_served(self) -> None:
        svg = edge_chart(maps_of("served"))
        assert svg is not None
        found = texts(svg)
        assert {"with sag", "massless", "worst pose, 51.2 mm"} <= found
        assert "no cable holds within 4.8 m" in found
        assert any(text.startswith("region ends, 10.4") for text in found)

    def test_left_out(self) -> None:
        svg = edge_chart(maps_of("exclude"))
        assert svg is not None
        assert "left out: a cable hangs below the platform" in texts(svg)


class TestCoverage:
    def test_served(self) -> None:
        found = texts(served_chart(maps_of("served").coverage))
        assert {"serves all: 51.2 mm", "massless: 29.3 mm", "with sag", "massless"} <= found

    def test_partly(self) -> None:
        served = maps_of("partly").coverage
        share = fmt.number(100.0 * served.unserved, 2)
        found = texts(served_chart(served))
        assert f"not served {share} %" in found
        assert not any(text.startswith("serves all") for text in found)

    @pytest.mark.parametrize("kind", ["served", "partly"])
    def test_shares_are_of_all_poses(self, kind: str) -> None:
        served = maps_of(kind).coverage
        for share in (served.share, served.massless_share):
            assert (np.diff(share) > 0.0).all()
            assert 0.0 < share[0] <= share[-1] <= 1.0
        assert served.share[-1] + served.unserved == pytest.approx(1.0)

    def test_where_neither_serves_all(self) -> None:
        served = replace(maps_of("partly").coverage, massless_needed_m=np.nan)
        nothing = np.empty(0)
        for one in (served, replace(served, diameter_m=nothing, share=nothing)):
            svg = served_chart(one)
            check(svg)
            assert "massless" in texts(svg)

    def test_all_left_out(self) -> None:
        assert "every pose is left out" in texts(served_chart(maps_of("all_left_out").coverage))


class TestLoop:
    def test_paper(self) -> None:
        pose = solved("served")[0].pose
        assert pose is not None
        svg = loop_chart(pose)
        check(svg)
        expected = {
            "massless 86.39 kN",
            "optimum 150.2 kN",
            "massless 24.72 mm",
            "optimum 32.60 mm",
        }
        assert expected <= texts(svg)

    def test_without_an_optimum_it_says_that_it_never_settles(self) -> None:
        pose = analyse_pose(pose_at("served", [250.0, 2.0, -50.0]))
        assert pose is not None
        svg = loop_chart(pose)
        check(svg)
        found = texts(svg)
        assert f"diverges, given up after {len(pose.loop.iterates) - 1} turns" in found
        assert not any("optimum" in text for text in found)

    def test_a_loop_that_runs_away_at_once_is_still_a_curve(self) -> None:
        pose = analyse_pose(pose_at("served", [250.0, 200.0, -1.0]))
        assert pose is not None
        assert len(shown_turns(pose)) == 3
        assert pose.loop.iterates[1].max_tension_N > 10.0 * pose.loop.iterates[0].max_tension_N
        check(loop_chart(pose))

    def test_slow_loop_still_shows_the_optimum(self) -> None:
        pose = analyse_pose(pose_at("served", [250.0, 4.85, -40.0]))
        assert pose is not None
        assert not pose.loop.has_converged
        svg = loop_chart(pose)
        check(svg)
        assert any(text.startswith("optimum") for text in texts(svg))

    def test_without_a_start_it_says_why(self) -> None:
        pose = analyse_pose(pose_at("served", [250.0, -20.0, -50.0]))
        assert pose is not None
        svg = loop_chart(pose)
        check(svg)
        assert any("has no start" in text for text in texts(svg))


class TestVerdicts:
    @pytest.mark.parametrize("name", CASES)
    def test_the_parts_are_the_whole(self, name: str) -> None:
        found = solved(name)[0].workspace
        assert found is not None
        assert sum(part.count for part in parts(found.census)) == found.census.samples
        check(verdict_chart(found.census))

    def test_labels(self) -> None:
        found = solved("partly")[0].workspace
        assert found is not None
        joined = " ".join(texts(verdict_chart(found.census)))
        assert "no finite cable" in joined
        assert "held, a cable hangs below" in joined
        share = 100.0 * found.census.fraction("no_finite_cable")
        assert f"{share:.1f} %, {found.census.statuses['no_finite_cable']}" in joined

    @pytest.mark.parametrize("starts", [[0.0, 0.5, 0.99], [0.0, 0.96, 0.98], [0.0, 0.01, 0.02]])
    def test_labels_do_not_overlap(self, starts: list[float]) -> None:
        labels = ["held\n53.4 %, 10 679", "no finite cable\n0.1 %", "not converged\n0.1 %"]
        places = spread(starts, labels)
        widths = [0.03 + 0.0098 * max(map(len, label.split("\n"))) for label in labels]
        ends = [place + width for place, width in zip(places, widths, strict=True)]
        assert places[0] >= 0.0
        assert ends[-1] <= 1.0 + 1e-12
        assert all(end <= after + 1e-12 for end, after in zip(ends, places[1:], strict=False))


@pytest.fixture(scope="module")
def selection() -> SelectionResult:
    workspace = Workspace(Prism.over(THREE.exit_points_m, 10.35, (-200.0, -40.0)), samples=200)
    wanted = (
        "gost-6x19s-iwrc-1960",
        "unirope-6x36-fc-1960",
        "unirope-7x19-galvanised",
        "unirope-6x19-iwrc-eips",
    )
    grades = load_catalogue((), with_plugins=False).grades
    chosen = Selection(grades=wanted, safety_factor=2.0)
    return select(THREE, workspace, chosen, grades)


class TestCandidates:
    def test_lightest_first_then_nearest(self, selection: SelectionResult) -> None:
        assert [outcome.grade.id for outcome in rank(selection.outcomes)] == [
            "gost-6x19s-iwrc-1960",
            "unirope-6x19-iwrc-eips",
            "unirope-6x36-fc-1960",
            "unirope-7x19-galvanised",
        ]

    def test_names_and_endings(self, selection: SelectionResult) -> None:
        svg = candidates_chart(selection)
        check(svg)
        assert selection.chosen is not None
        mass = f"{selection.chosen.total_mass_kg:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
        assert {f"20.5 mm, {mass} kg", "3/8 in insufficient", "20 mm insufficient"} <= texts(svg)

    def test_many_grades(self, selection: SelectionResult) -> None:
        copies = tuple(
            replace(outcome, grade=replace(outcome.grade, id=f"{outcome.grade.id}-{k}"))
            for k in range(20)
            for outcome in selection.outcomes
        )
        svg = candidates_chart(replace(selection, outcomes=copies))
        check(svg)
        found = texts(svg)
        assert "62 more grades are not shown" in found
        assert sum(text.startswith(("gost", "unirope")) for text in found) == 18

    def test_nothing_chosen_shows_what_would_hold(self, selection: SelectionResult) -> None:
        thin = tuple(o for o in selection.outcomes if o.best is None)
        fitting = tuple(o for o in selection.outcomes if o.best is not None)
        found = texts(
            candidates_chart(SelectionResult(thin, None, "every grade ends too thin", fitting))
        )
        assert "gost-6x19s-iwrc-1960 *" in found
        assert "unirope-7x19-galvanised" in found

    def test_no_section_holds(self, selection: SelectionResult) -> None:
        hopeless = tuple(
            replace(
                o,
                continuous_diameter_m=float("nan"),
                candidates=(),
                outcome="no_finite_cable",
                verdict=Verdict.NO_FINITE_CABLE,
                best=None,
            )
            for o in selection.outcomes
        )
        svg = candidates_chart(SelectionResult(hopeless, None, "none"))
        check(svg)
        assert "no section holds" in texts(svg)

    def test_no_grade_at_all(self) -> None:
        check(candidates_chart(SelectionResult((), None, "none")))


class TestPareto:
    def test_a_panel_for_each_other_objective(self, selection: SelectionResult) -> None:
        svg = pareto_chart(selection)
        assert svg is not None
        check(svg)
        assert {"drum diameter [m]", "largest tension [kN]", "mass of all cables [kg]"} <= texts(
            svg
        )

    def test_one_objective_has_nothing_to_be_drawn_over(self, selection: SelectionResult) -> None:
        assert pareto_chart(replace(selection, objectives=("mass",))) is None

    def test_nothing_holds(self, selection: SelectionResult) -> None:
        thin = tuple(o for o in selection.outcomes if o.best is None)
        assert pareto_chart(replace(selection, outcomes=thin, chosen=None)) is None


class TestUsable:
    def test_chosen_size_is_marked(self, selection: SelectionResult) -> None:
        assert selection.usable is not None
        svg = usable_chart(selection.usable, selection.chosen)
        check(svg)
        assert {"chosen", "20.5 mm"} <= texts(svg)

    def test_nothing_chosen(self, selection: SelectionResult) -> None:
        assert selection.usable is not None
        svg = usable_chart(selection.usable, None)
        check(svg)
        assert "chosen" not in texts(svg)

    def test_one_size(self, selection: SelectionResult) -> None:
        assert selection.usable is not None
        check(usable_chart(replace(selection.usable, sizes=selection.usable.sizes[-1:]), None))


class TestSteps:
    @pytest.mark.parametrize("factor", [1e-3, 0.37, 1.0, 1234.5])
    def test_round_and_around_all_values(self, factor: float) -> None:
        values = factor * np.linspace(2.0, 5.0, 100)
        steps = steps_for(values)
        assert steps is not None
        assert steps.levels[0] <= values.min()
        assert steps.levels[-1] >= values.max()
        assert steps.extend == "neither"
        assert 5 <= len(steps.levels) <= 15
        width = np.diff(steps.levels)
        assert width == pytest.approx(width[0])
        mantissa = width[0] / 10.0 ** np.floor(np.log10(width[0] * (1 + 1e-9)))
        assert min(abs(mantissa - m) for m in (1.0, 2.0, 2.5, 5.0)) < 1e-6
        assert set(steps.ticks) <= set(steps.levels)
        assert len(steps.levels) == steps.colormap.N + 1

    def test_a_few_huge_values_do_not_flatten_the_rest(self) -> None:
        values = np.append(np.linspace(20.0, 50.0, 1000), [500.0, 9000.0])
        steps = steps_for(values)
        assert steps is not None
        assert steps.extend == "max"
        assert 50.0 <= steps.levels[-1] < 150.0
        assert len(steps.edges) == len(steps.levels) + 1 == steps.colormap.N + 1

    def test_no_value_no_steps(self) -> None:
        assert steps_for(np.array([np.nan, np.inf])) is None

    def test_a_single_value(self) -> None:
        steps = steps_for(np.array([29.5, np.nan]))
        assert steps is not None
        assert steps.levels[0] < 29.5 < steps.levels[-1]


class TestStepsOverDecades:
    def test_each_decade_has_its_steps(self) -> None:
        steps = steps_over_decades(np.geomspace(22.0, 1600.0, 500))
        assert steps is not None
        assert steps.levels == pytest.approx([20, 50, 100, 200, 500, 1000, 2000])
        assert steps.extend == "neither"

    def test_what_lies_above_the_bulk_is_above_the_scale(self) -> None:
        steps = steps_over_decades(np.append(np.geomspace(2.0, 90.0, 500), [1e5]))
        assert steps is not None
        assert steps.levels[-1] == pytest.approx(100.0)
        assert steps.extend == "max"

    @pytest.mark.parametrize("low", [-1.0, 0.0, 30.0])
    def test_else_the_steps_are_even(self, low: float) -> None:
        values = np.linspace(low, 100.0, 200)
        found, even = steps_over_decades(values), steps_for(values)
        assert found is not None
        assert even is not None
        assert found.levels == pytest.approx(even.levels)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (51.2303, "51.23"),
        (371.03, "371.0"),
        (13525.4, "13 525"),
        (0.36281, "0.3628"),
        (-40.0, "−40.00"),
    ],
)
def test_significant_digits(value: float, text: str) -> None:
    assert canvas.significant(value) == text.replace(" ", "\N{NARROW NO-BREAK SPACE}")


def test_short_numbers() -> None:
    assert fmt.trimmed(-40.0, 6) == "−40"
    assert fmt.trimmed(86240.0, 6) == "86\N{NARROW NO-BREAK SPACE}240"
    assert canvas.decimals([0.5, 1.0, 1.25]) == 2
    assert canvas.decimals([10.0, 20.0]) == 0
