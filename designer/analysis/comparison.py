"""Two results side by side: what differs in what was asked, and in the answer."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

from designer import checked
from designer.documents.plain import Json
from designer.spelling import digits

_RTOL = 1e-9
"""Relative difference below which numbers are the same: what a search at a flat optimum leaves."""
_COST = "selection.chosen.cost"
_ANSWERS = {
    "positive": "all holds as asked",
    "answer.verdict": "answer",
    "selection.chosen.grade": "chosen grade",
    "selection.chosen.size_id": "chosen size",
    "selection.chosen.utilisation": "utilisation",
    "selection.chosen.max_tension_N": "largest tension of the chosen rope",
    "selection.chosen.allowable_tension_N": "allowable tension",
    "selection.chosen.linear_mass_kg_per_m": "mass per length",
    "selection.chosen.axial_stiffness_N": "axial stiffness",
    "selection.chosen.drum_diameter_m": "drum diameter",
    _COST: "cost",
    "selection.chosen.worst_pose": "worst position of the chosen rope",
    "answer.total_mass_kg": "mass of all cables",
    "pose.sagging.status": "configured pose",
    "pose.sagging.diameter_m": "needed diameter, configured pose",
    "pose.sagging.max_tension_N": "largest tension, configured pose",
    "workspace.sagging.diameter_m": "needed diameter, worst pose",
    "workspace.sagging.max_tension_N": "largest tension, worst pose",
    "workspace.sagging.pose": "worst position",
    "workspace.massless.diameter_m": "needed diameter without sag",
    "workspace.limit_ratio": "self-weight ratio",
    "workspace.statuses.solved": "samples solved",
    "workspace.samples": "samples",
    "workspace.stiffness.largest_displacement_m_per_N": "largest displacement by a force",
    "workspace.interference.min_distance_m": "smallest clearance",
}
"""Values of ``result.json`` that a reader compares first, and what they are called."""
_APART = (
    "inputs", "provenance", "verification", "name", "format", "pose.loop", "answer.reasons",
    "findings",
)  # fmt: skip
"""What is compared by itself, or tells only how and when."""
_LISTS = ("candidates", "pareto", "usable", "grades", "alternatives", "not_tried", "exclusions")
"""Of ``selection``: told by the products."""


@dataclass(frozen=True, slots=True)
class ComparisonLine:
    """One value of both.

    Parameters
    ----------
    path : str
        Where it stands in ``result.json``, or the field of the config.
    label : str
        What it is called; empty where it has no other name than its path.
    a, b
        Its values; None where there is none.
    """

    path: str
    label: str
    a: Any
    b: Any

    @property
    def relative(self) -> float | None:
        """Change from A to B over A; None for what is no number, or from zero."""
        a, b = (_with_unit(value) for value in (self.a, self.b))
        if a is None or b is None or a[1] != b[1] or not a[0]:
            return None
        return (b[0] - a[0]) / abs(a[0])

    @property
    def differs(self) -> bool:
        """Whether the two are not the same, beyond rounding."""
        return not _same(self.a, self.b)


@dataclass(frozen=True, slots=True, repr=False)
class Comparison(checked.Shown):
    """Two results.

    Parameters
    ----------
    a, b : Mapping
        What each ``result.json`` holds.
    inputs : tuple of ComparisonLine
        Fields that differ, in SI; of what only one of the two has, the other is None.
    has_inputs : bool
        Whether both results tell their inputs; older ones do not.
    answers : tuple of ComparisonLine
        What a reader compares first, whether it differs or not.
    unmet : tuple of ComparisonLine
        Requirements that do not hold in both, whether they differ or not; in words.
    products : tuple of ComparisonLine
        Sizes of grades that hold in one of the two only, or were tried in one only.
    remaining : tuple of ComparisonLine
        All other values that differ.
    """

    a: Mapping[str, Any]
    b: Mapping[str, Any]
    inputs: tuple[ComparisonLine, ...]
    has_inputs: bool
    answers: tuple[ComparisonLine, ...]
    unmet: tuple[ComparisonLine, ...]
    products: tuple[ComparisonLine, ...]
    remaining: tuple[ComparisonLine, ...]

    @property
    def is_same(self) -> bool:
        """Whether nothing differs but when and where they were computed."""
        lines = (*self.inputs, *self.answers, *self.unmet, *self.products, *self.remaining)
        return not any(line.differs for line in lines)

    def to_dict(self) -> Json:
        """Return what ``comparison.json`` holds."""

        def plain(lines: tuple[ComparisonLine, ...]) -> list[Json]:
            return [{**asdict(line), "relative": line.relative} for line in lines]

        return {
            "format": 1,
            "names": [self.a.get("name"), self.b.get("name")],
            "same": self.is_same,
            "inputs": plain(self.inputs) if self.has_inputs else None,
            "answers": plain(self.answers),
            "unmet": plain(self.unmet),
            "products": plain(self.products),
            "others": plain(self.remaining),
            "provenance": [self.a["provenance"], self.b["provenance"]],
        }


def compare(a: Mapping[str, Any], b: Mapping[str, Any]) -> Comparison:
    """Compare what two ``result.json`` hold."""
    has_inputs = all(isinstance(result.get("inputs"), Mapping) for result in (a, b))
    inputs = _lines(a["inputs"], b["inputs"]) if has_inputs else iter(())
    of_a, of_b = dict(_flat(a)), dict(_flat(b))
    answers = []
    for path, label in _ANSWERS.items():
        line = ComparisonLine(path, label, of_a.get(path), of_b.get(path))
        if line.a is not None or line.b is not None:
            answers.append(_with_currency(line, of_a, of_b) if path == _COST else line)
    remaining = (line for line in _lines(of_a, of_b) if line.path not in _ANSWERS)
    return Comparison(
        a,
        b,
        tuple(line for line in inputs if line.differs),
        has_inputs,
        tuple(answers),
        tuple(_unmet(a, b)),
        tuple(line for line in _lines(_products(a), _products(b)) if line.differs),
        tuple(line for line in remaining if line.differs),
    )


def _with_currency(
    line: ComparisonLine, of_a: Mapping[str, Any], of_b: Mapping[str, Any]
) -> ComparisonLine:
    """Return the costs with their currency, as texts where there are two, and what is borrowed."""
    sides = [(name, side) for name, side in (("A", of_a), ("B", of_b)) if side.get(_COST)]
    borrowed = [name for name, side in sides if side.get("selection.price_estimate.year")]
    estimate = f", a borrowed estimate in {' and '.join(borrowed)}" if borrowed else ""
    currencies = [side.get("selection.currency") for _, side in sides]
    if len({*currencies}) == 2:
        a, b = (
            f"{digits(side[_COST])} {currency or 'without a currency'}"
            for (_, side), currency in zip(sides, currencies, strict=True)
        )
        return replace(line, label=line.label + estimate, a=a, b=b)
    unit = f" [{currencies[0]}]" if any(currencies) else ""
    return replace(line, label=f"{line.label}{unit}{estimate}")


def _lines(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[ComparisonLine]:
    for path in dict.fromkeys([*a, *b]):
        yield ComparisonLine(path, "", a.get(path), b.get(path))


def _unmet(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[ComparisonLine]:
    """Yield each requirement that one of the two does not meet; None where it is not asked."""
    # Of groups of cables several have one name: the one that does not hold counts.
    checks_a, checks_b = (
        {
            f"{check['id']} in {check['load_case']}": check
            for check in sorted(result.get("checks", []), key=lambda c: c["state"] != "holds")
        }
        for result in (a, b)
    )
    for key in dict.fromkeys([*checks_a, *checks_b]):
        checks = checks_a.get(key), checks_b.get(key)
        if any(check is not None and check["state"] != "holds" for check in checks):
            yield ComparisonLine(key, key.replace("_", " "), *map(_check_words, checks))


def _check_words(check: Mapping[str, Any] | None) -> str | None:
    """Return state and figures in a line, such as ``fails: demand 28, capacity 25.2``."""
    if check is None:
        return None
    figures = ((name, check.get(name)) for name in ("demand", "capacity"))
    said = [
        f"{n} {digits(x)} {check.get('unit', '')}".rstrip() for n, x in figures if x is not None
    ]
    return f"{check['state']}: {', '.join(said)}" if said else str(check["state"])


def _flat(value: Mapping[str, Any], lead: str = "") -> Iterator[tuple[str, Any]]:
    """Yield path and value of everything below; lists of plain values are one value."""
    for key, part in value.items():
        path = f"{lead}{key}"
        if path in _APART or "residual" in key or (lead == "selection." and key in _LISTS):
            continue
        if isinstance(part, Mapping):
            yield from _flat(part, f"{path}.")
        elif isinstance(part, list) and any(isinstance(item, Mapping) for item in part):
            yield from _flat({str(k): item for k, item in enumerate(part)}, f"{path}.")
        else:
            yield path, part


def _products(result: Mapping[str, Any]) -> dict[str, str]:
    """Return whether each size of each grade holds."""
    selection = result.get("selection")
    candidates = selection.get("candidates", []) if isinstance(selection, Mapping) else []
    return {
        f"{candidate['grade']}, {candidate['size_id']}": (
            "does not hold" if candidate["standing"] in ("too_thin", "not_held") else "holds"
        )
        for candidate in candidates
    }


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_same, a, b))
    if _is_number(a) and _is_number(b):
        return math.isclose(a, b, rel_tol=_RTOL)
    return bool(a == b)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _with_unit(value: Any) -> tuple[float, str] | None:
    """Return number and unit of a number, or of a text such as ``4000 kg``; None for others."""
    if _is_number(value):
        return value, ""
    number, _, unit = str(value).partition(" ")
    try:
        return float(number), unit
    except ValueError:
        return None
