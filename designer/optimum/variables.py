"""Variables of an optimisation: which fields they set, within which bounds; read and checked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import chain

from pydantic import ValidationError

from designer.documents.document import Document, Key, Node, path_keys, path_text
from designer.documents.section import schema_faults
from designer.errors import Fault
from designer.io.config.schema import StudySection
from designer.units import QuantityError, describe, in_SI

_ROUNDING = 1e-9
"""Of a range: what reading its bounds in another unit may change."""
_STEPS = 1000
"""A bound's range has so many steps, or up to ten times as many: no mast is set to a micrometre."""


@dataclass(frozen=True, slots=True)
class Tie:
    """A field that goes with a variable: it is ``origin + slope · value``, in ``unit``."""

    keys: tuple[Key, ...]
    origin: float
    slope: float
    unit: str

    def node(self, value: float) -> Node:
        """Return what the study has in this field at a value of the variable."""
        text = f"{self.origin + self.slope * value + 0.0:.10g} {self.unit}".rstrip()
        return Node(1, text, is_plain=not self.unit)


@dataclass(frozen=True, slots=True)
class Variable:
    """One thing to choose.

    Parameters
    ----------
    name : str
        As the file calls it.
    ties : tuple of Tie
        The fields of the study that it sets.
    low, high : float
        Its bounds.
    unit : str
        Of both, as the file has it; empty for SI.
    given : float or None
        Its value in the study as it is; None where its fields have no common one.
    is_offset : bool
        Whether it is a change of what the study has.
    """

    name: str
    ties: tuple[Tie, ...]
    low: float
    high: float
    unit: str
    given: float | None
    is_offset: bool

    def at(self, share: float) -> float:
        """Return the value at a share of the range, in round steps."""
        step = 10.0 ** math.floor(math.log10((self.high - self.low) / _STEPS))
        value = round((self.low + share * (self.high - self.low)) / step) * step
        return min(max(float(f"{value:.10g}"), self.low), self.high)

    def share(self, value: float) -> float:
        """Return where in the range a value lies, from 0 to 1."""
        return (value - self.low) / (self.high - self.low)

    def bound_at(self, value: float) -> str:
        """Return which bound a value stands at: ``lower``, ``upper``, or empty for none."""
        share = self.share(value)
        return "lower" if abs(share) < 1e-3 else "upper" if abs(share - 1.0) < 1e-3 else ""

    def is_within(self, value: float) -> bool:
        """Tell whether a value lies within the bounds, give or take rounding."""
        return -_ROUNDING <= self.share(value) <= 1.0 + _ROUNDING

    def asks_for(self, value: float) -> str:
        """Return what a value asks for beside the study: ``less``, ``more``, ``other`` or nothing.

        Empty where the variable is of the robot, or its value that of the study.
        """
        senses = {tie: demand_sense(tie.keys) for tie in self.ties}
        demands = {tie: sense for tie, sense in senses.items() if sense is not None}
        if not demands or value == self.given:
            return ""
        change = math.nan if self.given is None else value - self.given
        changes = {tie.slope * sense * change for tie, sense in demands.items()}
        if all(x > 0.0 for x in changes):
            return "more"
        return "less" if all(x < 0.0 for x in changes) else "other"

    @property
    def fields(self) -> tuple[str, ...]:
        """The paths of its fields."""
        return tuple(path_text(tie.keys) for tie in self.ties)


_SENSES = {
    "safety_factor": 1, "inset": -1, "clearance": 1, "floor": 1,
    "sag": -1, "stiffness": 1, "drum_capacity": -1, "mass": 1, "dynamic_factor": 1,
    "acceleration": 1, "speed": 1, "thickness": 1, "tension_min": 1,
    "tension_max": -1, "platform_frequency": 1, "fleet_angle_max": -1, "dead_turns": 1,
}  # fmt: skip
"""Whether more of a demand asks for more, by the last name of its field."""
_ASKED = ("workspace", "selection", "load_cases", "pose", "uncertainty", "surroundings")
_OF_ROBOT = (("selection", "sheave_diameter"), ("selection", "termination_efficiency"))
_ASKED_OF_ROBOT = (
    ("tension_min",),
    ("winches", "tension_max"),
    ("winches", "drum", "fleet_angle_max"),
    ("winches", "drum", "dead_turns"),
    ("platform", "mass"),
    ("platform", "wrench"),
)


def demand_sense(keys: tuple[Key, ...]) -> int | None:
    """Return 1 where more in a field of a study asks for more, -1 where less does, 0 where neither.

    None where a field is what the robot is, and not what is asked of it.
    """
    is_asked = keys[0] in _ASKED and keys[:2] not in _OF_ROBOT
    is_asked |= keys[0] == "robot" and any(keys[1 : 1 + len(k)] == k for k in _ASKED_OF_ROBOT)
    is_asked |= keys == ("cable", "safety_factor")
    is_of_a_winch = keys[:3] == ("robot", "winches", "tension_max")  # a list has one for each
    return _SENSES.get(str(keys[2 if is_of_a_winch else -1]), 0) if is_asked else None


_SPEC = (
    "[low, high], or {fields: [robot.anchors.*.2], bounds: [9 m, 13 m]}, or offset: [-1 m, 1 m] "
    "in place of bounds"
)
_EVERY = "*"


def variables_of(document: Document, study: Document, faults: list[Fault]) -> tuple[Variable, ...]:
    """Return the variables of a file; those that are wrong are left out, with a fault more."""
    root = document.root.child("variables")
    assert root is not None and isinstance(root.content, dict)
    variables: list[Variable] = []
    owners: dict[str, str] = {}
    for name, node in root.content.items():
        try:
            variable = _variable(name, node, study.root)
            _check_values(variable, study)
        except _WrongError as error:
            faults.append(document.fault(("variables", name, *error.keys), *error.args))
            continue
        for field in variable.fields:
            if field in owners:
                problem = f"{field} is set by '{owners[field]}' already"
                faults.append(document.fault(("variables", name), problem, "each field once"))
            owners[field] = name
        variables.append(variable)
    return tuple(variables)


class _WrongError(Exception):
    """What is wrong with a variable, what was expected, and where in it."""

    def __init__(self, problem: str, expected: str = _SPEC, *keys: Key) -> None:
        super().__init__(problem, expected)
        self.keys = keys


def _variable(name: str, node: Node, study: Node) -> Variable:
    if not isinstance(node.content, dict):
        low, high, unit = _ends(node)
        return _tied(name, {name: 1.0}, low, high, unit, study, is_offset=False)
    unknown = [key for key in node.content if key not in ("fields", "bounds", "offset")]
    if unknown:
        raise _WrongError(f"unknown field '{unknown[0]}'", "one of fields, bounds, offset")
    bounds, offset = node.child("bounds"), node.child("offset")
    interval = bounds or offset
    if interval is None or (bounds and offset):
        raise _WrongError("has not one of bounds and offset")
    low, high, unit = _ends(interval)
    factors = _factors(name, node.child("fields"))
    return _tied(name, factors, low, high, unit, study, is_offset=offset is not None)


def _ends(node: Node) -> tuple[float, float, str]:
    """Return both ends of a range, and their unit."""
    content = node.content if isinstance(node.content, tuple) else ()
    ends = [part for part in (child.quantity() for child in content) if part is not None]
    if len(content) != 2 or len(ends) != 2:
        raise _WrongError(f"{describe(node.data())} is no range")
    (low, unit), (high, high_unit) = ends
    if unit != high_unit:
        raise _WrongError(f"its bounds are in '{unit}' and '{high_unit}'", "both in one unit")
    if not low < high:
        texts = f"{low:g} {unit}".rstrip(), f"{high:g} {unit}".rstrip()
        raise _WrongError(f"the lower bound {texts[0]} is not below {texts[1]}", "[lower, upper]")
    return low, high, unit


def _factors(name: str, node: Node | None) -> dict[str, float]:
    """Return the fields of a variable, each with what its value is multiplied by there."""
    if node is None:
        return {name: 1.0}
    if isinstance(node.content, str):
        return {node.content: 1.0}
    if isinstance(node.content, tuple):
        texts = [child.content for child in node.content]
        fields = [text for text in texts if isinstance(text, str)]
        if not fields or len(fields) < len(texts):
            expected = "paths such as robot.anchors.0.2; in brackets without brackets of their own"
            raise _WrongError("is no list of fields", expected, "fields")
        return dict.fromkeys(fields, 1.0)
    factors = {}
    for field, child in node.content.items():
        part = child.quantity()
        if part is None or part[1] or not part[0]:
            raise _WrongError(f"{describe(child.data())} is no factor", "such as 1 or -1", "fields")
        factors[field] = part[0]
    return factors


def _tied(
    name: str,
    factors: dict[str, float],
    low: float,
    high: float,
    unit: str,
    study: Node,
    *,
    is_offset: bool,
) -> Variable:
    ties, values = [], []
    for field, factor in factors.items():
        for keys in _spread(path_keys(field), study, field):
            node = study.at(keys)
            written = None if node is None else node.quantity()
            if written is None and is_offset:
                problem = f"{field}: the study has no number there"
                raise _WrongError(problem, "bounds, or a field that the study gives")
            ties.append(_tie(keys, factor, unit, written, is_offset=is_offset))
            if is_offset:
                values.append(0.0)
            elif written is not None:
                value, own_unit = written
                in_unit = value if own_unit == unit else _SI(value, own_unit) / _SI(1.0, unit)
                values.append(in_unit / factor)
    agree = len(values) == len(ties) and max(values) - min(values) <= 1e-9 * (high - low)
    initial = float(f"{values[0]:.10g}") if agree else None
    return Variable(name, tuple(ties), low, high, unit, initial, is_offset)


def _spread(keys: tuple[Key, ...], study: Node, field: str) -> list[tuple[Key, ...]]:
    """Return the paths that one with ``*`` stands for: every item of the list there."""
    if _EVERY not in keys:
        return [keys]
    at = keys.index(_EVERY)
    node = study.at(keys[:at])
    if node is None or not isinstance(node.content, tuple):
        raise _WrongError(f"{field}: the study has no list there", "the path of a list before '*'")
    paths = ((*keys[:at], k, *keys[at + 1 :]) for k in range(len(node.content)))
    return list(chain.from_iterable(_spread(path, study, field) for path in paths))


def _tie(
    keys: tuple[Key, ...],
    factor: float,
    unit: str,
    written: tuple[float, str] | None,
    *,
    is_offset: bool,
) -> Tie:
    """Return the tie of a field, which keeps the unit that the study has there where it can."""
    own_unit = unit if written is None else written[1]
    scale = 1.0 if own_unit == unit else _SI(1.0, unit)
    origin = written[0] if is_offset and written is not None else 0.0
    if own_unit not in (unit, ""):
        return Tie(keys, _SI(origin, own_unit), factor * scale, "")
    return Tie(keys, origin, factor * scale, own_unit)


def _SI(value: float, unit: str) -> float:
    try:
        return in_SI(f"{value!r} {unit}")
    except QuantityError as error:
        raise _WrongError(error.problem, error.expected) from None


def _in_bounds_unit(variable: Variable, tie: Tie, value: float) -> Node:
    """Return a value of a field in the unit of the bounds, which may be one of another kind."""
    node, unit = tie.node(value), variable.unit
    if unit == tie.unit:
        return node
    return Node(1, f"{float(node.as_written()) / _SI(1.0, unit):.10g} {unit}")


def _check_values(variable: Variable, study: Document) -> None:
    """Refuse a field that there is not, bounds that it cannot have by itself, and whole numbers."""
    # Within its bounds a variable takes any value, which a whole number cannot.
    between = variable.low + (variable.high - variable.low) / math.pi
    values = (variable.low, variable.high, between)
    for tie, value in ((tie, value) for tie in variable.ties for value in values):
        field = path_text(tie.keys)
        try:
            root = study.root.with_value(tie.keys, _in_bounds_unit(variable, tie, value))
        except KeyError:
            raise _WrongError(f"{field}: the study has no such field", "its path there") from None
        try:
            StudySection.model_validate(root.data())
        except ValidationError as error:
            fault = schema_faults(error, study, StudySection)[0]
            raise _WrongError(f"{field}: {fault.problem}", fault.expected) from None
