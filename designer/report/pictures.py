"""Drawings as figures of a page."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from designer.report.figures.stage import Image


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure without its words.

    Parameters
    ----------
    svg : str
        Vector graphics to inline, trusted since drawn by this program; may be empty.
    bitmap : str
        A PNG as a data URI; may be empty.
    scene : str
        A whole HTML page with the same scene to turn; may be empty.
    """

    svg: str = ""
    bitmap: str = ""
    scene: str = ""


def vector(svg: str | None) -> Drawing | None:
    """Return a chart, its half-transparent parts written so that they stay vector graphics.

    PlutoPrint composes an element with ``opacity`` and a clip as a bitmap; the same with
    ``fill-opacity`` and ``stroke-opacity`` it draws. None stays None.
    """
    if svg is None:
        return None
    split = r"fill-opacity: \1; stroke-opacity: \1"
    return Drawing(re.sub(r"(?<![-\w])opacity: ([\d.]+)", split, svg))


def in_space(image: Image | None, page: str = "") -> Drawing | None:
    """Return a picture in space; ``page`` is the same to turn. None stays None."""
    if image is None:
        return None
    from designer.report.figures.overlay import png

    encoded = base64.b64encode(png(image)).decode()
    return Drawing(bitmap=f"data:image/png;base64,{encoded}", scene=page)
