"""Optimisations and sweeps of the study in the window, from the plans that the commands take."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from designer.errors import Fault, InputError
from designer.explore.export import Written
from designer.explore.question import Question
from designer.explore.reading import text_of
from designer.io.output import file_names, output_folder
from designer.progress import Reporter


@dataclass(frozen=True, slots=True)
class OptimisedStudy:
    """What an optimisation came to, for the window.

    Parameters
    ----------
    headline : str
        The objective before and after, or that nothing better was found.
    variables : tuple of str
        What was chosen, each with its value before and after.
    trust : tuple of str
        How far it is to be believed, a sentence each.
    given_text : str
        The study as the search had it.
    text : str or None
        The study with the better design; None where none was found.
    """

    headline: str
    variables: tuple[str, ...]
    trust: tuple[str, ...]
    given_text: str
    text: str | None


def optimised_study(question: Question, reporter: Reporter, *, plan: Path) -> OptimisedStudy:
    """Search for a better design of the study in the window, as `designer optimise` does.

    Raises
    ------
    InputError
        If the plan is faulty, or is of another study, or the study is not saved.
    """
    from designer.optimum.optimise import optimum_of
    from designer.optimum.plan import read_optimisation
    from designer.report.optimum import headline, trust_lines, variable_rows

    laid_out = read_optimisation(plan, question.plugins.with_others)
    _require_study_of(question, plan, laid_out.document.name)
    optimum = optimum_of(laid_out, reporter)
    return OptimisedStudy(
        headline(optimum),
        tuple(f"{name}: {old or '–'} → {new}" for name, old, new, _ in variable_rows(optimum)),
        tuple(trust_lines(optimum)),
        question.text,
        optimum.text if optimum.is_better else None,
    )


def sweep_study(question: Question, reporter: Reporter, *, plan: Path, target: Path) -> Written:
    """Solve a sweep of the study in the window, as `designer sweep` does.

    Writes the store ``target`` and a folder with its report beside it. A sweep that was given up
    goes on with the same plan and store.

    Raises
    ------
    InputError
        If the plan is faulty, or is of another study, or the study is not saved; or if something
        else is at the target.
    OutputError
        If a file cannot be written.
    """
    from designer.report.sweep import write_sweep
    from designer.sweep import run as running
    from designer.sweep.plan import read_sweep
    from designer.sweep.store import opened, read_store, report_folder

    laid_out, base = read_sweep(plan, question.plugins.with_others)
    _require_study_of(question, plan, laid_out.document.name)
    folder, count = report_folder(target), running.processor_count()
    with output_folder(folder) as building:
        with opened(target, laid_out) as store:
            running.run(laid_out, base, store, running.processes(count), count, reporter)
        write_sweep(read_store(target), plan.stem, building)
        written = file_names(building)
    pages = sorted(written, key=lambda name: not name.endswith(".html"))
    return (*(folder / name for name in pages), target)


def _require_study_of(question: Question, plan: Path, study: str) -> None:
    """Refuse a plan that would not begin with what is seen in the window."""
    if Path(study).resolve() != question.path.resolve():
        problem = f"is {study}, and {question.path} is open"
        raise InputError([Fault(str(plan), None, "study", problem, "a plan of the open study")])
    if text_of(question.path) != question.text:
        problem = f"{study} is another in the window than in its file, which the plan starts from"
        raise InputError([Fault(str(plan), None, "study", problem, "a study that is saved")])
