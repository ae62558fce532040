"""From a plan to the optimum: searched, verified in full, compared with the study as it is."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from designer.analysis.analyse import Analysis, analyse
from designer.analysis.comparison import compare
from designer.documents import edits
from designer.documents.document import document_of
from designer.errors import DesignerError, InputError
from designer.grades.registry import Catalogue
from designer.optimum.measures import promising
from designer.optimum.plan import Plan, Values
from designer.optimum.read import read_optimisation
from designer.optimum.result import Optimum, Profile, is_near
from designer.optimum.search import LINE, Searched, Stop, search
from designer.optimum.trial import Examiner, Trial
from designer.progress import SILENT, Reporter
from designer.sweep.point import why_not

_MOST_VERIFIED = 3
_APART = 0.05
"""Of each range: designs that are no further apart are verified once."""
_MOST_PROFILES = 8


def optimise(
    path: Path | str, *, with_plugins: bool = True, reporter: Reporter = SILENT
) -> Optimum:
    """Find the values of a study's fields that make a result of it as good as can be found.

    Parameters
    ----------
    path : Path or str
        A YAML file with ``study``, ``variables`` and ``objective``, as for `designer optimise`.
    with_plugins : bool
        False leaves out what plugins bring, for the same answer on every machine.
    reporter : Reporter
        Shows progress.

    Returns
    -------
    Optimum
        The design with the study as it is, both analysed in full. Found, not proved the best.

    Raises
    ------
    InputError
        If anything is wrong with the file, or with its study.
    """
    return optimum_of(read_optimisation(Path(path), with_plugins), reporter)


def optimum_of(plan: Plan, reporter: Reporter = SILENT, stop: Stop = lambda: False) -> Optimum:
    """Search for the best design of a plan, and verify it.

    ``stop`` is asked before each design; once it says so, the best so far is the answer.
    """
    given_study = replace(plan.base, document=plan.document).study()
    catalogue = plan.base.catalogue()
    catalogue.require_grades_of(given_study)
    examiner = Examiner(plan, promising(given_study, catalogue.grades))
    with reporter.task("optimise", plan.budget.evaluations) as advance:
        searched = search(examiner, advance, stop)
    given = analyse(given_study, catalogue, reporter=reporter)
    return _verified(examiner, catalogue, searched, given, reporter)


def _verified(
    examiner: Examiner,
    catalogue: Catalogue,
    searched: Searched,
    given: Analysis,
    reporter: Reporter,
) -> Optimum:
    """Analyse the best designs in full until none that is left looks better than one that was.

    The search between the samples can only make a design worse, so a design that is no better in
    the search than a verified one is no better in full, but for what few samples cannot tell.
    """
    plan, sign = examiner.plan, examiner.plan.objective.sign
    best: Optimum | None = None
    rejected: list[Trial] = []
    for trial in _candidates(plan, searched):
        verified = best.after if best is not None and best.holds else None
        if verified is not None and sign * trial.value >= sign * verified:
            break
        found = _analysed(plan, catalogue, searched, given, trial, reporter)
        if best is None or _beats(found, best, sign):
            rejected += [best.best] if best is not None else []
            best = found
        else:
            rejected.append(trial)
    assert best is not None
    return replace(best, rejected=tuple(rejected), profiles=_profiles(examiner, best.best))


def _beats(a: Optimum, b: Optimum, sign: int) -> bool:
    if a.holds != b.holds:
        return a.holds
    return a.holds and sign * (a.after or 0.0) < sign * (b.after or 0.0)


def _candidates(plan: Plan, searched: Searched) -> list[Trial]:
    """Return the best designs that are well apart, the best first."""
    sign = plan.objective.sign
    tried = [one for one in searched.trials if one.values and plan.is_within(one.values)]
    if not tried:
        raise DesignerError("the search was ended before it had tried a design")
    ranked = sorted(tried, key=lambda t: (t.violation, sign * t.value if t.holds else math.inf))
    kept: list[Trial] = []
    for one in ranked:
        if len(kept) == _MOST_VERIFIED or (kept and not one.holds):
            break
        if not any(is_near(plan, one.values, other.values, _APART) for other in kept):
            kept.append(one)
    return kept


def _analysed(
    plan: Plan,
    catalogue: Catalogue,
    searched: Searched,
    given: Analysis,
    trial: Trial,
    reporter: Reporter,
) -> Optimum:
    text = optimised_text(plan, trial.values)
    document = document_of(text.encode(), plan.document.name)
    try:
        study = replace(plan.base, document=document).study()
    except InputError as error:  # its lines are those of no file of the user's
        why = f"no design that was tried makes a valid study: {why_not(error)}"
        raise DesignerError(f"{plan.name}: variables: {why}") from None
    analysis = analyse(study, catalogue, reporter=reporter)
    before, after = given.to_dict(), analysis.to_dict()
    values = plan.objective.value(before), plan.objective.value(after)
    breaches = tuple(limit for limit in plan.limits if limit.is_broken_by(after))
    comparison = compare(before, after)
    return Optimum(plan, searched, trial, given, analysis, *values, breaches, (), comparison, text)


def optimised_text(plan: Plan, values: Values) -> str:
    """Return the text of the study with a design's values, comments kept."""
    text = plan.text
    for keys, node in plan.changes(values):
        text = edits.with_value(text, keys, node.as_written())
    return text


def _profiles(examiner: Examiner, best: Trial) -> tuple[Profile, ...]:
    """Return what each variable does by itself about the optimum."""
    found = []
    for k, one in enumerate(examiner.plan.variables[:_MOST_PROFILES]):
        values = {one.at(float(x)) for x in np.linspace(0.0, 1.0, LINE)} | {best.values[k]}
        line = tuple(sorted(values))
        tried = [examiner.trial((*best.values[:k], x, *best.values[k + 1 :])) for x in line]
        found.append(Profile(line, tuple(t.value if t.holds else math.nan for t in tried)))
    return tuple(found)
