"""What the better model does to the design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from designer.catalogue.grade import Grade
from designer.declared import as_built_by
from designer.diagnosis.result import Choice, Diagnosis
from designer.selection.select import best_product
from designer.study import DeclaredEffect, Study
from designer.workspace.section import section_of_workspace
from designer.workspace.sweep import map_workspace

_NONE = float("nan")


def declared_by(diagnosis: Diagnosis) -> tuple[DeclaredEffect, ...]:
    """Return what was found as effects to declare, after those declared already."""
    found = tuple(
        DeclaredEffect(s.effect.id, s.effect.cable, dict(s.values)) for s in diagnosis.settings
    )
    return (*diagnosis.study.effects, *found)


def with_design(diagnosis: Diagnosis, grades: Sequence[Grade]) -> Diagnosis:
    """Add the chosen cable and the worst tension before and after, where the study has both."""
    study = diagnosis.study
    if study.workspace is None or study.selection is None or not study.robot.has_enough_cables:
        return diagnosis
    before = choice(study, grades)
    reaches = any(setting.effect.reaches_design for setting in diagnosis.settings)
    better = replace(study, effects=declared_by(diagnosis))
    after = choice(better, grades) if reaches else before
    return replace(diagnosis, design_before=before, design_after=after)


def choice(study: Study, grades: Sequence[Grade]) -> Choice:
    """Size the workspace and choose a product, with the effects that the study declares."""
    assert study.workspace is not None
    assert study.selection is not None
    built = as_built_by(study)
    built = replace(built, section_m=section_of_workspace(built, study.workspace, study.material))
    worst = map_workspace(built.robot, study.workspace, built.material(study.material)).sagging
    chosen = best_product(built.robot, study.workspace, study.selection, grades, built=built)
    return Choice(
        grade=chosen.grade.id if chosen else None,
        size_id=chosen.size.id if chosen else None,
        diameter_m=chosen.size.diameter_m if chosen else _NONE,
        max_tension_N=chosen.verification.max_tension_N if chosen else _NONE,
        optimum_m=worst.diameter_m if worst else _NONE,
        optimum_tension_N=worst.max_tension_N if worst else _NONE,
    )
