"""Effects that a config declares, made ready to act."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.design import AsBuilt, built_with
from designer.effects.effect import Setting
from designer.effects.known import KnownEffects
from designer.errors import InputError
from designer.machine import Machine
from designer.study import Study

_LIKELY_DIAMETER_M = 0.01
"""Of the cable that stands in where none is given yet."""


def declared_settings(study: Study, machine: Machine | None = None) -> tuple[Setting, ...]:
    """Return the declared effects with their values, in the order in which they act.

    Parameters
    ----------
    study : Study
        With its effects.
    machine : Machine, optional
        What to make them for; the study's robot with a cable of its family, if left out.

    Raises
    ------
    InputError
        If this machine cannot have one of them.
    """
    wanted = {(effect.id, effect.cable): effect.parameters for effect in study.effects}
    ids = {effect_id for effect_id, _ in wanted}
    known = KnownEffects(tuple(k for k in study.known_effects.kinds if k.name.id in ids))
    settings = tuple(
        Setting(effect, wanted[effect.id, effect.cable])
        for effect in known.of(machine or declared_machine(study))
        if (effect.id, effect.cable) in wanted
    )
    impossible = wanted.keys() - {(s.effect.id, s.effect.cable) for s in settings}
    if impossible:
        raise InputError(
            study.source.fault(f"effects.{effect_id}", "this robot cannot have it")
            for effect_id, _ in sorted(impossible, key=str)
        )
    return settings


def declared_machine(study: Study) -> Machine:
    """Return the robot in its declared surroundings, with a cable of the study's family."""
    cable = study.material.cable(_LIKELY_DIAMETER_M)
    return Machine(study.robot, cable, surroundings=study.surroundings)


def as_built_by(study: Study, section_m: float | None = None) -> AsBuilt:
    """Return the robot and its cables as the declared effects have them.

    Parameters
    ----------
    study : Study
        With its effects.
    section_m : float, optional
        Diameter at which they are applied to a family that does not stay one [m].
    """
    built = built_with(declared_machine(study), lambda machine: declared_settings(study, machine))
    return replace(built, section_m=section_m)
