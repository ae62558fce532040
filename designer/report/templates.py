"""Templates of reports: ours, and before them those of a folder of the user's."""

from __future__ import annotations

import math
import re
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, wraps
from inspect import isfunction
from operator import attrgetter
from pathlib import Path
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

from designer.errors import Fault, InputError, one_line
from designer.plugins import Plugins, find_plugins, named, registered
from designer.report import format as fmt
from designer.report import phrases
from designer.resources import data_folder, missing_library

if TYPE_CHECKING:
    from jinja2 import Environment

Filter = Callable[..., object]
_KINDS = ("*.j2", "*.css")


def why_no_pdf() -> str:
    """Return why no PDF can be made here; empty where it can."""
    missing = missing_library("plutoprint")
    return f"The PDF is left out: {missing}." if missing else ""


def environment(
    user_folder: Path | None = None, filters: Mapping[str, Filter] | None = None
) -> Environment:
    """Return the template environment: escaping on, and every undefined name an error.

    Templates of ``user_folder`` come before the shipped ones of the same name; there, the shipped
    ones are also known under ``default/``, so that ``page.html.j2`` can extend
    ``default/page.html.j2``. ``report/inputs.html.j2`` would show the section ``inputs``.
    The functions of `designer.report.format` are filters, such as ``{{ mass_kg | kilograms }}``;
    they also stand under ``fmt``, for those of several values. So are ``filters``, those of our
    rings if left out.
    """
    from jinja2 import ChoiceLoader, Environment, FileSystemLoader, PrefixLoader, StrictUndefined

    from designer.report.flow import FlowingText, KeptTemplates

    shipped = FileSystemLoader(data_folder("reports"))
    own = [FileSystemLoader(user_folder)] if user_folder is not None else []
    templates = Environment(
        extensions=[FlowingText],
        bytecode_cache=KeptTemplates(),
        loader=ChoiceLoader([*own, shipped, PrefixLoader({"default": shipped})]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    added = _filters_of_rings() if filters is None else filters
    templates.filters = {**added, **_FILTERS, **templates.filters}  # none of Jinja's is replaced
    templates.tests["finite"] = math.isfinite
    templates.globals |= {"fmt": fmt, "why_no_pdf": why_no_pdf}
    return templates


def public_functions(module: ModuleType) -> list[Filter]:
    """Return the functions of a module of words."""
    functions = vars(module).items()
    return [item for name, item in functions if isfunction(item) and not name.startswith("_")]


_FILTERS = {item.__name__: item for module in (fmt, phrases) for item in public_functions(module)}


def filters_of(plugins: Plugins) -> tuple[dict[str, Filter], list[str]]:
    """Return the filters of our rings and of plugins, and a line for each that is left out."""
    functions, problems = registered(
        plugins, "register_template_filters", FunctionType, attrgetter("__name__"), _FILTERS
    )
    return {name: _guarded(name, *item) for name, item in functions.items()}, problems


@cache
def _filters_of_rings() -> dict[str, Filter]:
    return filters_of(find_plugins(with_plugins=False))[0]


def _guarded(name: str, function: Filter, label: str) -> Filter:
    from jinja2 import pass_context

    @pass_context  # else what it makes of a constant is kept in the code of a template
    @wraps(function)
    def run(_: object, *values: Any, **options: Any) -> object:
        with named(label, f"fails in the filter {name}"):
            return function(*values, **options)

    return run


@dataclass(frozen=True, slots=True)
class Statement:
    """A heading and a sentence or two as plain text, and the tone: good, bad, doubt or none."""

    title: str
    text: str
    tone: str


def plain_statement(name: str, context: Mapping[str, object]) -> Statement:
    """Return what a template says that sets a title and a tone, for what is no page."""
    from markupsafe import Markup

    said = environment().get_template(name).make_module(dict(context))
    text = re.sub(r"[ \n]+", " ", Markup(said).unescape()).strip()
    return Statement(vars(said)["title"], text, vars(said)["tone"])


def check_templates(folder: Path) -> None:
    """Refuse, before any work, a folder of templates that cannot be used.

    Raises
    ------
    InputError
        If there is no such folder, none of its files is a template, or one of them is not well
        formed.
    """
    if not folder.is_dir():
        problem = "is a file" if folder.is_file() else "there is no such folder"
        raise InputError([Fault(str(folder), None, "", problem, "a folder of templates")])
    names = sorted(path.relative_to(folder) for kind in _KINDS for path in folder.rglob(kind))
    if not names:
        expected = "page.html.j2, report.css or another template of cdpr-designer"
        raise InputError([Fault(str(folder), None, "", "holds no template", expected)])
    for path in folder.rglob("*"):  # any of them may be included by another
        if not (path.is_file() or path.is_dir()):
            raise InputError([Fault(str(path), None, "", "is no file", "a template or a folder")])
    with told_in_one_line(folder):
        own = environment(folder, filters_of(find_plugins())[0])
        for name in names:
            own.get_template(name.as_posix())


@contextmanager
def told_in_one_line(folder: Path | None) -> Iterator[None]:
    """Turn whatever goes wrong in a template of the user's into a line that names it.

    Raises
    ------
    InputError
        If a template of the folder is faulty; what goes wrong in ours is raised as it is.
    """
    from jinja2 import TemplateSyntaxError

    try:
        yield
    except Exception as error:
        place = _place(error, folder) if folder is not None else None
        if place is None:
            raise
        if isinstance(error, TemplateSyntaxError):
            place = error.filename or place[0], error.lineno
        problem = str(error) or one_line(type(error).__name__)
        raise InputError([Fault(*place, "", problem, "a template of Jinja")]) from error


def _place(error: Exception, folder: Path) -> tuple[str, int | None] | None:
    """Return file and line of the innermost template of the folder that had a part in it."""
    filename = getattr(error, "filename", None)  # of a template that is not well formed
    frames = traceback.extract_tb(error.__traceback__)
    places = [(frame.filename, frame.lineno) for frame in reversed(frames)]
    for name, line in [*([(filename, None)] if filename else []), *places]:
        if Path(name).is_relative_to(folder):
            return name, line
    return None
