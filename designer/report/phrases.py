"""Words for values that several sections, the window or the terminal show, and numbers of captions.

They are filters of templates.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable
from datetime import datetime
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from designer import spelling
from designer.analysis.comparison import ComparisonLine
from designer.analysis.maps import CoverageCurve, EdgeProfile, WorkspaceMaps
from designer.arrays import FloatArray
from designer.grades.grade import Grade
from designer.model.region import Region
from designer.model.space import Orientations
from designer.model.verdict import Requirement, State
from designer.report import format as fmt
from designer.report.figures.colours import DIAMETER, RATIO
from designer.selection.assignment import Assignment
from designer.selection.result import CoveredSize
from designer.study import Study

if TYPE_CHECKING:
    from designer.analysis.uncertainty import SizeOdds, UncertaintyAnalysis
    from designer.optimum.measures import Measure

_MOST_LISTED = 6
"""As many orientations as a line has room for."""
_MOST_LENGTHS = 3
"""As many different lengths as page 1 lists; the fabrication data have them cable by cable."""
INPUT_NAMES: dict[str, str] = {
    "payload": "Payload",
    "modulus": "Modulus of the rope",
    "linear_mass": "Mass of the rope",
    "breaking_load": "Breaking load",
    "exit_points": "Exit points",
}
LITTLE = 0.02
"""A share by which sag may change a tension without a figure of that being worth its place."""
_COLUMN = 55
"""Characters of a line of a column on page 1."""
_NEAR = 0.005
"""A distance from the edge, over that of the region, that is none."""
_LIKELY, _UNLIKELY = 0.99, 0.5
"""From where on a probability is good news, and below which it is bad news."""


def compliance(value_m_per_N: float) -> str:
    """Return a displacement per force such as ``62.1 mm/kN``."""
    if not math.isfinite(value_m_per_N):
        return "not stable"
    return f"{fmt.number(1e6 * value_m_per_N, 3)}\u00a0mm/kN"


def described_region(region: Region) -> str:
    """Return a region in words."""
    words = region.words(fmt.position, fmt.plural)
    if region.is_discrete:
        return words
    low, high = region.bounds_m[:, 2]
    return f"{words}, z from {fmt.metres(low)} to {fmt.metres(high)}"


def known(value: float, decimals: int) -> str:
    """Return a number, or that there is none, such as a price that is not known."""
    return fmt.fixed(value, decimals) if math.isfinite(value) else fmt.MISSING


def whole_metres(value: float) -> str:
    """Return a long length such as ``2 354 m``."""
    return f"{fmt.count(round(value))}\u00a0m"


def in_millimetres(value_m: float) -> str:
    """Return a length in millimetres with five digits, without the unit."""
    value = 1e3 * value_m
    return fmt.trimmed(value, 5) if value == 0.0 or value > 1e-3 else fmt.power_of_ten(value)


def millimetre_step(step_m: float) -> str:
    """Return a step such as ``10 mm``."""
    return f"{fmt.trimmed(1e3 * step_m)}\u00a0mm"


def numbers(values: Iterable[float], digits: int = 4) -> str:
    """Return numbers as a row such as ``(0, 0, 1.5)``."""
    return f"({', '.join(fmt.trimmed(float(value), digits) for value in values)})"


def percentage_points(change: float) -> str:
    """Return a change of a share such as ``+0.123``."""
    if math.isnan(change):
        return fmt.MISSING
    text = fmt.fixed(100.0 * change, 3)
    return text if text.startswith("−") else f"+{text}"


def shown_time(moment: datetime) -> str:
    """Return date and time as a reader wants them."""
    return moment.strftime("%Y-%m-%d %H:%M %z").strip()


def angle(angle_rad: float) -> str:
    """Return an angle such as ``41.3°``."""
    return f"{fmt.fixed(math.degrees(angle_rad), 1)}°"


def short_position(place: FloatArray) -> str:
    """Return a position such as ``(12.5, 3, −1)``, as a cell of a table has room for."""
    return fmt.printed(spelling.vector(np.round(place[:3], 2)))


STATES = {State.HOLDS: "holds", State.OPEN: "not known", State.FAILS: "does not hold"}
"""As a table has it."""


def state_word(state: State) -> str:
    """Return whether a requirement holds, as a table has it."""
    return STATES[state]


def with_unit(value: float, unit: str) -> str:
    """Return a demand or a capacity with its unit."""
    if math.isnan(value):
        return fmt.MISSING
    if unit == "N":
        return fmt.newtons(value)
    if unit == "m":
        return fmt.millimetres(value) if abs(value) < 1.0 else fmt.metres(value)
    return f"{fmt.trimmed(value)}\u00a0{unit}".rstrip()


def of_requirement(value: float, requirement: Requirement) -> str:
    """Return a demand or a capacity of a requirement with its unit; sag as a share of the chord."""
    if requirement.id == "sag" and math.isfinite(value):
        return fmt.percent(value)
    return with_unit(value, requirement.unit)


def described_orientations(orientations: Orientations) -> str:
    """Return in words how the platform is turned at every position."""
    if orientations.is_level:
        return "level only"
    if orientations.law is not None:
        return orientations.law.words
    turns = np.degrees(orientations.turns_rad)
    if orientations.range_rad is None:
        listed = "; ".join(fmt.degrees(turn) for turn in turns[:_MOST_LISTED])
        more = f"; {len(turns) - _MOST_LISTED} more" if len(turns) > _MOST_LISTED else ""
        return f"turned by {listed}{more}" if len(turns) == 1 else f"each of {listed}{more}"
    low, high = np.degrees(orientations.range_rad)
    return f"all between {fmt.degrees(low)} and {fmt.degrees(high)}"


def orientation_words(study: Study) -> tuple[str, str] | None:
    """Return which orientations were checked, and how; None of a point mass, which has none."""
    if study.workspace is None or study.robot.is_point_mass:
        return None
    orientations = study.workspace.orientations
    how = f"{orientations.count} of them at each sample, the worst searched between"
    if orientations.is_level:
        how = "the platform was not turned"
    elif orientations.law is not None:
        how = ""
    elif orientations.range_rad is None:
        how = "rotation vectors, the worst of them counts" if orientations.count > 1 else ""
    return described_orientations(orientations), how


def lengths(length_m: FloatArray) -> str:
    """Return lengths such as ``6 × 338.20 m`` for alike ones; of many that differ the range."""
    counts = Counter(fmt.fixed(float(length), 2) for length in length_m)
    if len(counts) > _MOST_LENGTHS:
        return f"{fmt.fixed(float(length_m.min()), 2)} to {fmt.metres(float(length_m.max()))}"
    each = [f"{count}\u00a0×\u00a0{text}" if count > 1 else text for text, count in counts.items()]
    return f"{fmt.listing(each)}\u00a0m"


def construction(grade: Grade) -> str:
    """Return construction, core and finish of a grade, as far as its source states them."""
    core = "" if grade.core == spelling.NOT_STATED else f"core {grade.core}"
    return spelling.stated(grade.construction, core, grade.finish)


def assigned_ropes(assignment: Assignment) -> str:
    """Return which rope each group of cables gets."""
    if len(assignment.products) == 1:
        return f"Ropes of {assignment.ropes[0].label} for all groups"
    pairs = zip(assignment.groups, assignment.ropes, strict=True)
    return fmt.listing(f"{rope.label} for {group.name}" for group, rope in pairs)


def rounded_up(share: float) -> float:
    """Return a share rounded up as it is shown, so that what is proved is not overstated."""
    return math.ceil(1000.0 * share) / 1000.0


def rounded_down(share: float) -> float:
    """Return a share rounded down as it is shown."""
    return math.floor(1000.0 * share) / 1000.0


def each_statement(html: str) -> list[str]:
    """Return the statements of a part of a page, one by one."""
    return [Markup(part) for part in re.findall(r'<p class="statement.*?</p>', html, re.DOTALL)]


def length_of_statements(html: str) -> int:
    """Return how many characters the statements have, without their titles."""
    texts = (re.sub(r"<strong>.*?</strong>", "", part) for part in each_statement(html))
    return sum(len(Markup(text).striptags()) for text in texts)


def runs_that_serve_none(sizes: Iterable[CoveredSize]) -> list[list[CoveredSize]]:
    """Return sizes one by one, but three and more in a row that serve nothing together."""
    runs: list[list[CoveredSize]] = []
    for serves_some, run in groupby(sizes, key=lambda size: size.fraction > 0.0):
        same = list(run)
        runs += [same] if not serves_some and len(same) > 2 else [[size] for size in same]
    return runs


def two_columns(statements: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return statements in two columns: each goes where fewer lines stand, in their order."""
    columns: tuple[list[str], list[str]] = [], []
    lines = [0, 0]
    for text in statements:
        shorter = int(lines[1] < lines[0])
        columns[shorter].append(text)
        lines[shorter] += 1 + len(Markup(text).striptags()) // _COLUMN
    return columns


_BY_PATH: tuple[tuple[str, Callable[[float], str]], ...] = (
    ("utilisation", fmt.utilisation),
    ("ratio", fmt.percent),
    ("drum_diameter_m", fmt.metres),
    ("diameter_m", lambda x: f"{fmt.number(1e3 * x, 5)} mm"),
    ("distance_m", lambda x: f"{fmt.number(1e3 * x, 5)} mm"),
    ("m_per_N", lambda x: f"{fmt.number(1e6 * x)} mm/kN"),
    ("kg_per_m", fmt.kilograms_per_metre),
    ("_kg", fmt.kilograms),
    ("_N", fmt.newtons),
    ("", lambda x: fmt.trimmed(x, 6)),
)
"""How values of ``result.json`` are shown, by the end of their path."""


def result_value(value: Any, path: str) -> str:
    """Return a value of ``result.json``, which stands there at a path, as a reader wants it."""
    if value is None:
        return fmt.MISSING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):  # in a list of lists, which no result of ours has
        value = [[key, part] for key, part in value.items()]
    if isinstance(value, list):
        return f"({', '.join(result_value(part, path) for part in value)})"
    if isinstance(value, str):
        return value
    return next(text for end, text in _BY_PATH if path.endswith(end))(float(value))


def relative_change(line: ComparisonLine) -> str:
    """Return the relative change of a number; empty where there is none."""
    return fmt.signed_percent(line.relative) if line.differs and line.relative is not None else ""


def objective_value(value: float | None, measure: Measure) -> str:
    """Return a value of what an optimisation is for, or of its limits, as a reader wants it."""
    if value is not None and measure.dimension.unit == "m^3":
        return fmt.cubic_metres(value)
    return result_value(value, measure.path)


def paragraphs(html: str) -> list[Markup]:
    """Return what stands in each plain paragraph of a part of a page."""
    return [Markup(text) for text in re.findall(r"<p>(.*?)</p>", html, re.DOTALL)]


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


def edges(maps: WorkspaceMaps) -> str:
    """Return the extent of the region such as ``464 × 402 × 160``, in metres."""
    size = np.ptp(maps.region.bounds_m, axis=0)
    return " × ".join(fmt.trimmed(float(edge), 3) for edge in size if edge > 0.0)


def diameters_m(maps: WorkspaceMaps) -> tuple[float, float] | None:
    """Return the least and the largest needed diameter [m] that the region in space shows."""
    values = np.concatenate([DIAMETER.of(field).ravel() for field in maps.shown])
    values = 1e-3 * values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if len(values) else None


def is_partly_held(maps: WorkspaceMaps) -> bool:
    """Return whether there are poses among those that no cable holds."""
    return any(field.is_infeasible.any() for field in maps.shown)


def largest_ratio(maps: WorkspaceMaps) -> float:
    """Return the largest tension with sag over that without; NaN where there is none."""
    ratio = RATIO.of(maps.section)
    return float(np.nanmax(ratio)) if np.isfinite(ratio).any() else float("nan")


def largest_change(maps: WorkspaceMaps) -> float:
    """Return by what share sag changes the largest tension at most over the section; else zero."""
    ratio = RATIO.of(maps.section)
    return float(np.nanmax(np.abs(ratio - 1.0))) if np.isfinite(ratio).any() else 0.0


def sag_matters(maps: WorkspaceMaps) -> bool:
    """Return whether a map of the effect of sag on the tension is worth its place."""
    return largest_change(maps) > LITTLE


def ends_of_holding(profile: EdgeProfile) -> tuple[float | None, float | None]:
    """Return how far from the edge cables hold no more, and straight ones; None at the edge [m]."""
    assert profile.region_distance_m is not None
    near_m = _NEAR * profile.region_distance_m
    last, straight = (
        None if distance is None or distance < near_m else distance
        for distance in (profile.limit_distance_m, profile.straight_distance_m)
    )
    return last, straight


def diameter_of_nine_tenths_m(served: CoverageCurve) -> float | None:
    """Return the diameter that serves nine poses of ten [m]; None where none does."""
    most = np.flatnonzero(served.share >= 0.9)
    return float(served.diameter_m[most[0]]) if len(most) else None
