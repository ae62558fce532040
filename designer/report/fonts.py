"""The fonts of the pages, in the pages: they look the same whatever fonts a machine has.

They are the DejaVu fonts that come with Matplotlib, which draws the charts in them too.
"""

from __future__ import annotations

import base64
import hashlib
import html
import io
import re
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

from designer.io.output import cache_path, write_cache

FACES = (
    ("Report Sans", 400, "normal", "DejaVuSans"),
    ("Report Sans", 700, "normal", "DejaVuSans-Bold"),
    ("Report Sans", 400, "italic", "DejaVuSans-Oblique"),
    ("Report Serif", 400, "normal", "DejaVuSerif"),
    ("Report Serif", 400, "italic", "DejaVuSerif-Italic"),
    ("Report Mono", 400, "normal", "DejaVuSansMono"),
)
"""Family, weight and style as style sheets name them, and the file."""

_COMMON = frozenset(
    "⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉–—…−√∞≈≤≥→○•◦▪▸▾\u202f"
    + "".join(map(chr, [*range(0x20, 0x7F), *range(0xA0, 0x100), *range(0x391, 0x3CA)]))
)
"""Letters of most pages, in every font, so that it is made once for all pages on a machine."""
_ALONE = "".join(sorted(_COMMON))
_NOT_SHOWN = re.compile(r'<script.*?</script>|srcdoc="[^"]*"|base64,[\w+/=]+', re.DOTALL)
"""Of a page: what has no text, or fonts of its own."""
_LAST_NAME = 6
"""Of the records about a font: who made it, and what it is called; then come long texts."""


def with_fonts(page: str) -> str:
    """Return an HTML page with its fonts in its head: common letters, and all that it shows."""
    shown = {*html.unescape(_NOT_SHOWN.sub("", page))} - {"\n", "\t"}
    letters = "".join(sorted(_COMMON | shown))
    rules = [
        f'@font-face {{ font-family: "{family}"; font-weight: {weight}; font-style: {style}; '
        f"src: url(data:font/woff;base64,{_letters_of(file, letters)}) }}\n"
        for family, weight, style, file in FACES
        if f'"{family}"' in page
    ]
    return page.replace("</head>", f"<style>\n{''.join(rules)}</style>\n</head>", 1)


@lru_cache(maxsize=2 * len(FACES))
def _letters_of(file: str, letters: str) -> str:
    """Return these letters of a font as a WOFF file in base64, kept for other runs."""
    made_of = (file, letters, version("matplotlib"), version("fonttools"))
    name = hashlib.sha256(repr(made_of).encode()).hexdigest()[:16]
    path = cache_path("fonts", f"{name}.woff")
    try:
        font = path.read_bytes()
    except OSError:
        font = _subset(file, letters)
        if letters == _ALONE:
            write_cache(path, font)
    return base64.b64encode(font).decode()


def _subset(file: str, letters: str) -> bytes:
    import matplotlib
    from fontTools import subset

    options = subset.Options(
        flavor="woff", hinting=False, layout_features=["kern"], notdef_outline=True
    )
    options.drop_tables += ["FFTM"]  # FontForge's notes, which it does not know
    path = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{file}.ttf"
    subsetter = subset.Subsetter(options)
    subsetter.populate(text=letters)
    stream = io.BytesIO()
    with subset.load_font(path, options) as font:
        names = font["name"]  # put aside: the search for what is used of it takes half the time
        del font["name"]
        subsetter.subset(font)
        names.names = [one for one in names.names if one.nameID <= _LAST_NAME]
        font["name"] = names
        subset.save_font(font, stream, options)
    return stream.getvalue()
