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
    load_step,
    mast_compliance,
    platform_mass,
    pulley_friction,
    pulley_radius,
    stiffening,
    tension_bias,
    tension_gain,
    tension_length,
    thermal_expansion,
    wind_drag,
)
from designer.effects.kind import EffectKind
from designer.effects.known import KnownEffects

KINDS: tuple[EffectKind, ...] = (
    anchor_offset.KIND,
    base_tilt.KIND,
    pulley_radius.KIND,
    elastic_modulus.KIND,
    linear_mass.KIND,
    platform_mass.KIND,
    load_step.KIND,
    centre_of_mass_offset.KIND,
    wind_drag.KIND,
    bending_stiffness.KIND,
    mast_compliance.KIND,
    stiffening.KIND,
    thermal_expansion.KIND,
    creep.KIND,
    drum_layering.KIND,
    drum_scale.KIND,
    tension_length.KIND,
    length_offset.KIND,
    clock_offset.KIND,
    pulley_friction.KIND,
    tension_gain.KIND,
    tension_bias.KIND,
)

SHIPPED = KnownEffects(KINDS)
"""Our own effects, without those of plugins."""
