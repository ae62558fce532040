"""Plain text of a place, a mass, row numbers; the name that was probably meant."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

import numpy as np

from designer.arrays import FloatArray, IntArray

NOT_STATED = "not stated"


def nearest_name(text: str, names: Iterable[str]) -> str | None:
    """Return the name most like the given one, letter case apart first; None for nothing like it.

    Parameters
    ----------
    text : str
        What stands in the file.
    names : iterable of str
        What might have been meant.
    """
    candidates = list(names)
    same_letters = [name for name in candidates if name.casefold() == text.casefold()]
    return next(iter(same_letters or get_close_matches(text, candidates, n=1)), None)


def did_you_mean(text: str, names: Iterable[str]) -> str:
    """Return a hint to add to what is expected; empty where no name is near."""
    nearest = nearest_name(text, names)
    return f"; did you mean '{nearest}'?" if nearest else ""


def in_runs(numbers: Sequence[int] | IntArray) -> list[str]:
    """Return numbers with neighbours drawn together: ``12``, ``45 to 48``."""
    runs = np.split(np.asarray(numbers), np.flatnonzero(np.diff(numbers) > 1) + 1)
    return [str(run[0]) if len(run) == 1 else f"{run[0]} to {run[-1]}" for run in runs]


def position(place: Iterable[float]) -> str:
    """Return a place [m, rad] as plain text, such as ``(256.52, 10.35, -40) m``.

    The orientation follows in degrees, where it is not zero.
    """
    position_m, turn_rad = np.split(np.array([*place], dtype=np.float64), [3])
    text = f"({_decimal(position_m)}) m"
    return f"{text}, turned by ({_decimal(np.degrees(turn_rad))})°" if turn_rad.any() else text


def _decimal(values: FloatArray) -> str:
    return ", ".join(f"{value + 0.0:.10g}" for value in np.round(values, 2))


def kilograms(mass_kg: float) -> str:
    """Return a mass as plain text with four digits, such as ``21250 kg``."""
    return f"{digits(mass_kg)} kg"


def digits(value: float, count: int = 4) -> str:
    """Return a number with ``count`` significant digits at most, without exponent or ``-0``."""
    if not math.isfinite(value):
        return f"{value}"
    return np.format_float_positional(float(f"{value:.{count - 1}e}") + 0.0, trim="-")


def vector(values: Iterable[float], count: int = 4) -> str:
    """Return numbers such as ``(0, 34, 20)``; what is rounding beside the largest is zero."""
    row = np.array([*values], dtype=np.float64)
    least = 1e-6 * float(np.abs(row).max(initial=0.0))
    return f"({', '.join(digits(x if abs(x) > least else 0.0, count) for x in row.tolist())})"


def stated(*texts: str) -> str:
    """Join what a source states; catalogue files say "not stated" where it does not."""
    return ", ".join(text for text in texts if text not in ("", NOT_STATED)) or NOT_STATED
