"""What a plugin answers to `register_grades` as plain data, to come from another process."""

from __future__ import annotations

import dataclasses
import numbers
import os
from pathlib import Path
from typing import Any

from designer.errors import described, one_line
from designer.grades import parts
from designer.grades.grade import Grade, Size

_KINDS: dict[str, Any] = {
    kind.__name__: kind
    for kind in (
        Grade, Size, parts.AreaFactor, parts.ComputedFigure, parts.Limits, parts.Modulus,
        parts.Reference, parts.SheaveRatio, parts.ThermalExpansion, parts.Units,
        parts.RelativeStiffness, parts.Remark,
    )
}  # fmt: skip
"""What a grade is made of."""
_KIND, _PATH, _MISFIT = "kind", "path", "misfit"


@dataclasses.dataclass(frozen=True, slots=True)
class Misfit:
    """In place of something that is no grade, and no path of grade files."""

    problem: str


def to_plain(item: object) -> dict[str, Any]:
    """Return a grade or a path as what JSON holds; of anything else why it is none of them."""
    try:
        if isinstance(item, str | os.PathLike):
            return {_PATH: os.fsdecode(item)}
        if not isinstance(item, Grade):
            kind = one_line(type(item).__name__)
            return {_MISFIT: f"register_grades() gave {kind}, not a path or a Grade"}
        plain: dict[str, Any] = _plain(item)
    except Exception as error:  # a stranger's value may do anything when it is looked at
        return {_MISFIT: f"a Grade is not usable: {described(error)}"}
    return plain


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        return float(value)
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    kind = next((item.__name__ for item in type(value).__mro__ if item in _KINDS.values()), None)
    if kind is None:
        raise TypeError(f"it holds {type(value).__name__}")
    names = [field.name for field in dataclasses.fields(_KINDS[kind])]
    return {_KIND: kind, **{name: _plain(getattr(value, name)) for name in names}}


def from_plain(item: dict[str, Any]) -> Path | Grade | Misfit:
    """Return the grade or path that `to_plain` was given."""
    if _PATH in item:
        return Path(item[_PATH])
    if _MISFIT in item:
        return Misfit(str(item[_MISFIT]))
    grade = _value(item)
    return grade if isinstance(grade, Grade) else Misfit("it gave no Grade")


def _value(plain: Any) -> Any:
    if isinstance(plain, list):
        return tuple(_value(item) for item in plain)
    if not isinstance(plain, dict):
        return plain
    values = {name: _value(item) for name, item in plain.items() if name != _KIND}
    return _KINDS[plain[_KIND]](**values)
