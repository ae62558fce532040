"""Turns what pydantic found into faults with a line, in plain words."""

from __future__ import annotations

import difflib
from collections.abc import Collection

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from designer.documents.document import Document
from designer.documents.node import Key, printable
from designer.documents.section import AnySection, expected_of, known_fields
from designer.errors import Fault
from designer.units import describe

_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
MOST_FAULTS = 100
"""As many as anybody reads; a wrong generated file could have one in each of its lines."""


def schema_faults(error: ValidationError, document: Document, schema: AnySection) -> list[Fault]:
    """Return one fault for each thing in the document that does not follow the schema.

    A field that is missing while another one beside it has nearly its name is reported once, as
    misspelt. After the first hundred the rest are left out.
    """
    details = error.errors(include_url=False)[:MOST_FAULTS]
    unknown = [detail["loc"] for detail in details if detail["type"] in _UNKNOWN]
    meant = [(loc, _nearest_field(loc, schema)) for loc in unknown]
    misspelt = {(*loc[:-1], nearest) for loc, nearest in meant if nearest is not None}
    return [
        document.fault(_document_path(detail, document), *_words(detail, schema))
        for detail in details
        if detail["loc"] not in misspelt
    ]


def _nearest_field(loc: tuple[Key, ...], schema: AnySection) -> str | None:
    names = difflib.get_close_matches(str(loc[-1]), known_fields(schema, loc[:-1]), n=1)
    return names[0] if names else None


def _document_path(detail: ErrorDetails, document: Document) -> list[Key]:
    """Return pydantic's path without the steps that the document does not have.

    Those are the labels of alternatives, and the fields that a shorthand leaves out.
    """
    keys: list[Key] = []
    node = document.root
    for key in detail["loc"]:
        child = node.child(key)
        if child is not None:
            keys.append(key)
            node = child
    return [*keys, detail["loc"][-1]] if detail["type"] == "missing" else keys


def _words(detail: ErrorDetails, schema: AnySection) -> tuple[str, str]:
    """Return the problem and what was expected."""
    loc, context = detail["loc"], detail.get("ctx", {})
    if detail["type"] == "fault":
        return context["problem"], context["expected"]
    if detail["type"] == "missing":
        return "is missing", expected_of(known_fields(schema, loc[:-1])[str(loc[-1])])
    if detail["type"] in _UNKNOWN:
        nearest = _nearest_field(loc, schema)
        hint = f"; did you mean '{nearest}'?" if nearest else ""
        expected = _one_of(known_fields(schema, loc[:-1]), "one of ") + hint
        return f"unknown field '{printable(str(loc[-1]))}'", expected
    needed = _one_of(known_fields(schema, loc), "a mapping with ")
    verdict, expected = {
        "literal_error": ("is not known", context.get("expected", "")),
        "bool_type": ("is not a truth value", "true or false"),
        "model_type": ("is not a mapping", needed),
        "dataclass_type": ("is not a mapping", needed),
        "dict_type": ("is not a mapping", "a mapping such as {}"),
    }.get(detail["type"], ("is not valid here", ""))
    return f"{describe(detail['input'])} {verdict}", expected


def _one_of(names: Collection[str], lead: str) -> str:
    return lead + ", ".join(names) if names else ""
