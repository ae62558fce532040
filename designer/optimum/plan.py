"""What an optimisation varies, for what, within which limits: read from ``OPTIMISE.yaml``.

A variable sets one or more fields of the study, each a linear function of its value in the unit
that the study has there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from designer.arrays import FloatArray
from designer.documents import edits
from designer.documents.document import (
    Document,
    FileKind,
    Key,
    Node,
    decode,
    document_of,
    path_keys,
    path_text,
    read_document,
)
from designer.documents.fields import (
    FreeMapping,
    QuantityField,
    Section,
    Text,
    WholeNumber,
    schema_faults,
)
from designer.documents.opened import read_bytes
from designer.errors import Fault, InputError
from designer.io.config.schema import StudySection
from designer.model.region import Prism, Rectangle
from designer.optimum.measures import MEASURES, Measure, for_study, measure_at
from designer.selection.candidate import common_currency, offered, with_prices
from designer.spelling import did_you_mean
from designer.study import Study
from designer.sweeps.plan import Base, Change, value_at, why_no_value
from designer.units import TIME, QuantityError, describe, in_SI, read_quantity

_RANGE_RTOL = 1e-9
"""Of a range: what reading its bounds in another unit may change."""
_STEPS = 1000
"""A bound's range has so many steps, or up to ten times as many: no mast is set to a micrometre."""
_LIMIT_RTOL = 1e-9
"""What rounding may break a limit by."""
Values = tuple[float, ...]
"""One for each variable, in its unit."""


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
    """One thing to choose."""

    name: str  #: as the file calls it
    ties: tuple[Tie, ...]  #: the fields of the study that it sets
    low: float
    high: float
    unit: str  #: of both bounds, as the file has it; empty for SI
    given: float | None  #: the value in the study as it is; None where its fields differ
    is_offset: bool  #: whether it is a change of what the study has

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
        return -_RANGE_RTOL <= self.share(value) <= 1.0 + _RANGE_RTOL

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
            # A field keeps the unit that the study has there where it can.
            own_unit = unit if written is None else written[1]
            origin = written[0] if is_offset and written is not None else 0.0
            slope = factor * (1.0 if own_unit == unit else _SI(1.0, unit))
            if own_unit not in (unit, ""):
                origin, own_unit = _SI(origin, own_unit), ""
            ties.append(Tie(keys, origin, slope, own_unit))
            if is_offset:
                values.append(0.0)
            elif written is not None:
                value, stated_unit = written
                in_unit = value if stated_unit == unit else _SI(*written) / _SI(1.0, unit)
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


def _SI(value: float, unit: str) -> float:
    try:
        return in_SI(f"{value!r} {unit}")
    except QuantityError as error:
        raise _WrongError(error.problem, error.expected) from None


def _check_values(variable: Variable, study: Document) -> None:
    """Refuse a field that there is not, bounds that it cannot have by itself, and whole numbers."""
    # Within its bounds a variable takes any value, which a whole number cannot.
    between = variable.low + (variable.high - variable.low) / math.pi
    values = (variable.low, variable.high, between)
    for tie, value in ((tie, value) for tie in variable.ties for value in values):
        field, node, unit = path_text(tie.keys), tie.node(value), variable.unit
        if unit != tie.unit:  # the bounds may be of another kind than the field
            node = Node(1, f"{float(node.as_written()) / _SI(1.0, unit):.10g} {unit}")
        try:
            root = study.root.with_value(tie.keys, node)
        except KeyError:
            raise _WrongError(f"{field}: the study has no such field", "its path there") from None
        try:
            StudySection.model_validate(root.data())
        except ValidationError as error:
            fault = schema_faults(error, study, StudySection)[0]
            raise _WrongError(f"{field}: {fault.problem}", fault.expected) from None


@dataclass(frozen=True, slots=True)
class Limit:
    """What a result may be ``at most``, or ``at least``: a value [SI]."""

    measure: Measure
    value: float
    words: Literal["at most", "at least"]

    def excess(self, value: float) -> float:
        """Return by how much a value breaks it, over the limit; zero where it is kept."""
        beyond = value - self.value if self.words == "at most" else self.value - value
        return max(beyond, 0.0) / (abs(self.value) or 1.0)

    def is_broken_by(self, result: Mapping[str, Any]) -> bool:
        """Tell whether a whole result breaks it, or does not have it."""
        value = self.measure.value(result)
        return value is None or self.excess(value) > _LIMIT_RTOL


@dataclass(frozen=True, slots=True, eq=False)
class OptimisationPlan:
    """An optimisation."""

    name: str  #: of its file
    document: Document  #: the study as it is
    #: the study that designs are made from, as text: its region does not follow its anchors
    text: str
    base: Base  #: the same, to put values into
    region_stays: bool  #: whether the text had to be changed for that
    variables: tuple[Variable, ...]
    objective: Measure
    limits: tuple[Limit, ...]
    evaluations: int  #: designs that are tried at most
    time_s: float | None  #: for how long [s]; None for no limit
    starts: int  #: searches from different populations
    seed: int
    samples: int  #: poses tried of each design

    def values(self, shares: FloatArray) -> Values:
        """Return the values at shares of the ranges (n_variables,)."""
        return tuple(v.at(float(x)) for v, x in zip(self.variables, shares, strict=True))

    def shares(self, values: Values) -> FloatArray:
        """Return where in the ranges values lie (n_variables,), from 0 to 1 within the bounds."""
        return np.array([v.share(x) for v, x in zip(self.variables, values, strict=True)])

    def is_within(self, values: Values) -> bool:
        """Tell whether a design lies within all bounds, which the study as it is need not do."""
        return all(v.is_within(x) for v, x in zip(self.variables, values, strict=True))

    def changes(self, values: Values) -> list[Change]:
        """Return what these values put into the study."""
        pairs = zip(self.variables, values, strict=True)
        return [(tie.keys, tie.node(value)) for variable, value in pairs for tie in variable.ties]

    @property
    def given(self) -> Values | None:
        """Return the values of the study as it is; None where a variable has none."""
        values = tuple(v.given for v in self.variables if v.given is not None)
        return values if len(values) == len(self.variables) else None


OPTIMISATION = FileKind("an optimisation, with study, variables and objective", "study: crane.yaml")
_OBJECTIVE = f"{', '.join(MEASURES)}, or {{minimise: a path into result.json}}"
_LIMIT = "a quantity, or {at_most: 5 kN}, or {at_least: 0.2 m}"
_FIRST_EVALUATIONS, _EVALUATIONS_EACH = 150, 150
Time = Annotated[float, QuantityField(TIME, above=0.0, at_most=1e6)]


class BudgetSection(Section):
    """When the search ends."""

    evaluations: Annotated[int, WholeNumber(10, 1_000_000)] | None = None
    time: Time | None = None


class OptimiseSection(Section):
    """The whole file."""

    study: Text = Field(description="the path of a study, such as crane.yaml")
    variables: FreeMapping = Field(description="a mapping from fields of the study to bounds")
    objective: Any = Field(description=_OBJECTIVE)
    constraints: FreeMapping = Field(default_factory=dict)
    budget: BudgetSection = BudgetSection()
    starts: Annotated[int, WholeNumber(1, 20)] = 2
    seed: Annotated[int, WholeNumber(0, 2**31)] = 0
    samples: Annotated[int, WholeNumber(20, 100_000)] = 300
    region: Literal["stays", "follows"] = "stays"


def read_optimisation(path: Path, with_plugins: bool) -> OptimisationPlan:
    """Return the plan of an optimisation.

    Raises
    ------
    InputError
        If anything is wrong with it, or with its study.
    """
    document = read_document(path, OPTIMISATION)
    faults = list(document.faults)
    try:
        section = OptimiseSection.model_validate(document.root.data())
    except ValidationError as error:
        raise InputError([*faults, *schema_faults(error, document, OptimiseSection)]) from None
    if not section.variables:
        expected = "at least one field of the study"
        faults.append(document.fault(("variables",), "the mapping is empty", expected))
    study_path = path.parent / section.study
    raw = read_bytes(study_path, str(study_path))
    text = decode(raw, str(study_path))
    original = document_of(raw, str(study_path))
    study = Base(original, (), with_plugins).study()
    variables = variables_of(document, original, faults)
    moves_anchors = any("anchors" in tie.keys for variable in variables for tie in variable.ties)
    fixed = _with_fixed_regions(text, original, study) if moves_anchors else text
    if section.region == "follows":
        fixed = text
    objective = _objective(document, section.objective, faults)
    limits = _limits(document, section.constraints, faults)
    measures = [measure for measure in (objective, *(limit.measure for limit in limits)) if measure]
    keep = tuple(measure.path for measure in measures)
    if study.workspace is not None:  # all that the study asks for constrains the search
        keep += ("answer",)
    base = Base(document_of(fixed.encode(), str(study_path)), keep, with_plugins)
    faults += _faults_of_measures(document, study, measures, base)
    if faults or objective is None:
        raise InputError(faults)
    evaluations = _FIRST_EVALUATIONS + _EVALUATIONS_EACH * len(variables)
    return OptimisationPlan(
        name=path.stem,
        document=original,
        text=fixed,
        base=base,
        region_stays=fixed != text,
        variables=variables,
        objective=_as_sold(for_study(objective, study), base),
        limits=tuple(
            replace(limit, measure=_as_sold(for_study(limit.measure, study), base))
            for limit in limits
        ),
        evaluations=section.budget.evaluations or evaluations,
        time_s=section.budget.time,
        starts=section.starts,
        seed=section.seed,
        samples=section.samples,
    )


def _with_fixed_regions(text: str, document: Document, study: Study) -> str:
    """Return a study whose regions stay where they are when its anchors move."""
    cases = document.root.child("load_cases")
    count = len(cases.content) if cases is not None and isinstance(cases.content, tuple) else 0
    places: list[tuple[Key, ...]] = [("workspace", "region")]
    places += [("load_cases", k, "region") for k in range(count)]
    anchors = study.robot.exit_points_m
    for place in places:
        for shape in ("prism", "rectangle"):
            written = edits.value_text(text, (*place, shape))
            if written is not None and written.strip("'\"") == "anchors":
                flat = (0.0, 1.0)
                if shape == "prism":
                    corners = Prism.over(anchors, 0.0, flat).polygon_m
                else:
                    corners = Rectangle.over(anchors, 0.0, flat).ends_m
                rounded = np.round(corners, 9) + 0.0
                points = ", ".join(f"[{x:.10g}, {y:.10g}]" for x, y in rounded)
                text = edits.with_value(text, (*place, shape), f"[{points}]")
    return text


def _objective(document: Document, value: Any, faults: list[Fault]) -> Measure | None:
    if isinstance(value, str) and value in MEASURES:
        return MEASURES[value]
    if isinstance(value, dict) and len(value) == 1:
        ((goal, path),) = value.items()
        if goal in ("minimise", "maximise") and isinstance(path, str):
            return measure_at(path, 1 if goal == "minimise" else -1)
    name = value if isinstance(value, str) else ""
    expected = _OBJECTIVE + did_you_mean(name, MEASURES)
    faults.append(document.fault(("objective",), f"{describe(value)} is not known", expected))
    return None


def _limits(
    document: Document, constraints: Mapping[str, Any], faults: list[Fault]
) -> tuple[Limit, ...]:
    limits = []
    for name, constraint in constraints.items():
        place: tuple[Key, ...] = ("constraints", name)
        measure = MEASURES.get(name) or measure_at(name)
        usual = "at_most" if measure.sign > 0 else "at_least"
        is_told = isinstance(constraint, dict) and len(constraint) == 1
        ((sense, value),) = constraint.items() if is_told else ((usual, constraint),)
        if sense not in ("at_most", "at_least") or isinstance(value, dict | list):
            faults.append(document.fault(place, f"{describe(value)} is no limit", _LIMIT))
            continue
        try:
            is_named = name in MEASURES
            limit = read_quantity(value, measure.dimension) if is_named else in_SI(value)
        except QuantityError as error:
            faults.append(document.fault(place, error.problem, error.expected))
            continue
        limits.append(Limit(measure, limit, "at most" if sense == "at_most" else "at least"))
    return tuple(limits)


def _faults_of_measures(
    document: Document, study: Study, measures: list[Measure], base: Base
) -> list[Fault]:
    """Return a fault for each measure that results of this study do not have."""
    faults, result = [], None
    for measure in measures:
        is_objective = measure is measures[0]
        place: tuple[Key, ...] = ("objective",) if is_objective else ("constraints", measure.name)
        if measure.name in MEASURES:
            part = "workspace" if measure.name == "diameter" else "selection"
            has_volume = study.workspace is None or study.workspace.region.volume_m3 is not None
            missing = getattr(study, part) is None
            if measure.name == "max_tension" and study.workspace is not None:
                missing = False
            if missing or (measure.name == "usable_volume" and not has_volume):
                problem = f"the study has no {part}" if missing else "the region has no volume"
                expected = f"{part}: in the study, or another objective"
                faults.append(document.fault(place, problem, expected))
            elif (
                measure.name == "rope_cost"
                and study.selection is not None
                and common_currency(offered(base.catalogue().grades, study.selection)) is None
            ):
                expected = "grades with price_per_m, cost in selection.objectives, or rope_mass"
                faults.append(document.fault(place, "no grade of the study has prices", expected))
            continue
        try:
            result = base.result(base.study()) if result is None else result
            value = value_at(result, measure.path)
            if isinstance(value, str | dict | list):
                problem = f"{measure.path} is {'a text' if isinstance(value, str) else 'a list'}"
                faults.append(document.fault(place, problem, "a number of result.json"))
        except KeyError as error:
            problem, expected = why_no_value(error)
            if is_objective:
                expected += f"; or {', '.join(MEASURES)}"
            faults.append(document.fault(place, problem, expected))
    return faults


def _as_sold(measure: Measure, base: Base) -> Measure:
    """Return a measure whose title says where its prices are borrowed."""
    selection = base.study().selection
    if measure.name != "rope_cost" or selection is None:
        return measure
    _, estimate = with_prices(base.catalogue().grades, selection)
    return measure if estimate is None else replace(measure, title=f"estimated {measure.title}")
