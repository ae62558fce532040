"""Texts over a scene stand clear of each other, of the colour bar, and of what they name."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from designer.arrays import FloatArray
from designer.report.figures import canvas, overlay
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

FRONT = View(-np.pi / 2, 0.0, np.zeros(3), 5.0)
EMPTY = np.full((HEIGHT_PX, WIDTH_PX, 3), 255, dtype=np.uint8)
NOTHING = np.empty((0, 2))
MIDDLE = np.zeros(3)


def overlap(one: Any, other: Any) -> bool:
    return bool(one.get_window_extent().overlaps(other.get_window_extent()))


def test_texts_at_one_place_do_not_overlap() -> None:
    with canvas.drawing():
        _, axes = overlay.over(EMPTY)
        for text in ("worst pose, 51.2 mm", "119.6 kN", "sag 7.13 m"):
            overlay.write_clear(axes, FRONT, MIDDLE, text, NOTHING)
        first, second, third = axes.texts
        assert not (overlap(first, second) or overlap(first, third) or overlap(second, third))


def test_a_text_leaves_lines_free_and_stays_near() -> None:
    line = np.array([[-5.0, 0.0, 0.2], [5.0, 0.0, 0.2]])
    clear = overlay.obstacles(FRONT, [line])
    with canvas.drawing():
        _, axes = overlay.over(EMPTY)
        overlay.write_clear(axes, FRONT, MIDDLE, "here", clear)
        box = axes.texts[0].get_window_extent()
    height = HEIGHT_PX - float(FRONT.pixels(line)[0, 1])
    assert not box.y0 <= height <= box.y1
    assert not axes.lines  # near enough to need no line that leads to it


def test_a_text_far_off_is_led_to_its_place() -> None:
    grid = np.stack(np.meshgrid(np.arange(700.0, 900.0, 4.0), np.arange(400.0, 600.0, 4.0)), -1)
    with canvas.drawing():
        _, axes = overlay.over(EMPTY)
        overlay.write_clear(axes, FRONT, MIDDLE, "here", grid.reshape(-1, 2))
        assert len(axes.lines) == 1
        start = np.array(axes.lines[0].get_xydata())[0]
    assert start == pytest.approx(FRONT.pixels(MIDDLE))


@pytest.mark.parametrize("x_m", [-7.9, 7.9])
def test_a_text_stays_in_the_picture(x_m: float) -> None:
    with canvas.drawing():
        _, axes = overlay.over(EMPTY)
        overlay.write_clear(axes, FRONT, np.array([x_m, 0.0, 4.9]), "a long name", NOTHING)
        box = axes.texts[0].get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= WIDTH_PX
    assert box.y1 <= HEIGHT_PX


def test_exit_points_outside_the_picture_have_no_name() -> None:
    exits: FloatArray = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
    with canvas.drawing():
        _, axes = overlay.over(EMPTY)
        overlay.write_exits(axes, FRONT, exits, NOTHING)
        assert [text.get_text() for text in axes.texts] == ["A1"]


def test_points_along_lines_are_close_together() -> None:
    points = overlay.obstacles(FRONT, [np.array([[-4.0, 0.0, 0.0], [4.0, 0.0, 0.0]])])
    assert np.hypot(*np.diff(points, axis=0).T).max() < 10.0
    assert overlay.obstacles(FRONT, []).shape == (0, 2)


def test_the_next_picture_has_nothing_of_the_one_before() -> None:
    with canvas.drawing():
        figure, axes = overlay.over(EMPTY)
        overlay.write_clear(axes, FRONT, MIDDLE, "here", NOTHING)
        canvas.legend(figure, [("line", {"color": "black"})], "lower left")
        figure.add_axes((0.9, 0.2, 0.02, 0.6))
        assert (overlay.finished(figure) != EMPTY).any()
        figure, _ = overlay.over(EMPTY)
        assert np.array_equal(overlay.finished(figure), EMPTY)


@pytest.mark.parametrize("letters", [1.0, 1.9])
def test_what_is_not_written_on_stays_as_it_was(letters: float) -> None:
    image = np.random.default_rng(0).integers(0, 256, EMPTY.shape).astype(np.uint8)
    with canvas.drawing():
        figure, axes = overlay.over(image, letters)
        overlay.write_clear(axes, FRONT, MIDDLE, "here", NOTHING)
        box = axes.texts[0].get_window_extent()
        changed = np.argwhere((overlay.finished(figure) != image).any(axis=-1))
    assert len(changed) > 0
    (top, left), (bottom, right) = changed.min(axis=0), changed.max(axis=0)
    assert abs(np.array([left, right]) - [box.x0, box.x1]).max() < 12.0
    assert abs(HEIGHT_PX - np.array([bottom, top]) - [box.y0, box.y1]).max() < 12.0


def test_a_picture_is_cut_above_and_below_what_it_shows() -> None:
    image = EMPTY.copy()
    image[300:400, 5] = 0
    with Image.open(io.BytesIO(overlay.png(image))) as cut:
        assert cut.size == (WIDTH_PX, 120)
    with Image.open(io.BytesIO(overlay.png(EMPTY))) as whole:
        assert whole.size == (WIDTH_PX, HEIGHT_PX)
