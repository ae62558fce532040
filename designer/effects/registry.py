"""All effects, in the order in which they act: first on the machine, then on the readings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module

from designer.effects.effect import Effect, Setting
from designer.model.machine import Machine


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


_IN_ORDER = (
    "poses.SHIFT",
    "poses.SCALE",
    "poses.FRAME",
    "poses.DISTORTION",
    "poses.TOOL_POINT",
    "points.EXIT",
    "points.ATTACHMENT",
    "base_tilt",
    "pulley_radius",
    "rope.MODULUS",
    "rope.CABLE_MODULUS",
    "rope.MASS",
    "rope.CABLE_MASS",
    "platform_mass",
    "platform_force",
    "load_step",
    "points.CENTRE",
    "platform_force.TURNING",
    "wind_drag",
    "bending_stiffness",
    "mast_compliance",
    "stiffening",
    "thermal_expansion",
    "creep",
    "creep.ONE",
    "cable_pulley_radius",
    "pulley_inclination",
    "encoder_on_rope",
    "drum_layering",
    "winch_scale.ALL",
    "thermal_expansion.WINCH",
    "tension_length",
    "winch_scale",
    "winch_scale.ZEROS",
    "winch_scale.HOMED",
    "drum_eccentricity",
    "backlash",
    "clock_offset",
    "cell_at_platform",
    "pulley_friction",
    "tension_hysteresis",
    "tension_gain",
    "tension_gain.ALL",
    "tension_gain.ZEROS",
)
"""Files of this folder, each with its ``EFFECT``, or with several, named after a dot."""

EFFECTS: tuple[Effect, ...] = tuple(
    getattr(import_module(f"designer.effects.{file}"), name or "EFFECT")
    for file, _, name in (place.partition(".") for place in _IN_ORDER)
)
SHIPPED = KnownEffects(EFFECTS)
"""Our own effects, without those of plugins."""
