"""Search, and keep only the effects that hold.

An effect with values that nobody would believe is none. Structure that is left says that the model
is not the whole truth. Effects of the list are then bent to fit what is not in the list: as
constants they suit its average, or several together its shape. Those are withdrawn, weakest first,
and the rest is fitted anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.drift import drifting
from designer.diagnosis.dropped import find_common
from designer.diagnosis.events import find_events
from designer.diagnosis.fit import Fit
from designer.diagnosis.pace import Pace
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Reason, Withdrawn
from designer.diagnosis.search import Search, Searcher
from designer.diagnosis.structure import Structure, covariates_of, find_structure
from designer.diagnosis.swapped import find_swapped
from designer.effects.effect import Effect, Setting

_SMALL = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """A search whose findings hold.

    Parameters
    ----------
    problem, searcher
        What was searched; the searcher knows no effect that was withdrawn.
    search : Search
        All its rounds, with the effects that hold and their joint fit.
    withdrawn : tuple of Withdrawn
        What was found and does not hold.
    structure : Structure
        Test of what is left.
    """

    problem: Problem
    searcher: Searcher
    search: Search
    withdrawn: tuple[Withdrawn, ...]
    structure: Structure


def search_and_hold(
    problem: Problem,
    candidates: Sequence[Effect],
    given: Sequence[Effect],
    rows: BoolArray,
    progress: Pace,
) -> Outcome:
    """Search; withdraw what does not hold, and fit the rest anew.

    Where sensors are on each other's plugs there is nothing to search for.

    Parameters
    ----------
    problem, candidates, given, rows
        As for `Searcher`.
    progress : Pace
        Told in a few words what is being done; ends the search where its time is spent.
    """
    searcher = Searcher(problem, candidates, given, rows, progress)
    unsearched = searcher.fit([], thorough=True)
    if find_swapped(*_residual_and_predicted(problem, unsearched.settings, rows)):
        structure = structure_left(problem, unsearched.settings, rows)
        return Outcome(problem, searcher, Search((), unsearched, ()), (), structure)
    search = searcher.run()
    found, model = list(search.found), search.fit
    structure = structure_left(problem, model.settings, rows)
    withdrawn = _not_to_be_believed(search)
    while found:
        loose: Withdrawn | None = implausible(model, found)
        if loose is None and (structure.events or structure.may_bend):
            loose = _small(searcher, model, found) or _drifting(
                problem, model, found, structure, rows
            )
        if loose is None:
            break
        progress(f"{loose.effect} withdrawn")
        withdrawn.append(loose)
        found = without(found, [loose.effect])
        model = searcher.fit(found, model, thorough=True)
        structure = structure_left(problem, model.settings, rows)
    rest = without(candidates, [one.effect for one in withdrawn])
    return Outcome(
        problem,
        Searcher(problem, rest, given, rows, progress),
        Search(search.steps, model, tuple(found)),
        tuple(withdrawn),
        structure,
    )


def structure_left(problem: Problem, settings: Sequence[Setting], rows: BoolArray) -> Structure:
    """Test what a model leaves of the readings of some rows (n_rows,)."""
    covariates = {
        name: column[rows]
        for name, column in covariates_of(problem.measured, problem.surroundings(settings)).items()
    }
    residual, predicted = _residual_and_predicted(problem, settings, rows)
    numbers = problem.measured.row_numbers[rows]
    structure = find_structure(residual, covariates, settled=problem.measured.settled)
    swapped = find_swapped(residual, predicted)
    common = find_common(residual, covariates, numbers)
    events = find_events(residual, predicted, structure, numbers)
    named = (*([swapped] if swapped else []), *events, *([common] if common else []))
    return replace(structure, events=named)


def _residual_and_predicted(
    problem: Problem, settings: Sequence[Setting], rows: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return residual and prediction of some rows (…, 2 n_cables), both in units of noise."""
    predicted = problem.predicted(settings)
    in_noise = np.hstack([predicted.length_m, predicted.tension_N]) / problem.sigma
    return problem.residual(settings)[rows], in_noise[rows]


def _small(searcher: Searcher, model: Fit, found: Sequence[Effect]) -> Withdrawn | None:
    """Return the effect that gains least, if that is little against what stays unexplained."""
    left = model.loss - model.n_data
    gains = {
        effect.key: searcher.fit(without(found, [effect.key]), model).loss - model.loss
        for effect in found
    }
    least = min(gains, key=gains.__getitem__)
    return Withdrawn(least, reason=Reason.SMALL) if gains[least] < _SMALL * left else None


def _not_to_be_believed(search: Search) -> list[Withdrawn]:
    """Return the best of what would still earn its place, but with values that are not."""
    for trial in search.steps[-1].trials if search.steps else ():
        wild = implausible(trial.fit, [trial.effect]) if trial.earns_its_place else None
        if wild is not None:
            return [wild]
    return []


def implausible(model: Fit, found: Sequence[Effect]) -> Withdrawn | None:
    """Return the first effect with a value that an engineer would not believe."""
    keys = {effect.key for effect in found}
    for setting in model.settings:
        values = [
            f"{p.name} = {setting.values[p.name]:.4g} {p.unit}".rstrip()
            + f" ({p.plausible[0]:.4g} to {p.plausible[1]:.4g} would be)"
            for p in setting.effect.parameters
            if not p.plausible[0] <= setting.values[p.name] <= p.plausible[1]
        ]
        if values and setting.effect.key in keys:
            return Withdrawn(setting.effect.key, reason=Reason.IMPLAUSIBLE, detail=values[0])
    return None


def _drifting(
    problem: Problem, model: Fit, found: Sequence[Effect], structure: Structure, rows: BoolArray
) -> Withdrawn | None:
    covariates = covariates_of(problem.measured, problem.surroundings(model.settings))
    return drifting(problem, model, found, structure, covariates, rows)


def without(effects: Sequence[Effect], keys: Sequence[str]) -> list[Effect]:
    """Return the effects whose keys are not among those given."""
    return [effect for effect in effects if effect.key not in keys]
