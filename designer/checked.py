"""What the fields of frozen values may be: said by their types, checked as a value is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

import numpy as np

from designer.arrays import FloatArray, finite_array


@dataclass(frozen=True, slots=True)
class Number:
    """What a number may be: above or at least so much, at most so much, and finite or not NaN."""

    above: float = -np.inf
    least: float = -np.inf
    most: float = np.inf
    finite: bool = True

    def require(self, name: str, value: float | FloatArray) -> None:
        """Raise ValueError, with one sentence, unless a value is such a number, or all of it."""
        if isinstance(value, np.ndarray):
            for number in value.ravel().tolist():
                self.require(name, number)
            return
        if not value > self.above and self.above > -np.inf:
            raise ValueError(f"{name} must be above {self.above:g}, not {value:g}")
        if not value >= self.least:
            raise ValueError(f"{name} must not be below {self.least:g}, and is {value:g}")
        if value > self.most:
            raise ValueError(f"{name} must not be above {self.most:g}, and is {value:g}")
        if np.isnan(value) or (self.finite and not np.isfinite(value)):
            raise ValueError(f"{name} must be finite, not {value:g}")


FINITE = Number()
Finite = Annotated[float, FINITE]
Positive = Annotated[float, Number(above=0.0)]
Positives = Annotated[float | FloatArray, Number(above=0.0)]
NotNegative = Annotated[float, Number(least=0.0)]
Factor = Annotated[float, Number(least=1.0)]
Efficiency = Annotated[float, Number(above=0.0, most=1.0)]
Count = Annotated[int, Number(least=1)]


@dataclass(frozen=True, slots=True)
class Shape:
    """Length of each axis of an array of finite floats; None for any but zero."""

    axes: tuple[int | None, ...]


Vector = Annotated[FloatArray, Shape((3,))]
Wrench = Annotated[FloatArray, Shape((6,))]
Points = Annotated[FloatArray, Shape((None, 3))]


class Value:
    """A frozen value that refuses what its fields do not allow; see `check_fields`."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check_fields(self)


def check_fields(value: Any) -> None:
    """Raise ValueError, with one sentence, unless the fields of a value are as their types say.

    That is a `Number`, a `Shape`, or a ``Literal``, of which a tuple has each text once. None
    stands for what is not given. Arrays become what `finite_array` makes of them.
    """
    kind: Any = type(value)
    for name, limit in _limits_of(kind):
        given = getattr(value, name)
        if given is None:
            continue
        if isinstance(limit, Number):
            limit.require(name, given)
        elif isinstance(limit, Shape):
            object.__setattr__(value, name, finite_array(name, given, *limit.axes))
        else:
            require_one_of(name, [given] if isinstance(given, str) else given, limit)


@cache
def _limits_of(kind: type) -> list[tuple[str, Any]]:
    """Return the names of the fields that have limits, each with its own."""
    limits: list[tuple[str, Any]] = []
    for name, hint in get_type_hints(kind, include_extras=True).items():
        for part in (hint, *get_args(hint)):  # such as `Positive | None`
            if get_origin(part) is Literal:
                limits.append((name, get_args(part)))
            limits += [(name, x) for x in get_args(part)[1:] if isinstance(x, Number | Shape)]
    return limits


def require_one_of(name: str, values: Sequence[object], allowed: Sequence[object]) -> None:
    """Raise ValueError unless everything given is known, and nothing is given twice."""
    for k, value in enumerate(values):
        if value not in allowed:
            raise ValueError(f"{name}: {value!r} is none of {', '.join(map(str, allowed))}")
        if value in values[:k]:
            raise ValueError(f"{name}: {value!r} is given twice")
