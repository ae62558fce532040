"""HMPE rope whose allowable load falls with temperature and with the time it has to last."""

from __future__ import annotations

import os
from pathlib import Path

from designer.grades.grade import Grade
from designer.plugins import hookimpl

PARAMETERS_VARIABLE = "FIBRE_ROPE_PARAMETERS"
"""Environment variable that names a parameter file of the user's own."""
SHIPPED_PARAMETERS = Path(__file__).parent / "parameters.yaml"


@hookimpl
def register_grades() -> list[Grade]:
    """Return one computed grade for each condition in the parameter file."""
    from fibre_rope.grades import computed_grades
    from fibre_rope.parameters import read_parameters

    path = Path(os.environ.get(PARAMETERS_VARIABLE) or SHIPPED_PARAMETERS)
    return computed_grades(read_parameters(path))
