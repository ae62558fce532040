"""Effects that a config declares, made ready to act."""

from __future__ import annotations

from designer.cable import Cable
from designer.effects.design import AsBuilt, built_with
from designer.effects.effect import Setting
from designer.errors import InputError
from designer.machine import Machine
from designer.study import Study

_ANY_CABLE = Cable(1.0, 1.0, 1.0, 1.0)


def declared_settings(study: Study) -> tuple[Setting, ...]:
    """Return the declared effects with their values, in the order in which they act.

    Raises
    ------
    InputError
        If this machine cannot have one of them.
    """
    wanted = {(effect.id, effect.cable): effect.parameters for effect in study.effects}
    settings = tuple(
        Setting(effect, wanted[effect.id, effect.cable])
        for effect in study.known_effects.of(Machine(study.robot, _ANY_CABLE))
        if (effect.id, effect.cable) in wanted
    )
    impossible = wanted.keys() - {(s.effect.id, s.effect.cable) for s in settings}
    if impossible:
        raise InputError(
            study.source.fault(f"effects.{effect_id}", "this robot cannot have it")
            for effect_id, _ in sorted(impossible, key=str)
        )
    return settings


def as_built_by(study: Study) -> AsBuilt:
    """Return the robot and its cables as the declared effects have them."""
    return built_with(study.robot, declared_settings(study))
