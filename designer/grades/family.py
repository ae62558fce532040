"""The continuous family of a grade, for studies that name one as their cable."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from designer.grades.kept import kept_catalogue
from designer.model.cable import Material
from designer.plugins.find import Plugins
from designer.study import GradeFamily


class GradeError(ValueError):
    """A grade cannot stand for a family; ``problem`` and what was ``expected``."""

    def __init__(self, problem: str, expected: str) -> None:
        super().__init__(problem)
        self.problem, self.expected = problem, expected


def family_of(grade_family: GradeFamily, catalogues: Sequence[Path], plugins: Plugins) -> Material:
    """Return the material that a grade of the catalogue, or of ``catalogues``, stands for.

    Raises
    ------
    GradeError
        If there is no such grade, or if it lacks figures.
    """
    readable = [path for path in catalogues if path.exists()]
    catalogue = kept_catalogue(readable, plugins)
    grade = next((g for g in catalogue.grades if g.id == grade_family.grade), None)
    if grade is None:
        raise GradeError(*catalogue.explain_unknown(grade_family.grade))
    try:
        return grade.family(grade_family.safety_factor)
    except ValueError as error:  # a grade made in Python may lack stiffness or area
        expected = "a grade with breaking load, mass and stiffness"
        raise GradeError(f"cannot stand for a family: {error}", expected) from None
