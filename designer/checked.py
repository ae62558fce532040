"""What the fields of frozen values may be: said by their types, checked as a value is made.

Also how values show themselves.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, wraps
from html import escape
from inspect import signature
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from designer.arrays import FloatArray, finite_array
from designer.errors import InputError, WrongValueError
from designer.spelling import nearest_name

Made = TypeVar("Made")


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


_CALLED = {"anchors": "exit_points_m"}
"""Fields whose name in a study is no beginning of that in Python."""


def reports_field(kind: type[Made]) -> type[Made]:
    """Let a dataclass raise `WrongValueError`, which names the field, for all that it refuses."""
    made: Any = kind.__init__
    names = [entry.name for entry in fields(cast(Any, kind)) if entry.init]
    explained = _explained(kind.__name__, made, names)

    @wraps(made)
    def init(self: Any, *values: Any, **named: Any) -> None:
        for name, value in {**dict(zip(names, values, strict=False)), **named}.items():
            _require_field(kind, names, name, value)
        explained(self, *values, **named)

    kind.__init__ = init  # type: ignore[method-assign]
    for name, member in list(vars(kind).items()):
        if isinstance(member, classmethod):  # another way to make one
            arguments = [*signature(member.__func__).parameters]
            setattr(kind, name, classmethod(_explained(kind.__name__, member.__func__, arguments)))
    return kind


def _explained(kind: str, make: Callable[..., Any], names: Sequence[str]) -> Callable[..., Any]:
    @wraps(make)
    def explained(*values: Any, **named: Any) -> Any:
        try:
            return make(*values, **named)
        except InputError:
            raise
        except (ValueError, TypeError, AttributeError) as error:
            words = re.findall(r"\w+", str(error))  # each sentence names its field
            field = next((word for word in words if word in names), "")
            raise WrongValueError(kind, field, str(error)) from error

    return explained


def _require_field(kind: type, names: Sequence[str], name: str, value: object) -> None:
    """Refuse what is no field, with the one that a study calls so, and values of other classes."""
    if name not in names:
        meant = [n for n in names if n.startswith(f"{name}_") or n == _CALLED.get(name)]
        nearest = meant[0] if meant else nearest_name(name, names)
        expected = f"{nearest}, in SI units" if nearest else ", ".join(names)
        raise WrongValueError(kind.__name__, name, f"{name} is no field", expected)
    allowed, is_listed = _kinds_of(kind).get(name, ((object,), False))
    items = value if is_listed and isinstance(value, tuple | list) else [value]
    if not all(isinstance(item, allowed) for item in items):
        classes = " or ".join(part.__name__ for part in allowed if part is not NoneType)
        expected = "a number in SI units" if np.floating in allowed else classes
        raise WrongValueError(kind.__name__, name, f"{name} is {value!r:.60}", expected)


@cache
def _kinds_of(kind: type) -> dict[str, tuple[tuple[type, ...], bool]]:
    """Return what the values of fields may be instances of, and whether of tuples of them.

    Only of fields whose annotations are classes: what becomes an array is seen as one is made.
    """
    kinds = {}
    for name, hint in get_type_hints(kind).items():
        is_listed = get_origin(hint) is tuple and get_args(hint)[1:] == (...,)
        union = get_args(hint)[0] if is_listed else hint
        parts = get_args(union) if get_origin(union) in (Union, UnionType) else (union,)
        classes: set[Any] = set()
        for part in parts:
            is_literal = get_origin(part) is Literal
            classes |= {*map(type, get_args(part))} if is_literal else {get_origin(part) or part}
        if {int, float} & classes:
            classes |= {int, float, np.integer, np.floating}
        if bool in classes:
            classes.add(np.bool_)
        is_array = classes in ({np.ndarray}, {np.ndarray, NoneType})
        are_classes = all(isinstance(part, type) for part in classes)
        if are_classes and not is_array and tuple not in classes:
            kinds[name] = (tuple(classes), is_listed)
    return kinds


class Shown:
    """A value that shows what it holds beside defaults: in a line, in a notebook as a table."""

    __slots__ = ()

    def summary(self) -> dict[str, str]:
        """Return what is shown: a text for each name."""
        shown = {}
        for entry in fields(cast(Any, self)):
            value = getattr(self, entry.name)
            is_plain = isinstance(value, bool | int | float | str | tuple)
            is_default = value is entry.default or (is_plain and value in ((), entry.default))
            if entry.repr and value is not None and not is_default:
                shown[entry.name] = _in_short(value)
        return shown

    def __repr__(self) -> str:
        """Return one line."""
        return f"{type(self).__name__}({', '.join(f'{k}: {v}' for k, v in self.summary().items())})"

    def _repr_html_(self) -> str:
        rows = (
            f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in self.summary().items()
        )
        return f"<table><caption>{type(self).__name__}</caption>{''.join(rows)}</table>"


def _in_short(value: object) -> str:
    if isinstance(value, np.ndarray):
        is_short = value.size <= 6 and value.ndim <= 1
        return np.array2string(value, precision=5) if is_short else f"array {value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple | list | Mapping) and len(value) > 3:
        return f"{len(value)} of {type(next(iter(value))).__name__}"
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_in_short, value))})"
    if is_dataclass(value):
        name = next((n for n in ("name", "id", "label") if getattr(value, n, "")), "")
        return f"{type(value).__name__} {getattr(value, name)!r}" if name else type(value).__name__
    return f"{value!r:.60}" if isinstance(value, str) else f"{value!s:.60}"


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
