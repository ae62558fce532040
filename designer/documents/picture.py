"""Whether a page can show a picture of the user's, which may be made to do harm.

What a file says of itself is checked here; then it is drawn once by another process with little
memory and time, which it may end.
"""

from __future__ import annotations

import base64
import io
import re
from functools import lru_cache

from designer.documents.opened import apart
from designer.documents.xml import Element, xml_of
from designer.errors import InputError

LARGEST_PICTURE_BYTES = 1_000_000
_MAX_PIXELS = 20_000_000
_LONGEST_S = 10
_SVG = "image/svg+xml"
_EXPECTED = "a PNG, JPEG or SVG file"
_INSIDE = re.compile(r"#|data:image/(?:png|jpeg);base64,", re.IGNORECASE)
_ADDRESS = re.compile(r"url\(\s*[\"']?\s*([^)]*)|@import\s*(.*)", re.IGNORECASE)

_LOADS = ("loads something from elsewhere", "a picture that holds all that it shows")


def picture_type(start: bytes) -> str | None:
    """Return the MIME type of a picture that begins so; None for what a page does not show."""
    if start.startswith(b"\x89PNG\r\n\x1a\n"):
        return "image/png"
    if start.startswith(b"\xff\xd8\xff"):
        return "image/jpeg"
    return _SVG if b"<svg" in start else None


@lru_cache(maxsize=8)
def why_not_shown(raw: bytes) -> tuple[str, str] | None:
    """Return what keeps a page from showing a picture, and what was expected; None if nothing does.

    Checked are its kind, its size in bytes and pixels, and of an SVG how deep it nests, entities,
    and references to elsewhere; and that it can be drawn at all.
    """
    if len(raw) > LARGEST_PICTURE_BYTES:
        return "is too large", f"at most {LARGEST_PICTURE_BYTES:,} bytes"
    kind = picture_type(raw[:512])
    if kind is None:
        return "is no such picture", _EXPECTED
    if kind == _SVG and (why_no_svg := _why_no_svg(raw)):
        return why_no_svg
    why = apart(_drawn, raw, _LONGEST_S, kind)
    if why is None:
        return f"cannot be drawn, or not within {_LONGEST_S} s", "a simpler picture"
    return tuple(why) or None


def _why_no_svg(raw: bytes) -> tuple[str, str] | None:
    try:
        root = xml_of(raw, "")
    except InputError as error:
        (fault,) = error.faults
        place = "" if fault.line is None else f" in line {fault.line}"
        return f"is no plain SVG{place}: {fault.problem}", "one without that"
    outside = next((place for element in root.everything() for place in _outside(element)), None)
    outside = outside or ("a style sheet" if b"<?xml-stylesheet" in raw else None)
    return None if outside is None else (f"refers to {outside[:80]!r}", _LOADS[1])


def _outside(element: Element) -> list[str]:
    """Return the addresses in an element that lead out of the picture."""
    attributes = element.attributes
    named = [value for name, value in attributes.items() if name.split(":")[-1] in ("href", "src")]
    texts = (*attributes.values(), element.text)
    named += ["".join(address) for text in texts for address in _ADDRESS.findall(text)]
    return [address for address in named if not _INSIDE.match(address.strip())]


def _drawn(raw: bytes, kind: str) -> tuple[str, str] | tuple[()]:
    """Draw a picture, and return what keeps a page from showing it."""
    if kind != _SVG:
        from PIL import Image

        Image.MAX_IMAGE_PIXELS = None  # ours is told by its name
        try:
            picture = Image.open(io.BytesIO(raw), formats=("PNG", "JPEG"))
            if picture.width * picture.height > _MAX_PIXELS:
                return f"has more than {_MAX_PIXELS / 1e6:g} million pixels", "fewer"
            picture.load()
        except Exception:
            return "cannot be decoded", _EXPECTED
    try:
        import plutoprint
    except ImportError:
        return ()  # no wheel for this kind of machine: nothing of ours will draw it
    requested: list[str] = []

    class Nothing(plutoprint.ResourceFetcher):
        def fetch_url(self, url: str) -> plutoprint.ResourceData:
            requested.append(url)
            return plutoprint.ResourceData(b"", "text/plain")

    book = plutoprint.Book(plutoprint.PAGE_SIZE_A4)
    book.custom_resource_fetcher = Nothing()
    address = f"data:{kind};base64,{base64.b64encode(raw).decode()}"
    book.load_html(f'<img style="max-width: 11rem" src="{address}">', base_url="report:/")
    book.write_to_pdf_stream(io.BytesIO())
    return _LOADS if requested else ()
