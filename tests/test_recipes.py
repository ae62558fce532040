"""What `CONTRIBUTING.md` tells to do for a new thing is all that it takes."""

from __future__ import annotations

import ast
from pathlib import Path

import designer
from designer.model.verdict import Verdict
from designer.report.figures.charts_shares import parts
from designer.workspace.result import Census


def test_every_verdict_has_its_part_of_the_bar() -> None:
    met = Census(len(Verdict), {verdict.label: 1 for verdict in Verdict}, 0, 0)
    found = parts(met)
    assert sum(part.count for part in found) == met.samples
    assert {part.label for part in found} >= {v.reason for v in Verdict} - {Verdict.SOLVED.reason}
    assert len({(part.colour, part.hatch) for part in found}) == len(found)


def test_every_verdict_but_solved_says_what_to_do() -> None:
    for verdict in set(Verdict) - {Verdict.SOLVED}:
        assert verdict.advice.startswith("Move the configured pose")


def test_verdicts_are_listed_only_where_they_are_defined() -> None:
    package = Path(designer.__file__).parent
    home = package / "model" / "verdict.py"
    listed = [
        f"{path.relative_to(package)}:{node.lineno}"
        for path in sorted(package.rglob("*.py"))
        if path != home
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Tuple | ast.List | ast.Set | ast.Dict)
        if sum(ast.unparse(part).startswith("Verdict.") for part in ast.iter_child_nodes(node)) > 2
    ]
    assert listed == []
