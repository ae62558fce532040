"""Cuts the empty rows above and below a scene, so that it takes no more paper than it needs."""

from __future__ import annotations

import io

import numpy as np

_MARGIN = 0.01


def without_empty_rows(png: bytes) -> bytes:
    """Return a PNG without the rows of one colour at its top and bottom, but for a narrow margin.

    The width stays, so that all scenes of a page are drawn to one scale.
    """
    from matplotlib import image

    pixels = np.asarray(image.imread(io.BytesIO(png), format="png"))
    drawn = np.flatnonzero((pixels != pixels[:1, :1]).any(axis=(1, 2)))
    if len(drawn) == 0:
        return png
    margin = round(_MARGIN * len(pixels))
    first, last = max(int(drawn[0]) - margin, 0), int(drawn[-1]) + margin + 1
    stream = io.BytesIO()
    kept = np.ascontiguousarray(pixels[first:last])
    image.imsave(stream, kept, format="png", metadata={"Software": "cdpr-designer"})
    return stream.getvalue()
