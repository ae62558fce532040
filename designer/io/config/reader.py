"""From a config file to a study: read, check everything, build."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from pydantic import ValidationError

from designer.documents.document import Document, read_document
from designer.documents.faults import MOST_FAULTS, schema_faults
from designer.documents.node import path_text
from designer.effects.known import KnownEffects
from designer.effects.registry import SHIPPED
from designer.errors import Fault, InputError
from designer.io.config.build import build_study
from designer.io.config.checks import all_faults
from designer.io.config.effects import effect_entries
from designer.io.config.entries import all_entries
from designer.io.config.grade_family import family_entries, material_and_family
from designer.io.config.schema import StudySection
from designer.plugins.find import Plugins
from designer.study import Entry, Source, Study


def study_from(path: Path, known: KnownEffects = SHIPPED, plugins: Plugins | None = None) -> Study:
    """Return the study that the config file describes, see `designer.io.config.read_study`."""
    document = read_document(path)
    section = _checked(document, known)
    if section.name is None:
        section = section.model_copy(update={"name": path.stem})
    material, family = material_and_family(section, document, plugins)
    source = _source(path, document, section, known)
    source = replace(source, entries=tuple(family_entries([*source.entries], material, family)))
    return build_study(section, source, known, material, family)


def _checked(document: Document, known: KnownEffects) -> StudySection:
    faults = [*document.faults, *all_faults(document, known.by_id)]
    section = None
    try:
        section = StudySection.model_validate(document.root.data())
    except ValidationError as error:
        faults += schema_faults(error, document, StudySection)
    if section is None or faults:
        raise InputError(sorted(faults, key=_place)[:MOST_FAULTS])
    return section


def _place(fault: Fault) -> tuple[int, str]:
    return fault.line or 0, fault.field


def _source(path: Path, document: Document, section: StudySection, known: KnownEffects) -> Source:
    lines = {path_text(keys): node.line for keys, node in document.root.walk()}
    entries = [*all_entries(section, document.root), *_effect_entries(document, section, known)]
    return Source(path, document.sha256, tuple(entries), lines)


def _effect_entries(
    document: Document, section: StudySection, known: KnownEffects
) -> Iterator[Entry]:
    node = document.root.child("effects")
    if node is not None:
        yield from effect_entries(section.effects, node, len(section.robot.anchors), known.by_id)
