"""What carries a result: sensitivities, reserves, the sizes beside it, where the rope ends."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from designer.analysis.first_failures import FirstFailure, first_failures
from designer.analysis.reserve import Reserve, payload_reserve, region_reserve
from designer.analysis.sensitivities import Sensitivities, Sensitivity, sensitivities
from designer.documents.plain import Json
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult
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

    candidate: Candidate = field(
        metadata={"json": lambda rope: rope.ids | {"total_mass_kg": rope.total_mass_kg}}
    )
    load_case: str
    max_tension_N: float
    utilisation: float
    safety_factor: float


@dataclass(frozen=True, slots=True, eq=False)
class Carries:
    """What carries the result of a chosen rope.

    Parameters
    ----------
    governing : CaseResult
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

    governing: CaseResult
    sensitivities: Sensitivities
    payload: Reserve | None
    region: Reserve | None
    sizes: tuple[SizeBeside, ...]
    failures: tuple[FirstFailure, ...]

    @property
    def nearest(self) -> FirstFailure | None:
        """The nearest of the failures."""
        return min(
            (failure for failure in self.failures if failure.distance_m >= 0.0),
            key=lambda failure: failure.distance_m,
            default=None,
        )


def carries_of(
    study: Study, selection: SelectionResult | None, rope: Candidate | None
) -> Carries | None:
    """Return what carries the choice of a rope for all cables; None without one."""
    if selection is None or rope is None or study.selection is None or study.workspace is None:
        return None
    breaking_load_N = rope.size.minimum_breaking_load_N
    return Carries(
        governing=rope.governing,
        sensitivities=sensitivities(rope.governing, rope.efficiency, breaking_load_N),
        payload=payload_reserve(rope.cases),
        region=region_reserve(rope.cases, study.workspace.region),
        sizes=tuple(_sizes(selection, rope, study.selection.safety_factor)),
        failures=first_failures(rope.governing),
    )


def _sizes(
    selection: SelectionResult, rope: Candidate, safety_factor: float
) -> Iterator[SizeBeside]:
    """Yield the size and those beside it, by diameter."""
    worst = rope.governing
    for candidate in selection.beside(rope):
        governing = candidate.governing
        case, tension_N = governing.case, governing.verification.max_tension_N
        utilisation = governing.utilisation
        for case_found in (c for c in candidate.cases if c.case is worst.case):
            loaded = worst.loaded.on(*case_found.loaded.bare)
            at_worst_N = worst.tension_N(loaded)
            if at_worst_N / loaded.cable.allowable_tension_N > utilisation:
                utilisation = at_worst_N / loaded.cable.allowable_tension_N
                tension_N, case = at_worst_N, case_found.case
        factor = case.safety_factor or safety_factor
        yield SizeBeside(candidate, case.name, tension_N, utilisation, factor / utilisation)


def carries_dict(carries: Carries | None, groups: Sequence[Sensitivities]) -> Json:
    """Return sensitivities, reserves, sizes and first failures; empty where none is chosen.

    Of ``groups`` there are sensitivities alone, each with the name of its group.
    """
    if carries is None:
        rows = [*_sensitivities(groups)]
        return {"sensitivities": rows, "reserve": None, "sizes_beside": [], "first_failures": []}
    return {
        "sensitivities": [*_sensitivities([carries.sensitivities])],
        "reserve": {
            "payload_factor": math.nan if carries.payload is None else carries.payload.value,
            "region_margin_m": math.nan if carries.region is None else carries.region.value,
            "payload": carries.payload,
            "region": carries.region,
        },
        "sizes_beside": carries.sizes,
        "first_failures": carries.failures,
    }


def _sensitivities(of_ropes: Iterable[Sensitivities]) -> Iterator[Json]:
    for of_rope in of_ropes:
        rows: list[Json] = [asdict(sensitivity) for sensitivity in of_rope.each]
        for (cable, axis), slope in np.ndenumerate(of_rope.exit_points_per_m):
            name = f"exit_point_{cable + 1}_{'xyz'[axis]}"
            rows.append(asdict(Sensitivity(name, math.nan, "m", float(slope), math.nan)))
        group = of_rope.group and of_rope.group.name
        yield from (row | {"method": of_rope.method, "group": group} for row in rows)
