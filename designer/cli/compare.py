"""`designer compare`: two designs side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from designer.cli.options import (
    NoPlugins,
    Template,
    argument,
    catalogue_of,
    output_option,
    study_of,
)

if TYPE_CHECKING:
    from designer.analysis.comparison import Comparison
    from designer.documents.plain import Json
    from designer.grades.registry import Catalogue
    from designer.study import Study


def compare(
    a: Annotated[Path, argument("A", "A study or result.json.")],
    b: Annotated[Path, argument("B", "Another one.")],
    output: Annotated[Path | None, output_option("A-B-comparison")] = None,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Put two designs side by side: what differs in what was asked, and in the answer.

    Studies are solved first; results of `designer report` are taken as they are. Writes
    comparison.html, comparison.pdf and comparison.json.

    Example:  designer compare crane.yaml crane-report/result.json
    """
    from designer.cli.terminal import ProgressBars, announce_compiling
    from designer.io.output import file_names, output_folder
    from designer.io.results import read_result

    sources: list[Json | tuple[Study, Catalogue]] = []
    plugins = None
    for path in (a, b):
        if path.suffix == ".json":
            sources.append(read_result(path))
        else:
            study, plugins = study_of(path, no_plugins, plugins)
            sources.append((study, catalogue_of(study, plugins)))
    announce_compiling(proves=True)

    from designer.analysis.analyse import analyse
    from designer.analysis.comparison import compare as compare_results
    from designer.documents.plain import json_text
    from designer.report.comparison import write_comparison

    folder = output or Path(f"{a.stem}-{b.stem}-comparison")
    with output_folder(folder) as building, ProgressBars() as bars:
        results = [
            source if isinstance(source, dict) else analyse(*source, reporter=bars).to_dict()
            for source in sources
        ]
        comparison = compare_results(*results)
        write_comparison(comparison, (a.name, b.name), building, template)
        text = f"{json_text(comparison.to_dict())}\n"
        (building / "comparison.json").write_text(text, encoding="utf-8")
        written = file_names(building)
    _print_comparison(comparison, (a.name, b.name), folder, written)


def _print_comparison(
    comparison: Comparison, names: tuple[str, str], folder: Path, written: Sequence[str]
) -> None:
    from rich.markup import escape

    from designer.cli.terminal import bare_table, show
    from designer.report.phrases import relative_change, result_value

    if comparison.is_same:
        show("Nothing differs.")
    table = bare_table("", f"A: {names[0]}", f"B: {names[1]}", "change")
    for line in (*comparison.inputs, *comparison.answers, *comparison.unmet):
        if line.differs:
            values = (result_value(value, line.path) for value in (line.a, line.b))
            table.add_row(*map(escape, (line.label or line.path, *values, relative_change(line))))
    if table.row_count:
        show(table)
    show(f"{folder}: {', '.join(written)}", markup=False)
