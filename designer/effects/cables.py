"""Cables that are not as the data sheet has them: stiffness, mass, bending, stiffening, growth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import (
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
    pull_of,
    sized_by,
    weight_N,
)
from designer.model.measurements import Measured
from designer.model.robot import Machine
from designer.units import FLEXURAL_RIGIDITY, FORCE, NUMBER, PER_TEMPERATURE, TIME

# Ropes softer or stiffer, heavier or lighter than declared: all of them, or that of one cable.


def _scale(low: float, high: float) -> tuple[Parameter, ...]:
    """Return the scale that each of them has, plausible between two values."""
    size = Size(0.05, bounds=(0.02, 50.0), plausible=(low, high))
    return (Parameter("scale", NUMBER, size, neutral=1.0, above=0.0),)


def _scaled_share(
    machine: Machine, shares: FloatArray | None, cable: int, scale: float
) -> FloatArray:
    """Return shares of all cables (n_cables,), ones before, with that of one cable scaled."""
    scaled = np.ones(machine.robot.n_cables) if shares is None else np.array(shares)
    scaled[cable - 1] *= scale
    return scaled


def _scale_stiffness(machine: Machine, values: Values) -> Machine:
    stiffness_N = machine.cable.axial_stiffness_N * values["scale"]
    return replace(machine, cable=replace(machine.cable, axial_stiffness_N=stiffness_N))


def _scale_mass(machine: Machine, values: Values) -> Machine:
    density = machine.cable.linear_density_kg_per_m * values["scale"]
    return replace(machine, cable=replace(machine.cable, linear_density_kg_per_m=density))


def _scale_stiffness_of_cable(machine: Machine, values: Values, *, cable: int) -> Machine:
    shares = _scaled_share(machine, machine.relative_stiffness, cable, values["scale"])
    return replace(machine, relative_stiffness=shares)


def _scale_mass_of_cable(machine: Machine, values: Values, *, cable: int) -> Machine:
    shares = _scaled_share(machine, machine.relative_mass, cable, values["scale"])
    return replace(machine, relative_mass=shares)


ELASTIC_MODULUS = Effect(
    id="elastic_modulus",
    summary="the cable is softer or stiffer than declared",
    law="EA is scale times the declared one",
    source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli scatter, and rise with use",
    parameters=_scale(0.2, 5.0),
    on_machine=_scale_stiffness,
    reaches_design=True,
    of_rope=True,
)
LINEAR_MASS = replace(  # water, grease, ice
    ELASTIC_MODULUS,
    id="linear_mass",
    summary="the cable is heavier or lighter than declared",
    law="mass per length is scale times the declared one",
    source="definition",
    parameters=_scale(0.8, 2.5),
    on_machine=_scale_mass,
)
CABLE_MODULUS = Effect(
    id="cable_modulus",
    summary="cable {cable} is not as stiff as the others",
    law="EA of this cable is scale times that of the others",
    source="Hooke's law",
    parameters=_scale(0.2, 2.0),
    on_machine=_scale_stiffness_of_cable,
    takes_cable=True,
    of_rope=True,
)
CABLE_MASS = replace(
    CABLE_MODULUS,
    id="cable_mass",
    summary="cable {cable} is not as heavy as the others",
    law="mass per length of this cable is scale times that of the others",
    source="definition",
    parameters=_scale(0.5, 3.0),
    on_machine=_scale_mass_of_cable,
)


# A cable stiff enough in bending to straighten its ends.


def _rigidity_size(machine: Machine) -> Size:
    """No rope is stiffer than a solid bar, EA · A/(4π), of the lightest material, 1000 kg/m³."""
    cable = machine.cable
    area_m2 = cable.mean_density_kg_per_m / 1000.0
    stiffest = cable.axial_stiffness_N * area_m2 / (4.0 * math.pi)
    return Size(10.0, bounds=(0.0, 1e6), plausible=(0.0, stiffest))


BENDING_STIFFNESS = Effect(
    id="bending_stiffness",
    summary="the cable resists bending, so its ends sag less",
    law="boundary layers of length √(EI/T) at both ends, clamped along the chord",
    source="Irvine, Cable Structures, 1981, section 2.5",
    parameters=(
        Parameter("flexural_rigidity_N_m2", FLEXURAL_RIGIDITY, _rigidity_size, at_least=0.0),
    ),
    on_machine=lambda machine, values: replace(
        machine, flexural_rigidity_N_m2=values["flexural_rigidity_N_m2"]
    ),
)


# Cables that are soft as long as they are slack, and stiffen.

_TOE_STRAIN = Size(1e-4, bounds=(0.0, 0.05), plausible=(0.0, 0.01))


def _stretch_toe(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    mean = pull_of(machine, measured, readings.tension_N).mean_N
    stretch = 1.0 + mean / machine.cables.axial_stiffness_N
    more = -values["toe_strain"] * np.expm1(-mean / values["toe_tension_N"])
    # Stretched length stays; what is unstrained of it shrinks by the strain that is added.
    return replace(readings, length_m=readings.length_m * stretch / (stretch + more))


_TOE_TENSION = sized_by(weight_N, 0.1, bounds=(0.02, 20.0), plausible=(0.02, 10.0), neutral=0.3)
"""The tension at which the toe ends is near those that hold the platform."""


STIFFENING = Effect(
    id="stiffening",
    summary="the cables stiffen with tension",
    law="strain is T/EA + ε (1 - exp(-T/T_toe))",
    source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli rise with stress",
    parameters=(
        Parameter("toe_strain", NUMBER, _TOE_STRAIN, at_least=0.0),
        Parameter("toe_tension_N", FORCE, _TOE_TENSION, above=0.0),
    ),
    on_readings=_stretch_toe,
    needs=frozenset({"length"}),
    takes_machine=True,
)


# Cables, and winches, that grow with temperature.

_METAL_KG_PER_M3 = 2500.0
"""Ropes of metal weigh at least 3500, of fibre at most 1500, over the circle of their diameter."""


def _thermal_growth(values: Values, measured: Measured) -> FloatArray:
    assert measured.temperature_C is not None
    growth = 1.0 + values["coefficient_per_K"] * (measured.temperature_C - 20.0)
    return np.asarray(growth[:, None])


def _expansion_size(machine: Machine) -> Size:
    """Fibre may shrink; metal grows, in the sun by more than the air's temperature tells."""
    is_metal = machine.rope_density_kg_per_m3 > _METAL_KG_PER_M3
    return Size(1e-5, (-1e-3, 1e-3), plausible=(0.0, 5e-5) if is_metal else (-5e-5, 2e-4))


THERMAL_EXPANSION = Effect(
    id="thermal_expansion",
    summary="the cables grow with temperature",
    law="unstrained length times 1 + α (T - 20 °C)",
    source="definition; steel 12.5e-6 /K, aramid -2e-6 /K, HMPE -12e-6 /K along the fibre",
    parameters=(Parameter("coefficient_per_K", PER_TEMPERATURE, _expansion_size),),
    # The winch pays out length at 20 °C; what hangs is longer by the growth.
    on_readings=lambda readings, values, measured: replace(
        readings, length_m=readings.length_m / _thermal_growth(values, measured)
    ),
    needs=frozenset({"temperature", "length"}),
)
WINCH_EXPANSION = replace(
    THERMAL_EXPANSION,
    id="winch_expansion",
    summary="the winches' readings change with temperature, as where the drums grow",
    law="true length times 1 + α (T - 20 °C); α of a drum that grows and counts its turns is minus "
    "its own expansion",
    source="definition; steel 12e-6 /K, aluminium 23e-6 /K",
    parameters=(
        Parameter(
            "coefficient_per_K", PER_TEMPERATURE, Size(1e-5, (-1e-3, 1e-3), plausible=(-5e-5, 5e-5))
        ),
    ),
    on_readings=lambda readings, values, measured: replace(
        readings, length_m=readings.length_m * _thermal_growth(values, measured)
    ),
)


# Cables that grow with time under load: all, or one, such as a new one among old ones.

_CREEP_STRAIN = Size(1e-4, bounds=(-0.05, 0.05), plausible=(0.0, 0.01))
_CREEP_ONSET = Size(50.0, bounds=(0.1, 1e7), plausible=(1.0, 1e6))


def _creep_growth(values: Values, measured: Measured) -> FloatArray:
    """Return length over length at the start of each row (n_rows,)."""
    assert measured.time_s is not None
    decades = np.log10(1.0 + np.maximum(measured.time_s, 0.0) / values["onset_s"])
    return np.asarray(1.0 + values["strain_per_decade"] * decades)


def _creep_cable(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] /= _creep_growth(values, measured)
    return replace(readings, length_m=length)


CREEP = Effect(
    id="creep",
    summary="the cables grow with time",
    law="unstrained length times 1 + c log10(1 + t/t0)",
    source="McKenna, Hearle and O'Hear, Handbook of Fibre Rope Technology, 2004",
    parameters=(
        Parameter("strain_per_decade", NUMBER, _CREEP_STRAIN),
        Parameter("onset_s", TIME, _CREEP_ONSET, neutral=100.0, above=0.0),
    ),
    on_readings=lambda readings, values, measured: replace(
        readings, length_m=readings.length_m / _creep_growth(values, measured)[:, None]
    ),
    needs=frozenset({"time", "length"}),
    starts=tuple({"strain_per_decade": 1e-4, "onset_s": t} for t in (5.0, 100.0, 2000.0)),
)
CABLE_CREEP = replace(
    CREEP,
    id="cable_creep",
    summary="cable {cable} grows with time",
    law="unstrained length of this cable times 1 + c log10(1 + t/t0)",
    on_readings=_creep_cable,
    takes_cable=True,
)
