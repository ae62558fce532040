"""Drawings as figures of a page."""

from __future__ import annotations

import base64
import re
from typing import TYPE_CHECKING, overload

from designer.report.blocks import Picture

if TYPE_CHECKING:
    from designer.report.figures.stage import Image


@overload
def chart(caption: str, alternative: str, svg: str) -> Picture: ...
@overload
def chart(caption: str, alternative: str, svg: None) -> None: ...
def chart(caption: str, alternative: str, svg: str | None) -> Picture | None:
    """Return a chart, its half-transparent parts written so that they stay vector graphics.

    PlutoPrint composes an element with ``opacity`` and a clip as a bitmap; the same with
    ``fill-opacity`` and ``stroke-opacity`` it draws. None stays None.
    """
    if svg is None:
        return None
    split = r"fill-opacity: \1; stroke-opacity: \1"
    return Picture(caption, alternative, re.sub(r"(?<![-\w])opacity: ([\d.]+)", split, svg))


@overload
def scene(
    caption: str, alternative: str, image: Image, *, page: str = "", kind: str = ""
) -> Picture: ...
@overload
def scene(
    caption: str, alternative: str, image: None, *, page: str = "", kind: str = ""
) -> None: ...
def scene(
    caption: str, alternative: str, image: Image | None, *, page: str = "", kind: str = ""
) -> Picture | None:
    """Return a picture in space; ``page`` is the same to turn. None stays None."""
    if image is None:
        return None
    from designer.report.figures.overlay import png

    kept = base64.b64encode(png(image)).decode()
    address = f"data:image/png;base64,{kept}"
    return Picture(caption, alternative, bitmap=address, scene=page, kind=kind)
