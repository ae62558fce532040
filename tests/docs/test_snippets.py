"""Every command, file and snippet of the docs, in the order in which a reader meets them.

What a block is: with a caption, a file of that name; ``console``, commands after ``$`` and below
each what it prints, in order, perhaps among more (``# status N`` where it is not 0); ``python``,
run in one namespace for a page; ``yaml`` without a caption, a part of a study. ``sh`` holds what
changes the machine, such as installing, and is not run here: `.ci/run` installs.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from jsonschema import Draft7Validator
from pages import DOCS, Block, blocks, pages

from designer.documents.document import document_of
from designer.effects.registry import SHIPPED
from designer.io.config.json_schema import study_schema

KNOWN = {"console", "python", "yaml", "html+jinja", "css+jinja", "text", "sh"}
_COMMAND = re.compile(r"^\$ (.*?)(?:\s+# status (\d))?$")
_AT_ONCE = {"how-to/plugin.md", "how-to/effect.md"}
_NOT_RUN = {"how-to/window.md"}
"""Opens the window, which has tests of its own."""
_SELDOM = {
    *("name", "not_tried", "strongest_covariate", "fraction_of_variance"),
    *("grade", "size_id", "safety_factor"),
    *("first", "second", "correlation"),  # of parameters that data tell badly apart
    "session",  # of logs of several sessions, which no page has
    # Of findings, each of which some studies have.
    *("policy", "depth_m", "inradius_m", "lowest_z_m"),
    *("kind", "turn", "move", "mixed", "of_any_cable"),  # a motion that no cable resists
    *("raised_m", "stronger"),  # what would hold a pose
    *("what", "why", "by_neighbours"),  # what a yes is subject to
    *("year", "low", "high"),  # of prices that are borrowed
    *("file", "dates", "prices"),  # of a price list
    *(
        "lowest_frequency_Hz",
        "share",
        "rotation_vector",
        "wind_direction",
        "inertia_direction",
        "wrench_N",
        "force_N",
    ),
}
"""Keys that not every result has."""


def name_of(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


def run(text: str) -> None:
    """Run the commands of a block, and compare what they print."""
    wanted: list[str] = []
    printed = ""
    for line in [*text.splitlines(), "$ exit 0"]:
        command = _COMMAND.match(line)
        if command is None:
            wanted.append(line.strip())
            continue
        for each in wanted:
            assert each in printed, f"not printed: {each!r}\n{printed}"
            printed = printed.partition(each)[2]
        wanted, printed = [], done(command[1], int(command[2] or 0))


def done(command: str, status: int) -> str:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    answer = subprocess.run(
        command,
        shell=True,
        env={**os.environ, "PATH": path, "COLUMNS": "100"},
        capture_output=True,
        text=True,
        check=False,
    )
    told = answer.stdout + answer.stderr
    assert answer.returncode == status, f"$ {command}\nstatus {answer.returncode}\n{told}"
    return told


def keys_are_told(name: str, found: dict[str, object]) -> None:
    """Compare a file that a page has made with the reference: first level both ways."""
    page = (DOCS / "reference" / "results.md").read_text(encoding="utf-8")
    part = page.partition(f"## `{name}`")[2].partition("\n## ")[0]
    cells = [row.split(" | ") for row in re.findall(r"^\| (`.*) \|$", part, re.M)]
    first = {key for cell in cells for key in re.findall(r"`(\w+)`", cell[0])}
    if "check" in found:  # of a diagnosis that searches nothing: a sentence of its own
        assert set(found) - first <= set(re.findall(r"`(\w+)`", part.rpartition("|\n")[2]))
        return
    assert first == set(found)
    filled = {key for key, value in found.items() if is_filled(value)}
    given = [cell for cell in cells if filled & set(re.findall(r"`(\w+)`", cell[0]))]
    below = {key for cell in given for key in re.findall(r"`(\w+)`", cell[1])}
    assert below - {key for one in found.values() for key in keys_in(one)} <= _SELDOM


def is_filled(value: object) -> bool:
    return any(value.values()) if isinstance(value, dict) else bool(value)


def keys_in(value: object) -> set[str]:
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    own = set(value) if isinstance(value, dict) else set()
    return own.union(*(keys_in(part) for part in parts))


def is_part_of_a_study(text: str) -> None:
    properties = study_schema(SHIPPED.by_id)["properties"]
    data = document_of(text.encode(), "part.yaml").root.data()
    assert isinstance(data, dict)
    for name, value in data.items():
        assert list(Draft7Validator(properties[name]).iter_errors(value)) == []


def follow(block: Block, names: dict[str, object]) -> None:
    assert block.language in KNOWN, block
    if block.file:
        Path(block.file).parent.mkdir(parents=True, exist_ok=True)
        Path(block.file).write_text(block.text, encoding="utf-8")
    elif block.language == "console":
        run(block.text)
    elif block.language == "python":
        exec(compile(block.text, f"line {block.line}", "exec"), names)
    elif block.language == "yaml":
        is_part_of_a_study(block.text)


def cases() -> Iterator[object]:
    for page in pages():
        name, languages = name_of(page), {block.language for block in blocks(page)}
        if languages and name not in _NOT_RUN:
            is_quick = name in _AT_ONCE or not languages & {"console", "python"}
            yield pytest.param(page, id=name, marks=[] if is_quick else [pytest.mark.slow])


@pytest.mark.parametrize("page", list(cases()))
def test_a_page_does_what_it_says(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks(page):
        follow(block, names)
    for kind in ("result", "diagnosis"):
        for file in Path().glob(f"*/{kind}.json"):
            keys_are_told(f"{kind}.json", json.loads(file.read_text(encoding="utf-8")))


def test_no_block_is_overlooked() -> None:
    for page in pages():
        text = page.read_text(encoding="utf-8")
        fences = [line for line in text.splitlines() if line.startswith("```")]
        others = sum(line.startswith("```{") and "code-block" not in line for line in fences)
        assert len(fences) == 2 * (len(list(blocks(page))) + others), name_of(page)


def test_there_is_something_to_run() -> None:
    found = [block for page in pages() for block in blocks(page)]
    run_here = [one for one in found if one.language != "sh"]
    print(f"{len(found)} blocks of code, {len(run_here)} of them followed")
    assert len(run_here) >= 40
