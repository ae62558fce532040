"""What all mappings of a config or grade file have in common, and what is wrong in them."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache
from typing import Annotated, Any, ClassVar, get_args, get_origin, get_type_hints

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    Tag,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, ErrorDetails, core_schema

from designer.documents.document import Document, Key, printable
from designer.errors import Fault
from designer.spelling import did_you_mean, nearest_name
from designer.units import describe


class Section(BaseModel):
    """A mapping of a file: frozen, without unknown fields, each with a text below it."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

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


@dataclasses.dataclass(frozen=True, slots=True)
class ReadAs:
    """Annotation of a value that the file gives as a section, whose ``value()`` it is."""

    section: type[Section]

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let pydantic read the section and make the value of it."""
        schema = handler.generate_schema(self.section)
        return core_schema.no_info_after_validator_function(lambda read: read.value(), schema)


AnySection = type[Section] | type[FileValue]


def config_field(title: str = "", default: object = None, *, expected: str = "") -> Any:
    """Return the field of a section; the text below it says what it is.

    Messages, editors, the window and the docs take its words from here. Where the section stands
    in several places, ``{title}`` and ``{meaning}`` are those of the field that holds it.

    Parameters
    ----------
    title : str
        What the window calls it; empty for its name in the file.
    default : object
        Its value where a file leaves it out.
    expected : str
        Of a field that must be given: what to write, for the message that it is missing.
    """
    extra: Any = {"expected": expected} if expected else None
    return Field(... if expected else default, title=title or None, json_schema_extra=extra)


def expected_of(field: FieldInfo) -> str:
    """Return what to write for a field that is missing; of a `FileValue` its description says."""
    extra = field.json_schema_extra
    expected = extra.get("expected") if isinstance(extra, dict) else None
    return str(expected or field.description or "")


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


def known_fields(schema: AnySection, loc: Sequence[Key]) -> Mapping[str, FieldInfo]:
    """Return the fields that the schema knows at pydantic's path ``loc``."""
    section = next(_sections_in(kind_at(schema, loc)), None)
    return fields_of(section) if section else {}


def kind_at(schema: AnySection, loc: Sequence[Key]) -> Any:
    """Return what the schema holds at a path, which may have pydantic's labels of alternatives."""
    kind: Any = schema
    for key in loc:
        kind = _step(kind, key)
    return kind


def _step(kind: Any, key: Key) -> Any:
    """Return what the schema holds one step further; a place in a list keeps its kind."""
    plain = get_args(kind)[0] if get_origin(kind) is Annotated else kind
    if get_origin(plain) is dict:
        return get_args(plain)[1]
    branch = _branch(kind, key)
    if branch is not None:
        return branch
    infos = (fields_of(section).get(str(key)) for section in _sections_in(kind))
    return next((info.rebuild_annotation() for info in infos if info is not None), kind)


def _branch(kind: Any, label: Key) -> Any:
    """Return the alternative with this label, None where there is none."""
    parts = get_args(kind)
    if any(isinstance(part, Tag) and part.tag == label for part in parts):
        return kind
    return next((branch for part in parts if (branch := _branch(part, label)) is not None), None)


def _sections_in(kind: Any) -> Iterator[AnySection]:
    if isinstance(kind, ReadAs):
        yield kind.section
    elif isinstance(kind, type) and issubclass(kind, Section | FileValue):
        yield kind
    else:
        for part in get_args(kind):
            yield from _sections_in(part)


@cache
def words_at(schema: AnySection, path: str) -> tuple[str, str]:
    """Return title and meaning of a field, by its dotted path without places in lists."""
    kind: Any = schema
    title = meaning = ""
    for name in path.split("."):
        infos = (fields_of(section).get(name) for section in _sections_in(kind))
        info = next((info for info in infos if info is not None), None) or FieldInfo()
        plain_title = name.replace("_", " ").capitalize()
        title, meaning = (
            words.replace("{title}", title.lower()).replace("{meaning}", meaning)
            for words in (info.title or plain_title, " ".join((info.description or "").split()))
        )
        kind = info.rebuild_annotation()
    return title, meaning


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
    meant = [(loc, nearest_name(str(loc[-1]), known_fields(schema, loc[:-1]))) for loc in unknown]
    misspelt = {(*loc[:-1], nearest) for loc, nearest in meant if nearest is not None}
    return [
        document.fault(_document_path(detail, document), *_words(detail, schema))
        for detail in details
        if detail["loc"] not in misspelt
    ]


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
        names = known_fields(schema, loc[:-1])
        expected = _one_of(names, "one of ") + did_you_mean(str(loc[-1]), names)
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
