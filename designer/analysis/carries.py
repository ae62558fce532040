"""What carries a result: sensitivities, reserves, the sizes beside it, where the rope ends."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from designer.analysis.first_failures import FirstFailure, first_failures
from designer.analysis.reserve import Reserve, payload_reserve, region_reserve
from designer.analysis.sensitivities import Sensitivities, sensitivities
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseFound
from designer.selection.result import SelectionResult
from designer.study import Study


@dataclass(frozen=True, slots=True, eq=False)
class SizeBeside:
    """The chosen size, or the next one of its grade.

    Parameters
    ----------
    candidate : Candidate
        The size.
    load_case : str
        The one that asks for most of it.
    max_tension_N, utilisation : float
        The largest of the samples and of the chosen size's worst pose, for the chosen one searched.
    safety_factor : float
        What is left of the breaking load over that tension.
    """

    candidate: Candidate
    load_case: str
    max_tension_N: float
    utilisation: float
    safety_factor: float


@dataclass(frozen=True, slots=True, eq=False)
class Carries:
    """What carries the result of a chosen rope.

    Parameters
    ----------
    governing : CaseFound
        The load case that governs.
    sensitivities : Sensitivities
        At its worst pose.
    payload, region : Reserve or None
        How much more there could be of each, in all load cases; None where no end was found.
    sizes : tuple of SizeBeside
        The next thinner size of the grade, the chosen one, the next thicker one, where there are.
    failures : tuple of FirstFailure
        The first pose that is not held, in each direction out of the region.
    """

    governing: CaseFound
    sensitivities: Sensitivities
    payload: Reserve | None
    region: Reserve | None
    sizes: tuple[SizeBeside, ...]
    failures: tuple[FirstFailure, ...]

    @property
    def nearest(self) -> FirstFailure | None:
        """The nearest of the failures."""
        return min(
            (one for one in self.failures if one.distance_m >= 0.0),
            key=lambda one: one.distance_m,
            default=None,
        )


def carries_of(study: Study, found: SelectionResult | None) -> Carries | None:
    """Return what carries the choice of a rope for all cables; None without one."""
    chosen = found.chosen if found is not None else None
    if found is None or chosen is None or study.selection is None or study.workspace is None:
        return None
    size = chosen.size
    return Carries(
        governing=chosen.governing,
        sensitivities=sensitivities(
            chosen.governing, chosen.efficiency, size.minimum_breaking_load_N
        ),
        payload=payload_reserve(chosen.cases),
        region=region_reserve(chosen.cases, study.workspace.region),
        sizes=tuple(_sizes(found, chosen, study.selection.safety_factor)),
        failures=first_failures(chosen.governing),
    )


def _sizes(found: SelectionResult, chosen: Candidate, safety_factor: float) -> Iterator[SizeBeside]:
    """Yield the size and those beside it, by diameter."""
    worst = chosen.governing
    for one in found.beside(chosen):
        most = one.governing
        used, tension_N, case = most.utilisation, most.verification.max_tension_N, most.case
        for same in (o for o in one.cases if o.case is worst.case):
            here = worst.loaded.on(*same.loaded.bare)
            there_N = worst.tension_N(here)
            if there_N / here.cable.allowable_tension_N > used:
                used, tension_N, case = there_N / here.cable.allowable_tension_N, there_N, same.case
        factor = case.safety_factor or safety_factor
        yield SizeBeside(one, case.name, tension_N, used, factor / used)
