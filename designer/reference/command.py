"""`designer verify`: figures of others beside ours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from designer.cli.options import output_option


def verify(
    output: Annotated[Path | None, output_option("none", "FILE.md")] = None,
) -> bool:
    """Compute what was published or computed by other programs, and put it beside theirs.

    Example:  designer verify -o verification.md

    Exit status 0: every figure is as near as its source allows. 1: one is not.
    """
    from rich.markup import escape

    from designer.cli.terminal import ProgressBars, announce_compiling, bare_table, show
    from designer.io.output import require_file, write_file
    from designer.reference.page import HEADINGS, cells, compute, markdown

    if output is not None:
        require_file(output)
    announce_compiling(proves=True)
    with ProgressBars("computing") as bars:
        computed = compute(bars)
    for case, figures in computed:
        table = bare_table("", *HEADINGS, title=case.title)
        for figure in figures:
            table.add_row(*map(escape, cells(figure)))
        show(table)
    if output is not None:
        write_file(output, markdown(computed))
        show(f"{output} written.", markup=False)
    return all(figure.holds for _, figures in computed for figure in figures)
