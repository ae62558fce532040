"""The name that was probably meant."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def nearest_name(given: str, names: Iterable[str]) -> str | None:
    """Return the name most like the given one, letter case apart first; None for nothing like it.

    Parameters
    ----------
    given : str
        What stands in the file.
    names : iterable of str
        What might have been meant.
    """
    known = list(names)
    same_letters = [name for name in known if name.casefold() == given.casefold()]
    return next(iter(same_letters or get_close_matches(given, known, n=1)), None)


def did_you_mean(given: str, names: Iterable[str]) -> str:
    """Return a hint to add to what is expected; empty where no name is near."""
    nearest = nearest_name(given, names)
    return f"; did you mean '{nearest}'?" if nearest else ""
