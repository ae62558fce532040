"""From parameters to grades."""

from __future__ import annotations

from designer.grades.grade import ComputedFigure, Grade, Limits, Reference, RelativeStiffness, Size
from fibre_rope.creep import CreepLaw
from fibre_rope.parameters import Condition, Parameters

_YEAR_S = 365.25 * 86400.0
_ZERO_CELSIUS_K = 273.15
_STIFFNESS_UNCERTAINTY = 0.3
"""MoorPy gives 56 quasi-static and 59 + 54 · load fraction dynamic: up to 30 % apart."""


def computed_grades(parameters: Parameters) -> list[Grade]:
    """Return one grade for each condition."""
    return [_grade(parameters, condition) for condition in parameters.conditions]


def breaking_load_N(parameters: Parameters, diameter_m: float) -> float:
    """Return the breaking load of a new rope at room temperature [N]."""
    growth = parameters.breaking_load_d2 + parameters.breaking_load_d3 * diameter_m
    return growth * diameter_m**2


def creep_load_fraction(parameters: Parameters, condition: Condition) -> float:
    """Return the load over breaking load at which the rope lasts as long as it must.

    The stress is that of the fibre, the load over the fibre's own section. At one load fraction it
    is highest in the thickest size, which is taken for all.
    """
    thickest_m = parameters.diameters_m[-1]
    fibre_area_m2 = parameters.mass_d2 * thickest_m**2 / parameters.fibre_density_kg_per_m3
    breaking_stress_Pa = breaking_load_N(parameters, thickest_m) / fibre_area_m2
    law = CreepLaw(
        activation_energy_J=parameters.activation_energy_J,
        activation_volume_m3=parameters.activation_volume_m3,
        reference_stress_Pa=parameters.reference_load_fraction * breaking_stress_Pa,
        reference_temperature_K=parameters.reference.temperature_K,
        reference_life_s=parameters.reference.life_s,
    )
    return law.stress_Pa(condition.life_s, condition.temperature_K) / breaking_stress_Pa


def usable_share(parameters: Parameters, condition: Condition) -> float:
    """Return the share of the breaking load that is left where creep is counted.

    Divided by the safety factor it is the lesser of the load that the safety factor allows and the
    load that creep allows.
    """
    return min(1.0, parameters.safety_factor * creep_load_fraction(parameters, condition))


def _grade(parameters: Parameters, condition: Condition) -> Grade:
    share = usable_share(parameters, condition)
    temperature_C = condition.temperature_K - _ZERO_CELSIUS_K
    where = f"{temperature_C:.4g} °C for {_years(condition)}"
    left = f"{creep_load_fraction(parameters, condition):.3g} of the breaking load"
    return Grade(
        id=f"hmpe-computed-{temperature_C:.4g}c-{condition.life_s / _YEAR_S:.4g}y",
        manufacturer="computed",
        product=f"HMPE rope at {where}",
        construction="braided, not a product",
        core="HMPE",
        finish="none",
        # The catalogue's bounds for HMPE hold for breaking loads; these are lowered ones.
        material="other",
        sizes=tuple(_size(parameters, share, diameter_m) for diameter_m in parameters.diameters_m),
        source=Reference("computed by the plugin fibre-rope", parameters.rope_source),
        trust="C",
        stiffness=RelativeStiffness(
            # EA is that of the whole rope, whatever share of its strength may be used.
            ea_over_breaking_load=(parameters.ea_over_breaking_load / share,),
            load_fraction=(),
            basis="computed",
            source=f"{parameters.ea_over_breaking_load:g} times the full breaking load: "
            + parameters.rope_source,
            uncertainty=_STIFFNESS_UNCERTAINTY,
        ),
        limits=Limits(
            source=f"{parameters.temperature_source}; {parameters.creep_source}",
            creep=f"at {where} creep allows {left}; less if warmer or longer",
        ),
        computed=(
            ComputedFigure(
                "minimum_breaking_load",
                f"{share:.3g} of the breaking load, so that a safety factor of "
                f"{parameters.safety_factor:g} leaves what creep allows",
            ),
            ComputedFigure("linear_mass", "by the regression"),
        ),
        notes=_notes(parameters),
        is_nominal=True,
    )


def _size(parameters: Parameters, share: float, diameter_m: float) -> Size:
    assumed = "creep is computed from an assumption: set creep.reference and its source"
    return Size(
        id=f"{1e3 * diameter_m:g} mm",
        diameter_m=diameter_m,
        minimum_breaking_load_N=share * breaking_load_N(parameters, diameter_m),
        linear_density_kg_per_m=parameters.mass_d2 * diameter_m**2,
        doubt=None if parameters.reference_source else assumed,
    )


def _notes(parameters: Parameters) -> tuple[str, ...]:
    reference = parameters.reference_source or "an assumption, not of any maker"
    return (
        f"Right for a safety factor of {parameters.safety_factor:g} alone; another one asks for "
        "another parameter file.",
        f"Creep life at {parameters.reference_load_fraction:g} of the breaking load, "
        f"{parameters.reference.temperature_K - _ZERO_CELSIUS_K:.4g} °C: "
        f"{_years(parameters.reference)}, {reference}.",
        "The load is taken as there all the time, which is too hard on a rope that is unloaded "
        "between lifts.",
    )


def _years(condition: Condition) -> str:
    years = f"{condition.life_s / _YEAR_S:.4g}"
    return f"{years} year" if years == "1" else f"{years} years"
