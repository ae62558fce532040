"""Turns what pydantic found in a grade file into faults with a line, in plain words."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from designer.catalogue.schema import GradeSection
from designer.config.document import Document
from designer.config.node import Key, printable
from designer.errors import Fault
from designer.units import describe


def schema_faults(error: ValidationError, document: Document) -> list[Fault]:
    """Return one fault for each thing that does not follow the schema.

    A field that is missing while another one beside it has nearly its name is reported once, as
    misspelt.
    """
    details = error.errors(include_url=False)
    misspelt = {
        (*one["loc"][:-1], _nearest(one["loc"]))
        for one in details
        if one["type"] == "extra_forbidden"
    }
    return [
        document.fault(one["loc"], *_words(one)) for one in details if one["loc"] not in misspelt
    ]


def _words(detail: ErrorDetails) -> tuple[str, str]:
    """Return the problem and what was expected."""
    loc, kind, context = detail["loc"], detail["type"], detail.get("ctx", {})
    if kind == "fault":
        return context["problem"], context["expected"]
    if kind == "missing":
        return "is missing", _fields_at(loc[:-1])[str(loc[-1])].description or ""
    if kind == "extra_forbidden":
        nearest = _nearest(loc)
        hint = f"; did you mean '{nearest}'?" if nearest else ""
        expected = f"one of {', '.join(_fields_at(loc[:-1]))}{hint}"
        return f"unknown field '{printable(str(loc[-1]))}'", expected
    found = describe(detail["input"])
    if kind == "literal_error":
        return f"{found} is not known", context["expected"]
    return f"{found} is not a mapping", f"a mapping with {', '.join(_fields_at(loc))}"


def _nearest(loc: Sequence[Key]) -> str | None:
    names = difflib.get_close_matches(str(loc[-1]), _fields_at(loc[:-1]), n=1)
    return names[0] if names else None


def _fields_at(loc: Sequence[Key]) -> dict[str, FieldInfo]:
    """Return the fields that the schema knows at this place of a grade file."""
    section: type[BaseModel] = GradeSection
    for key in loc:
        if isinstance(key, str):
            section = _section_in(section.model_fields[key].annotation) or section
    return section.model_fields


def _section_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _section_in(part))), None)
