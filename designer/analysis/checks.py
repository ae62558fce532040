"""What was checked of the chosen rope: each check with its demand, its capacity, and where."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from designer.analysis.governing import string_frequency_Hz
from designer.arrays import FloatArray
from designer.model.robot import Poses
from designer.selection.cases import CaseFound
from designer.selection.qualities import Qualities
from designer.selection.result import Candidate
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.study import Selection

_SAMPLES = 500
_WHERE = f"{_SAMPLES} samples and the corners of the region in each case"
_Solved = tuple[CaseFound, FloatArray, Statics]
"""A load case, places (n, n_coordinates) in it, and their equilibria (n,)."""


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
    solved = tuple(_solved(chosen))
    found.append(_slack(chosen, least_N, solved))
    found += _clearance(qualities)
    found += _stability(chosen.governing)
    found += _stiffness(qualities, selection.limits.stiffness_N_per_m)
    found += _excitation(solved, selection.limits.excitation_Hz)
    found += _drum(chosen, selection.limits.drum_capacity_m)
    return tuple(found)


def _solved(chosen: Candidate) -> Iterator[_Solved]:
    """Yield some samples of every load case in which no lengths are kept, solved."""
    for one in chosen.cases:
        if one.loaded.keeps_lengths:
            continue
        space = one.workspace.space
        own = one.verification.worst_position_m[None]
        places = np.concatenate([own, space.landmarks(), one.workspace.thinned(_SAMPLES)])
        loaded, poses = one.loaded, Poses.at(places)
        yield one, places, solve_sagging(loaded.robot, poses, loaded.cable, seeks_better=False)


def _breaking(chosen: Candidate, selection: Selection) -> Check:
    most = chosen.governing
    case, met = most.case, most.verification
    factor = selection.under(case).safety_factor
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


def _slack(chosen: Candidate, least_N: float, solved: Sequence[_Solved]) -> Check:
    """Return the least tension over the samples."""
    best: tuple[float, CaseFound, int, FloatArray] | None = None
    for one, places, statics in solved:
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
        source=f"robot.tension_min; {_WHERE}",
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


def _stiffness(qualities: Qualities | None, least_N_per_m: float | None) -> Iterator[Check]:
    """Yield the least stiffness of the platform, where the study asks for one."""
    found = None if qualities is None else qualities.stiffness
    if found is None or least_N_per_m is None:
        return
    there = 1.0 / found.softest_m_per_N
    yield Check(
        id="stiffness",
        title="Stiffness",
        formula="least force per displacement of the platform, cables of fixed length ≥ the limit",
        source="selection.limits.stiffness; searched over the workspace",
        demand=least_N_per_m,
        capacity=there,
        unit="N/m",
        utilisation=least_N_per_m / there if there > 0.0 else math.inf,
        holds=there >= least_N_per_m,
        load_case="static load of the study",
        place=found.softest_place,
    )


def _excitation(solved: Sequence[_Solved], band_Hz: tuple[float, float] | None) -> Iterator[Check]:
    """Yield the cable whose lowest frequency comes nearest the band, or lies deepest in it."""
    if band_Hz is None or not solved:
        return
    low, high = band_Hz
    best: tuple[float, float, CaseFound, int, FloatArray] | None = None
    for one, places, statics in solved:
        frequency = np.where(
            statics.is_solved[:, None], string_frequency_Hz(one.loaded, statics), np.inf
        )
        depth = np.minimum(high / frequency, frequency / low)  # above 1 within the band
        row, cable = np.unravel_index(int(depth.argmax()), depth.shape)
        if best is None or depth[row, cable] > best[0]:
            nearest = float(frequency[row, cable])
            best = float(depth[row, cable]), nearest, one, int(cable) + 1, places[row]
    assert best is not None
    depth_there, there, case, number, place = best
    is_above = there / low >= high / there
    yield Check(
        id="excitation",
        title="Excitation",
        formula=f"√(T/m)/2l of each cable outside {low:g} to {high:g} Hz; no overtones",
        source=f"selection.limits.excitation; {_WHERE}",
        demand=high if is_above else there,
        capacity=there if is_above else low,
        unit="Hz",
        utilisation=depth_there,
        holds=depth_there < 1.0,
        load_case=case.case.name,
        cable=number,
        place=place,
    )


def _drum(chosen: Candidate, capacity_m: float | None) -> Iterator[Check]:
    """Yield the largest stroke of a cable, where the study says what a drum takes up."""
    if capacity_m is None:
        return
    met = chosen.verification
    stroke = met.longest_m - met.shortest_m
    cable = int(np.nan_to_num(stroke, nan=-1.0).argmax())
    yield Check(
        id="drum_capacity",
        title="Drum",
        formula="stroke: largest − smallest unstrained length ≤ what the drum takes up",
        source="selection.limits.drum_capacity, beside its dead turns",
        demand=float(stroke[cable]),
        capacity=capacity_m,
        unit="m",
        utilisation=float(stroke[cable]) / capacity_m,
        holds=bool(stroke[cable] <= capacity_m),
        load_case="all",
        cable=cable + 1,
    )
