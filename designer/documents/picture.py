"""What kind of picture a file holds, by its first bytes."""

from __future__ import annotations


def picture_type(start: bytes) -> str | None:
    """Return the MIME type of a picture that begins so; None for what a page does not show."""
    if start.startswith(b"\x89PNG\r\n\x1a\n"):
        return "image/png"
    if start.startswith(b"\xff\xd8\xff"):
        return "image/jpeg"
    return "image/svg+xml" if b"<svg" in start else None
