"""Data that lies beside the checkout, in ``../shared``, and is not shipped with it."""

from __future__ import annotations

from pathlib import Path

import pytest

SHARED = Path(__file__).parents[2] / "shared"


def shared(*parts: str) -> Path:
    """Return the path of a file or folder in ``../shared``, whether it is there or not."""
    return SHARED.joinpath(*parts)


def needs_shared(*parts: str) -> pytest.MarkDecorator:
    """Return the mark that skips a test where this part of ``../shared`` is absent."""
    path = shared(*parts)
    reason = f"needs ../shared/{'/'.join(parts)} beside the checkout, which is not there"
    return pytest.mark.skipif(not path.exists(), reason=reason)
