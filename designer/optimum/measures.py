"""What a design is judged by: a value of its result, and a quick way to it for the search.

The quick way solves few samples, half of them on the border of the region, and looks closer only
about the worst of them; the verified value is that of the whole result. A measure without a quick
way takes it from a whole result over few samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.load_case import STATIC, Loaded
from designer.model.region import PointList
from designer.model.robot import Poses
from designer.model.space import Space
from designer.model.verdict import Requirement
from designer.model.workspace import Workspace
from designer.progress import SILENT
from designer.selection.candidate import Candidate, candidates_of, offered, undominated
from designer.selection.cases import governing
from designer.selection.compare import Screen
from designer.selection.criteria import CaseLoads, criteria_of, evaluate
from designer.selection.select import at_samples
from designer.selection.verify import verify_sizes
from designer.sizing.newton import size_poses
from designer.study import Objective, Selection, Study, as_built_by
from designer.sweeps.plan import value_at
from designer.units import FORCE, LENGTH, MASS, NUMBER, Dimension
from designer.workspace.demand import demand_of, diameter_demand, rope_demand
from designer.workspace.refine import Demand, Worst
from designer.workspace.section import section_of_workspace

_CLOSE = 0.9
"""Utilisation at the samples from which on it is looked closer."""
_HARDLY = 1e-3
_REACHES, _CLOUD = 0.1 * 0.5 ** np.arange(6.0), 24
VOLUME = Dimension("a volume", "m^3", "200 m^3")


class NotHeldError(Exception):
    """A design has no value: why, and how far it is from one, so that a search is led to it.

    ``violation`` is at most 1 where all poses are held but something is too weak or another
    requirement does not hold, and 1 plus the share of the poses that are not held otherwise.
    """

    def __init__(self, violation: float, reason: str) -> None:
        super().__init__(reason)
        self.violation, self.reason = violation, reason


class Quick:
    """What a design comes to at few samples; computed where it is asked for."""

    def __init__(self, study: Study, grades: tuple[Grade, ...], samples: int) -> None:
        self._study, self._grades, self._samples = study, grades, samples

    @cached_property
    def workspace(self) -> Workspace:
        """The workspace with few samples, half of them on the border, where most extremes lie."""
        workspace = self.evenly
        if workspace.region.is_discrete:
            return workspace
        border, rng = workspace.region.border(), np.random.default_rng(workspace.seed)
        quarter = 1 + workspace.samples // 4
        counts = (1 + quarter // max(len(parts), 1) for parts in (border.edges_m, border.faces_m))
        points = [border.landmarks_m(), border.samples_m(rng, *counts)]
        points.append(workspace.region.inside_m(rng, 2 * quarter))
        return replace(workspace, region=PointList(frozen_array(np.concatenate(points))))

    @cached_property
    def evenly(self) -> Workspace:
        """The workspace with few samples, evenly spread."""
        workspace = self._study.workspace
        assert workspace is not None
        return replace(workspace, samples=min(self._samples, workspace.samples))

    @property
    def selection(self) -> Selection:
        """How the rope is chosen."""
        assert self._study.selection is not None
        return self._study.selection

    @cached_property
    def _built(self) -> AsBuilt:
        built = as_built_by(self._study)
        section_m = section_of_workspace(built, self.workspace, self._study.material)
        return replace(built, section_m=section_m)

    @cached_property
    def worst(self) -> Worst:
        """Return the place that needs the thickest cable of the family, and that diameter [m].

        Raises
        ------
        NotHeldError
            If no cable of the family holds some place.
        """
        built, workspace = self._built, self.workspace
        places = np.concatenate([*workspace.places()])
        material = built.material(self._study.material)
        sizing = size_poses(built.robot, Poses.at(places), material)
        demand = demand_of(sizing.diameter_m, sizing.statics, workspace.hangs_below)
        not_held = float(np.isposinf(demand).mean())
        if not_held:
            raise NotHeldError(1.0 + not_held, "no cable holds in all of the workspace")
        if np.isneginf(demand).all():
            raise NotHeldError(2.0, "every pose is left out")
        at, hangs_below = int(demand.argmax()), workspace.hangs_below
        closer = partial(diameter_demand, built.robot, material, hangs_below)
        return climbed(self.evenly.space, closer, places[at], float(demand[at]))

    @cached_property
    def _candidates(self) -> list[Candidate]:
        """Return all ropes with what they meet, each as stiff as at the largest tension of it."""
        return at_samples(
            self.workspace, self.selection, self._grades, self._built, self._study.load_cases
        )

    @cached_property
    def rope(self) -> Candidate:
        """Return the rope that would be chosen.

        Raises
        ------
        NotHeldError
            If none holds.
        """
        holding = [c for c in self._candidates if c.verification.holds]
        if not holding:
            raise NotHeldError(*_why_no_rope(self._candidates))
        decides: Objective = next(
            (o for o in self.selection.objectives if o != "stiffness"), "mass"
        )
        ranked = sorted(holding, key=lambda candidate: candidate.figures.burden(decides))
        criteria = criteria_of(self._built.robot, self.workspace, self.selection)
        screen = Screen(criteria, self.selection, SILENT)
        for candidate in ranked:
            if candidate.rejected_by is not None:
                continue
            is_far = candidate.verification.utilisation < _CLOSE
            allowable_N = governing(candidate.cases).loaded.cable.allowable_tension_N
            if is_far or self._tension_N(candidate) <= allowable_N:
                screen.rejects_any(candidate, (), ranked)
                if candidate.rejected_by is None:
                    return candidate
        raise _nearest_to_holding(screen, ranked)

    def _tension_N(self, candidate: Candidate) -> float:
        """Return what a rope meets in the case that governs, about its worst sample as well."""
        case = governing(candidate.cases)
        loaded = case.loaded
        of_rope = loaded.robot, loaded.cable, self.evenly.hangs_below
        if loaded.lost_cable is not None:
            return case.verification.max_tension_N
        worst = climbed(
            self.evenly.of_case(case.case).space,
            lambda places: rope_demand(*of_rope, places)[:, 0],
            case.verification.worst_place,
            case.verification.max_tension_N,
        )
        return worst.demand

    def require(self) -> None:
        """Require all that the study asks for: of the rope, or of the cable of the family.

        Raises
        ------
        NotHeldError
            If something of it does not hold.
        """
        if self._study.selection is not None:
            _ = self.rope
            return
        built, material = self._built, self._built.material(self._study.material)
        bare = built.robot, material.cable(self.worst.demand)
        loads = CaseLoads(self.workspace, (Loaded(STATIC, bare, *bare),))
        criteria = criteria_of(built.robot, self.workspace, None)
        unmet = [
            evaluated.requirement
            for evaluated in evaluate([loads], criteria)
            if not evaluated.requirement.holds
        ]
        if unmet:
            raise _violated(unmet)

    @property
    def diameter_m(self) -> float:
        """The thickest cable of the family that a place needs [m]."""
        return self.worst.demand

    @property
    def max_tension_N(self) -> float:
        """Largest tension of the rope; of the cable of the family where none is chosen [N]."""
        if self._study.selection is not None:
            return self._tension_N(self.rope)
        built = self._built
        pose, material = Poses.at(self.worst.place), built.material(self._study.material)
        return float(size_poses(built.robot, pose, material).statics.largest_tension_N)

    @property
    def usable_volume_m3(self) -> float:
        """What the rope serves that serves most [m³]."""
        cables = [candidate.cable for candidate in self._candidates]
        verifications = verify_sizes(self._built.robot, self.evenly, cables, gives_up=False)
        volume = self.evenly.region.volume_m3 or 0.0
        return volume * max(verification.served for verification in verifications)


def climbed(space: Space, demand: Demand, place: FloatArray, value: float) -> Worst:
    """Return the largest demand about a place, by clouds of trials that shrink.

    A search for the best design finds every gap between samples that lets a thinner rope pass.
    """
    rng, size = np.random.default_rng(0), np.ptp(space.bounds, axis=0)
    for reach in _REACHES if not space.is_discrete else ():
        cloud = space.nearest(place + reach * size * rng.uniform(-1.0, 1.0, (_CLOUD, len(size))))
        demands = demand(cloud)
        at = int(np.argmax(demands))
        if demands[at] > value:
            place, value = cloud[at], float(demands[at])
    return Worst(place, value)


def _why_no_rope(candidates: list[Candidate]) -> tuple[float, str]:
    """Return how far the ropes are from holding, and why none does."""
    if not candidates:
        return 2.0, "no rope can be tried"
    least = min(candidate.verification.utilisation for candidate in candidates)
    if np.isfinite(least):
        return 1.0 - 1.0 / least, "no rope is strong enough"
    shares = [
        candidate.sampled.not_held / max(candidate.sampled.samples, 1) for candidate in candidates
    ]
    return 1.0 + min(*shares, 1.0), "no rope holds in all of the workspace"


def shortfall(demand: float, capacity: float, utilisation: float) -> float:
    """Return how far a requirement is from holding: above 0, at most 1 (NaN for no figure)."""
    gap = abs(demand - capacity)
    far = 1.0 - 1.0 / utilisation if utilisation >= 1.0 else gap / (1.0 + gap)
    return max(far, _HARDLY) if math.isfinite(far) else 1.0


def _shortfall(requirement: Requirement) -> float:
    return shortfall(requirement.demand, requirement.capacity, requirement.utilisation)


def _violated(unmet: Iterable[Requirement]) -> NotHeldError:
    """Return the error of requirements that do not hold: the one that is furthest from it."""
    worst = max(unmet, key=_shortfall)
    reason = f"{worst.id} in {worst.load_case}: {worst.state.value}"
    return NotHeldError(_shortfall(worst), reason)


def _nearest_to_holding(screen: Screen, strong: Sequence[Candidate]) -> NotHeldError:
    """Return what the rope fails that is nearest to meeting all requirements."""
    rejected = [
        (candidate, candidate.rejected_by)
        for candidate in strong
        if candidate.rejected_by is not None
    ]
    if not rejected:
        return NotHeldError(_HARDLY, "no rope is strong enough")
    nearest, by = min(rejected, key=lambda rejection: _shortfall(rejection[1]))
    return _violated(
        [by, *(requirement for requirement in screen.evaluated(nearest) if not requirement.holds)]
    )


@dataclass(frozen=True, slots=True)
class Measure:
    """One value of a result."""

    name: str  #: as a file calls it
    title: str  #: as a reader does
    path: str  #: where ``result.json`` has it
    dimension: Dimension  #: its kind of quantity
    sign: int = 1  #: 1 where less is better, -1 where more is
    quick: Callable[[Quick], float] | None = None  #: the quick way
    #: from a result, where that takes more than the path
    of_result: Callable[[Mapping[str, Any]], float | None] | None = None

    def value(self, result: Mapping[str, Any]) -> float | None:
        """Return what a result has; None where it has none.

        Raises
        ------
        KeyError
            If results never have it, see `designer.sweeps.plan.value_at`.
        """
        value: Any = (self.of_result or (lambda values: value_at(dict(values), self.path)))(result)
        return float(value) if isinstance(value, int | float) else None


def _usable(result: Mapping[str, Any]) -> float | None:
    sizes = (result.get("selection") or {}).get("usable", [])
    return max((size["volume_m3"] for size in sizes if size["volume_m3"] is not None), default=None)


MEASURES: Mapping[str, Measure] = {
    measure.name: measure
    for measure in (
        Measure(
            "rope_mass", "mass of all ropes", "answer.total_mass_kg", MASS,
            quick=lambda quick: quick.rope.figures.mass_kg,
        ),
        Measure(
            "rope_cost", "price of all ropes", "selection.chosen.cost", NUMBER,
            quick=lambda quick: quick.rope.figures.cost,
        ),
        Measure(
            "max_tension", "largest tension", "selection.chosen.max_tension_N", FORCE,
            quick=lambda quick: quick.max_tension_N,
        ),
        Measure(
            "diameter", "needed diameter", "workspace.sagging.diameter_m", LENGTH,
            quick=lambda quick: quick.diameter_m,
        ),
        Measure(
            "usable_volume", "usable volume", "selection.usable", VOLUME, -1,
            quick=lambda quick: quick.usable_volume_m3, of_result=_usable,
        ),
    )
}  # fmt: skip
"""By the name that a file may use."""


def measure_at(path: str, sign: int = 1) -> Measure:
    """Return the measure at a path of ``result.json``."""
    return Measure(path, path, path, NUMBER, sign)


def for_study(measure: Measure, study: Study) -> Measure:
    """Return the measure as this study has it.

    There is no quick way to what groups of cables, or load cases of a family, are asked for.
    """
    if measure.name == "max_tension" and study.selection is None:
        measure = replace(measure, path="workspace.sagging.max_tension_N")
    selection = study.selection
    takes_whole = bool(study.load_cases) if selection is None else bool(selection.groups)
    return replace(measure, quick=None) if takes_whole else measure


def promising(study: Study, grades: tuple[Grade, ...]) -> tuple[Grade, ...]:
    """Return the grades with those sizes that no other beats in mass, strength and stiffness.

    Of a whole catalogue those are few; the verified result tries them all. Of what tension sets the
    stiffness is not known before a design is solved, so any tension counts.
    """
    if study.selection is None:
        return ()
    allowed = offered(grades, study.selection)
    candidates = candidates_of(study.selection, allowed, as_built_by(study))
    by_price = "cost" in study.selection.objectives
    unbeaten = undominated(candidates, by_price=by_price, at_any_tension=True)
    sizes = {id(candidate.size) for candidate in unbeaten}
    trimmed = [
        replace(grade, sizes=tuple(size for size in grade.sizes if id(size) in sizes))
        for grade in allowed
        if any(id(size) in sizes for size in grade.sizes)
    ]
    return tuple(trimmed)
