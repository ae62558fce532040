"""What no effect explains."""

from __future__ import annotations

from dataclasses import dataclass

from designer.diagnosis.result import Diagnosis
from designer.diagnosis.trends import in_runs
from designer.report import format as fmt
from designer.report.diagnosis import words
from designer.report.parts import Fact, Picture, Statement


@dataclass(frozen=True, slots=True)
class UnexplainedSection:
    """What no effect explains.

    Parameters
    ----------
    statement : Statement
        What the residual goes with.
    facts : tuple of Fact
        The strongest covariates.
    picture : Picture or None
        The residual that is left, against them.
    correction : tuple of Fact
        A smooth empirical correction; empty where there is none.
    """

    statement: Statement
    facts: tuple[Fact, ...]
    picture: Picture | None
    correction: tuple[Fact, ...]


def unexplained_section(diagnosis: Diagnosis, picture: Picture | None) -> UnexplainedSection | None:
    """Return what is left unexplained; None where nothing is."""
    if not diagnosis.is_unexplained:
        return None
    structure = diagnosis.structure_after
    carriers, events = structure.present, structure.events
    named = events[0].text if events else words.covariate(carriers[0].name)
    return UnexplainedSection(
        statement=Statement(
            f"Goes with {named}",
            "No effect that the program knows accounts for it. Covariates that vary together share "
            f"the blame: the cause need not be the first of them.{_where(diagnosis)}",
            "bad",
        ),
        facts=tuple(
            Fact(words.capital(e.text), f"{fmt.percent(e.fraction_of_variance, 2)} of it")
            for e in events
        )
        + tuple(
            Fact(
                words.capital(words.covariate(c.name)),
                f"{fmt.percent(c.fraction_of_variance, 2)} of the variance",
                f"chance {words.chance(c.chance)}",
            )
            for c in carriers[:6]
        ),
        picture=picture,
        correction=_correction(diagnosis),
    )


def _where(diagnosis: Diagnosis) -> str:
    place = diagnosis.left_in
    if place is None:
        return ""
    return (
        f" It shows most in {place.reading}, and is farthest off, by up to "
        f"{fmt.number(abs(place.size), 2)} times the noise, at rows "
        f"{fmt.listing(in_runs(place.rows))}."
    )


def _correction(diagnosis: Diagnosis) -> tuple[Fact, ...]:
    correction = diagnosis.correction
    if correction is None:
        return ()
    what = words.covariate(correction.covariate)
    return (
        Fact("Correction", f"a parabola in {what} for each reading"),
        Fact("Held-out error without it", _in_noise(correction.heldout_before)),
        Fact(
            "With it",
            _in_noise(correction.heldout_after),
            ""
            if correction.heldout_after < correction.heldout_before
            else "no help on rows that it has not seen",
        ),
    )


def _in_noise(value: float) -> str:
    return f"{fmt.number(value, 3)} times the noise"
