"""How likely a rope is enough where inputs are not certain, in words; filters of templates."""

from __future__ import annotations

from designer.analysis.uncertainty.uncertainty import SizeOdds, UncertaintyAnalysis
from designer.model.uncertainty import Input, Normal, Spread
from designer.report import format as fmt

INPUT_NAMES: dict[str, str] = {
    "payload": "Payload",
    "modulus": "Modulus of the rope",
    "linear_mass": "Mass of the rope",
    "breaking_load": "Breaking load",
    "exit_points": "Exit points",
}
_LIKELY, _UNLIKELY = 0.99, 0.5
"""From where on a probability is good news, and below which it is bad news."""


def in_a_sentence(uncertainty: UncertaintyAnalysis) -> str:
    """Return the probability and what carries most of the spread, without a full stop."""
    text = strong_enough(uncertainty.chosen)
    if len(uncertainty.shares) > 1:
        largest = uncertainty.shares[0]
        percent = bounded_percent(largest.first_order)
        text += f", {INPUT_NAMES[largest.input].lower()} carries {percent} of the spread"
    if uncertainty.chosen.not_held:
        missing = fmt.share(uncertainty.chosen.not_held, uncertainty.samples)
        text += f"; in {missing} of the draws a pose is not held at all, which is not enough"
    return f"{text}; this is strength alone, without the other requirements"


def odds_tone(odds: SizeOdds) -> str:
    """Return the colour of a probability, by the lower end of its confidence interval."""
    low = odds.probability_95[0]
    return "good" if low >= _LIKELY else "doubt" if low >= _UNLIKELY else "bad"


def strong_enough(odds: SizeOdds) -> str:
    """Return the probability with its confidence interval."""
    return (
        f"strong enough with {probability(odds)} probability "
        f"(95\u00a0% confidence: {confidence(odds)})"
    )


def probability(odds: SizeOdds) -> str:
    """Return the share of draws in which a size is enough; 100 % and 0 % only for all and none."""
    if odds.enough in (0, len(odds.utilisation)):
        return f"{100 * odds.enough // len(odds.utilisation)}\u00a0%"
    return _near_an_end(odds.probability)


def confidence(odds: SizeOdds) -> str:
    """Return the confidence interval of that share."""
    low, high = odds.probability_95
    return f"{_near_an_end(low, unit='')} to {_near_an_end(high)}"


def _near_an_end(share: float, unit: str = "\u00a0%") -> str:
    """Return a probability with as many digits as tell it from certainty."""
    if share in (0.0, 1.0):
        return f"{100.0 * share:.0f}{unit}"
    from_end = min(share, 1.0 - share)
    decimals = 1 if from_end >= 0.001 else 2 if from_end >= 1e-4 else 3
    return f"{fmt.fixed(100.0 * share, decimals)}{unit}"


def bounded_percent(share: float) -> str:
    """Return a share; what an estimate from draws puts below none or above all is none or all."""
    bounded = min(max(share, 0.0), 1.0)
    return f"{fmt.fixed(100.0 * bounded + 0.0, 0 if bounded >= 0.1 else 1)}\u00a0%"


def interval(ends: tuple[float, float]) -> str:
    """Return the confidence interval of a share."""
    low, high = (min(max(end, 0.0), 1.0) for end in ends)
    return f"{fmt.fixed(100.0 * low, 1)} to {fmt.fixed(100.0 * high, 1)}\u00a0%"


def distribution(spread: Spread, name: Input) -> str:
    """Return the distribution of an input in words."""

    def deviation(value: float) -> str:
        if name == "exit_points":
            return f"{fmt.trimmed(1e3 * value)}\u00a0mm"
        return f"{fmt.trimmed(100.0 * value)}\u00a0%"

    if isinstance(spread, Normal):
        return f"normal, standard deviation {deviation(spread.standard_deviation)}"
    if spread.low == -spread.high:
        return f"±\u00a0{deviation(spread.high)}, uniform"
    return f"{deviation(spread.low)} to {deviation(spread.high)}, uniform"
