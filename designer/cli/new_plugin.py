"""Writes a plugin project to start from."""

from __future__ import annotations

import keyword
import re
import sys
from importlib.machinery import PathFinder
from pathlib import Path

from designer.errors import InputError, OutputError
from designer.io.output import output_folder
from designer.resources import data_folder

_LONGEST_NAME = 60


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
