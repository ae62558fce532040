"""Effects that a config declares, made ready to act."""

from __future__ import annotations

from designer.cable import Cable
from designer.effects.design import AsBuilt, built_with
from designer.effects.effect import Setting
from designer.effects.registry import all_effects
from designer.machine import Machine
from designer.study import Study

_ANY_CABLE = Cable(1.0, 1.0, 1.0, 1.0)


def declared_settings(study: Study) -> tuple[Setting, ...]:
    """Return the declared effects with their values, in the order in which they act."""
    wanted = {(effect.id, effect.cable): effect.parameters for effect in study.effects}
    return tuple(
        Setting(effect, wanted[effect.id, effect.cable])
        for effect in all_effects(Machine(study.robot, _ANY_CABLE))
        if (effect.id, effect.cable) in wanted
    )


def as_built_by(study: Study) -> AsBuilt:
    """Return the robot and its cables as the declared effects have them."""
    return built_with(study.robot, declared_settings(study))
