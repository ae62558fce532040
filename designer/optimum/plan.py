"""What an optimisation varies, for what, within which limits: read from ``OPTIMISE.yaml``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from designer.arrays import FloatArray
from designer.documents import edits
from designer.documents.document import Document, FileKind, Key, decode, document_of
from designer.documents.document import read_document as read_file
from designer.documents.fields import FreeMapping, QuantityField, Text, WholeNumber
from designer.documents.opened import read_bytes
from designer.documents.section import Section, schema_faults
from designer.errors import Fault, InputError
from designer.model.prism import Prism
from designer.model.rectangle import Rectangle
from designer.optimum.measures import MEASURES, Measure, for_study, measure_at
from designer.optimum.variables import Variable, variables_of
from designer.selection.candidate import common_currency
from designer.selection.prices import offered, with_prices
from designer.spelling import did_you_mean
from designer.study import Study
from designer.sweeps.point import Base, Change, value_at, why_no_value
from designer.units import TIME, QuantityError, describe, in_SI, read_quantity

_ROUNDING = 1e-9
"""Relative: what rounding may break a limit by."""
Values = tuple[float, ...]
"""One for each variable, in its unit."""


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
        return value is None or self.excess(value) > _ROUNDING


@dataclass(frozen=True, slots=True, eq=False)
class OptimisationPlan:
    """An optimisation.

    Parameters
    ----------
    name : str
        Of its file.
    document : Document
        The study as it is.
    text : str
        The study that designs are made from, as text: its region does not follow its anchors.
    base : Base
        The same, to put values into.
    region_stays : bool
        Whether the text had to be changed for that.
    variables, objective, limits
        What is chosen, for what, within what.
    evaluations : int
        Designs that are tried at most.
    time_s : float or None
        For how long [s]; None for no limit.
    starts, seed, samples : int
        Searches from different populations; of their random numbers; poses tried of each design.
    """

    name: str
    document: Document
    text: str
    base: Base
    region_stays: bool
    variables: tuple[Variable, ...]
    objective: Measure
    limits: tuple[Limit, ...]
    evaluations: int
    time_s: float | None
    starts: int
    seed: int
    samples: int

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
    document = read_file(path, OPTIMISATION)
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
            elif measure.name == "rope_cost" and not _has_prices(study, base):
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


def _has_prices(study: Study, base: Base) -> bool:
    selection = study.selection
    grades = [] if selection is None else offered(base.catalogue().grades, selection)
    return common_currency(grades) is not None


def _as_sold(measure: Measure, base: Base) -> Measure:
    """Return a measure whose title says where its prices are borrowed."""
    selection = base.study().selection
    if measure.name != "rope_cost" or selection is None:
        return measure
    _, estimate = with_prices(base.catalogue().grades, selection)
    return measure if estimate is None else replace(measure, title=f"estimated {measure.title}")
