"""What all mappings of a config or grade file have in common."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cache
from typing import Any, ClassVar, get_type_hints

from pydantic import BaseModel, ConfigDict, TypeAdapter, model_validator
from pydantic.fields import FieldInfo


class Section(BaseModel):
    """A mapping of a file: frozen, without unknown fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _leave_out_empty_fields(cls, given: object) -> object:
        return _without_empty(cls, given)


class FileValue:
    """Base of a dataclass that is read from a mapping by `reader_of`.

    Its annotations say what each field may hold in a file and, by an alias, how the file calls it.
    Made in Python it is a plain dataclass, which checks nothing.
    """

    __slots__ = ()
    __pydantic_config__: ClassVar = ConfigDict(extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _leave_out_empty_fields(cls, given: object) -> object:
        return _without_empty(cls, given)


@cache
def reader_of(kind: Any) -> TypeAdapter[Any]:
    """Return what reads values of a kind; made once, since that takes milliseconds."""
    return TypeAdapter(kind)


AnySection = type[Section] | type[FileValue]


def fields_of(section: AnySection) -> Mapping[str, FieldInfo]:
    """Return the fields of a mapping, by their names in the file."""
    if issubclass(section, BaseModel):
        return section.model_fields
    kind: Any = section  # mypy takes its __hash__ for a method of one value
    return _annotated_fields(kind)


@cache
def _annotated_fields(section: Any) -> dict[str, FieldInfo]:
    hints = get_type_hints(section, include_extras=True)
    infos = {
        field.name: FieldInfo.from_annotation(hints[field.name])
        if field.default is dataclasses.MISSING
        else FieldInfo.from_annotated_attribute(hints[field.name], field.default)
        for field in dataclasses.fields(section)
    }
    return {info.alias or name: info for name, info in infos.items()}


def _without_empty(section: AnySection, given: object) -> object:
    """Take ``samples:`` with nothing after it as a field that is not given."""
    if not isinstance(given, dict):
        return given
    fields = fields_of(section)
    return {
        key: value
        for key, value in given.items()
        if value is not None or key not in fields or fields[key].is_required()
    }
