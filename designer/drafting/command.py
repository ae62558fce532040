"""`designer catalog new`: from a maker's table to a grade file."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from designer.cli.options import NoPlugins, argument, can_ask, output_option
from designer.errors import Fault, InputError

if TYPE_CHECKING:
    from designer.drafting.grade_draft import GradeDraft, OffTheLaw
    from designer.drafting.maker_table import MakerTable
    from designer.grades.grade import Grade

_REPEATED = "Several times, once for each."


def new(
    table: Annotated[Path, argument("TABLE", "CSV, Excel workbook or PDF, a row for each size.")],
    output: Annotated[Path | None, output_option("TABLE's name with .yaml", "FILE")] = None,
    page: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Page of a PDF that the table is on.")
    ] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FIGURE=HEAD", help=f"Which column is what, by head or number. {_REPEATED}"
        ),
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(metavar="FIGURE=UNIT", help=f"Unit, where the heads have none. {_REPEATED}"),
    ] = None,
    field: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="FIELD=TEXT", help=f"What the table does not say. {_REPEATED}"
        ),
    ] = None,
    like: Annotated[
        str | None,
        typer.Option(
            metavar="GRADE", help="Borrow stiffness, D/d and what else is not set from this grade."
        ),
    ] = None,
    doubt: Annotated[
        str, typer.Option(metavar="WHY", help="Keep rows that are off the law of d², marked so.")
    ] = "",
    no_plugins: NoPlugins = False,
) -> bool:
    """Make a grade file from a maker's table, checked as all grades are.

    Columns are guessed from their heads, units from heads or a row of units below; on a terminal
    you are asked for what is not known. FIGURE is id, diameter, minimum_breaking_load, linear_mass
    or metallic_area; UNIT such as mm, in, kN, kgf, lbf, kip, kg/m, kg/100m, lb/ft; of tons
    short_ton_force (2000 lb), tonf (1000 kg), long_ton_force (2240 lb). FIELD is as in the file:
    manufacturer, product, construction, core, finish, material, wire_grade, trust,
    source.publisher, source.document, modulus.value and others.

    Breaking load and mass follow MBL = c d² and m = k d² within a grade: a row that does not is
    shown beside the law, and refused unless you say with --doubt why it may be so.

    \b
    Examples:
      designer catalog new acme.csv
      designer catalog new acme.csv --unit linear_mass=kg/100m --like unirope-6x36-iwrc-1960
      designer catalog new acme.csv --column minimum_breaking_load="MBL 1960" \\
        --set manufacturer=Acme --set product=Quarry -o my-ropes/acme.yaml

    Exit status 0: the file is whole. 1: it is written, and comments in it say what is missing. 2:
    the table or an option is wrong, and nothing is written.
    """
    from designer.drafting.grade_draft import TEXTS, GradeDraft
    from designer.drafting.maker_table import FIGURES, read_maker_table
    from designer.io.output import write_new_file

    columns, units = _pairs("--column", column, FIGURES), _pairs("--unit", unit, FIGURES[1:])
    given = _pairs("--set", field, TEXTS)
    lender = None if like is None else _grade(like, no_plugins)
    maker_table = read_maker_table(table, columns, _choose if can_ask() else lambda *_: None, page)
    units = _units(maker_table, units)
    left_out: list[str] = []
    rows = maker_table.rows(units, left_out.append)
    _print_table(maker_table, units, len(rows))
    for size in left_out:
        typer.echo(f"  left out: {size}")
    texts = _usual(table, lender) | given
    draft = GradeDraft(maker_table, rows, units, texts, lender, doubt)
    if can_ask():
        draft = _asked(draft, no_plugins)
    draft = _with_doubt(draft)
    if not draft.missing:
        draft.grade()
    path = output or table.with_suffix(".yaml").name
    write_new_file(Path(path), draft.text())
    _print_end(Path(path), draft, "trust" in given or can_ask())
    return not draft.missing


def _pairs(
    option: str, given: Sequence[str] | None, names: Sequence[str] | Mapping[str, str]
) -> dict[str, str]:
    """Return what an option names several times, such as ``diameter=mm``."""
    pairs: dict[str, str] = {}
    for text in given or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not value:
            raise InputError.at(option, f"{text!r} has no value", "such as diameter=…")
        if name not in names:
            raise InputError.at(option, f"{name!r} is not known", ", ".join(names))
        if name in pairs:
            raise InputError.at(option, f"{name} is given twice", "once")
        pairs[name] = value
    return pairs


def _grade(grade_id: str, no_plugins: bool) -> Grade:
    from designer.grades.registry import load_catalogue

    return load_catalogue(with_plugins=not no_plugins).grade(grade_id)


def _usual(table: Path, lender: Grade | None) -> dict[str, str]:
    """Return what is usual where nobody says otherwise."""
    from designer.drafting.grade_draft import COPIED

    grade_id = re.sub(r"[^a-z0-9]+", "-", table.stem.casefold()).strip("-")
    usual = {"id": grade_id, "trust": "C", "source.document": table.name}
    if lender is not None:
        usual |= {name: value for name in COPIED if (value := getattr(lender, name))}
    return usual


def _choose(figure: str, heads: Sequence[str], why: str) -> int | None:
    """Ask which column a figure is; None for none of them."""
    typer.echo(f"{figure}: {why}")
    for number, head in enumerate(heads, start=1):
        typer.echo(f"  {number}: {head}")
    number = -1
    while not 0 <= number <= len(heads):
        number = typer.prompt("  Number (0 for none)", type=int, default=0)
    return number - 1 if number else None


def _units(table: MakerTable, named: Mapping[str, str]) -> dict[str, str]:
    """Return the unit of each figure: as an option has it, as the table prints it, or as asked."""
    from designer.drafting.maker_table import SIZE, known_unit
    from designer.grades.grade import DIMENSIONS

    units: dict[str, str] = {}
    faults = []
    for figure, column in table.columns.items():
        if figure == SIZE:
            continue
        text = named.get(figure) or column.unit
        while can_ask() and (text is None or known_unit(figure, text) is None):
            text = typer.prompt(f"Unit of '{column.head}' ({DIMENSIONS[figure].expected_unit})")
        unit = None if text is None else known_unit(figure, text)
        if unit is not None:
            units[figure] = unit
        elif text is None:
            problem = "the unit is not known"
            expected = f"--unit {figure}=UNIT, {DIMENSIONS[figure].expected_unit}"
            faults.append(table.fault(table.head_line, column.head, problem, expected))
        else:
            expected = DIMENSIONS[figure].expected_unit
            faults.append(Fault("--unit", None, figure, f"{text!r} does not fit", expected))
    faults += [
        Fault("--unit", None, figure, "no column is known to be it", f"--column {figure}=HEAD")
        for figure in named
        if figure not in table.columns
    ]
    if faults:
        raise InputError(faults)
    return units


def _print_table(table: MakerTable, units: Mapping[str, str], n_rows: int) -> None:
    """Print which column was taken for what."""
    typer.echo(f"{table.name}: {n_rows} sizes")
    for figure, column in table.columns.items():
        unit = f", in {units[figure]}" if figure in units else ""
        without = ", without the figures in brackets" if column.has_brackets else ""
        typer.echo(f"  {figure}: column '{column.head}'{unit}{without}")
    if table.left_out:
        typer.echo(f"  left out: {', '.join(table.left_out)}")


def _asked(draft: GradeDraft, no_plugins: bool) -> GradeDraft:
    """Return the draft with what somebody at the terminal says of it."""
    from dataclasses import replace

    from designer.drafting.grade_draft import ELASTICITY, OPTIONAL, TEXTS

    texts, like = dict(draft.texts), draft.like
    for name, meaning in TEXTS.items():
        if name not in ELASTICITY:
            default = texts.get(name, "" if name in OPTIONAL else None)
            if name == "source.publisher":
                default = default or texts["manufacturer"]
            texts[name] = typer.prompt(f"{name} ({meaning})", default=default)
    if like is None and "modulus.value" not in texts:
        answer = typer.prompt("modulus (such as 62.7 GPa), or the id of a grade to borrow it from")
        if re.match(r"\s*[\d.]", answer):
            texts["modulus.value"] = answer
        else:
            like = _grade(answer.strip(), no_plugins)
    if "modulus.value" in texts:
        for name in ELASTICITY[1:]:
            texts[name] = typer.prompt(f"{name} ({TEXTS[name]})", default=texts.get(name))
    return replace(draft, texts=texts, like=like)


def _with_doubt(draft: GradeDraft) -> GradeDraft:
    """Return the draft where no row is off the law, or somebody says why; refuse it otherwise."""
    from dataclasses import replace

    from designer.drafting.grade_draft import refused

    off = draft.off_the_law()
    if not off:
        return draft
    _print_off(draft, off)
    if not draft.doubt and can_ask():
        why = typer.prompt("Why they may be so, to keep them (empty to stop)", default="")
        draft = replace(draft, doubt=why)
    if not draft.doubt:
        raise refused(off, draft.table)
    return draft


def _print_off(draft: GradeDraft, off: Sequence[OffTheLaw]) -> None:
    """Print rows beside the law of d²."""
    from designer.cli.terminal import bare_table, show

    table = bare_table("line", "size", "", "printed", "by the law of d²", "off")
    for item in off:
        unit = draft.units[item.name]
        table.add_row(
            str(item.row.line),
            item.row.id,
            item.name,
            f"{item.figure:g} {unit}",
            f"{item.by_law:.4g} {unit}",
            f"{item.figure / item.by_law - 1.0:+.0%}",
        )
    show(table)


def _print_end(path: Path, draft: GradeDraft, trust_is_given: bool) -> None:
    from designer.drafting.grade_draft import TEXTS

    typer.echo(f"{path} written: {draft.texts.get('id', '')}, {len(draft.rows)} sizes.")
    if draft.like is not None:
        typer.echo(f"  copied from {draft.like.id}: {'; '.join(draft.copied)}")
    if not trust_is_given:
        typer.echo("  trust: C, third hand; --set trust=A if it is the maker's own table")
    for remark in draft.remarks():
        typer.echo(f"  remark: {remark}")
    if draft.missing:
        typer.echo("Fill in what is missing, in the file or by --set, then check it:")
        for name in draft.missing:
            typer.echo(f"  {name}: {TEXTS[name]}")
    else:
        typer.echo("It is checked. To use it: catalogues: in a study, or the user folder.")
    typer.echo(f"Next:  designer catalog check {shlex.quote(str(path))}")
