"""A centre of mass that is not where the drawing has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import LENGTH


def _change(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    offset = np.array([values["x_m"], values["y_m"], values["z_m"]])
    moved = replace(platform, centre_of_mass_m=frozen_array(platform.centre_of_mass_m + offset))
    return replace(machine, robot=replace(machine.robot, platform=moved))


def build(machine: Machine) -> list[Effect]:
    """Return the effect; none for a point mass, which has no body."""
    if machine.robot.is_point_mass:
        return []
    axes = tuple(
        Parameter(name, "m", 0.0, 0.01, (-5.0, 5.0), (-0.5, 0.5)) for name in ("x_m", "y_m", "z_m")
    )
    return [
        Effect(
            id="centre_of_mass_offset",
            summary="the centre of mass is not where the drawing has it",
            law="centre of mass plus offset, body frame",
            source="definition",
            parameters=axes,
            on_machine=_change,
            needs=frozenset({"rotation"}),
            reaches_design=True,
        )
    ]


KIND = EffectKind(
    EffectName(
        "centre_of_mass_offset",
        tuple(ParameterName(name, LENGTH, neutral=0.0) for name in ("x_m", "y_m", "z_m")),
    ),
    build,
)
