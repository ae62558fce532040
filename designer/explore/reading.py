"""What a text is: a study, or what is wrong with it; and the files that texts are in."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from designer.documents.document import Document, decode, document_of
from designer.documents.opened import read_bytes
from designer.effects.registry import KnownEffects
from designer.errors import DesignerError, Fault, InputError
from designer.explore.fields import Field, study_fields
from designer.io.config.moved import moved_to
from designer.io.config.reader import checked, study_of
from designer.io.config.schema import StudySection
from designer.plugins.find import Plugins
from designer.study import Study


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What a text is read with: where its relative paths start, effects, and plugins' grades."""

    path: Path
    effects: KnownEffects
    plugins: Plugins

    def read(self, text: str) -> Reading:
        """Return what a text is."""
        try:
            document = document_of(text.encode(), str(self.path))
            section = checked(document, self.effects)
            study = study_of(section, document, self.path, self.effects, self.plugins)
        except InputError as error:
            return Reading(self, text, None, error.faults)
        except DesignerError as error:
            return Reading(self, text, None, (Fault(str(self.path), None, "", str(error)),))
        return Reading(self, text, study, (), document, section)


@dataclass(frozen=True, eq=False)
class Reading:
    """A text, and the study that it is; None, and faults, where it is none."""

    context: Context
    text: str
    study: Study | None
    faults: tuple[Fault, ...]
    document: Document | None = None
    section: StudySection | None = None

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        """Every value that can vary; empty where the text is no study."""
        if self.section is None or self.document is None:
            return ()
        return study_fields(self.section, self.document.root, self.context.effects.by_id)

    @cached_property
    def by_path(self) -> dict[str, Field]:
        """The same by their paths."""
        return {field.path: field for field in self.fields}

    def moved_to(self, folder: Path) -> str:
        """Return the text with the relative paths in it as they are from a folder."""
        if self.document is None:
            return self.text
        return moved_to(folder, self.text, self.document, self.context.path.parent)


def text_of(path: Path) -> str:
    """Return what a file holds, its line ends kept.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or is no text.
    """
    return decode(read_bytes(path, str(path)), str(path))
