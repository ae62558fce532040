"""From a study with measurements to a case for the diagnosis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.diagnosis.diagnose import Case
from designer.effects.effect import NEEDS, Effect, as_built
from designer.model.cable import Cable
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.study import Measurements, Study, declared_settings


def case_of(study: Study, measurements: Measurements, measured: Measured) -> Case:
    """Return what the diagnosis starts from.

    An effect that is declared and unknown is fitted like any unknown.

    Parameters
    ----------
    study, measurements, measured
        As read.
    """
    if measurements.estimated_noise:
        measurements = _without_estimates(measurements)
    # The diagnosis asks no strength of the cable, and only laws of plugins ask its diameter.
    cable = Cable(
        diameter_m=measurements.diameter_m or float("nan"),
        linear_density_kg_per_m=measurements.linear_density_kg_per_m,
        axial_stiffness_N=measurements.axial_stiffness_N,
        allowable_tension_N=float("inf"),
    )
    machine = Machine(study.robot, cable, surroundings=study.surroundings)
    declared = declared_settings(study, machine)
    fixed = [s for s in declared if not s.effect.is_among(measurements.unknown)]
    known = {setting.effect.key for setting in fixed}
    effects = [e for e in study.known_effects.of(as_built(machine, declared)) if e.key not in known]
    recorded = _recorded(study, measured)
    skipped = [(e.key, missing) for e in effects if (missing := _missing(e, recorded))]
    shown = [e for e in effects if not _missing(e, recorded)]
    return Case(
        study,
        measurements,
        machine,
        measured,
        tuple(e for e in shown if not e.is_among(measurements.unknown)),
        tuple(e for e in shown if e.is_among(measurements.unknown)),
        tuple(skipped),
        tuple(s for s in fixed if _acts(s.effect, recorded)),
        tuple(
            (s.effect.key, _missing(s.effect, recorded))
            for s in fixed
            if not _acts(s.effect, recorded)
        ),
    )


def _without_estimates(measurements: Measurements) -> Measurements:
    """Leave out the noise that a diagnosis has estimated before: nobody declared it."""
    is_length, is_tension = (kind in measurements.estimated_noise for kind in ("length", "tension"))
    return replace(
        measurements,
        length_noise_m=None if is_length else measurements.length_noise_m,
        tension_noise_N=None if is_tension else measurements.tension_noise_N,
    )


def _acts(effect: Effect, recorded: frozenset[str]) -> bool:
    """Tell whether a declared effect acts on these rows; on the machine it does unseen."""
    is_bodily = effect.on_machine is not None and "wind" not in effect.needs
    return is_bodily or not _missing(effect, recorded)


def _missing(effect: Effect, recorded: frozenset[str]) -> str:
    """Return what the data lack for an effect to show; empty where it shows."""
    missing = sorted(effect.needs - recorded)
    return f"needs {NEEDS[missing[0]]}" if missing else ""


def _recorded(study: Study, measured: Measured) -> frozenset[str]:
    found = set(measured.columns)
    if not measured.settled:
        found.add("motion")
    if not study.robot.is_point_mass:
        found.add("rotation")
    if not np.isnan(measured.length_m).all():
        found.add("length")
    if not np.isnan(measured.tension_N).all():
        found.add("tension")
    return frozenset(found)
