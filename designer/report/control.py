"""What a drawing office asks of a document: number, revision, names, logo, and what it is of."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from designer.documents.opened import read_input
from designer.documents.picture import picture_type, why_not_shown
from designer.grades.registry import Catalogue
from designer.report.document import Control, ControlBox
from designer.study import Study

_DIGITS = 12
"""Of a digest on the first page; the provenance has all of them."""


def control_of(study: Study, catalogue: Catalogue | None = None) -> Control:
    """Return the head of a document on a study; with the grades that it was solved with."""
    given = study.document
    names = ("number", "revision", "author", "checker", "approver")
    titles = ("Document", "Revision", "Author", "Checked", "Approved")
    boxes = (
        ControlBox(title, getattr(given, name)) for name, title in zip(names, titles, strict=True)
    )
    return Control(
        tuple(box for box in boxes if box.value),
        "" if given.logo is None else _data_uri(given.logo),
        " · ".join(f"{what} {digest[:_DIGITS]}" for what, digest in _digests(study, catalogue)),
    )


def _digests(study: Study, catalogue: Catalogue | None) -> Iterator[tuple[str, str]]:
    if study.source.sha256:
        yield "SHA-256 of configuration", study.source.sha256
    for source in catalogue.sources if catalogue is not None else ():
        if source.n_grades:
            yield f"grades {source.name}", source.sha256
    if study.measurements is not None:
        with suppress(OSError):  # a design needs no data, so they may be gone
            yield "measured data", sha256(read_input(study.measurements.file)).hexdigest()


def _data_uri(path: Path) -> str:
    """Return a picture; empty where it is gone or is none, although the study was read."""
    with suppress(OSError):
        content = read_input(path)
        if why_not_shown(content) is None:
            return f"data:{picture_type(content[:512])};base64,{base64.b64encode(content).decode()}"
    return ""
