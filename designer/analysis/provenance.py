"""Where the numbers of a report come from, also of reports that need no analysis."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from datetime import datetime
from importlib.metadata import version
from importlib.util import find_spec

from designer import __version__
from designer.study import Study


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where the numbers come from."""

    version: str  #: of this program
    libraries: tuple[tuple[str, str], ...]  #: name and version of what computed and drew them
    system: str  #: operating system and Python
    created: datetime  #: when the analysis was started

    @classmethod
    def now(cls, study: Study | None = None) -> Provenance:
        """Return the provenance of an analysis that starts now, with what the study asks for."""
        names = ["numpy", "scipy", "numba", "xarray", "pyvista", "matplotlib", "plutoprint"]
        if study is not None:
            if study.robot.is_redundant:  # solved again by convex programmes
                names.append("clarabel")
            if study.selection is not None and study.selection.groups:
                names += ["cvxpy", "highspy"]
        return cls(
            version=__version__,
            libraries=tuple((name, version(name)) for name in names if find_spec(name)),
            system=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
            created=datetime.now().astimezone(),
        )
