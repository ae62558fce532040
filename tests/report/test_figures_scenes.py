"""Scenes: where things land in the picture, what is on the stage, and the pictures themselves."""

from __future__ import annotations

import base64
import io
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from figures_cases import CASES, SIX, THREE, maps_of, pose_at, solved

from designer.analysis.maps import RegionField, WorkspaceMaps
from designer.analysis.pose import analyse_pose
from designer.errors import MissingLibraryError
from designer.model.region import Prism
from designer.report.figures import opengl, overlay, palette, parts, stage
from designer.report.figures.colours import DIAMETER, RATIO, TENSION
from designer.report.figures.interactive import workspace_scene_html
from designer.report.figures.scenes import (
    bounds_m,
    edges_m,
    robot_scene,
    scale_of,
    view_of,
    workspace_scene,
)
from designer.report.figures.view import (
    HEIGHT_PX,
    WIDTH_PX,
    View,
    clear_azimuth_rad,
    fitting,
)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="session")
def graphics() -> None:
    """Skip where this machine cannot draw."""
    missing = opengl.why_no_scenes()
    if missing:
        pytest.skip(missing)


def rgb(colour: str) -> tuple[int, int, int]:
    """Return ``#rrggbb`` as three bytes."""
    return tuple(bytes.fromhex(colour[1:]))  # type: ignore[return-value]


def count(image: np.ndarray, colour: str) -> int:
    """How many pixels have exactly this colour."""
    return int((image == rgb(colour)).all(axis=-1).sum())


def area(image: np.ndarray, colour: str) -> int:
    """How many pixels have this colour as all their neighbours, which those of lines do not."""
    same = (image == rgb(colour)).all(axis=-1)
    across = same[1:-1, :-2] & same[1:-1, 1:-1] & same[1:-1, 2:]
    return int((across & same[:-2, 1:-1] & same[2:, 1:-1]).sum())


class TestView:
    def test_axes_of_a_view_from_the_south(self) -> None:
        view = View(np.radians(-90.0), 0.0, np.zeros(3), 10.0)
        assert view.right == pytest.approx([1.0, 0.0, 0.0])
        assert view.up == pytest.approx([0.0, 0.0, 1.0])
        shown = view.pixels(np.array([[0.0, 5.0, 0.0], [10.0, 0.0, 0.0], [0.0, 0.0, 10.0]]))
        middle = [WIDTH_PX / 2, HEIGHT_PX / 2]
        half = HEIGHT_PX / 2
        assert shown[0] == pytest.approx(middle)
        assert shown[1] == pytest.approx([middle[0] + half, middle[1]])
        assert shown[2] == pytest.approx([middle[0], 0.0])

    @pytest.mark.parametrize("azimuth", [-2.0, 0.3, 1.9])
    @pytest.mark.parametrize("elevation", [0.1, 0.5, 1.2])
    def test_fitting_fills_the_frame(self, azimuth: float, elevation: float) -> None:
        points = np.random.default_rng(1).normal(size=(50, 3)) * [300.0, 200.0, 50.0] + 1000.0
        frame = (0.1, 0.8, 0.2, 0.9)
        shown = fitting(points, azimuth, elevation, frame).pixels(points) / [WIDTH_PX, HEIGHT_PX]
        low, high = shown.min(axis=0), shown.max(axis=0)
        assert (low >= [0.1 - 1e-9, 0.1 - 1e-9]).all()  # y counts downward
        assert (high <= [0.8 + 1e-9, 0.8 + 1e-9]).all()
        fill = (high - low) / [0.7, 0.7]
        assert fill.max() == pytest.approx(1.0)
        assert 0.5 * (low + high) == pytest.approx([0.45, 0.45])

    def test_nearer_moves_nothing_in_the_picture(self) -> None:
        view = View(0.7, 0.4, np.ones(3), 30.0)
        points = np.array([[1.0, 2.0, 3.0], [-4.0, 0.0, 9.0]])
        assert view.pixels(view.nearer(points, 5.0)) == pytest.approx(view.pixels(points))

    def test_clear_azimuth_is_not_along_an_axis(self) -> None:
        lines = np.array([[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]], dtype=float)
        azimuth = np.degrees(clear_azimuth_rad(lines, 0.4))
        assert min(abs(azimuth - k * 90.0) for k in range(-1, 4)) >= 14.0

    @pytest.mark.parametrize("name", CASES)
    def test_region_and_exit_points_are_in_the_picture(self, name: str) -> None:
        maps = maps_of(name)
        low, high = bounds_m(maps)
        exits = maps.study.robot.exit_points_m
        inside = exits[np.all((exits >= low) & (exits <= high), axis=1)]
        points = [inside, *(field.position_m.reshape(-1, 3) for field in maps.shell.values())]
        shown = view_of(maps).pixels(np.concatenate(points)) / [WIDTH_PX, HEIGHT_PX]
        assert shown.min() > 0.05
        assert shown.max() < 0.95
        assert len(inside) == (len(exits) if name not in _SPECKS else 0)


_SPECKS = ("outside", "unheld", "all_left_out", "speck")


class TestOverlay:
    def test_ticks_are_round_and_inside(self) -> None:
        assert parts.ticks_between(0.0, 433.01).tolist() == [0.0, 100.0, 200.0, 300.0, 400.0]
        assert parts.ticks_between(-200.0, 0.0, 4).tolist() == [-200, -150, -100, -50, 0]
        assert parts.ticks_between(3.0, 3.0).tolist() == [3.0]

    def test_leftmost_corner(self) -> None:
        bounds = np.array([[0.0, 0.0, 0.0], [10.0, 10.0, 5.0]])
        view = View(np.radians(-45.0), 0.4, np.zeros(3), 10.0)  # from the corner (10, 0)
        assert overlay.leftmost_corner(view, bounds).tolist() == [0.0, 0.0]

    def test_floor_lines_stay_on_the_floor_but_one(self) -> None:
        bounds = np.array([[0.0, 0.0, -3.0], [10.0, 10.0, 5.0]])
        lines = overlay.floor_lines(View(1.0, 0.4, np.zeros(3), 10.0), bounds)
        assert all((line[:, 2] == -3.0).all() for line in lines[:-1])
        assert lines[-1][:, 2].tolist() == [-3.0, 5.0]


def plane(values: Any, verdict: int = 0, uplift: float = -1.0) -> RegionField:
    """A field on a square grid of side 1 whose diameter is given in millimetres."""
    rows, columns = np.shape(values)
    x, y = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    diameter = np.asarray(values) / 1e3
    return RegionField(
        position_m=np.stack([x, y, 0.0 * x], axis=-1),
        diameter_m=diameter,
        tension_N=1e6 * diameter,
        massless_diameter_m=diameter,
        massless_tension_N=1e6 * diameter,
        uplift=np.full(diameter.shape, uplift),
        verdict=np.full(diameter.shape, verdict, dtype=np.int8),
        is_left_out=np.zeros(diameter.shape, dtype=np.bool_),
    )


class TestStage:
    def test_bands_follow_the_steps_of_the_scale(self) -> None:
        from designer.report.figures.colours import steps_for

        slope = np.tile(np.linspace(10.0, 20.0, 7)[:, None], (1, 4))
        field = plane(slope)
        steps = steps_for(slope)
        assert steps is not None
        cut = stage.banded(stage.counted_surface(field, DIAMETER), steps)
        assert cut.area == pytest.approx(1.0)
        centres = np.asarray(cut.cell_centers().points)
        value = 10.0 + 10.0 * centres[:, 0]
        band = np.searchsorted(steps.levels, value, side="right") - 1
        wanted = [np.round(255 * np.array(steps.colormap(int(b))[:3])) for b in band]
        assert np.asarray(cut.cell_data["colour"]) == pytest.approx(np.array(wanted))
        assert len(set(band.tolist())) == len(steps.levels) - 1

    def test_values_above_the_scale_have_its_last_colour(self) -> None:
        from designer.report.figures.colours import Steps

        steps = Steps(np.array([0.0, 1.0, 2.0]), "max")
        cut = stage.banded(stage.counted_surface(plane(np.full((3, 3), 70.0)), DIAMETER), steps)
        last = np.round(255 * np.array(steps.colormap(2)[:3]))
        assert np.asarray(cut.cell_data["colour"]) == pytest.approx(np.tile(last, (cut.n_cells, 1)))

    def test_lines_of_equal_value_lie_where_the_value_is(self) -> None:
        from designer.report.figures.colours import steps_for

        slope = np.tile(np.linspace(10.0, 20.0, 7)[:, None], (1, 4))
        steps = steps_for(slope)
        assert steps is not None
        lines = stage.contour_lines(stage.counted_surface(plane(slope), DIAMETER), steps)
        inner = [tick for tick in steps.ticks if 10.0 < tick < 20.0]
        found = sorted({round(10.0 + 10.0 * float(x), 6) for line in lines for x in line[:, 0]})
        assert set(inner) <= set(found)
        assert all(any(abs(value - tick) < 1e-6 for tick in steps.ticks) for value in found)

    def test_what_is_left_out_is_cut_off_sharply(self) -> None:
        from dataclasses import replace

        field = plane(np.full((5, 5), 30.0))
        uplift = field.position_m[..., 0] - 0.3
        field = replace(field, uplift=uplift, is_left_out=uplift > 0.0)
        assert stage.counted_surface(field, DIAMETER).area == pytest.approx(0.3)
        assert stage.left_out_surface(field, DIAMETER).area == pytest.approx(0.7)

    def test_where_nothing_holds_there_is_no_surface(self) -> None:
        field = plane(np.full((4, 4), np.nan), verdict=2, uplift=np.nan)
        assert stage.counted_surface(field, DIAMETER).n_cells == 0
        assert stage.left_out_surface(field, DIAMETER).n_cells == 0
        assert stage.quads(field.position_m, np.ones((3, 3), dtype=np.bool_)).n_cells == 9

    def test_hull_of_a_platform(self) -> None:
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
        assert len(parts.hull_faces(corners)) == 4
        flat = np.array([[0, 0, 2], [1, 0, 2], [1, 1, 2], [0, 1, 2], [0.5, 0.5, 2]], dtype=float)
        assert len(parts.hull_faces(flat)) == 2
        assert len(parts.hull_faces(SIX.attachments_m)) == 1
        assert len(parts.hull_faces(flat[:, [0, 0, 0]])) == 0
        assert len(parts.hull_faces(np.zeros((6, 3)))) == 0

    def test_edges_are_those_of_the_opened_region(self) -> None:
        maps = maps_of("served")
        edges = edges_m(maps)
        assert isinstance(maps.region, Prism)
        low, high = maps.region.bounds_m
        points = np.concatenate(edges)
        assert (points >= low - 1e-9).all()
        assert (points <= high + 1e-9).all()
        upright = [edge for edge in edges if np.ptp(edge[:, :2], axis=0).max() < 1e-9]
        kept = maps.shell["wall"].position_m[0, :, :2]
        corners = sum(
            bool((np.linalg.norm(kept - corner, axis=1) < 1e-9).any())
            for corner in maps.region.polygon_m
        )
        assert len(upright) == 3 + corners

    def test_scale_reaches_over_the_whole_scene(self) -> None:
        maps = maps_of("served")
        steps = scale_of(maps, DIAMETER)
        assert steps is not None
        lowest = min(np.nanmin(DIAMETER.of(field)) for field in maps.shell.values())
        assert steps.levels[0] <= lowest
        assert steps.levels[-1] >= 51.23
        assert scale_of(maps_of("unheld"), DIAMETER) is None


_SHOWN = {
    "served": "scale",
    "exclude": "scale, left out",
    "partly": "scale, no cable",
    "partly_exclude": "scale, left out",
    "found_by_search": "scale",
    "box": "scale, no cable",
    "six": "scale, no cable",
    "points": "dots",
    "one_point": "dots",
    "lost_points": "dots",
    "outside": "no cable",
    "unheld": "no cable",
    "all_left_out": "left out",
    "flat": "scale",
    "speck": "scale",
}
"""What covers areas in the picture of each case; single points cover none."""


def scale_colours(maps: WorkspaceMaps) -> list[str]:
    """Return the colours of the bands of a scene."""
    steps = scale_of(maps, DIAMETER)
    if steps is None:
        return []
    bands = [steps.colormap(band)[:3] for band in range(len(steps.levels) - 1)]
    return ["#" + bytes(round(255 * part) for part in band).hex() for band in bands]


@pytest.mark.usefixtures("graphics")
class TestPictures:
    @pytest.mark.parametrize("name", CASES)
    def test_every_case_shows_its_colours(self, name: str) -> None:
        maps = maps_of(name)
        image = workspace_scene(maps)
        assert image.shape == (HEIGHT_PX, WIDTH_PX, 3)
        assert (image[0, 0] == 255).all()
        assert (image < 255).any(axis=-1).sum() > 20_000
        in_scene = image[:, : int(0.86 * WIDTH_PX)]
        areas = {
            "scale": sum(count(in_scene, colour) for colour in scale_colours(maps)),
            "no cable": count(in_scene, palette.WARNING),
            "left out": area(in_scene, palette.LEFT_OUT),
        }
        shown = {what for what, area in areas.items() if area > 5_000}
        assert shown == set(_SHOWN[name].split(", ")) - {"dots"}

    def test_colours_are_those_of_the_scale(self) -> None:
        maps = maps_of("served")
        steps = scale_of(maps, DIAMETER)
        assert steps is not None
        image = workspace_scene(maps)
        top = np.round(255 * np.array(steps.colormap(0)[:3])).astype(int)
        in_scene = image[:, : int(0.86 * WIDTH_PX)]
        assert (in_scene == top).all(axis=-1).sum() > 500
        assert count(in_scene, palette.WARNING) == 0

    def test_orange_where_no_cable_holds(self) -> None:
        assert count(workspace_scene(maps_of("partly")), palette.WARNING) > 10_000

    def test_grey_where_poses_are_left_out(self) -> None:
        image = workspace_scene(maps_of("exclude"))
        assert count(image, palette.LEFT_OUT) > 10_000
        assert count(image, palette.WARNING) == 0

    def test_the_map_shines_through_the_border_of_what_no_rope_serves(self) -> None:
        maps = maps_of("served")
        low, high = bounds_m(maps)
        across = np.array([[low, [*high[:2], low[2]], high], [low, high, [*low[:2], high[2]]]])
        border = replace(maps, impossible_m=across)
        without, drawn = workspace_scene(maps), workspace_scene(border)
        tinted = (without != drawn).any(axis=-1)
        assert tinted.sum() > 20_000
        assert count(without, palette.IMPOSSIBLE) == count(drawn, palette.IMPOSSIBLE) == 0
        mixed = 0.5 * without[tinted] + 0.5 * np.array(rgb(palette.IMPOSSIBLE))
        assert (np.abs(drawn[tinted] - mixed).max(axis=1) < 3.0).mean() > 0.8
        told = "no rope of any size holds beyond this (proved)"
        assert told in workspace_scene_html(border)
        assert told not in workspace_scene_html(maps)

    def test_quantities_differ(self) -> None:
        quantities = (DIAMETER, TENSION, RATIO)
        drawn = {workspace_scene(maps_of("served"), q).tobytes() for q in quantities}
        assert len(drawn) == 3

    def test_drawn_twice_it_is_the_same(self) -> None:
        once, again = (workspace_scene(maps_of("served")) for _ in range(2))
        assert (once == again).all()

    @pytest.mark.parametrize("name", ["served", "six"])
    def test_robot_shows_its_cables(self, name: str) -> None:
        pose = solved(name)[0].pose
        assert pose is not None
        image = robot_scene(pose.sizing.statics)
        assert image.shape == (HEIGHT_PX, WIDTH_PX, 3)
        assert count(image, palette.SAG) > 500
        assert count(image, palette.WARNING) == 0

    def test_robot_without_equilibrium_says_so(self) -> None:
        pose = analyse_pose(pose_at("served", [250.0, -20.0, -50.0]))
        assert pose is not None
        image = robot_scene(pose.sizing.statics)
        assert count(image, palette.SAG) == 0
        assert count(image, palette.WARNING) > 100

    def test_vertical_cable(self) -> None:
        """Below an exit point one cable would hold it alone, which counts as no equilibrium."""
        pose = analyse_pose(pose_at("served", [1e-9, 0.0, -50.0]))
        assert pose is not None
        image = robot_scene(pose.sizing.statics)
        assert image.shape == (HEIGHT_PX, WIDTH_PX, 3)
        assert (image[0, 0] == 255).all()
        assert count(image, palette.WARNING) > 1_000


@pytest.fixture(scope="module")
def page(graphics: None) -> str:
    """The served case as a page."""
    return workspace_scene_html(maps_of("served"))


def scene_in(page: str) -> dict[str, Any]:
    """Unpack the scene that a page carries."""
    found = re.search(r'const base64Str = "([^"]+)"', page)
    assert found is not None
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(found.group(1)))) as archive:
        scene: dict[str, Any] = json.loads(archive.read("index.json"))
    return scene


def kinds(node: dict[str, Any]) -> list[str]:
    """Return the types of all objects of a scene."""
    below = [kind for child in node.get("dependencies", []) for kind in kinds(child)]
    return [node["type"], *below]


@pytest.mark.usefixtures("graphics")
class TestInteractive:
    @pytest.mark.parametrize("name", CASES)
    def test_every_case_makes_a_page(self, name: str) -> None:
        scene = scene_in(workspace_scene_html(maps_of(name)))["scene"]
        assert "vtkActor" in " ".join(kinds(scene)) or "Actor" in " ".join(kinds(scene))

    def test_loads_nothing_from_the_web(self, page: str) -> None:
        assert "kitware.github.io/vtk-js/icon" not in page
        assert not re.search(r'(?:src|href)\s*=\s*["\'`]?https?:', page)
        assert not re.search(r"url\(\s*['\"]?https?:", page)
        assert not re.search(r"@import|<link|importScripts", page)

    def test_is_small(self, page: str) -> None:
        assert len(page) < 1_500_000
        assert "data:image/jpeg" not in page

    def test_scene_has_surfaces_and_their_colours(self, page: str) -> None:
        scene = scene_in(page)
        colours = [
            base64.b64decode(array["content"])
            for array in scene["hashes"].values()
            if array["type"] == "Uint8Array"
        ]
        assert len(colours) == 5  # top, bottom, wall and both cuts
        assert min(len(colour) for colour in colours) > 300

    def test_labels_stand_at_their_points(self, page: str) -> None:
        labels = re.findall(r'class="(label[^"]*)" data-at="([^"]+)">([^<]+)<', page)
        assert [text for _, _, text in labels] == ["worst pose, 51.2 mm", "A1", "A2", "A3"]
        for (_, at, _), exit_point in zip(labels[1:], THREE.exit_points_m, strict=True):
            assert [float(x) for x in at.split(",")] == pytest.approx(exit_point, rel=1e-5)

    def test_names_are_escaped(self, page: str) -> None:
        assert "<title>A &amp; B &lt;crane&gt;</title>" in page

    def test_axes_stand_around_it(self, page: str) -> None:
        ticks = re.findall(r'class="tick" data-at="([^"]+)">([^<]+)<', page)
        names = [text for _, text in ticks if "[m]" in text]
        assert names == ["x [m]", "y [m]", "z [m]"]
        for axis, name in enumerate(names):
            after = [text for _, text in ticks].index(name)
            for at, text in ticks[:after][-2:]:
                number = float(text.replace("−", "-"))
                assert float(at.split(",")[axis]) == pytest.approx(number, abs=1e-4)

    @pytest.mark.parametrize("name", CASES)
    def test_every_pose_that_is_seen_can_be_read(self, name: str) -> None:
        page, shown = workspace_scene_html(maps_of(name)), maps_of(name).thinned().shown
        found = re.search(r'id="poses">(.*?)</script>', page)
        assert found is not None
        data = json.loads(found.group(1))
        for grid, field in zip(data["grids"], shown, strict=True):
            points = np.array(grid["points"])
            assert points[:, :3] == pytest.approx(field.position_m.reshape(-1, 3), rel=1e-4)
            assert len(points) % grid["columns"] == 0
            value = DIAMETER.of(field).ravel()
            has_value = np.isfinite(value)
            assert points[has_value, 3] == pytest.approx(value[has_value], rel=1e-4)
            for number in {round(code) for code in points[~has_value, 3]}:
                why = data["reasons"][-number - 1]
                left_out = field.is_left_out.ravel()[points[:, 3] == number]
                assert left_out.all() == why.startswith("left out")

    def test_is_worked_by_keys_and_dark_as_the_system(self, page: str) -> None:
        assert re.search(
            r'class="content" tabindex="0" role="application" aria-label="[^"]+"', page
        )
        assert 'id="picked" role="status"' in page
        assert "@media (prefers-color-scheme: dark)" in page

    @pytest.mark.slow
    @pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Chromium")
    def test_a_browser_shows_it_and_obeys_the_keys(self, page: str, tmp_path: Path) -> None:
        probe = """<script>setTimeout(() => {
          window.dispatchEvent(new KeyboardEvent("keydown", {key: "n"}));
        }, 2000);</script></body>"""
        file = tmp_path / "scene.html"
        before, after = page.rsplit("</body>", 1)
        file.write_text(before + probe + after, encoding="utf-8")
        flags = ("--headless", "--no-sandbox", "--use-angle=swiftshader", "--disable-dev-shm-usage")
        more = ("--enable-unsafe-swiftshader", "--virtual-time-budget=6000", "--dump-dom")
        command = ["chromium", *flags, *more, f"--user-data-dir={tmp_path / 'profile'}", str(file)]
        run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=900)
        if "WebGL" in run.stderr and 'class="label strong" style' not in run.stdout:
            pytest.skip("this Chromium draws no WebGL here")
        assert re.search(r'class="label strong"[^>]* style="left: [\d.]+px; top: ', run.stdout)
        picked = re.search(r'id="picked"[^>]*>([^<]+)<', run.stdout)
        assert picked is not None
        assert picked.group(1).startswith("needed diameter 51.2 mm at x ")

    def test_says_what_orange_and_grey_mean(self) -> None:
        assert "no finite cable</span>" in workspace_scene_html(maps_of("partly"))
        assert "left out: a cable hangs below" in workspace_scene_html(maps_of("exclude"))


ASK = "from designer.report.figures.opengl import why_no_scenes; print(why_no_scenes(), end='')"


@pytest.fixture
def asked_anew() -> Iterator[None]:
    """Forget what was found out, before the test and after it."""
    opengl.why_no_scenes.cache_clear()
    opengl._probe.cache_clear()
    yield
    opengl.why_no_scenes.cache_clear()
    opengl._probe.cache_clear()


class TestOpenGL:
    @pytest.mark.skipif(not sys.platform.startswith("linux"), reason="EGL and its drivers")
    def test_a_library_without_a_driver_is_told_with_the_packages(self, tmp_path: Path) -> None:
        """As after ``apt-get install libegl1`` alone, where VTK ends the process."""
        no_driver = {"__EGL_VENDOR_LIBRARY_DIRS": str(tmp_path), "__EGL_EXTERNAL_PLATFORM": ""}
        kept = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", opengl._CHOICE)}
        done = subprocess.run(
            [sys.executable, "-c", ASK],
            env={**kept, **no_driver},
            capture_output=True,
            text=True,
            timeout=900,
            check=True,
        )
        assert "apt-get install libegl1 libgl1-mesa-dri'" in done.stdout
        assert done.stderr == ""

    def test_the_first_way_that_draws_is_taken(
        self, asked_anew: None, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(sys, "platform", "linux")
        monkeypatch.delenv("DISPLAY", raising=False)
        monkeypatch.setenv(opengl._CHOICE, "to be put back")
        monkeypatch.delenv(opengl._CHOICE)
        monkeypatch.setattr(opengl, "_has_drawn", lambda window: window == "")
        assert opengl.why_no_scenes() == ""
        assert opengl._CHOICE not in os.environ
        opengl.why_no_scenes.cache_clear()
        monkeypatch.setattr(opengl, "_has_drawn", lambda window: window == opengl._EGL)
        assert opengl.why_no_scenes() == ""
        assert os.environ[opengl._CHOICE] == opengl._EGL

    @pytest.mark.parametrize("code", ["import os; os.abort()", "import sys; sys.exit(1)"])
    def test_a_crash_and_a_wrong_picture_are_no_picture(
        self, asked_anew: None, monkeypatch: pytest.MonkeyPatch, code: str
    ) -> None:
        monkeypatch.setattr(opengl, "_DRAW", code)
        assert opengl.why_no_scenes().startswith("Pictures in space are left out")
        with pytest.raises(MissingLibraryError):
            stage.SceneCanvas(View(0.7, 0.4, np.ones(3), 30.0))

    def test_what_hangs_is_left_behind(
        self, asked_anew: None, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(opengl, "_DRAW", "import time; time.sleep(600)")
        monkeypatch.setattr(opengl, "_LONGEST_S", 0.1)
        assert opengl.why_no_scenes() != ""
