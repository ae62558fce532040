"""All effects, in the order in which they act: first on the machine, then on the readings."""

from __future__ import annotations

from designer.effects import (
    anchor_offset,
    base_tilt,
    bending_stiffness,
    centre_of_mass_offset,
    clock_offset,
    creep,
    drum_layering,
    drum_scale,
    elastic_modulus,
    length_offset,
    linear_mass,
    platform_mass,
    pulley_friction,
    pulley_radius,
    tension_bias,
    tension_gain,
    thermal_expansion,
    wind_drag,
)
from designer.effects.effect import Builder, Effect
from designer.machine import Machine

BUILDERS: tuple[Builder, ...] = (
    anchor_offset.build,
    base_tilt.build,
    pulley_radius.build,
    elastic_modulus.build,
    linear_mass.build,
    platform_mass.build,
    centre_of_mass_offset.build,
    wind_drag.build,
    bending_stiffness.build,
    thermal_expansion.build,
    creep.build,
    drum_layering.build,
    drum_scale.build,
    length_offset.build,
    clock_offset.build,
    pulley_friction.build,
    tension_gain.build,
    tension_bias.build,
)


def all_effects(machine: Machine) -> list[Effect]:
    """Return every effect that this machine may have, in the order in which they act."""
    return [effect for build in BUILDERS for effect in build(machine)]
