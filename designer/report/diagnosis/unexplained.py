"""What no effect explains."""

from __future__ import annotations

from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.blocks import Block, Box, Fact, Facts, Section, Statement, Subheading
from designer.report.diagnosis import carriers, words
from designer.spelling import in_runs

_MOST_CARRIERS = 6


def section(diagnosis: Diagnosis) -> Section | None:
    """Return what is left unexplained; None where nothing is."""
    if not diagnosis.is_unexplained:
        return None
    structure = diagnosis.structure_after
    present, events = structure.present, structure.events
    named = events[0].text if events else words.covariate(present[0].name)
    text = (
        "No effect that the program knows accounts for it. Covariates that vary together share "
        f"the blame: the cause need not be the first of them.{_where(diagnosis)}"
    )
    facts = (
        *(
            Fact(fmt.capital(e.text), f"{fmt.percent(e.fraction_of_variance, 2)} of it")
            for e in events
        ),
        *(
            Fact(
                fmt.capital(words.covariate(c.name)),
                f"{fmt.percent(c.fraction_of_variance, 2)} of the variance",
                f"chance {words.chance(c.chance)}",
            )
            for c in present[:_MOST_CARRIERS]
        ),
    )
    return Section.of(
        "unexplained",
        "What is unexplained",
        Statement(f"Goes with {named}", text, "bad"),
        Facts(facts),
        carriers.left(diagnosis),
        *_correction(diagnosis),
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


def _correction(diagnosis: Diagnosis) -> tuple[Block, ...]:
    """Return a smooth empirical correction; nothing where there is none."""
    correction = diagnosis.correction
    if correction is None:
        return ()
    before, after = correction.heldout_before, correction.heldout_after
    what = words.covariate(correction.covariate)
    no_help = "" if after < before else "no help on rows that it has not seen"
    facts = (
        Fact("Correction", f"a parabola in {what} for each reading"),
        Fact("Held-out error without it", f"{fmt.number(before, 3)} times the noise"),
        Fact("With it", f"{fmt.number(after, 3)} times the noise", no_help),
    )
    note = (
        "It only smooths these data. It may serve to correct readings in the range that was "
        "measured; it says nothing of the cause, and it is not in the config that was written."
    )
    title = "An empirical correction: no physics, not used in the design"
    return Subheading("correction", title), Box.of("panel empirical", Facts(facts), note)
