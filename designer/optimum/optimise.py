"""From a plan to the optimum: searched, verified in full, compared with the study as it is."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from designer.analysis.analyse import Analysis, analyse
from designer.analysis.comparison import compare
from designer.analysis.result_json import result_part
from designer.documents import edits
from designer.documents.document import document_of
from designer.errors import DesignerError, InputError
from designer.grades.registry import Catalogue
from designer.optimum.measures import promising
from designer.optimum.plan import OptimisationPlan, Values, read_optimisation
from designer.optimum.result import Optimum, Profile
from designer.optimum.search import LINE, Searched, Stop, search
from designer.optimum.trial import Examiner, Trial
from designer.optimum.verifier import FEW_VERIFIED, MOST_VERIFIED, Verifier
from designer.progress import SILENT, Reporter
from designer.study import Study
from designer.sweep.point import why_not

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


def optimum_of(
    plan: OptimisationPlan, reporter: Reporter = SILENT, stop: Stop = lambda: False
) -> Optimum:
    """Search for the best design of a plan, and verify it.

    ``stop`` is asked before each design; once it says so, the best so far is the answer.
    """
    given_study = replace(plan.base, document=plan.document).study()
    catalogue = plan.base.catalogue()
    catalogue.require_grades_of(given_study)
    examiner = Examiner(plan, promising(given_study, catalogue.grades))
    with reporter.task("optimise", plan.evaluations) as advance:
        searched = search(examiner, advance, stop)
    analysis = analyse(given_study, catalogue, reporter=reporter)
    return _verified(examiner, catalogue, searched, analysis, reporter)


def _verified(
    examiner: Examiner,
    catalogue: Catalogue,
    searched: Searched,
    original: Analysis,
    reporter: Reporter,
) -> Optimum:
    """Return the best design that holds in full, or the one that looked best where none does."""
    plan = examiner.plan
    ranked = _ranked(plan, searched)
    if not ranked:
        raise DesignerError("the search was ended before it had tried a design")
    holding = [trial for trial in ranked if trial.holds]
    n_verified = FEW_VERIFIED if searched.ended in ("asked", "time") else MOST_VERIFIED
    with reporter.task("verification", n_verified) as advance:
        verifier = Verifier(
            plan, lambda trial: _in_full(plan, catalogue, trial), advance, n_verified
        )
        verifier.verify(holding, examiner.trial)
    best = verifier.best or ranked[0]
    return replace(
        _analysed(plan, catalogue, searched, original, best, reporter),
        rejected=tuple(trial for trial in verifier.failed if trial is not best),
        unverified=len(verifier.unverified(holding)),
        profiles=_profiles(examiner, best),
    )


def _ranked(plan: OptimisationPlan, searched: Searched) -> list[Trial]:
    """Return the designs within the bounds, each once, the best first."""
    sign = plan.objective.sign
    designs = {t.values: t for t in searched.trials if t.values and plan.is_within(t.values)}
    return sorted(
        designs.values(), key=lambda t: (t.violation, sign * t.value if t.holds else math.inf)
    )


def _in_full(plan: OptimisationPlan, catalogue: Catalogue, trial: Trial) -> float | None:
    """Return the objective of a design that holds over all samples and between them; else None."""
    study = _study_of(plan, trial)
    result = result_part(Analysis.begin(study, catalogue), ("positive", *plan.base.keep))
    holds = result["positive"] and not any(limit.is_broken_by(result) for limit in plan.limits)
    return plan.objective.value(result) if holds else None


def _analysed(
    plan: OptimisationPlan,
    catalogue: Catalogue,
    searched: Searched,
    original: Analysis,
    trial: Trial,
    reporter: Reporter,
) -> Optimum:
    analysis = analyse(_study_of(plan, trial), catalogue, reporter=reporter)
    before, after = original.to_dict(), analysis.to_dict()
    values = plan.objective.value(before), plan.objective.value(after)
    breaches = tuple(limit for limit in plan.limits if limit.is_broken_by(after))
    comparison = compare(before, after)
    text = optimised_text(plan, trial.values)
    return Optimum(
        plan, searched, trial, original, analysis, *values, breaches, (), comparison, text
    )


def _study_of(plan: OptimisationPlan, trial: Trial) -> Study:
    document = document_of(optimised_text(plan, trial.values).encode(), plan.document.name)
    try:
        return replace(plan.base, document=document).study()
    except InputError as error:  # its lines are those of no file of the user's
        why = f"no design that was tried makes a valid study: {why_not(error)}"
        raise DesignerError(f"{plan.name}: variables: {why}") from None


def optimised_text(plan: OptimisationPlan, values: Values) -> str:
    """Return the text of the study with a design's values, comments kept."""
    text = plan.text
    for keys, node in plan.changes(values):
        text = edits.with_value(text, keys, node.as_written())
    return text


def _profiles(examiner: Examiner, best: Trial) -> tuple[Profile, ...]:
    """Return what each variable does by itself about the optimum."""
    profiles = []
    for k, variable in enumerate(examiner.plan.variables[:_MOST_PROFILES]):
        values = {variable.at(float(x)) for x in np.linspace(0.0, 1.0, LINE)} | {best.values[k]}
        line = tuple(sorted(values))
        trials = [examiner.trial((*best.values[:k], x, *best.values[k + 1 :])) for x in line]
        profiles.append(Profile(line, tuple(t.value if t.holds else math.nan for t in trials)))
    return tuple(profiles)
