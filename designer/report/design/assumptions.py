"""What the results rest on. The template of the section adds the equations."""

from __future__ import annotations

import numpy as np

from designer.analysis.analyse import Analysis
from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.robot import Robot
from designer.report import format as fmt
from designer.report.blocks import Bullets, Section
from designer.report.design.source import Source
from designer.study import Selection, Study, rope_effects


def section(source: Source) -> Section:
    """Return what the results rest on."""
    analysis = source.analysis
    robot, selection, found = analysis.built.robot, analysis.study.selection, analysis.qualities
    kind = "point mass" if robot.is_point_mass else "rigid platform that can turn"
    where = ", guided in a vertical plane" if robot.is_planar else ""
    exits = "Exit points are fixed points, without pulleys."
    if robot.pulley_radius_m != 0.0:
        radius = fmt.trimmed(1e3 * robot.pulley_radius_m)
        exits = (
            f"The cables leave over swivelling pulleys of {radius}\u00a0mm radius at the exit "
            "points."
        )
    safety = ""
    if selection is not None:
        safety = (
            f"The safety factor of {fmt.trimmed(selection.safety_factor)} applies to the minimum "
            "breaking load. Breaking load, mass and modulus are those of the rope's table."
        )
    crossing = "Cables may cross each other, the ground or the platform; this is not checked."
    if found is not None and found.interference is not None:
        crossing = (
            "Cables are checked against each other and the platform, but may touch the ground."
        )
    of_group = " of a group" if analysis.assignment.has_groups else ""
    items = (
        f"Static equilibrium only: a {kind} of {fmt.kilograms(robot.platform.mass_kg)} on "
        f"{robot.n_cables} cables{where}. {_motion(analysis.study)}",
        f"All cables{of_group} are equal. Each is elastic, carries no bending and no compression.",
        _loads(robot),
        f"{exits} {_losses(selection)}",
        _thinnest(robot),
        _effects(analysis),
        safety,
        f"{_not_counted(analysis.study)} Gravity is "
        f"{fmt.number(STANDARD_GRAVITY_M_PER_S2, 3)}\u00a0m/s².",
        crossing,
    )
    shown = Bullets(tuple(item for item in items if item))
    return Section.of("assumptions", "Assumptions and limits", shown)


def _not_counted(study: Study) -> str:
    if any(case.temperature_change_K for case in study.load_cases):
        return "Temperature counts as in the load cases; creep and wear are not counted."
    return "Temperature, creep and wear are not counted."


def _motion(study: Study) -> str:
    if study.load_cases:
        return "Motion, wind and ice are as in the load cases, as forces at rest."
    return "No motion, no wind, no ice."


def nomenclature(_: Source) -> Section:
    """Return the names of quantities, which stand in a template of their own."""
    return Section("nomenclature", "Nomenclature")


def _effects(analysis: Analysis) -> str:
    study = analysis.study
    if not study.effects:
        return ""
    ids = ", ".join(dict.fromkeys(effect.id for effect in study.effects))
    text = (
        f"All results are those of the machine with the effects that the study declares: {ids}. "
        "They act on each rope with its own mass and stiffness. Where a law asks for the "
        "temperature, it is the declared one, "
        f"{fmt.trimmed(study.surroundings.temperature_C)}\u00a0°C."
    )
    if note := rope_effects_note(study):
        text += f" {note}"
    if analysis.section_m is None:
        return text
    return (
        f"{text} They do not act alike on all sections. The configured family is computed with "
        f"what they make of its member of {fmt.millimetres(analysis.section_m)}, which is right "
        "for the worst pose; poses that need less are mapped a little too thin."
    )


def rope_effects_note(study: Study) -> str:
    """Return to which rope the effects of a rope belong; empty where none is declared."""
    ids = rope_effects(study)
    if not ids:
        return ""
    verb, them = ("belongs", "It is") if len(ids) == 1 else ("belong", "They are")
    whose = "configured family" if study.measurements is None else "rope on the machine"
    return (
        f"{fmt.capital(fmt.listing(ids))} {verb} to the {whose}. {them} not applied to ropes of "
        "the catalogue, which have the figures of their data sheets."
    )


def _thinnest(robot: Robot) -> str:
    if robot.has_one_branch:
        return (
            "A point mass on as many cables as it has degrees of freedom has one equilibrium for "
            "each cable, so a needed diameter is the thinnest there is."
        )
    return (
        "The cables may run in more than one way: one may hang as a counterweight, or be pulled "
        "tight. At each pose the multipliers of the way found tell what a cable could gain by "
        "hanging or by more pull; where that is above 0.05 % of the weight, other ways are tried: "
        "each cable hanging in turn, all cables with half their pull, and random pulls. A needed "
        "diameter is the thinnest that was found; it is not proved that there is no thinner one."
    )


def _loads(robot: Robot) -> str:
    """Return what acts on the platform beside its weight, and where the weight points."""

    def row(values: FloatArray, digits: int = 4) -> str:
        return f"({', '.join(fmt.trimmed(float(x), digits) for x in values)})"

    parts = []
    force, moment = robot.platform.wrench_N[:3], robot.platform.wrench_N[3:]
    if force.any():
        parts.append(
            f"A constant force of {row(force)}\u00a0N acts on the platform beside its weight."
        )
    if moment.any():
        parts.append(f"A constant moment of {row(moment)}\u00a0N·m acts on the platform.")
    down = robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    if not np.array_equal(down, [0.0, 0.0, -1.0]):
        parts.append(f"Things fall along {row(down, 3)}.")
    if robot.tension_min_N > 0.0:
        least = fmt.newtons(robot.tension_min_N)
        parts.append(f"No cable has less than {least} anywhere along it.")
    if robot.is_redundant and robot.sag_max is not None:
        share = fmt.share(robot.sag_max, 1.0)
        parts.append(f"Where the cables can keep it, none sags more than {share} of its chord.")
    return " ".join(parts)


def _losses(selection: Selection | None) -> str:
    bends = selection is not None and selection.sheave_diameter_m is not None
    ends = selection is not None and selection.termination_efficiency < 1.0
    if selection is None or not (bends or ends):
        return (
            "Loss of strength by bending over a drum or a sheave (D/d) is not counted, nor are "
            "terminations."
        )
    parts = []
    if ends:
        share = fmt.trimmed(selection.termination_efficiency, 3)
        parts.append(f"the end fittings leave {share} of the breaking load")
    if selection.sheave_diameter_m is not None:
        sheave = fmt.millimetres(selection.sheave_diameter_m)
        parts.append(
            f"bending over {sheave} leaves a wire rope 1 − 0.5/√(D/d) of it, a fibre rope all, "
            "down to the least D/d of its maker (Noble Denton 0027/ND, 7.8)"
        )
    text = f"{' and '.join(parts)}{'; the smaller share counts' if len(parts) > 1 else ''}"
    return f"{fmt.capital(text)}. Fatigue of a rope that runs over sheaves is not counted."
