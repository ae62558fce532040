"""`designer optimise`: fields of a study chosen so that a result of it is as good as can be."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from designer.cli.options import NoPlugins, Template, argument, output_option

if TYPE_CHECKING:
    from designer.optimum.optimise import Optimum


def optimise(
    plan: Annotated[Path, argument("OPTIMISE", "What to choose, a YAML file.")],
    output: Annotated[Path | None, output_option("OPTIMISE-optimum")] = None,
    template: Template = None,
    no_plugins: NoPlugins = False,
) -> bool:
    """Choose fields of a study, such as mast positions, for the best result that can be found.

    \b
        study: yard.yaml
        objective: rope_mass
        variables:
          robot.anchors[*][2]: [10 m, 14 m]
          spread: {fields: {robot.anchors.0.0: -1, robot.anchors.1.0: 1}, offset: [-3 m, 3 m]}
        constraints: {max_tension: 1500 N}
        budget: {evaluations: 400, time: 5 min}

    Objectives: rope_mass, rope_cost, max_tension, diameter, usable_volume, or {minimise: PATH} and
    {maximise: PATH} of result.json. The region to serve stays where it is when anchors move, unless
    the file says region: follows. The best design is analysed in full, beside the study as it is.

    Writes optimise.html, optimise.pdf, optimise.json, designs.csv, the comparison of both, the
    study with the chosen values, and a report of each in the folders given and optimised. Ctrl-C
    ends the search and answers with the best so far; once more, and nothing is written.

    Example:  designer optimise masts.yaml

    Exit status 0: a better design was found, and holds. 1: none was. 2: the input is wrong.
    """
    from designer.cli.terminal import ProgressBars, announce_compiling, print_left_out, show
    from designer.io.output import file_names, output_folder, require_file
    from designer.io.process import ends_gently
    from designer.report.figures.opengl import begin_probe, why_no_scenes

    begin_probe()
    announce_compiling(proves=True)

    from designer.optimum.optimise import optimum_of
    from designer.optimum.plan import read_optimisation
    from designer.optimum.report import write_optimum
    from designer.report.render import REPORT_FILES, write_report_files

    laid_out = read_optimisation(plan, with_plugins=not no_plugins)
    print_left_out(laid_out.base.catalogue().problems)
    folder = output or Path(f"{plan.stem}-optimum")
    with ExitStack() as stack:
        building = stack.enter_context(output_folder(folder))
        places = [
            stack.enter_context(output_folder(folder / name, REPORT_FILES))
            for name in ("given", "optimised")
        ]
        require_file(folder / f"{Path(laid_out.document.name).stem}.optimised.yaml")
        bars = stack.enter_context(ProgressBars())
        with ends_gently() as stop:
            optimum = optimum_of(laid_out, bars, stop)
        write_optimum(optimum, building, folder, template, bars)
        problems: list[str] = []
        for place, analysis in zip(places, (optimum.given, optimum.optimised), strict=True):
            problems += write_report_files(analysis, place, template, bars)
        written = file_names(building)
    print_left_out(dict.fromkeys(filter(None, [why_no_scenes(), *problems])))
    _print_summary(optimum)
    text = f"{folder}: {', '.join(written)}; full reports in given and optimised"
    show(text, markup=False)
    return optimum.is_better


def _print_summary(optimum: Optimum) -> None:
    from rich.markup import escape

    from designer.cli.terminal import bare_table, show
    from designer.optimum.report import headline, trust_lines, variable_rows

    show(headline(optimum), markup=False)
    table = bare_table("", "given", "optimised", "bounds")
    for row in variable_rows(optimum):
        table.add_row(*map(escape, row))
    show(table)
    for line in trust_lines(optimum):
        show(line, markup=False)
