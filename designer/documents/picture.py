"""What kind of picture a file holds, by its first bytes."""

from __future__ import annotations

_BEGINNINGS = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def picture_type(start: bytes) -> str | None:
    """Return the MIME type of a picture that begins so; None for what a page does not show."""
    for beginning, kind in _BEGINNINGS.items():
        if start.startswith(beginning):
            return kind
    return "image/svg+xml" if b"<svg" in start else None
