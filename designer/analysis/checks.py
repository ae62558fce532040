"""What was checked of the chosen rope: each check with its demand, its capacity, and where."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.model.robot import Poses
from designer.selection.cases import CaseFound
from designer.selection.qualities import Qualities
from designer.selection.result import Candidate
from designer.statics.inverse import solve_sagging
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.study import Selection

_SAMPLES = 500


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """One check.

    Parameters
    ----------
    id : str
        Its name in result files.
    title, formula, source : str
        What is checked, how, and by which clause, for the reader of a report.
    demand, capacity : float
        What is asked for, and what there is [unit].
    unit : str
        SI; empty for a ratio.
    utilisation : float
        Demand over capacity, or capacity over demand where less is better; NaN where neither is.
    holds : bool
        The verdict.
    load_case : str
        In which load case.
    cable : int or None
        The cable, from 1.
    place : array (n_coordinates,) or None
        Where [m, rad].
    """

    id: str
    title: str
    formula: str
    source: str
    demand: float
    capacity: float
    unit: str
    utilisation: float
    holds: bool
    load_case: str
    cable: int | None = None
    place: FloatArray | None = None


def checks_of(
    chosen: Candidate, selection: Selection, least_N: float, qualities: Qualities | None
) -> tuple[Check, ...]:
    """Return the checks that the study gives what they need for; ``least_N`` is tension_min."""
    found: list[Check] = [_breaking(chosen, selection)]
    found += _bending(chosen, selection)
    found.append(_slack(chosen, least_N))
    found += _clearance(qualities)
    found += _stability(chosen.governing)
    return tuple(found)


def _breaking(chosen: Candidate, selection: Selection) -> Check:
    most = chosen.governing
    case, met = most.case, most.verification
    factor = case.safety_factor or selection.safety_factor
    return Check(
        id="breaking_load",
        title="Breaking load",
        formula=f"T ≤ η F / S; η the smaller of end fitting and bending, S = {factor:g}",
        source="Noble Denton 0027/ND, 7.6 to 7.8; S as the study gives it",
        demand=met.max_tension_N,
        capacity=most.loaded.cable.allowable_tension_N,
        unit="N",
        utilisation=met.utilisation,
        holds=met.holds,
        load_case=case.name,
        cable=most.most_used(),
        place=met.worst_position_m,
    )


def _bending(chosen: Candidate, selection: Selection) -> Iterator[Check]:
    """Yield the bending ratio, where the study has a sheave and the maker gives a least ratio."""
    ratio = chosen.grade.sheave_ratio
    if selection.sheave_diameter_m is None or ratio is None or ratio.minimum is None:
        return
    there = selection.sheave_diameter_m / chosen.size.diameter_m
    yield Check(
        id="sheave_ratio",
        title="Sheave",
        formula="D / d ≥ the least ratio of the construction",
        source=f"table of {chosen.grade.id}",
        demand=ratio.minimum,
        capacity=there,
        unit="",
        utilisation=ratio.minimum / there,
        holds=there >= ratio.minimum,
        load_case="all",
    )


def _slack(chosen: Candidate, least_N: float) -> Check:
    """Return the least tension over some samples of every load case in which no cable is lost."""
    best: tuple[float, CaseFound, int, FloatArray] | None = None
    for one in chosen.cases:
        if one.loaded.lost_cable is not None:
            continue
        space = one.workspace.space
        own = one.verification.worst_position_m[None]
        places = np.concatenate([own, space.landmarks(), one.workspace.thinned(_SAMPLES)])
        statics = solve_sagging(
            one.loaded.robot, Poses.at(places), one.loaded.cable, seeks_better=False
        )
        tension = np.where(statics.is_solved[:, None], statics.least_tension_N, np.inf)
        row, cable = np.unravel_index(int(tension.argmin()), tension.shape)
        if best is None or tension[row, cable] < best[0]:
            best = float(tension[row, cable]), one, int(cable) + 1, places[row]
    least, case, number, place = best or (math.nan, chosen.governing, 0, None)
    holds = least > 0.0 and least >= least_N * (1.0 - 1e-9)
    used = least_N / least if least > 0.0 else math.inf
    return Check(
        id="least_tension",
        title="Slack",
        formula="least tension anywhere in a cable ≥ what the study asks for",
        source=f"robot.tension_min; {_SAMPLES} samples and the corners of the region in each case",
        demand=least_N,
        capacity=least,
        unit="N",
        utilisation=min(used, 1.0) if holds else used,
        holds=holds,
        load_case=case.case.name,
        cable=number or None,
        place=place,
    )


def _clearance(qualities: Qualities | None) -> Iterator[Check]:
    found = None if qualities is None else qualities.interference
    if found is None or found.worst is None:
        return
    worst = found.worst
    yield Check(
        id="clearance",
        title="Clearance",
        formula=f"distance of {' and '.join(worst.names)}, axis to axis ≥ what the study asks for",
        source="workspace.clearance",
        demand=found.clearance_m,
        capacity=worst.distance_m,
        unit="m",
        utilisation=found.clearance_m / worst.distance_m if worst.distance_m > 0.0 else math.inf,
        holds=not found.is_violated,
        load_case="static load of the study",
        place=worst.place,
    )


def _stability(most: CaseFound) -> Iterator[Check]:
    """Yield whether the platform stays where it is at the governing pose."""
    statics = most.statics()
    if statics is None or not statics.is_solved.all():
        return
    softness = float(largest_displacement_m_per_N(statics)[0])
    is_stable = math.isfinite(softness)
    yield Check(
        id="stability",
        title="Stability",
        formula="smallest stiffness of the platform, cables of fixed length > 0",
        source="energy has a minimum there",
        demand=0.0,
        capacity=1.0 / softness if is_stable else math.nan,
        unit="N/m",
        utilisation=math.nan,
        holds=is_stable,
        load_case=most.case.name,
        place=most.verification.worst_position_m,
    )
