"""The continuous family of a grade, for studies that name one as their cable."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from designer.cable import Material
from designer.catalogue.registry import load_catalogue
from designer.config.grade_family import GradeError, MaterialOf
from designer.plugins.find import Plugins
from designer.study import GradeFamily


def families(plugins: Plugins | None = None) -> MaterialOf:
    """Return what `designer.config.read_study` asks for the family of a grade.

    Parameters
    ----------
    plugins : Plugins or None
        Those that were found already; None to find them.
    """

    def material_of(family: GradeFamily, catalogues: Sequence[Path]) -> Material:
        readable = [path for path in catalogues if path.exists()]
        catalogue = load_catalogue(readable, plugins=plugins)
        grade = next((g for g in catalogue.grades if g.id == family.grade), None)
        if grade is None:
            raise GradeError(*catalogue.explain_unknown(family.grade))
        try:
            return grade.family(family.safety_factor)
        except ValueError as error:  # a grade made in Python may lack stiffness or area
            expected = "a grade with breaking load, mass and stiffness"
            raise GradeError(f"cannot stand for a family: {error}", expected) from None

    return material_of
