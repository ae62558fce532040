"""Search, and where structure is left, keep only the effects that hold in spite of it.

Structure that is left says that the model is not the whole truth. Effects of the list are then
bent to fit what is not in the list: as constants they suit its average, or several together its
shape. Those are withdrawn, weakest first, and the rest is fitted anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from designer.arrays import BoolArray
from designer.diagnosis.drift import drifting
from designer.diagnosis.errors_of import without_outliers
from designer.diagnosis.fit import Fit
from designer.diagnosis.pace import Pace
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Reason, Withdrawn
from designer.diagnosis.search import Search, Searcher
from designer.diagnosis.structure import Structure, covariates_of, find_structure
from designer.effects.effect import Effect

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
    """Search; while structure is left, withdraw what does not hold and fit the rest anew.

    Parameters
    ----------
    problem, candidates, given, rows
        As for `Searcher`.
    progress : Pace
        Told in a few words what is being done; ends the search where its time is spent.
    """
    searcher = Searcher(problem, candidates, given, rows, progress)
    search = searcher.run()
    found, model = list(search.found), search.fit
    structure = structure_left(problem, model)
    withdrawn: list[Withdrawn] = []
    while found and structure.is_present:
        loose = (
            _small(searcher, model, found)
            or _implausible(model, found)
            or _drifting(problem, model, found, structure, rows)
        )
        if loose is None:
            break
        progress(f"{loose.effect} withdrawn")
        withdrawn.append(loose)
        found = _without(found, [loose.effect])
        model = searcher.fit(found, model, thorough=True)
        structure = structure_left(problem, model)
    rest = _without(candidates, [one.effect for one in withdrawn])
    return Outcome(
        problem,
        Searcher(problem, rest, given, rows, progress),
        Search(search.steps, model, tuple(found)),
        tuple(withdrawn),
        structure,
    )


def structure_left(problem: Problem, model: Fit) -> Structure:
    """Test what a model leaves of the readings, outliers blanked."""
    return find_structure(
        without_outliers(problem.residual(model.settings)),
        covariates_of(problem.measured, problem.surroundings(model.settings)),
        settled=problem.measured.settled,
    )


def _small(searcher: Searcher, model: Fit, found: Sequence[Effect]) -> Withdrawn | None:
    """Return the effect that gains least, if that is little against what stays unexplained."""
    left = model.loss - model.n_data
    gains = {
        effect.key: searcher.fit(_without(found, [effect.key]), model).loss - model.loss
        for effect in found
    }
    least = min(gains, key=gains.__getitem__)
    return Withdrawn(least, reason=Reason.SMALL) if gains[least] < _SMALL * left else None


def _implausible(model: Fit, found: Sequence[Effect]) -> Withdrawn | None:
    """Return the first effect with a value that an engineer would not believe."""
    keys = {effect.key for effect in found}
    for setting in model.settings:
        if setting.effect.key in keys and not all(
            p.plausible[0] <= setting.values[p.name] <= p.plausible[1]
            for p in setting.effect.parameters
        ):
            return Withdrawn(setting.effect.key, reason=Reason.IMPLAUSIBLE)
    return None


def _drifting(
    problem: Problem, model: Fit, found: Sequence[Effect], structure: Structure, rows: BoolArray
) -> Withdrawn | None:
    covariates = covariates_of(problem.measured, problem.surroundings(model.settings))
    return drifting(problem, model, found, structure, covariates, rows)


def _without(effects: Sequence[Effect], keys: Sequence[str]) -> list[Effect]:
    return [effect for effect in effects if effect.key not in keys]
