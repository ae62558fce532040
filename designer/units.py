"""Quantities as people write them, such as ``4000 kg`` or ``200 GPa``, read into SI numbers.

A text is taken apart by a small grammar of our own, so that nothing in it is ever evaluated, and
only the names of units go to pint, of which most studies need none.
"""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pint import Unit, UnitRegistry

_LONGEST_TEXT = 64
_NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?(?![\d.])")
_FACTOR = re.compile(
    r"\s*(?:(?P<divided>/)(?:\s*(?P<of>1000?))?|[*·])?\s*(?P<name>[^\W\d]{1,40}|°[CF]?|%)"
    r"(?:(?:\s*(?:\^|\*\*)\s*)?(?P<power>[-+]?[1-9]))?(?!\d)"
)
_MANY = {"100": "hecto", "1000": "kilo", None: ""}
"""Rope tables give the mass of so many feet or metres."""
_COMMON_UNITS = (
    *("m", "mm", "cm", "km", "in", "ft", "metre", "meter", "millimetre", "inch", "foot", "feet"),
    *("kg", "g", "t", "lb", "kilogram", "gram", "tonne", "pound"),
    *("N", "kN", "MN", "kgf", "lbf", "kip", "tonf", "newton", "kilonewton", "meganewton"),
    *("Pa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "pascal", "megapascal", "gigapascal"),
    *("rad", "deg", "radian", "degree", "K", "degC", "kelvin", "s", "min", "h", "second", "Hz"),
)
TONS = ("short_ton_force", "tonf", "long_ton_force")
_FORCES_OF_TONS = "short_ton_force (2000 lb), tonf (1000 kg), long_ton_force (2240 lb)"
_TABLE_UNITS = {
    "m": "mm, cm, m, in",
    "N": f"N, daN, kN, MN, kgf, lbf, kip, {_FORCES_OF_TONS}",
    "kg/m": "kg/m, g/m, kg/100m, kg/km, lb/ft, lb/100ft",
    "m^2": "mm^2, cm^2, in^2",
}


@dataclass(frozen=True, slots=True)
class Dimension:
    """A kind of quantity: such as ``a length``, its SI unit (empty for a number), an example.

    Of numbers, those that may be given in percent say so.
    """

    noun: str
    unit: str
    example: str
    takes_percent: bool = False

    @property
    def expected(self) -> str:
        """What to write, for an error message."""
        return f"{self.noun} such as " + (f"'{self.example}'" if self.unit else self.example)

    @property
    def expected_unit(self) -> str:
        """What unit to write in a table, for an error message."""
        return f"a unit of {self.noun}: {_TABLE_UNITS.get(self.unit, self.unit)}"


NUMBER = Dimension("a plain number", "", "5")
FRACTION = Dimension("a fraction", "", "0.9")
RELATIVE = Dimension("a share", "", "2 %", takes_percent=True)
LENGTH = Dimension("a length", "m", "2 mm")
AREA = Dimension("an area", "m^2", "20 mm^2")
ANGLE = Dimension("an angle", "rad", "10 deg")
MASS = Dimension("a mass", "kg", "4000 kg")
FORCE = Dimension("a force", "N", "10 kN")
MOMENT = Dimension("a moment", "N*m", "2 kN*m")
STRESS = Dimension("a stress or a modulus", "Pa", "200 GPa")
DENSITY = Dimension("a density", "kg/m^3", "7800 kg/m^3")
LINEAR_DENSITY = Dimension("a mass per length", "kg/m", "0.142 kg/m")
PER_TEMPERATURE = Dimension("a strain per temperature", "1/K", "1.2e-5 /K")
TIME = Dimension("a time", "s", "10 s")
PER_LENGTH = Dimension("a change per length", "1/m", "2e-4 /m")
COMPLIANCE = Dimension("a displacement per force", "m/N", "2e-6 m/N")
FLEXURAL_RIGIDITY = Dimension("a flexural rigidity", "N*m^2", "12 N*m^2")
TEMPERATURE = Dimension("a temperature", "degC", "20 degC")
TEMPERATURE_CHANGE = Dimension("a change of temperature", "K", "-30 K")
SPEED = Dimension("a speed", "m/s", "3 m/s")
FREQUENCY = Dimension("a frequency", "Hz", "2 Hz")
STIFFNESS = Dimension("a force per displacement", "N/m", "50 kN/m")
INERTIA = Dimension("a moment of inertia", "kg*m^2", "300 kg*m^2")
ROTATIONAL_SPEED = Dimension("a rotational speed", "rad/s", "3000 rpm")
POWER = Dimension("a power", "W", "5 kW")
ACCELERATION = Dimension("an acceleration", "m/s^2", "0.5 m/s^2")

SCALES = {
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "in": 0.0254},
    "m^2": {"mm^2": 1e-6, "mm2": 1e-6, "in2": 0.00064516},
    "rad": {"rad": 1.0, "deg": 0.017453292519943295},
    "kg": {"kg": 1.0, "t": 1e3},
    "N": {"N": 1.0, "daN": 10.0, "kN": 1e3, "kgf": 9.80665, "lbf": 4.4482216152605005}
    | {"short_ton_force": 8896.443230521003},
    "N*m": {"N*m": 1.0, "kN*m": 1e3},
    "Pa": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6},
    "kg/m^3": {"kg/m^3": 1.0},
    "kg/m": {"kg/m": 1.0, "g/m": 1e-3, "kg/km": 1e-3, "lb/ft": 1.488163943569554}
    | {"kg/100m": 0.01, "lb/100ft": 0.01488163943569554},
    "1/K": {"/K": 1.0, "1/K": 1.0},
    "m/s": {"m/s": 1.0},
    "m/s^2": {"m/s^2": 1.0},
}
"""What pint makes of common units of each SI unit, so that most studies do without importing it."""


class QuantityError(ValueError):
    """A value is no quantity of the wanted kind: what was found, and what was expected.

    The reader of a file turns it into a `designer.errors.Fault`, which knows the line.
    """

    def __init__(self, problem: str, expected: str) -> None:
        super().__init__(f"{problem} (expected {expected})")
        self.problem, self.expected = problem, expected


def read_quantity(value: object, dimension: Dimension) -> float:
    """Return the SI value of ``value``.

    Parameters
    ----------
    value : int, float or str
        A bare number, which is SI already, or a text that may carry a unit.
    dimension : Dimension
        What kind of quantity it has to be.

    Returns
    -------
    float
        Finite value in ``dimension.unit``.

    Raises
    ------
    QuantityError
        If it is no number, not finite, or has an unknown unit or one of another dimension.
    """
    try:
        return _read(value, dimension)
    except _MisreadError as error:
        raise error.about(value, dimension.expected) from None


def unit_conversion(unit: str, dimension: Dimension) -> tuple[float, float]:
    """Return scale and offset from numbers in a unit to SI; raises as `read_quantity` does."""
    zero, unit_SI = (read_quantity(f"{number} {unit}", dimension) for number in (0, 1))
    return unit_SI - zero, zero


def split_quantity(value: object) -> tuple[float, str] | None:
    """Return number and unit of a quantity as they are written; None for what is none."""
    number = _NUMBER.match(str(value).strip())
    if number is None or isinstance(value, bool):
        return None
    return float(number[0]), str(value).strip()[number.end() :].strip()


def in_SI(given: object) -> float:
    """Return the SI value of a quantity of whatever kind; a bare number is one already.

    Raises
    ------
    QuantityError
        If it is none.
    """
    parts = split_quantity(given)
    try:
        if parts is None or not math.isfinite(parts[0]):
            raise _MisreadError("is not a number")
        value, unit = parts
        if not unit:
            return value
        return float(_registry().Quantity(value, _unit(unit)).to_base_units().magnitude)
    except _MisreadError as error:
        raise error.about(given, "a quantity") from None


def format_SI(value: float, dimension: Dimension) -> str:
    """Return ``value`` (in SI) as text with its SI unit, such as ``0.002 m`` or ``2e11 Pa``."""
    text = f"{value + 0.0:.10g}"  # 0.0 makes a plain zero of −0
    if abs(value) >= 1e6:
        digits, power = f"{value:.9e}".split("e")
        text = f"{digits.rstrip('0').rstrip('.')}e{int(power)}"
    return f"{text} {dimension.unit}".rstrip()


def describe(value: object) -> str:
    """Name a value of a file within an error message, cut short and free of control codes."""
    if value is None:
        return "an empty value"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return repr(value if len(value) <= _LONGEST_TEXT else value[:_LONGEST_TEXT] + "…")
    if isinstance(value, int | float):
        return f"{_as_float(value):.10g}"
    return "a mapping" if isinstance(value, dict) else "a list"


class _MisreadError(Exception):
    def __init__(self, problem: str, *, instead: str = "", nearest: str | None = None) -> None:
        super().__init__(problem)
        self.problem, self.instead, self.nearest = problem, instead, nearest

    def about(self, value: object, expected: str) -> QuantityError:
        """Return the error about a value of a file."""
        hint = f"; did you mean '{self.nearest}'?" if self.nearest else ""
        return QuantityError(f"{describe(value)} {self.problem}", (self.instead or expected) + hint)


def _read(given: object, dimension: Dimension) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float | str):
        raise _MisreadError("is not a number")
    value = _read_text(given, dimension) if isinstance(given, str) else _as_float(given)
    if not math.isfinite(value):
        raise _MisreadError("is not a finite number")
    return value


def _as_float(number: float) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf


@functools.lru_cache(maxsize=4096)
def _read_text(text: str, dimension: Dimension) -> float:
    if len(text) > _LONGEST_TEXT:
        raise _MisreadError(f"is too long for a number ({len(text)} characters)")
    plain = unicodedata.normalize("NFKC", text).replace("−", "-").strip()
    number = _NUMBER.match(plain)
    if number is None:
        is_infinite = plain.strip("+-.").lower() in {"nan", "inf", "infinity"}
        raise _MisreadError("is not a finite number" if is_infinite else "is not a number")
    value, unit = float(number[0]), plain[number.end() :].strip()
    if unit.startswith(","):
        raise _MisreadError("has a decimal comma", instead="a decimal point")
    scale = SCALES.get(dimension.unit, {}).get(unit) if unit else 1.0
    return _to_SI(value, _unit(unit), dimension) if scale is None else value * scale


def _to_SI(value: float, unit: Unit, dimension: Dimension) -> float:
    """Return the SI value of a unit of this dimension; an angle is not a plain ratio."""
    from pint import PintError

    with suppress(PintError, ArithmeticError):  # such as a logarithmic unit in a product
        expected = _unit(dimension.unit)
        if dimension.takes_percent and unit == _unit("%"):
            return value / 100.0
        if dimension.unit and _root(unit) == _root(expected):
            if dimension is TEMPERATURE_CHANGE and _registry().Quantity(0.0, unit).to(expected):
                raise _MisreadError(f"has the unit {unit:P}, of which 0 is no change of 0 K")
            return float(_registry().Quantity(value, unit).to(expected).magnitude)
    raise _MisreadError(f"has the unit {unit:P}")


@functools.lru_cache(maxsize=1024)
def _unit(text: str) -> Unit:
    """Return the unit that ``text`` names, a product of powers of names that pint knows."""
    rest = text.removeprefix("1") if text.startswith("1/") else text
    factors = []
    while rest:
        factor = _FACTOR.match(rest)
        if factor is None:
            raise _MisreadError(f"has the unreadable unit {text!r}")
        name = _MANY[factor["of"]] + factor["name"]
        _check_unit(name)
        power = int(factor["power"] or 1) * (-1 if factor["divided"] else 1)
        factors.append(f"{name}**{power}" if power != 1 else name)
        rest = rest[factor.end() :]
    return _registry().parse_units("*".join(factors))


def _check_unit(name: str) -> None:
    from pint import PintError

    from designer.spelling import nearest_name

    if re.fullmatch(r"tons?(_force)?|force_tons?", name):
        masses = "short_ton (2000 lb), t (1000 kg), long_ton (2240 lb)"
        instead = f"of a mass {masses}; of a force {_FORCES_OF_TONS}"
        raise _MisreadError(f"has the unit '{name}', of which there are three", instead=instead)
    try:
        _registry().parse_units(name)
    except PintError:
        nearest = nearest_name(name, _COMMON_UNITS)
        raise _MisreadError(f"has the unknown unit '{name}'", nearest=nearest) from None


@functools.lru_cache(maxsize=1024)
def _root(unit: Unit) -> Unit:
    return _registry().get_root_units(unit)[1]


@functools.cache
def _registry() -> UnitRegistry[float]:
    from pint import UnitRegistry

    try:  # as pint has once read its definitions on this machine, which takes a quarter second
        registry: UnitRegistry[float] = UnitRegistry(cache_folder=":auto:")
    except Exception:  # there is no folder for that, or another process is just writing there
        registry = UnitRegistry()
    # As in tables that have kgf; tons of 2000 and 2240 lb have names of their own.
    registry.define("tonf = 1000 * kilogram_force")
    return registry
