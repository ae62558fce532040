"""A diagnosis that goes on where an effect of a plugin fails."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.errors import EffectError
from designer.model.measured_data import Measured
from designer.study import Measurements, Study


def diagnose_study(
    study: Study,
    measurements: Measurements,
    measured: Measured,
    progress: Callable[[str], None] = lambda _: None,
) -> Diagnosis:
    """Diagnose; an effect of a plugin that fails at work is left out, and all is done again.

    The study of the answer says in ``known_effects.problems`` what was left out.

    Raises
    ------
    EffectError
        If the config itself asks for the effect that fails.
    InputError
        See `designer.diagnosis.diagnose.diagnose`.
    """
    asked_for = {effect.id for effect in study.effects} | set(measurements.unknown)
    while True:
        try:
            return diagnose(case_of(study, measurements, measured), progress)
        except EffectError as failure:
            if failure.effect_id in asked_for:
                raise
            known = study.known_effects.without(failure.effect_id, f"{failure}: left out")
            study = replace(study, known_effects=known)
