"""Ropes softer or stiffer, heavier or lighter than declared: all of them, or that of one cable."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values, of_one
from designer.model.machine import Machine
from designer.units import NUMBER


def _scale(low: float, high: float) -> tuple[Parameter, ...]:
    """Return the scale that each of them has, plausible between two values."""
    size = Size(0.05, bounds=(0.02, 50.0), plausible=(low, high))
    return (Parameter("scale", NUMBER, size, neutral=1.0, above=0.0),)


def _stretch(machine: Machine, values: Values) -> Machine:
    stiffness_N = machine.cable.axial_stiffness_N * values["scale"]
    return replace(machine, cable=replace(machine.cable, axial_stiffness_N=stiffness_N))


def _load(machine: Machine, values: Values) -> Machine:
    density = machine.cable.linear_density_kg_per_m * values["scale"]
    return replace(machine, cable=replace(machine.cable, linear_density_kg_per_m=density))


def _stretch_one(machine: Machine, values: Values, *, cable: int) -> Machine:
    shares = of_one(machine, machine.relative_stiffness, cable, values["scale"])
    return replace(machine, relative_stiffness=shares)


def _load_one(machine: Machine, values: Values, *, cable: int) -> Machine:
    shares = of_one(machine, machine.relative_mass, cable, values["scale"])
    return replace(machine, relative_mass=shares)


MODULUS = Effect(
    id="elastic_modulus",
    summary="the cable is softer or stiffer than declared",
    law="EA is scale times the declared one",
    source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli scatter, and rise with use",
    parameters=_scale(0.2, 5.0),
    on_machine=_stretch,
    reaches_design=True,
    of_rope=True,
)
MASS = replace(  # water, grease, ice
    MODULUS,
    id="linear_mass",
    summary="the cable is heavier or lighter than declared",
    law="mass per length is scale times the declared one",
    source="definition",
    parameters=_scale(0.8, 2.5),
    on_machine=_load,
)
CABLE_MODULUS = Effect(
    id="cable_modulus",
    summary="cable {cable} is not as stiff as the others",
    law="EA of this cable is scale times that of the others",
    source="Hooke's law",
    parameters=_scale(0.2, 2.0),
    on_machine=_stretch_one,
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
    on_machine=_load_one,
)
