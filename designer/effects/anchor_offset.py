"""One exit point that is not where the drawing has it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import LENGTH


def _change(machine: Machine, values: Values, *, cable: int) -> Machine:
    moved = np.array(machine.robot.exit_points_m)
    moved[cable - 1] += [values["x_m"], values["y_m"], values["z_m"]]
    return replace(machine, robot=replace(machine.robot, exit_points_m=frozen_array(moved)))


def build(machine: Machine) -> list[Effect]:
    """Return one effect for each cable."""
    size = float(np.ptp(machine.robot.exit_points_m, axis=0).max())
    axes = tuple(
        Parameter(name, "m", 0.0, 1e-3 * size, (-size, size), (-0.02 * size, 0.02 * size))
        for name in ("x_m", "y_m", "z_m")
    )
    return [
        Effect(
            id="anchor_offset",
            summary=f"the exit point of cable {cable} is not where the drawing has it",
            law="exit point plus offset",
            source="definition",
            parameters=axes,
            on_machine=partial(_change, cable=cable),
            cable=cable,
            reaches_design=True,
        )
        for cable in range(1, machine.robot.n_cables + 1)
    ]


KIND = EffectKind(
    EffectName(
        "anchor_offset",
        tuple(ParameterName(name, LENGTH, neutral=0.0) for name in ("x_m", "y_m", "z_m")),
        takes_cable=True,
    ),
    build,
)
