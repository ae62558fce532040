"""All effects, in the order in which they act: first on the machine, then on the readings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from designer.effects import cables, load_cells, platform_loads, pulleys, setting_up, winches
from designer.effects.effect import Effect, Setting
from designer.model.robot import Machine


@dataclass(frozen=True, slots=True)
class KnownEffects:
    """Our own effects and those of plugins.

    Parameters
    ----------
    effects : tuple of Effect
        In the order in which they act; ids are unique.
    problems : tuple of str
        What was left out and why, one line each.
    """

    effects: tuple[Effect, ...]
    problems: tuple[str, ...] = ()

    @property
    def by_id(self) -> Mapping[str, Effect]:
        """Every effect by its id, in the order in which they act."""
        return {effect.id: effect for effect in self.effects}

    def of(self, machine: Machine) -> list[Effect]:
        """Return every effect that this machine may have, in the order in which they act.

        Raises
        ------
        designer.errors.EffectError
            If an effect of a plugin fails at this machine.
        """
        return [variant for effect in self.effects for variant in effect.on(machine)]

    def in_order(self, settings: Iterable[Setting]) -> list[Setting]:
        """Return settings in the order in which they act: a model is one, however it was found."""
        place = {effect.id: k for k, effect in enumerate(self.effects)}

        def order(setting: Setting) -> tuple[int, int, int]:
            effect = setting.effect
            return place[effect.id], effect.cable or 0, effect.session or 0

        return sorted(settings, key=order)

    def without(self, effect_id: str, problem: str) -> KnownEffects:
        """Return all effects but one, with the reason why it is left out."""
        remaining = tuple(effect for effect in self.effects if effect.id != effect_id)
        return KnownEffects(remaining, (*self.problems, problem))


EFFECTS: tuple[Effect, ...] = (
    setting_up.POSE_OFFSET,
    setting_up.POSE_SCALE,
    setting_up.POSE_FRAME,
    setting_up.POSE_DISTORTION,
    setting_up.TOOL_POINT,
    setting_up.ANCHOR_OFFSET,
    setting_up.ATTACHMENT_OFFSET,
    setting_up.BASE_TILT,
    pulleys.PULLEY_RADIUS,
    cables.ELASTIC_MODULUS,
    cables.CABLE_MODULUS,
    cables.LINEAR_MASS,
    cables.CABLE_MASS,
    platform_loads.PLATFORM_MASS,
    platform_loads.PLATFORM_FORCE,
    platform_loads.LOAD_STEP,
    setting_up.CENTRE_OF_MASS_OFFSET,
    platform_loads.PLATFORM_MOMENT,
    platform_loads.WIND_DRAG,
    cables.BENDING_STIFFNESS,
    pulleys.MAST_COMPLIANCE,
    cables.STIFFENING,
    cables.THERMAL_EXPANSION,
    cables.CREEP,
    cables.CABLE_CREEP,
    pulleys.CABLE_PULLEY_RADIUS,
    pulleys.PULLEY_INCLINATION,
    winches.ENCODER_ON_ROPE,
    winches.DRUM_LAYERING,
    winches.DRUM_SCALE,
    cables.WINCH_EXPANSION,
    winches.TENSION_LENGTH,
    winches.WINCH_SCALE,
    winches.LENGTH_OFFSET,
    winches.WINCH_ZERO,
    winches.DRUM_ECCENTRICITY,
    winches.BACKLASH,
    setting_up.CLOCK_OFFSET,
    load_cells.CELL_AT_PLATFORM,
    load_cells.PULLEY_FRICTION,
    load_cells.TENSION_HYSTERESIS,
    load_cells.TENSION_GAIN,
    load_cells.TENSION_SCALE,
    load_cells.TENSION_BIAS,
)
SHIPPED = KnownEffects(EFFECTS)
"""Our own effects, without those of plugins."""
