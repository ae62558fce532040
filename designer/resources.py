"""Where shipped files live, in a checkout or inside the wheel; which libraries are not there."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

_PACKAGE = Path(__file__).parent


def data_folder(name: str) -> Path:
    """Return the folder ``catalog``, ``reports`` or ``plugins``.

    A wheel carries them in ``designer/_data``; a checkout has them beside ``designer``.

    Raises
    ------
    FileNotFoundError
        If the installation is incomplete.
    """
    for candidate in (_PACKAGE / "_data" / name, _PACKAGE.parent / name):
        if candidate.is_dir():
            return candidate
    raise FileNotFoundError(f"the folder {name!r} is missing from this installation")


_CALLED = {"plutoprint": "PlutoPrint", "cvxpy": "CVXPY", "clarabel": "Clarabel"}
"""Libraries that have no wheel for some kinds of machines."""


def missing_library(*modules: str) -> str:
    """Return that one of these libraries is not installed, and why it may be so; empty for none."""
    missing = [_CALLED[module] for module in modules if find_spec(module) is None]
    return f"{missing[0]} is not installed; some machines have no wheel of it" if missing else ""


def example_file(name: str) -> Path:
    """Return the path of a shipped example study, such as ``fast``."""
    return _PACKAGE / "examples" / f"{name}.yaml"


def example_names() -> tuple[str, ...]:
    """Return the names of all shipped example studies."""
    return tuple(sorted(path.stem for path in (_PACKAGE / "examples").glob("*.yaml")))


def example_summary(name: str) -> str:
    """Return the first sentence of a shipped example study."""
    lines = example_file(name).read_text(encoding="utf-8").splitlines()
    comment = " ".join(line.removeprefix("#").strip() for line in lines if line.startswith("#"))
    return comment.split(". ", 1)[0].rstrip(".")
