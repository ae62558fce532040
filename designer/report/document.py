"""What a report is: sections with what their templates are given, and the head of the document."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import NamedTuple

from designer import __version__
from designer.report.phrases import shown_time

MOST_ROWS = 8
"""As many rows of a ranking as a reader takes in; files beside the report have the rest."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section: the id that links point to, classes of the style sheet, what its template gets.

    It is shown by a template of its own in the folder of the document, such as
    ``report/nomenclature.html.j2``, which gets ``context`` and sets ``title``; ``title`` and
    ``body`` are what that made of it.
    """

    id: str
    kind: str = ""
    context: Mapping[str, object] = field(default_factory=dict)
    title: str = ""
    body: str = ""


class ControlBox(NamedTuple):
    """A box in the head of a document, such as the number of the document."""

    label: str
    value: str


@dataclass(frozen=True, slots=True)
class Control:
    """Head of a document.

    Parameters
    ----------
    boxes : tuple of ControlBox
        Number, revision and names, those that the study gives.
    logo : str
        A picture as a data URI; may be empty.
    identity : str
        Digests of config, grades and measured data.
    """

    boxes: tuple[ControlBox, ...] = ()
    logo: str = ""
    identity: str = ""


NO_CONTROL = Control()


@dataclass(frozen=True, slots=True)
class Report:
    """A whole document; the templates know it as ``report``.

    Parameters
    ----------
    name : str
        ``report`` or ``diagnosis``: the name of its files, and of the folder of its own templates.
    title : str
        Name of the study.
    document : str
        What it is, such as ``Cable design report``.
    generator : str
        This program and its version.
    created, created_iso : str
        Date and time of the results, to read and as ISO 8601.
    sections : tuple of Section
        All sections, in order.
    missing : str
        Why pictures in space are left out, and what to install; empty where they are not.
    control : Control
        Number, revision, names, logo, digests.
    """

    name: str
    title: str
    document: str
    generator: str
    created: str
    created_iso: str
    sections: tuple[Section, ...]
    missing: str = ""
    control: Control = NO_CONTROL

    @classmethod
    def of(
        cls,
        name: str,
        title: str,
        document: str,
        created: datetime,
        sections: Iterable[Section | None],
        *,
        version: str = __version__,
        missing: str = "",
        control: Control = NO_CONTROL,
    ) -> Report:
        """Return a report; sections that are None are left out."""
        return cls(
            name,
            title,
            document,
            f"cdpr-designer {version}",
            shown_time(created),
            created.isoformat(timespec="seconds"),
            tuple(section for section in sections if section is not None),
            missing,
            control,
        )

    def section(self, section_id: str) -> Section:
        """Return a section that this report has."""
        return next(section for section in self.sections if section.id == section_id)
