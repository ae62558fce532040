"""The JSON Schema of the config, by which an editor completes, explains and checks it.

It knows fields, types and bounds. Which units there are, and what needs several fields at once,
only the program knows.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from designer.documents.bounds import MAX_CABLES
from designer.documents.fields import JsonSchema, WholeNumber, words_at
from designer.effects.effect import Effect
from designer.io.config.effects import field_of
from designer.io.config.machine import OrientationSection
from designer.io.config.schema import ColumnSection, PathSection, PoseSection, StudySection

_SHORTHANDS = (PoseSection, OrientationSection, ColumnSection, PathSection)
"""Sections that the file may also give as the value of their first field alone."""


def schema_text(effects: Mapping[str, Effect]) -> str:
    """Return the schema as a file."""
    return json.dumps(study_schema(effects), indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def study_schema(effects: Mapping[str, Effect]) -> JsonSchema:
    """Return the schema of a study that may declare these effects.

    It is of draft 7, which all editors know, and without references, so that each field can have
    a title and a description of its own.
    """
    generated: JsonSchema = StudySection.model_json_schema()
    sections = generated.pop("$defs")
    for section in _SHORTHANDS:
        mapping = sections[section.__name__]
        shorthand = _without(next(iter(mapping["properties"].values())), "expected")
        sections[section.__name__] = {"anyOf": [shorthand, mapping]}
    schema: JsonSchema = _plain(generated, sections)
    schema["properties"]["effects"] = {
        "type": ["object", "null"],
        "properties": {name: _effect(effect) for name, effect in effects.items()},
        "additionalProperties": False,
    }
    _explain(schema, "")
    head = {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A study of cdpr-designer",
    }
    return schema | head | {"description": "Fields, types and bounds; `designer` checks the rest."}


def _plain(node: Any, sections: Mapping[str, Any]) -> Any:
    """Return a part of the schema without references, and with one schema for all items of a list.

    A field that may be left out may also stand with nothing after it.
    """
    if isinstance(node, list):
        return [_plain(item, sections) for item in node]
    if not isinstance(node, dict):
        return node
    if "$ref" in node:
        return _plain(sections[node["$ref"].rpartition("/")[2]] | _without(node, "$ref"), sections)
    if isinstance(node.get("properties"), dict):
        fields = {  # `_explain` says what each is
            name: _without(field, "title", "description", "expected")
            for name, field in node["properties"].items()
        }
        node = node | {"properties": fields}
    plain = {key: _plain(value, sections) for key, value in node.items()}
    if "prefixItems" in plain:  # all of one kind, which older drafts can say as well
        plain["items"] = plain.pop("prefixItems")[0]
    for name, field in plain.get("properties", {}).items():
        if name not in plain.get("required", ()):
            plain["properties"][name] = _or_nothing(field)
    return plain


def _without(node: JsonSchema, *keys: str) -> JsonSchema:
    return {key: value for key, value in node.items() if key not in keys}


def _or_nothing(schema: JsonSchema) -> JsonSchema:
    """Return the schema of a field that may also be empty; its default stays outside."""
    default = schema.get("default")
    outside = {} if default is None or isinstance(default, dict) else {"default": default}
    outside |= {"x-unit": schema["x-unit"]} if "x-unit" in schema else {}
    inside = _without(schema, "default", "title")
    null = {"type": "null"}
    if not inside:
        return outside
    kinds = inside["anyOf"] if set(inside) <= {"anyOf", "x-unit"} else [inside]
    return {"anyOf": [*(kind for kind in kinds if kind != null), null], **outside}


def _effect(effect: Effect) -> JsonSchema:
    single = [parameter for parameter in effect.parameters if "{cable}" not in parameter.name]
    each_cable = [parameter for parameter in effect.parameters if "{cable}" in parameter.name]
    json_schema: JsonSchema = {
        "type": "object",
        "minProperties": 1,
        "properties": {parameter.name: field_of(parameter).json_schema() for parameter in single},
        "patternProperties": {
            f"^{parameter.name.format(cable='[1-9][0-9]?')}$": field_of(parameter).json_schema()
            for parameter in each_cable
        },
        "required": [parameter.name for parameter in single if not parameter.is_optional],
        "additionalProperties": False,
    }
    summary = effect.summary.format(cable="…")
    words = {"title": summary, "description": f"{effect.law} ({effect.source})"}
    if not effect.takes_cable:
        return json_schema | words
    json_schema["properties"]["cable"] = WholeNumber(1, MAX_CABLES).json_schema()
    json_schema["required"].append("cable")
    return {"anyOf": [json_schema, {"type": "array", "items": json_schema, "minItems": 1}], **words}


def _explain(node: JsonSchema, path: str) -> None:
    """Give each field below a path its title, and its meaning for a description."""
    for kind in (*node.get("anyOf", ()), *node.get("oneOf", ())):
        _explain(kind, path)
    if isinstance(node.get("items"), dict):
        _explain(node["items"], path)
    for name, field in node.get("properties", {}).items():
        place = f"{path}.{name}".lstrip(".")
        if place.startswith("effects."):
            continue
        field["title"], field["description"] = words_at(StudySection, place)
        _explain(field, place)
    if isinstance(node.get("additionalProperties"), dict):
        _explain(node["additionalProperties"], path)
