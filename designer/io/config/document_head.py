"""What a config says of the head of the report."""

from __future__ import annotations

from designer.documents.fields import Text
from designer.documents.section import Section


class DocumentSection(Section):
    """What a drawing office writes on the report."""

    number: Text | None = None
    revision: Text | None = None
    author: Text | None = None
    checker: Text | None = None
    approver: Text | None = None
    logo: Text | None = None
