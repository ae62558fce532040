"""Two folders of reports: are the figures the same to 1e-12, and the words of the pages exactly?

    designer report STUDY.yaml -o REFERENCE_FOLDER/STUDY   # with the code before a change
    designer report STUDY.yaml -o NEW_FOLDER/STUDY         # with the code after it
    python tests/benchmarks/same_results.py REFERENCE_FOLDER NEW_FOLDER

Compared are all `result.json` and `report.html` of the reference, but for versions, times and
hashes. What differs is printed, and ends the run with status 1.
"""

from __future__ import annotations

import html
import json
import math
import re
import sys
from collections.abc import Iterator
from difflib import unified_diff
from pathlib import Path
from typing import Any

RTOL = 1e-12
PROVENANCE = {"created", "version", "config_sha256", "libraries", "system"}
"""What tells only how and when."""
TAG = re.compile(r"<(script|style)\b.*?</\1>|<[^>]*>", re.DOTALL)
TIME = re.compile(r"\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d)?|\b[0-9a-f]{12,64}\b")
MAX_LINES = 20
"""Printed of each file."""


def differing(a: Any, b: Any, path: str = "") -> Iterator[str]:
    """Yield the paths of `result.json` at which two values differ."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in sorted((a.keys() | b.keys()) - PROVENANCE):
            yield from differing(a.get(key, "absent"), b.get(key, "absent"), f"{path}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for k, pair in enumerate(zip(a, b, strict=True)):
            yield from differing(*pair, f"{path}[{k}]")
    elif isinstance(a, float) and isinstance(b, float):
        if not math.isclose(a, b, rel_tol=RTOL):
            yield f"{path.lstrip('.')}: {a!r}, now {b!r}"
    elif a != b:
        yield f"{path.lstrip('.')}: {str(a)[:60]}, now {str(b)[:60]}"


def words(page: Path) -> list[str]:
    """Return the lines of text of a page, those of drawings too, without times and hashes."""
    text = html.unescape(TAG.sub("\n", page.read_text(encoding="utf-8")))
    return [line for line in map(str.strip, TIME.sub("", text).splitlines()) if line]


def main() -> int:
    reference, new = map(Path, sys.argv[1:])
    files = sorted([*reference.rglob("result.json"), *reference.rglob("report.html")])
    is_same = bool(files)
    for file in files:
        name = file.relative_to(reference)
        pair = file, new / name
        if not pair[1].exists():
            lines = ["missing"]
        elif file.suffix == ".json":
            lines = [*differing(*(json.loads(p.read_text(encoding="utf-8")) for p in pair))]
        else:
            lines = [*unified_diff(*map(words, pair), lineterm="", n=0)][2:]
        print(f"{name}: {f'{len(lines)} lines differ' if lines else 'same'}")
        print(*(f"  {line}" for line in lines[:MAX_LINES]), sep="\n", end="\n" if lines else "")
        is_same &= not lines
    return 0 if is_same else 1


if __name__ == "__main__":
    sys.exit(main())
