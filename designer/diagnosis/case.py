"""From a study with measurements to a case for the diagnosis."""

from __future__ import annotations

import numpy as np

from designer.cable import Cable
from designer.declared import declared_settings
from designer.diagnosis.diagnose import Case
from designer.effects.effect import NEEDS, Effect, as_built
from designer.machine import Machine
from designer.measured_data import Measured
from designer.study import Measurements, Study


def case_of(study: Study, measurements: Measurements, measured: Measured) -> Case:
    """Return what the diagnosis starts from; declared effects are part of the machine.

    Parameters
    ----------
    study, measurements, measured
        As read.
    """
    # The diagnosis asks no strength of the cable, and only laws of plugins ask its diameter.
    cable = Cable(
        diameter_m=measurements.diameter_m or float("nan"),
        linear_density_kg_per_m=measurements.linear_density_kg_per_m,
        axial_stiffness_N=measurements.axial_stiffness_N,
        allowable_tension_N=float("inf"),
    )
    bare = Machine(study.robot, cable, surroundings=study.surroundings)
    declared = declared_settings(study, bare)
    machine = as_built(bare, declared)
    known = {setting.effect.key for setting in declared}
    effects = [e for e in study.known_effects.of(machine) if e.key not in known]
    given = tuple(e for e in effects if _is_given(e, measurements))
    candidates, skipped = [], []
    for effect in effects:
        missing = sorted(effect.needs - _recorded(study, measured))
        if effect in given:
            continue
        if missing:
            skipped.append((effect.key, f"needs {NEEDS[missing[0]]}"))
        else:
            candidates.append(effect)
    return Case(
        study,
        measurements,
        machine,
        measured,
        tuple(candidates),
        given,
        tuple(skipped),
        tuple(
            s
            for s in declared
            if s.effect.on_readings is not None and s.effect.needs <= _recorded(study, measured)
        ),
    )


def _is_given(effect: Effect, measurements: Measurements) -> bool:
    by_id = effect.id in measurements.unknown
    return by_id or (effect.id == "anchor_offset" and "anchors" in measurements.unknown)


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
