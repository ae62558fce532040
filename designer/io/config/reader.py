"""From a config file to a study: read, check everything, build."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from designer.documents.document import Document, read_document
from designer.documents.faults import MOST_FAULTS, schema_faults
from designer.documents.node import path_text
from designer.effects.registry import SHIPPED, KnownEffects
from designer.errors import InputError
from designer.io.config.build import build_study
from designer.io.config.checks import all_faults
from designer.io.config.effects import effect_entries
from designer.io.config.entries import all_entries
from designer.io.config.schema import StudySection
from designer.plugins.find import Plugins
from designer.study import Study, StudySource


def read_study(
    path: Path, known_effects: KnownEffects | None = None, plugins: Plugins | None = None
) -> Study:
    """Return the study that the config file describes.

    Parameters
    ----------
    path : Path
        A YAML file.
    known_effects : KnownEffects or None
        Which effects it may declare; None for ours alone, without those of plugins.
    plugins : Plugins or None
        Whose grades ``cable`` may name; None for ours and those that the file itself adds.

    Raises
    ------
    designer.errors.InputError
        If anything is wrong with it; carries every fault, a hundred at most, in the order of the
        lines.
    """
    known, document = known_effects or SHIPPED, read_document(path)
    return study_of(checked(document, known), document, path, known, plugins)


def study_of(
    section: StudySection,
    document: Document,
    path: Path,
    known: KnownEffects,
    plugins: Plugins | None = None,
) -> Study:
    """Return the study of a document, `checked`, that lies, or is to lie, at a path."""
    if section.name is None:
        section = section.model_copy(update={"name": path.stem})
    entries = all_entries(section, document.root)
    effects = document.root.child("effects")
    if effects is not None:
        n_cables = len(section.robot.anchors)
        entries += effect_entries(section.effects, effects, n_cables, known.by_id)
    lines = {path_text(keys): node.line for keys, node in document.root.walk()}
    source = StudySource(path, document.sha256, tuple(entries), lines)
    return build_study(section, source, document, known, plugins)


def checked(document: Document, known: KnownEffects) -> StudySection:
    """Return what the document holds by the schema; `InputError` with all faults otherwise."""
    faults = [*document.faults, *all_faults(document, known.by_id)]
    section = None
    try:
        section = StudySection.model_validate(document.root.data())
    except ValidationError as error:
        faults += schema_faults(error, document, StudySection)
    if section is None or faults:
        faults.sort(key=lambda fault: (fault.line or 0, fault.field))
        raise InputError(faults[:MOST_FAULTS])
    return section
