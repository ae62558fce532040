"""Plugins that live for one test."""

from __future__ import annotations

import textwrap
from pathlib import Path


def install_plugin(site: Path, name: str, code: str, *, entry: str | None = None) -> None:
    """Write a module and its distribution's metadata, as an installer would, into ``site``."""
    module = name.replace("-", "_")
    site.mkdir(parents=True, exist_ok=True)
    (site / f"{module}.py").write_text(code, encoding="utf-8")
    info = site / f"{module}-1.2.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n")
    lines = f"[designer.plugins]\n{name} = {entry or module}\n"
    (info / "entry_points.txt").write_text(lines)


def hook(body: str, name: str = "register_grades") -> str:
    """Return the code of a plugin whose hook has this body."""
    return (
        "from designer.plugins import hookimpl\n\n"
        f"@hookimpl\ndef {name}():\n{textwrap.indent(body, '    ')}\n"
    )
