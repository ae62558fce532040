"""A base that does not stand upright."""

from __future__ import annotations

from dataclasses import replace

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import ANGLE


def _change(machine: Machine, values: Values) -> Machine:
    tilt = frozen_array([values["rx_rad"], values["ry_rad"]])
    return replace(machine, robot=replace(machine.robot, tilt_rad=tilt))


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    angles = tuple(
        Parameter(name, "rad", 0.0, 2e-3, (-0.5, 0.5), (-0.1, 0.1)) for name in ("rx_rad", "ry_rad")
    )
    return [
        Effect(
            id="base_tilt",
            summary="gravity is not along the frame's -z: the base stands tilted",
            law="the base frame is turned by the rotation vector (rx, ry, 0) against the vertical",
            source="definition",
            parameters=angles,
            on_machine=_change,
            reaches_design=True,
        )
    ]


KIND = EffectKind(
    EffectName(
        "base_tilt", tuple(ParameterName(name, ANGLE, neutral=0.0) for name in ("rx_rad", "ry_rad"))
    ),
    build,
)
