"""The cable of a study: its figures, or the continuous family of a grade."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from designer.documents.document import Document
from designer.errors import InputError
from designer.io.config.schema import CableSection, StudySection
from designer.model.cable import Material
from designer.plugins.find import Plugins, find_plugins
from designer.study import Entry, GradeFamily
from designer.units import DENSITY, STRESS, format_SI

_USUAL_FACTOR = 5.0


def material_and_family(
    section: StudySection, document: Document, plugins: Plugins | None
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
    from designer.grades.family import GradeError, family_of  # most studies name no grade

    folder = Path(document.name).parent
    files = [folder / name for name in section.catalogues]
    try:
        return family_of(family, files, plugins or find_plugins(with_plugins=False)), family
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
