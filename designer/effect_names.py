"""Ids and parameters of the effects, as config and result files spell them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from designer.units import (
    ANGLE,
    AREA,
    FORCE,
    LENGTH,
    MASS,
    NUMBER,
    PER_TEMPERATURE,
    Dimension,
)

TIME = Dimension("a time", "s", "10 s")
PER_LENGTH = Dimension("a change per length", "1/m", "2e-4 /m")
FLEXURAL_RIGIDITY = Dimension("a flexural rigidity", "N*m^2", "12 N*m^2")


@dataclass(frozen=True, slots=True)
class ParameterName:
    """One number of an effect.

    Parameters
    ----------
    name : str
        As in the files, with its SI unit; ``{cable}`` stands for the number of a cable, from 1.
    dimension : Dimension
        What kind of quantity it is.
    neutral : float or None
        Value of a parameter that is left out; None where it must be given.
    above, at_least : float or None
        Limits beyond which it has no meaning.
    """

    name: str
    dimension: Dimension
    neutral: float | None = None
    above: float | None = None
    at_least: float | None = None


@dataclass(frozen=True, slots=True)
class EffectName:
    """One effect.

    Parameters
    ----------
    id : str
        As in the files.
    parameters : tuple of ParameterName
        Its numbers.
    takes_cable : bool
        Whether it concerns one cable, to be named with it, so that it may stand more than once.
    """

    id: str
    parameters: tuple[ParameterName, ...]
    takes_cable: bool = False

    def parameters_for(self, n_cables: int) -> tuple[ParameterName, ...]:
        """Return the parameters on a robot with so many cables."""
        return tuple(one for each in self.parameters for one in _expanded(each, n_cables))


def _expanded(parameter: ParameterName, n_cables: int) -> list[ParameterName]:
    if "{cable}" not in parameter.name:
        return [parameter]
    return [
        replace(parameter, name=parameter.name.format(cable=cable))
        for cable in range(1, n_cables + 1)
    ]


_SCALE = ParameterName("scale", NUMBER, above=0.0)
_SHIFT = tuple(ParameterName(name, LENGTH, neutral=0.0) for name in ("x_m", "y_m", "z_m"))
_TILT = tuple(ParameterName(name, ANGLE, neutral=0.0) for name in ("rx_rad", "ry_rad"))

_ALL = (
    EffectName("pulley_radius", (ParameterName("radius_m", LENGTH, at_least=0.0),)),
    EffectName("thermal_expansion", (ParameterName("coefficient_per_K", PER_TEMPERATURE),)),
    EffectName("elastic_modulus", (_SCALE,)),
    EffectName("linear_mass", (_SCALE,)),
    EffectName("platform_mass", (ParameterName("offset_kg", MASS),)),
    EffectName("centre_of_mass_offset", _SHIFT),
    EffectName("anchor_offset", _SHIFT, takes_cable=True),
    EffectName("length_offset", (ParameterName("offset_{cable}_m", LENGTH, neutral=0.0),)),
    EffectName("drum_scale", (_SCALE,)),
    EffectName(
        "drum_layering",
        (
            ParameterName("radius_gain_per_m", PER_LENGTH),
            ParameterName("reference_{cable}_m", LENGTH, neutral=0.0),
        ),
    ),
    EffectName(
        "creep",
        (ParameterName("strain_per_decade", NUMBER), ParameterName("onset_s", TIME, above=0.0)),
    ),
    EffectName("pulley_friction", (ParameterName("coefficient", NUMBER),)),
    EffectName("tension_gain", (ParameterName("gain", NUMBER, above=0.0),), takes_cable=True),
    EffectName("tension_bias", (ParameterName("offset_{cable}_N", FORCE, neutral=0.0),)),
    EffectName("wind_drag", (ParameterName("drag_area_m2", AREA),)),
    EffectName("base_tilt", _TILT),
    EffectName("clock_offset", (ParameterName("offset_s", TIME),)),
    EffectName(
        "bending_stiffness",
        (ParameterName("flexural_rigidity_N_m2", FLEXURAL_RIGIDITY, at_least=0.0),),
    ),
)

EFFECTS: Mapping[str, EffectName] = {effect.id: effect for effect in _ALL}
"""Every effect by its id."""
