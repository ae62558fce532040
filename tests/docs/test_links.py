"""Links of the pages outside the site, which Sphinx does not follow, lead to files."""

from __future__ import annotations

import re

import pytest
from pages import ROOT

PAGES = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "plugins/README.md", "catalog/README.md"]


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_to_files(name: str) -> None:
    page = ROOT / name
    text = page.read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#:]+)(?:#[\w-]+)?\)", text)
    assert [link for link in links if not (page.parent / link).exists()] == []
    assert links or name not in ("README.md", "plugins/README.md")
