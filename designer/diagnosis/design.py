"""What the better model does to the design."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from designer.diagnosis.result import Diagnosis, RopeChoice, Use
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.cable import Cable
from designer.model.uncertainty import MAX_DEVIATION, Uncertainty
from designer.model.workspace import Workspace
from designer.selection.candidate import Candidate
from designer.selection.cases import converge_stiffness
from designer.selection.reeving import Allowance, bending_efficiency
from designer.selection.select import best_product
from designer.selection.verify import verify
from designer.study import DeclaredEffect, Study, as_built_by
from designer.workspace.section import section_of_workspace
from designer.workspace.sweep import map_workspace


def declared_by(diagnosis: Diagnosis) -> tuple[DeclaredEffect, ...]:
    """Return the whole model as effects to declare: what was declared, fitted and found."""
    return _declared(diagnosis, diagnosis.study.effects, None)


def declared_of_session(diagnosis: Diagnosis, session: int) -> tuple[DeclaredEffect, ...]:
    """Return what was declared, fitted and found of one session alone, from 1."""
    return _declared(diagnosis, diagnosis.study.effects_of_session(session), session)


def _declared(
    diagnosis: Diagnosis, before: Sequence[DeclaredEffect], session: int | None
) -> tuple[DeclaredEffect, ...]:
    fitted = (
        DeclaredEffect(s.effect.id, s.effect.cable, dict(s.values))
        for s in (*diagnosis.given, *diagnosis.settings)
        if s.effect.session == session
    )
    all_of_it = {(e.id, e.cable): e for e in (*before, *fitted)}
    return tuple(all_of_it.values())


def spreads_of(diagnosis: Diagnosis) -> dict[str, float]:
    """Return standard deviations of a design's inputs that the data settle, by their names there.

    ``payload`` is relative, and left out where the study says how it varies. ``exit_points`` [m] is
    the root mean square over all coordinates, those that were not fitted being certain, and is left
    out where the study says it and not all were fitted.
    """
    study, calibration = diagnosis.study, diagnosis.calibration
    selection, robot = study.selection, study.robot
    if calibration is None or selection is None or selection.groups:
        return {}  # only what one rope on all cables meets is drawn
    stated = study.uncertainty or Uncertainty()
    spreads = {}
    of_machine = [
        parameter for parameter in calibration.parameters if parameter.effect.session is None
    ]
    for fitted in of_machine:
        if fitted.effect.id == "platform_mass" and stated.payload is None:
            mass_kg = robot.platform.mass_kg + fitted.value
            spreads["payload"] = min(fitted.std / mass_kg, MAX_DEVIATION)
    points = [fitted for fitted in of_machine if fitted.effect.id == "anchor_offset"]
    is_whole = len(points) >= robot.exit_points_m.size
    if points and (is_whole or stated.exit_points_m is None):
        squares = sum(fitted.std**2 for fitted in points) / robot.exit_points_m.size
        spreads["exit_points"] = math.sqrt(squares)
    return {name: spread for name, spread in spreads.items() if 0.0 < spread < math.inf}


def with_design(diagnosis: Diagnosis, grades: Sequence[Grade]) -> Diagnosis:
    """Add what the design comes to before and after, where the study has one.

    That is the cable to choose, the one chosen before in the better model, and the one that hangs
    on the machine, where its breaking load is known. Only the last has what was found of the rope
    itself, such as its modulus: another rope is as its data sheet says.
    """
    study = diagnosis.study
    if study.workspace is None or study.selection is None or not study.robot.has_enough_cables:
        return diagnosis
    selected = _selected(study, grades)
    reaching = [
        s.effect
        for s in (*diagnosis.given, *diagnosis.settings)
        if s.effect.reaches_design and s.effect.session is None
    ]
    better = replace(study, effects=declared_by(diagnosis))
    is_other = any(not effect.of_rope for effect in reaching)
    last = _selected(better, grades) if is_other else selected
    mounted = mounted_use(study)
    old_use = None  # where the product chosen before is as good as any
    before, after = selected.product, last.product
    if before is not None and (after is None or after.name != before.name):
        cable = Allowance.of(study.selection, study.robot.winches).cable(before.grade, before.size)
        old_use = _use(last.built.of_products, study.workspace, cable)
    return replace(
        diagnosis,
        design_before=selected.choice,
        design_after=last.choice,
        kept=old_use,
        mounted_before=mounted,
        mounted_after=mounted_use(better) if reaching else mounted,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Selected:
    """A choice, the product behind it, and the machine that it was chosen for."""

    choice: RopeChoice
    product: Candidate | None
    built: AsBuilt


def _selected(study: Study, grades: Sequence[Grade]) -> _Selected:
    """Size the workspace and choose a product, with the effects that the study declares."""
    assert study.workspace is not None
    assert study.selection is not None
    built = as_built_by(study)
    built = replace(built, section_m=section_of_workspace(built, study.workspace, study.material))
    material = built.material(study.material)
    worst = map_workspace(built.robot, study.workspace, material, with_massless=False).sagging
    chosen = best_product(
        built.robot,
        study.workspace,
        study.selection,
        grades,
        built=built,
        load_cases=study.load_cases,
    )
    choice = RopeChoice(
        grade=chosen.grade.id if chosen else None,
        size_id=chosen.size.id if chosen else None,
        diameter_m=chosen.size.diameter_m if chosen else math.nan,
        max_tension_N=chosen.verification.max_tension_N if chosen else math.nan,
        optimum_m=worst.diameter_m if worst else math.nan,
        optimum_tension_N=worst.max_tension_N if worst else math.nan,
        utilisation=chosen.verification.utilisation if chosen else math.nan,
    )
    return _Selected(choice, chosen, built)


def _use(built: AsBuilt, workspace: Workspace, cable: Cable) -> Use:
    def max_tension_N(rope: Cable) -> float:
        return verify(built.robot, workspace, rope).max_tension_N

    verification = verify(
        built.robot, workspace, converge_stiffness(built.cable(cable), max_tension_N)
    )
    return Use(verification.max_tension_N, verification.utilisation)


def mounted_use(study: Study) -> Use | None:
    """Return what the cable on the machine meets, with the effects that the study declares.

    Its allowable tension is as for a product: end fittings, or bending with the losses of the
    sheaves, whichever takes more, and the safety factor. None where the study lacks a part of that.
    """
    rope, workspace, selection = study.measurements, study.workspace, study.selection
    if rope is None or workspace is None or selection is None:
        return None
    bending, reeving = 1.0, study.robot.winches.reeving_efficiency
    if selection.sheave_diameter_m and rope.diameter_m:
        bending = bending_efficiency(selection.sheave_diameter_m / rope.diameter_m)
    if rope.minimum_breaking_load_N is None or math.isnan(bending):  # outside the rule
        return None
    efficiency = min(selection.termination_efficiency, bending * reeving)
    allowable_N = rope.minimum_breaking_load_N * efficiency / selection.safety_factor
    return _use(as_built_by(study, mounted=True), workspace, rope.cable(allowable_N))
