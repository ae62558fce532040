"""How likely the chosen rope is enough where inputs are not certain, and what that hangs on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.uncertainty.shares import SCRAMBLES
from designer.analysis.uncertainty.uncertainty import SizeOdds, UncertaintyAnalysis
from designer.model.uncertainty import Input, Normal, Spread
from designer.report import format as fmt
from designer.report.blocks import (
    Column,
    Heads,
    Picture,
    Row,
    Section,
    Statement,
    Table,
    Tone,
)
from designer.report.design.source import Source
from designer.report.pictures import chart

_NAMES: dict[str, str] = {
    "payload": "Payload",
    "modulus": "Modulus of the rope",
    "linear_mass": "Mass of the rope",
    "breaking_load": "Breaking load",
    "exit_points": "Exit points",
}
_MEANINGS = {
    "payload": "weight, inertia and constant loads of the platform; wind on it stays",
    "modulus": "on all cables alike",
    "linear_mass": "on all cables alike; ice stays",
    "breaking_load": "on all cables alike",
    "exit_points": "each coordinate of each point for itself",
}
_LIKELY, _UNLIKELY = 0.99, 0.5


def section(source: Source) -> Section | None:
    """Return the probabilities and shares; None where nobody asked and no modulus is borrowed."""
    found = source.analysis.uncertainty
    if found is None:
        return _nothing_drawn(source.analysis)
    if not found.is_asked:
        return Section.of("uncertainty", "Uncertainty", _of_modulus(found), " ".join(_how(found)))
    return Section.of(
        "uncertainty",
        "Uncertainty",
        statement(found),
        _inputs(found),
        _sizes(found),
        _odds(found) if source.draws else None,
        _shares(found),
        _bars(found) if source.draws and len(found.shares) > 1 else None,
        found.why_no_shares and f"No shares: {found.why_no_shares}.",
        " ".join(_how(found)),
    )


def _nothing_drawn(analysis: Analysis) -> Section | None:
    if analysis.study.uncertainty is None:
        return None
    chosen = analysis.chosen
    why = "no rope was chosen" if chosen is None else "the study has every input as certain"
    return Section.of("uncertainty", "Uncertainty", f"Nothing was drawn: {why}.")


def statement(found: UncertaintyAnalysis) -> Statement:
    """Return the probability and what carries most of the spread, for the first page."""
    low = found.chosen.probability_95[0]
    tone: Tone = "good" if low >= _LIKELY else "doubt" if low >= _UNLIKELY else "bad"
    text = fmt.capital(in_a_sentence(found))
    return Statement("With the uncertainty stated", f"{text}.", tone)


def in_a_sentence(found: UncertaintyAnalysis) -> str:
    """Return the same without title and full stop."""
    text = _odds_words(found.chosen)
    if len(found.shares) > 1:
        most = found.shares[0]
        text += f", {_NAMES[most.input].lower()} carries {_percent(most.first_order)} of the spread"
    if found.chosen.not_held:
        missing = fmt.share(found.chosen.not_held, found.samples)
        text += f"; in {missing} of the draws a pose is not held at all, which is not enough"
    return f"{text}; this is strength alone, without the other requirements"


def _odds_words(one: SizeOdds) -> str:
    return f"strong enough with {probability(one)} probability (95\u00a0% confidence: {_ends(one)})"


def probability(one: SizeOdds) -> str:
    """Return the share of draws in which a size is enough; 100 % and 0 % only for all and none."""
    if one.enough in (0, len(one.utilisation)):
        return f"{100 * one.enough // len(one.utilisation)}\u00a0%"
    return _near_an_end(one.probability)


def _ends(one: SizeOdds) -> str:
    low, high = one.probability_95
    return f"{_near_an_end(low, unit='')} to {_near_an_end(high)}"


def _near_an_end(share: float, unit: str = "\u00a0%") -> str:
    """Return a probability with as many digits as tell it from certainty."""
    if share in (0.0, 1.0):
        return f"{100.0 * share:.0f}{unit}"
    from_end = min(share, 1.0 - share)
    decimals = 1 if from_end >= 0.001 else 2 if from_end >= 1e-4 else 3
    return f"{fmt.fixed(100.0 * share, decimals)}{unit}"


def _percent(share: float) -> str:
    """Return a share; what an estimate from draws puts below none or above all is none or all."""
    shown = min(max(share, 0.0), 1.0)
    return f"{fmt.fixed(100.0 * shown + 0.0, 0 if shown >= 0.1 else 1)}\u00a0%"


def _of_modulus(found: UncertaintyAnalysis) -> Statement:
    """Say what the borrowed modulus alone makes of the answer."""
    used, spread = found.chosen.utilisation, _words("modulus", found.spreads["modulus"])
    ends = dict.fromkeys(fmt.utilisation(float(end)) for end in (used.min(), used.max()))
    shown = " to ".join(ends) if len(ends) > 1 else f"{next(iter(ends))} throughout"
    text = (
        f"The modulus of the chosen rope is borrowed from another one and may be off by {spread}. "
        f"By that alone the utilisation is {shown}: the rope is {_odds_words(found.chosen)}. "
        "An uncertainty block in the study adds payload, mass, breaking load and exit points, and "
        "the share of each."
    )
    return Statement("Borrowed modulus", text, "" if found.chosen.probability == 1.0 else "bad")


def _words(name: Input, spread: Spread) -> str:
    """Return a distribution in words."""

    def shown(value: float) -> str:
        if name == "exit_points":
            return f"{fmt.trimmed(1e3 * value)}\u00a0mm"
        return f"{fmt.trimmed(100.0 * value)}\u00a0%"

    if isinstance(spread, Normal):
        return f"normal, standard deviation {shown(spread.standard_deviation)}"
    if spread.low == -spread.high:
        return f"±\u00a0{shown(spread.high)}, uniform"
    return f"{shown(spread.low)} to {shown(spread.high)}, uniform"


def _inputs(found: UncertaintyAnalysis) -> Table:
    rows = []
    for name, spread in found.spreads.items():
        of_grade = name == "modulus" and found.is_modulus_of_grade
        source = "the rope's grade" if of_grade else "the study"
        rows.append((_NAMES[name], _words(name, spread), source, fmt.capital(_MEANINGS[name])))
    caption = "What is not certain, as deviations from what the study or the rope's table states."
    return Table.of(caption, ("Input", "Distribution", "Stated by", "Acts"), *rows)


def _sizes(found: UncertaintyAnalysis) -> Table:
    columns: Heads = (
        *("Size", Column("Stated"), Column("Median"), Column("95\u00a0% are below")),
        *(Column("Enough with"), Column("95\u00a0% confidence"), Column("Not held")),
    )
    rows = []
    for one in found.sizes:
        used = one.utilisation
        middle, high = (float(np.percentile(used, at, method="higher")) for at in (50.0, 95.0))
        stated = one.candidate.verification.utilisation
        cells = (
            one.candidate.size.id,
            *(fmt.utilisation(value) for value in (stated, middle, high)),
            *(probability(one), _ends(one), fmt.count(one.not_held)),
        )
        rows.append(Row(cells, "good" if one.candidate is found.chosen.candidate else ""))
    caption = (
        "The chosen size and those beside it: how much of it is used, as stated and in the draws, "
        f"and in how many of {fmt.count(found.samples)} draws that is no more than 100\u00a0%."
    )
    return Table.of(caption, columns, *rows)


def _odds(found: UncertaintyAnalysis) -> Picture | None:
    from designer.report.figures.charts_uncertainty import odds_chart

    shown = [
        (one.candidate.size.id, one.utilisation, one is found.chosen)
        for one in found.sizes
        if np.isfinite(one.utilisation).any()
    ]
    if not shown:
        return None
    caption = (
        "How much of each size is used in the draws; to the right of the line it is not enough."
    )
    return chart(caption, "Histograms, one for each size", odds_chart(shown))


def _shares(found: UncertaintyAnalysis) -> Table | None:
    if len(found.shares) < 2:
        return None
    rows = [
        (
            _NAMES[one.input],
            _percent(one.first_order), _interval(one.first_order_95),
            _percent(one.total_order), _interval(one.total_order_95),
        )
        for one in found.shares
    ]  # fmt: skip
    columns: Heads = (
        *("Input", Column("Alone"), Column("95\u00a0% confidence")),
        *(Column("With others"), Column("95\u00a0% confidence")),
    )
    caption = (
        "Share of each input in the variance of the utilisation: by how much it would fall if this "
        "input alone were certain (Sobol's index of first order), and with all that the input does "
        "together with others (total order)."
    )
    return Table.of(caption, columns, *rows)


def _interval(ends: tuple[float, float]) -> str:
    low, high = (min(max(end, 0.0), 1.0) for end in ends)
    return f"{fmt.fixed(100.0 * low, 1)} to {fmt.fixed(100.0 * high, 1)}\u00a0%"


def _bars(found: UncertaintyAnalysis) -> Picture:
    from designer.report.figures.charts_uncertainty import shares_chart

    drawn = shares_chart([(_NAMES[one.input], one) for one in found.shares])
    return chart("The same as bars, with their confidence.", "Bars, one for each input", drawn)


def _how(found: UncertaintyAnalysis) -> Iterator[str]:
    yield (
        f"{fmt.count(found.samples)} independent random draws (seed {found.seed}), so that the "
        "interval of Clopper and Pearson is exact."
    )
    if found.points:
        yield (
            f"Shares from {SCRAMBLES} independent scrambles of {found.points} quasi-random points "
            "(Saltelli 2010), their confidence by Student's t over the scrambles."
        )
    yield (
        f"In each draw {fmt.plural(found.poses, 'pose')} of the chosen size "
        f"{'was' if found.poses == 1 else 'were'} solved: all, of every load case, that are among "
        "the worst at the ends of the inputs."
    )
    checked = found.checked
    if checked.draws == 0:
        yield "The region was not searched again for other worst poses."
        return
    yield (
        f"The region was searched again in {fmt.plural(checked.draws, 'draw')}, among them the "
        "nearest to 100\u00a0% and the largest; what was worse joined these poses."
    )
    points = 100.0 * checked.missed
    if checked.missed == 0.0:
        yield f"In the last of {fmt.plural(checked.rounds, 'round')} nothing was worse."
    else:
        yield (
            f"In the last of {fmt.plural(checked.rounds, 'round')} a pose was worse by "
            f"{fmt.trimmed(points, 2)} percentage points."
        )
