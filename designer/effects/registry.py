"""All effects, in the order in which they act: first on the machine, then on the readings."""

from __future__ import annotations

from importlib import import_module

from designer.effects.effect import Effect
from designer.effects.known import KnownEffects

_IN_ORDER = (
    "anchor_offset",
    "base_tilt",
    "pulley_radius",
    "elastic_modulus",
    "linear_mass",
    "platform_mass",
    "load_step",
    "centre_of_mass_offset",
    "wind_drag",
    "bending_stiffness",
    "mast_compliance",
    "stiffening",
    "thermal_expansion",
    "creep",
    "drum_layering",
    "drum_scale",
    "tension_length",
    "length_offset",
    "clock_offset",
    "pulley_friction",
    "tension_gain",
    "tension_bias",
)
"""Files of this folder, each with its ``EFFECT``."""

EFFECTS: tuple[Effect, ...] = tuple(
    import_module(f"designer.effects.{name}").EFFECT for name in _IN_ORDER
)
SHIPPED = KnownEffects(EFFECTS)
"""Our own effects, without those of plugins."""
