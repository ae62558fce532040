"""Whether reports can be made for paper here."""

from __future__ import annotations

from importlib.util import find_spec


def why_no_pdf() -> str:
    """Return why no PDF can be made here; empty where it can."""
    if find_spec("plutoprint") is not None:
        return ""
    return "The PDF is left out: PlutoPrint, which makes it, has no wheel for this kind of machine."
