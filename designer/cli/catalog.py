"""The commands `designer catalog …`."""

from __future__ import annotations

import json
import keyword
import re
import shlex
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from designer.cli.options import (
    WRONG_INPUT,
    AsJson,
    HookedCommands,
    NoPlugins,
    argument,
    quantity_of,
)
from designer.errors import InputError, OutputError
from designer.io.output import output_folder
from designer.resources import data_folder
from designer.units import LENGTH

if TYPE_CHECKING:
    from designer.grades.registry import Catalogue


_LONGEST_NAME = 60


class CatalogCommands(HookedCommands):
    """The commands below `designer catalog`."""

    hook = "register_catalog_commands"
    order = ("list", "show", "check", "new", "new-plugin")


catalog = typer.Typer(
    cls=CatalogCommands, help="Look at the rope grades that are known.", no_args_is_help=True
)


@catalog.command("list")
def catalog_list(
    construction: Annotated[
        str | None, typer.Option(metavar="TEXT", help="Only these, such as 7x19 or braid.")
    ] = None,
    material: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only these, such as steel or HMPE.")
    ] = None,
    maker: Annotated[
        str | None, typer.Option(metavar="TEXT", help="Only makers or publishers named so.")
    ] = None,
    diameter: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Only sizes of this, such as 12mm.")
    ] = None,
    nominal: Annotated[
        bool, typer.Option("--nominal", help="Those computed by a standard's factors instead.")
    ] = False,
    as_json: AsJson = False,
    no_plugins: NoPlugins = False,
) -> bool:
    """List the grades with their source.

    With --json it is a list with what the table has of each, in SI: id, manufacturer, product,
    construction, core, finish, material, trust, source, origin, the ids of its sizes, and the least
    and largest diameter_m and minimum_breaking_load_N.

    Example:  designer catalog list --construction 7x19 --diameter 6mm
    """
    from designer.cli.tables import print_grades
    from designer.grades.listing import GradeFilter, listed, split_nominal

    catalogue = _loaded(no_plugins)
    criteria = GradeFilter(
        construction, _material(material, catalogue), maker, _diameter_m(diameter)
    )
    products, computed = split_nominal(criteria.among(catalogue.grades))
    listed_grades, further = (computed, products) if nominal else (products, computed)
    if as_json:
        typer.echo(
            json.dumps([listed(grade) for grade in listed_grades], indent=2, ensure_ascii=False)
        )
    elif listed_grades:
        print_grades(listed_grades)
    if further and not nominal and not as_json:
        typer.echo(f"{len(further)} nominal grades, computed by a standard's factors: --nominal")
    if not listed_grades:
        typer.echo("no grade is like that", err=True)
    return bool(listed_grades)


def _loaded(no_plugins: bool) -> Catalogue:
    """Return all grades, after a line for each that was left out."""
    from designer.cli.terminal import print_left_out
    from designer.grades.registry import load_catalogue

    catalogue = load_catalogue(with_plugins=not no_plugins)
    print_left_out(catalogue.problems)
    return catalogue


def _material(name: str | None, catalogue: Catalogue) -> str | None:
    materials = sorted({grade.material for grade in catalogue.grades if grade.material})
    if name is not None and name.casefold() not in map(str.casefold, materials):
        problem = f"no grade is of {name!r}"
        raise InputError.at("--material", problem, ", ".join(materials))
    return name


def _diameter_m(text: str | None) -> float | None:
    from designer.documents.bounds import BOUNDS

    if text is None:
        return None
    diameter_m = quantity_of("--diameter", text, LENGTH)
    bound = BOUNDS["rope diameter"]
    if not bound.least <= diameter_m <= bound.most:
        problem = f"{text!r} is {diameter_m:g} m, which no rope has"
        is_bare = text.strip().replace(".", "", 1).isdigit()
        expected = f"'{text.strip()}mm'" if is_bare else "a diameter such as '12mm'"
        raise InputError.at("--diameter", problem, expected)
    return diameter_m


@catalog.command("show")
def catalog_show(
    grade: Annotated[str, typer.Argument(metavar="GRADE", help="Id from `designer catalog list`.")],
    no_plugins: NoPlugins = False,
) -> None:
    """Show one grade: where its figures come from, and its sizes.

    Example:  designer catalog show unirope-7x19-galvanised
    """
    from designer.cli.tables import print_grade

    print_grade(_loaded(no_plugins).grade(grade))


@catalog.command("check")
def catalog_check(
    path: Annotated[
        Path | None, argument("PATH", "Grade file, or a folder of them; else all that load.")
    ] = None,
    no_plugins: NoPlugins = False,
) -> None:
    """Check grades: units, proportions, unknown fields.

    Example:  designer catalog check my-ropes/
    """
    from designer.grades.listing import summary, ton_remarks
    from designer.grades.registry import read_grades

    if path is not None:
        files, faults = read_grades(path, needs_any=True)
        if faults:
            raise InputError(faults)
        for file in files:
            for remark in ton_remarks(file.grade):
                typer.echo(f"{file.path}: {remark}")
        typer.echo(f"{path}: no fault found")
        return
    catalogue = _loaded(no_plugins)
    typer.echo(summary(catalogue) + ("" if catalogue.problems else ": no fault found"))
    if catalogue.problems:
        raise typer.Exit(WRONG_INPUT)


@catalog.command("new-plugin")
def catalog_new_plugin(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Its name, such as acme-ropes.")],
    path: Annotated[Path | None, argument("PATH", "New folder to write, NAME if left out.")] = None,
    effect: Annotated[
        bool, typer.Option("--effect", help="One that brings a physical effect, not grades.")
    ] = False,
) -> None:
    """Write a plugin project with one commented grade file or effect, ready to install.

    Example:  designer catalog new-plugin acme-ropes
    """
    folder = path or Path(name)
    write_plugin(name, folder, effect=effect)
    package = folder / module_name(name)
    typer.echo(f"{folder} written. Next:")
    typer.echo(f"  pip install -e {shlex.quote(str(folder))}")
    if effect:
        typer.echo(f"  pip install pytest && pytest {shlex.quote(str(folder))}")
        typer.echo(f"then write your own law in {package / 'effect.py'}")
    else:
        typer.echo("  designer catalog list")
        typer.echo(f"then put your own figures into {package / 'grades'}")


def module_name(name: str) -> str:
    """Return the Python module that a plugin of this name has."""
    return name.replace("-", "_")


def write_plugin(name: str, folder: Path, *, effect: bool = False) -> None:
    """Write an installable plugin with one grade file or one effect, a test and a README.

    The name is that of the distribution, the plugin and, with ``_`` for ``-``, the module; the
    folder does not exist yet.

    Raises
    ------
    InputError
        If the name cannot be one, or is taken by an installed module.
    OutputError
        If the folder exists, or cannot be written.
    """
    problem = _problem(name)
    if problem:
        expected = "a new name such as acme-ropes: lower-case letters, digits and single '-'"
        raise InputError.at("NAME", problem, expected)
    if folder.exists() or folder.is_symlink():
        raise OutputError(f"{folder}: exists already (expected a new folder)")
    import jinja2

    template = data_folder("plugins") / ("template-effect" if effect else "template")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(template),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,  # TOML, Python and YAML; the name is checked
    )
    names = {"name": name, "module": module_name(name)}
    with output_folder(folder) as building:
        for path in environment.list_templates(extensions=["j2"]):
            renamed = path.replace("MODULE", names["module"]).replace("NAME", names["name"])
            target = building / renamed.removesuffix(".j2")
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(environment.get_template(path).render(names), encoding="utf-8")


def _problem(name: str) -> str:
    quoted = repr(name[:_LONGEST_NAME])
    if not re.fullmatch(r"[a-z][a-z0-9]*(?:-[a-z0-9]+)*", name) or len(name) > _LONGEST_NAME:
        return f"{quoted} cannot be the name of a plugin"
    module = module_name(name)
    if keyword.iskeyword(module) or keyword.issoftkeyword(module):
        return f"{quoted} is a word of Python's own"
    if module in sys.stdlib_module_names or PathFinder.find_spec(module) is not None:
        return f"there is a module {module!r} already"
    return ""
