"""The cable of a study: its figures, or the continuous family of a grade."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from designer.cable import Material
from designer.config.document import Document
from designer.config.schema import CableSection, StudySection
from designer.errors import InputError
from designer.study import Entry, GradeFamily
from designer.units import DENSITY, STRESS, format_SI

MaterialOf = Callable[[GradeFamily, Sequence[Path]], Material]
"""Returns the family of a grade of the catalogue, which the study's own files are added to.

Raises `designer.config.grade_family.GradeError`.
"""
_USUAL_FACTOR = 5.0


class GradeError(ValueError):
    """A grade cannot stand for a family; ``problem`` and what was ``expected``."""

    def __init__(self, problem: str, expected: str) -> None:
        super().__init__(problem)
        self.problem, self.expected = problem, expected


def material_and_family(
    section: StudySection, document: Document, material_of: MaterialOf | None
) -> tuple[Material, GradeFamily | None]:
    """Return the material of a study, and the grade that it is of.

    A safety factor that is left out is that of the selection.

    Raises
    ------
    InputError
        If there is no such grade, or if it lacks figures.
    """
    cable = section.cable
    if isinstance(cable, CableSection):
        material = Material(cable.density, cable.youngs_modulus, cable.allowable_stress)
        return material, None
    usual = section.selection.safety_factor if section.selection else _USUAL_FACTOR
    family = GradeFamily(cable.grade, cable.safety_factor or usual)
    try:
        if material_of is None:
            raise GradeError("is a grade, and no catalogue was given", "figures of a cable")
        folder = Path(document.name).parent
        return material_of(family, [folder / name for name in section.catalogues]), family
    except GradeError as error:
        fault = document.fault(("cable", "grade"), error.problem, error.expected)
        raise InputError([fault]) from None


def family_entries(
    entries: list[Entry], material: Material, family: GradeFamily | None
) -> list[Entry]:
    """Return the table of inputs with what a grade stands for."""
    if family is None:
        return entries
    meaning = {
        "cable.grade": (
            f"{format_SI(material.density_kg_per_m3, DENSITY)}, "
            f"modulus {format_SI(material.youngs_modulus_Pa, STRESS)}, "
            f"allowable {format_SI(material.allowable_stress_Pa, STRESS)}, on the nominal circle"
        ),
        "cable.safety_factor": f"{family.safety_factor:g}",
    }
    return [replace(e, value_SI=meaning.get(e.field, e.value_SI)) for e in entries]
