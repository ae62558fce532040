"""Colours and sizes that all figures share, told apart by every kind of colour vision.

The accents are from M. Okabe and K. Ito, "Color Universal Design", 2008.
"""

from __future__ import annotations

from typing import Any

COLORMAP = "viridis"
"""Sequential, perceptually even, also in grey; for diameter, tension and their ratio."""
DIFFERENCES = "PuOr_r"
"""About zero, with even steps to either side; C. Brewer, ColorBrewer."""

SAG, SAG_PALE = "#0072B2", "#8CC1E0"
"""With sag."""
MASSLESS = "#7F7F7F"
"""Straight weightless cables."""
WARNING = "#D55E00"
"""Where no cable holds the platform."""
WARNING_PALE = "#F9E3D3"
IMPOSSIBLE = "#CC79A7"
"""Where the part begins that no rope can serve, which is proved."""
LEFT_OUT = "#DADADA"
"""What the study leaves out."""
INK = "#222222"
"""Text, axes, outlines."""
FAINT = "#B5B5B5"
"""Guides and whatever is not the subject."""

CLASS_COLOURS = {
    "steel": "#0072B2",
    "stainless steel": "#009E73",
    "fibre": "#E69F00",
    "not stated": MASSLESS,
}
"""Of the classes of a rope's material."""
PAPER_WIDTH_MM, HALF_WIDTH_MM = 170.0, 84.0
"""Column width of the printed report, and of one of two charts side by side."""
FONT_POINTS = 8.0


def look_of(kind: str) -> dict[str, Any]:
    """Return colour and shape of the points of a class, for those who see no colours as well."""
    shapes = {"steel": "o", "stainless steel": "s", "fibre": "^", "not stated": "D"}
    return {"linestyle": "none", "color": CLASS_COLOURS[kind], "marker": shapes[kind]}
