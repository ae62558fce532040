"""Numbers as a reader of a report wants them: a unit, few digits, thin spaces for thousands.

A no-break space stands before each unit and a narrow one between thousands, so that no line of
the report breaks inside a figure.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable

import numpy as np

MISSING = "–"
"""Stands for a number that does not exist."""

_THIN = "\u202f"
_BEFORE_UNIT = "\u00a0"
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_POSITION_DIGITS = 2
_FORCES = (("N", 1.0, 1e3), ("kN", 1e3, 1e7), ("MN", 1e6, math.inf))
_TINY, _TOO_WIDE = 1e-9, 1e12
"""Beyond these, numbers are written as powers of ten, so that none is wider than a column."""


def number(value: float, digits: int = 4) -> str:
    """Return a number rounded to ``digits`` significant digits."""
    if value == 0.0 or not math.isfinite(value):
        return fixed(value, 0)
    if not _TINY <= abs(value) < _TOO_WIDE:
        return power_of_ten(value)
    rounded = float(f"{value:.{digits - 1}e}")
    leading = math.floor(math.log10(abs(rounded)))
    return fixed(rounded, max(digits - 1 - leading, 0))


def trimmed(value: float, digits: int = 4) -> str:
    """Return a number with at most ``digits`` significant digits, without closing zeros."""
    text = number(value, digits)
    return text.rstrip("0").rstrip(".") if "." in text else text


def fixed(value: float, decimals: int) -> str:
    """Return a number with ``decimals`` digits after the point; a huge one as a power of ten."""
    if math.isnan(value):
        return MISSING
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if abs(value) >= _TOO_WIDE:
        return power_of_ten(value)
    text = f"{round(value, decimals) + 0.0:,.{decimals}f}"  # 0.0 makes a plain zero of −0
    return text.replace(",", _THIN).replace("-", "−")


def decimals(values: Iterable[float], digits: int = 3) -> int:
    """Return how many decimals a column needs so that its smallest number keeps its digits."""
    sizes = [abs(value) for value in values if math.isfinite(value) and value != 0.0]
    if not sizes:
        return 0
    return min(max(digits - 1 - math.floor(math.log10(min(sizes))), 0), 3)


def count(value: int) -> str:
    """Return a whole number, such as ``20 000``."""
    return fixed(value, 0)


def metres(value: float) -> str:
    """Return a length such as ``324.22 m``; one below 5 mm by its first digits."""
    if _TINY < abs(value) < 0.005:
        return power_of_ten(value, "m") if abs(value) < 1e-4 else _with_unit(trimmed(value, 2), "m")
    return _with_unit(fixed(value, 2), "m")


def square_metres(value: float) -> str:
    """Return an area such as ``93 280 m²``."""
    return _with_unit(number(value), "m²")


def cubic_metres(value: float) -> str:
    """Return a volume such as ``14 930 000 m³``."""
    return _with_unit(number(value), "m³")


def millimetres(value_m: float) -> str:
    """Return a small length such as ``51.2 mm``; the argument is in metres."""
    return _with_unit(number(1e3 * value_m, 3), "mm")


def newtons(value: float) -> str:
    """Return a force in N, kN or MN, such as ``371.0 kN``."""
    return _scaled(value, _FORCES)


def newtons_alike(*values: float) -> tuple[str, ...]:
    """Return forces that are to be compared, all in the unit that suits the smallest."""
    sizes = [abs(value) for value in values if math.isfinite(value) and value != 0.0]
    smallest = min(sizes, default=0.0)
    unit, scale = next((name, scale) for name, scale, end in _FORCES if smallest < end)
    return tuple(_scaled(value, ((unit, scale, math.inf),)) for value in values)


def alike(values_N: Iterable[float], digits: int = 4) -> Callable[..., tuple[str, ...]]:
    """Return what writes forces of one column: in one unit, the largest with so many digits."""
    largest_N = max((abs(value) for value in values_N if math.isfinite(value)), default=0.0)
    unit, scale = next((name, scale) for name, scale, end in _FORCES if largest_N < end)
    places = max(digits - 1 - math.floor(math.log10(max(largest_N / scale, 1.0))), 0)
    return lambda *values: tuple(
        _with_unit(fixed(float(value) / scale, places), unit) for value in values
    )


def force_unit(typical_N: float) -> tuple[str, float]:
    """Return the unit for a column of forces, and how many newtons it has."""
    return ("kN", 1e3) if typical_N >= 1e3 else ("N", 1.0)


def pascals(value: float) -> str:
    """Return a stress in MPa or GPa, such as ``180 MPa``."""
    return _scaled(value, (("MPa", 1e6, 1e10), ("GPa", 1e9, math.inf)), trimmed)


def kilograms(value: float) -> str:
    """Return a mass such as ``3 217 kg``."""
    return _with_unit(number(value), "kg")


def kilograms_per_metre(value: float) -> str:
    """Return a mass per length such as ``1.662 kg/m``."""
    return _with_unit(trimmed(value), "kg/m")


def kilograms_per_cubic_metre(value: float) -> str:
    """Return a density such as ``7 800 kg/m³``."""
    return _with_unit(number(value), "kg/m³")


def percent(fraction: float, digits: int = 3) -> str:
    """Return a share such as ``4.05 %``."""
    return _with_unit(number(100.0 * fraction, digits), "%")


def share(part: float, whole: float = 1.0) -> str:
    """Return a share such as ``4.05 %``; never ``100 %`` for what is not all."""
    nearly_all = part < whole and round(part / whole, 3) == 1.0
    return f"over{_BEFORE_UNIT}{percent(0.999)}" if nearly_all else percent(part / whole)


def signed_percent(fraction: float) -> str:
    """Return a change such as ``+12.3 %``."""
    text = fixed(100.0 * fraction, 1)
    return _with_unit(text if text.startswith(("−", MISSING)) else f"+{text}", "%")


def plus_minus(fraction: float) -> str:
    """Return a relative uncertainty such as ``± 5 %``."""
    return f"±{_BEFORE_UNIT}{_with_unit(trimmed(100.0 * fraction), '%')}"


def utilisation(fraction: float) -> str:
    """Return tension over what is allowed; never ``100.0 %`` for what exceeds it."""
    if math.isinf(fraction):
        return "not held"
    if fraction > 1.0 and round(100.0 * fraction, 1) == 100.0:
        return f"over{_BEFORE_UNIT}100{_BEFORE_UNIT}%"
    return _with_unit(fixed(100.0 * fraction, 1), "%")


def factor(value: float) -> str:
    """Return a plain ratio such as ``3.06``."""
    return number(value, 3)


def position(place: Iterable[float]) -> str:
    """Return a position such as ``(256.52, 10.35, −40.00) m``.

    Of a place with an orientation (position [m] and rotation vector [rad]) both, the latter in
    degrees and only where it is not zero.
    """
    xyz_m, turn_rad = np.split(np.array([*place], dtype=np.float64), [3])
    text = _with_unit(f"({_row(xyz_m)})", "m")
    if not turn_rad.any():
        return text
    return f"{text}, turned by {degrees(np.degrees(turn_rad))}"


def degrees(turn_deg: Iterable[float]) -> str:
    """Return a rotation vector [degrees] such as ``(0.00, 3.00, 0.00)°``."""
    return f"({_row(turn_deg)})°"


def _row(values: Iterable[float]) -> str:
    return f",{_BEFORE_UNIT}".join(fixed(float(x), _POSITION_DIGITS) for x in values)


def power_of_ten(value: float, unit: str = "") -> str:
    """Return a tiny or huge number such as ``3.1 × 10⁻¹² m``."""
    if not math.isfinite(value) or value == 0.0:
        return _with_unit(number(value), unit)
    digits, exponent = f"{value:.1e}".split("e")
    power = str(int(exponent)).translate(_SUPERSCRIPTS)
    return _with_unit(f"{digits.replace('-', '−')}{_THIN}×{_THIN}10{power}", unit)


def plural(amount: int, noun: str) -> str:
    """Return a count with its noun, such as ``1 grade`` or ``19 grades``."""
    return f"{count(amount)}{_BEFORE_UNIT}{noun}{'' if amount == 1 else 's'}"


def printed(text: str) -> str:
    """Return a plain text as it is printed: ``d²`` for ``d^2``, true minus signs and powers."""
    text = re.sub(r"(?<!\w)(\d+(?:\.\d+)?)e([-+]?\d{1,3})\b", _power, text)
    raised = re.sub(
        r"\^(\d)|(?<=\bmm)(2)\b",
        lambda found: (found[1] or found[2]).translate(_SUPERSCRIPTS),
        text,
    )
    return re.sub(r"(?<=[( ])-(?=\d)", "−", raised)


def _power(found: re.Match[str]) -> str:
    power = str(int(found[2])).translate(_SUPERSCRIPTS)
    return f"{found[1]}{_THIN}×{_THIN}10{power}"


def shorter(text: str) -> str:
    """Return a text in which no number has decimals that only a change of units has brought."""
    return re.sub(r"\d+\.\d{6,}(?!\d*e)", lambda found: f"{float(found[0]):.6g}", text)


def capital(text: str) -> str:
    """Return a text with a capital first letter."""
    return text[:1].upper() + text[1:]


def sentence(text: str) -> str:
    """Return a note of a table as it begins a sentence."""
    return printed(capital(text))


def doubtful(doubt: str | None) -> str:
    """Return the remark on figures of a size that are in doubt; empty where none are."""
    return f"Doubtful figures: {printed(doubt)}" if doubt else ""


def listing(words: Iterable[str], last: str = "and") -> str:
    """Return words as ``a, b and c``."""
    *head, tail = list(words)
    return f"{', '.join(head)} {last} {tail}" if head else tail


def _scaled(
    value: float,
    units: tuple[tuple[str, float, float], ...],
    shown: Callable[[float], str] = number,
) -> str:
    if not math.isfinite(value):
        return number(value)
    unit, scale = next((name, scale) for name, scale, end in units if abs(value) < end)
    return _with_unit(shown(value / scale), unit)


def _with_unit(text: str, unit: str) -> str:
    return text if not unit or text == MISSING else f"{text}{_BEFORE_UNIT}{unit}"
