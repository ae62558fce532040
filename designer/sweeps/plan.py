"""What a sweep varies and keeps, read from ``SWEEP.yaml``; and one of its studies, solved.

The points, and the kind of each result, are determined before the sweep begins. A point that is no
valid study, or fails, is a result with its reason.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, ValidationError

from designer import __version__
from designer.analysis.analyse import Analysis
from designer.analysis.pose import analyse_pose
from designer.analysis.result_json import result_part, size_dict
from designer.arrays import FloatArray
from designer.documents.document import (
    Document,
    FileKind,
    Key,
    Node,
    path_keys,
    path_text,
    read_document,
)
from designer.documents.fields import (
    FreeMapping,
    Section,
    Text,
    WholeNumber,
    different,
    list_of,
    schema_faults,
)
from designer.documents.plain import Json
from designer.effects.load import load_effects
from designer.effects.registry import KnownEffects
from designer.errors import DesignerError, Fault, InputError, described
from designer.grades.registry import Catalogue, cached_catalogue
from designer.io.config.reader import checked, study_of
from designer.model.verdict import Verdict
from designer.plugins import Plugins, find_plugins
from designer.selection.candidate import common_currency, offered, with_prices
from designer.spelling import did_you_mean
from designer.study import Study
from designer.units import describe

Change = tuple[tuple[Key, ...], Node]


MOST_POINTS = 10_000_000


@dataclass(frozen=True, slots=True)
class Base:
    """The study that a sweep starts from, and what is kept of those made of it."""

    document: Document
    keep: tuple[str, ...]  #: paths into ``result.json``
    with_plugins: bool = True

    def study(self, changes: Sequence[Change] = ()) -> Study:
        """Return the study with some values put in.

        Raises
        ------
        InputError
            If it is none then.
        """
        root = self.document.root
        for keys, node in changes:
            root = root.with_value(keys, node)
        plugins, effects = _plugins(self.with_plugins)
        document = replace(self.document, root=root)
        path = Path(document.name)
        return study_of(checked(document, effects), document, path, effects, plugins)

    def catalogue(self, study: Study | None = None) -> Catalogue:
        """Return the grades that its studies, or one of them, choose from."""
        return cached_catalogue((study or self.study()).catalogues, _plugins(self.with_plugins)[0])

    def result(self, study: Study) -> Json:
        """Return as much of ``result.json`` as what is kept of it asks for."""
        parts = {name.split(".")[0] for name in self.keep}
        if parts <= {"pose", "name"}:
            return size_dict(study, analyse_pose(study), self.keep)
        # A proof may take its whole budget for each of thousands of studies.
        if "proof" not in parts:
            study = study.unproved
        return result_part(Analysis.begin(study, self.catalogue(study), keep=self.keep))


@cache
def _plugins(with_plugins: bool) -> tuple[Plugins, KnownEffects]:
    plugins = find_plugins(with_plugins)
    return plugins, load_effects(plugins)


def value_at(result: Json, path: str) -> Any:
    """Return what a result holds at a path such as ``selection.chosen.utilisation``.

    None where a part on the way is None: there is no such result.

    Raises
    ------
    KeyError
        If results never have it; carries the names that there are in its place.
    """
    value: Any = result
    for key in path.split("."):
        if value is None:
            return None
        names = list(map(str, range(len(value)))) if isinstance(value, list) else value
        if not isinstance(names, dict | list) or key not in names:
            raise KeyError(key, list(names) if isinstance(names, dict | list) else [])
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


def why_no_value(error: KeyError) -> tuple[str, str]:
    """Return the problem with a path that `value_at` refuses, and what was expected."""
    key, names = error.args
    expected = f"one of {', '.join(names[:20])}{did_you_mean(key, names)}"
    return f"results have no '{key}' there", expected


def solve_points(base: Base, points: Sequence[Sequence[Change]]) -> list[tuple[list[Any], str]]:
    """Return of each point what is kept, and why there is nothing of it where there is not.

    A study that is none, or fails, is a result like others: one of many must not end the rest.
    Runs on one thread: as many processes as processors are at work.
    """
    import numba
    from threadpoolctl import threadpool_limits

    numba.set_num_threads(1)
    with threadpool_limits(1):
        return [_solve(base, changes) for changes in points]


def _solve(base: Base, changes: Sequence[Change]) -> tuple[list[Any], str]:
    try:
        result = base.result(base.study(changes))
    except Exception as error:  # whatever a plugin or a library may raise
        return [None] * len(base.keep), why_not(error)
    values: list[Any] = []
    reasons = [why_negative(result)]
    for name in base.keep:
        try:
            values.append(value_at(result, name))
        except KeyError:  # such as the tension of a fourth cable where there are three
            values.append(None)
            reasons.append(f"there is no {name} here")
    return values, "; ".join(filter(None, reasons))


def why_not(error: Exception) -> str:
    """Return in a line why a study gave no result."""
    if isinstance(error, InputError):
        fault = error.faults[0]
        expected = f" (expected {fault.expected})" if fault.expected else ""
        return f"{fault.field}: {fault.problem}{expected}"
    if isinstance(error, DesignerError):
        return str(error).partition("\n")[0]
    if isinstance(error, KeyError):
        return f"there is no {error.args[0]} in this result"
    return described(error)


def why_negative(result: Json) -> str:
    """Return why a result is no answer, in a line; empty where it is one."""
    pose = result.get("pose")
    if pose is not None and pose["sagging"]["status"] != "solved":
        return f"the configured pose: {Verdict[pose['sagging']['status'].upper()].reason}"
    answer, workspace = result.get("answer"), result.get("workspace")
    if answer is None:  # not evaluated: what is kept does not take it
        is_held = workspace is None or workspace["sagging"] is not None
        return "" if is_held else "no cable of the family holds in all of the workspace"
    return "; ".join(
        f"{requirement['id']} in {requirement['load_case']}: {requirement['state']}"
        for requirement in answer["reasons"]
    )


@dataclass(frozen=True, slots=True)
class Range:
    """Evenly spread values of a field, in the unit that both ends have in the file."""

    keys: tuple[Key, ...]
    low: float
    high: float
    unit: str
    count: int | None = None

    def values(self) -> FloatArray:
        """Return those of a grid."""
        return np.linspace(self.low, self.high, self.count or 1)

    def at(self, share: FloatArray) -> FloatArray:
        """Return those at shares of the range, each from 0 to 1."""
        return self.low + share * (self.high - self.low)

    def node(self, value: float) -> Node:
        """Return a value as the study would have it."""
        return Node(1, f"{float(value)!r} {self.unit}".rstrip(), is_plain=not self.unit)


@dataclass(frozen=True, slots=True)
class ValueList:
    """Values of a field, as a list."""

    keys: tuple[Key, ...]
    nodes: tuple[Node, ...]
    unit: str = ""
    numbers: FloatArray | None = None  #: the values, if all are numbers of one unit

    @property
    def labels(self) -> FloatArray | np.ndarray:
        """What the store holds for each."""
        if self.numbers is not None:
            return self.numbers
        return np.array([node.as_written() for node in self.nodes], dtype=object)


@dataclass(frozen=True, slots=True)
class SweptField:
    """The values of one field at all points."""

    varied: Range | ValueList
    values: np.ndarray  #: (n_points,) numbers of a range, or indices into a list

    @property
    def name(self) -> str:
        """The field's path, such as ``robot.platform.mass``."""
        return path_text(self.varied.keys)

    @property
    def stored(self) -> np.ndarray:
        """Numbers, or texts, one a point."""
        return self.values if isinstance(self.varied, Range) else self.varied.labels[self.values]

    def node(self, point: int) -> Node:
        """Return the value at a point as the study would have it."""
        value = self.values[point]
        return (
            self.varied.node(value) if isinstance(self.varied, Range) else self.varied.nodes[value]
        )


@dataclass(frozen=True, slots=True)
class SweepPlan:
    """A sweep: the study it starts from, its points, what is kept of each."""

    base: Base  #: the study, as it is written, and what is kept of each
    columns: tuple[SweptField, ...]  #: the fields that are varied
    #: of each path that is kept, whether it is a number (`float`) or a text (`str`)
    kinds: Mapping[str, type]
    #: of numbers that are kept: 1 for the less the better, -1 for the more the better
    goals: Mapping[str, int]
    #: of prices that are kept: their currency as ``units``, and ``estimate`` where they are
    #: borrowed; the same at all points
    attributes: Mapping[str, Mapping[str, str]]
    digest: str  #: SHA-256 of all that the results depend on

    @property
    def n_points(self) -> int:
        """How many studies there are."""
        return len(self.columns[0].values)

    def changes(self, point: int) -> list[tuple[tuple[Key, ...], Node]]:
        """Return what a point changes in the study."""
        return [(column.varied.keys, column.node(point)) for column in self.columns]


def columns_of(
    varied: tuple[Range | ValueList, ...], sampling: str, points: int, seed: int
) -> tuple[SweptField, ...]:
    """Return the values at all points; on a grid the last field varies fastest.

    ``points`` and ``seed`` are those of ``random`` and ``latin_hypercube`` (McKay, Beckman and
    Conover, Technometrics 21, 1979).
    """
    if sampling == "grid":
        axes = [
            field.values() if isinstance(field, Range) else np.arange(len(field.nodes))
            for field in varied
        ]
        grids = np.meshgrid(*axes, indexing="ij")
        return tuple(
            SweptField(field, grid.ravel()) for field, grid in zip(varied, grids, strict=True)
        )
    from scipy.stats import qmc

    if sampling == "random":
        shares = np.random.default_rng(seed).random((points, len(varied)))
    else:
        shares = qmc.LatinHypercube(len(varied), rng=seed).random(points)
    return tuple(
        SweptField(
            field,
            field.at(share)
            if isinstance(field, Range)
            else np.minimum((share * len(field.nodes)).astype(int), len(field.nodes) - 1),
        )
        for field, share in zip(varied, shares.T, strict=True)
    )


SWEEP = FileKind("a sweep, with study, vary and keep", "study: crane.yaml")
_LISTED = "a list of values, or {from: 100 kg, to: 300 kg, count: 21}"
_KEPT = "a list of paths into result.json, such as [selection.chosen.utilisation]"
Count = Annotated[int, WholeNumber(1, MOST_POINTS)]
Paths = Annotated[tuple[Text, ...], list_of(1, 100, _KEPT), AfterValidator(different)]
Goals = Annotated[tuple[Text, ...], list_of(0, 100, _KEPT)]


class SweepSection(Section):
    """The whole file."""

    study: Text = Field(description="the path of a study, such as crane.yaml")
    vary: FreeMapping = Field(description="a mapping from fields of the study to their values")
    keep: Paths = Field(description=_KEPT)
    sampling: Literal["grid", "random", "latin_hypercube"] = "grid"
    points: Count | None = None
    seed: Annotated[int, WholeNumber(0, 2**32 - 1)] = 0
    minimise: Goals = ()
    maximise: Goals = ()


def read_sweep(path: Path, with_plugins: bool) -> SweepPlan:
    """Return the plan of a sweep, and the study that it starts from.

    That study is solved once, to know what results there are to keep.

    Raises
    ------
    InputError
        If anything is wrong with the sweep, or with its study.
    """
    document = read_document(path, SWEEP)
    faults = list(document.faults)
    try:
        section = SweepSection.model_validate(document.root.data())
    except ValidationError as error:
        raise InputError([*faults, *schema_faults(error, document, SweepSection)]) from None
    faults += _faults_of_sampling(document, section)
    varied = {name: _varied(document, name, section.sampling, faults) for name in section.vary}
    _refuse(faults)
    fields = {name: field for name, field in varied.items() if field is not None}
    faults += _faults_of_points(document, section, fields)
    _refuse(faults)
    study_path = path.parent / section.study
    base = Base(read_document(study_path), section.keep, with_plugins)
    faults += _faults_of_fields(document, base, fields)
    _refuse(faults)
    kinds = _kinds(document, base)
    goals = _goals(document, section, kinds)
    columns = columns_of(
        tuple(fields.values()), section.sampling, section.points or 0, section.seed
    )
    studies = [base.study()]
    for field in fields.values():  # a value that is no number may name another file
        if isinstance(field, ValueList) and field.numbers is None:
            for node in field.nodes:
                with suppress(InputError):  # such points are stored with their reason
                    studies.append(base.study([(field.keys, node)]))
    files = [source.sha256 for study in studies for source in base.catalogue(study).sources]
    files += [sha256 for study in studies for _, sha256 in study.source.tables]
    origin = [document.root.as_written(), base.document.sha256, *dict.fromkeys(files), __version__]
    digest = hashlib.sha256(json.dumps(origin).encode()).hexdigest()
    attributes = _price_attributes(document, studies, base)
    return SweepPlan(base, columns, kinds, goals, attributes, digest)


def _price_attributes(
    document: Document, studies: Sequence[Study], base: Base
) -> dict[str, dict[str, str]]:
    """Return the currency of each price that is kept, and what is borrowed.

    Raises
    ------
    InputError
        If these are not the same at all points.
    """
    names = [name for name in base.keep if name.endswith(".cost")]
    if not names:
        return {}
    kinds: list[dict[str, str]] = []
    for study in studies:
        prices = _attributes_of_prices(study, base)
        if prices and prices not in kinds:
            kinds.append(prices)
    if len(kinds) > 1:
        words = " and ".join(
            f"borrowed in {prices['units']}" if "estimate" in prices else f"in {prices['units']}"
            for prices in kinds
        )
        expected = "points whose prices can be compared, or no prices in keep"
        _refuse([document.fault(("vary",), f"its points have prices {words}", expected)])
    return dict.fromkeys(names, kinds[0] if kinds else {})


def _attributes_of_prices(study: Study, base: Base) -> dict[str, str]:
    """Return ``units``, and ``estimate`` where a study borrows its prices; nothing without any."""
    if study.selection is None:
        return {}
    grades = base.catalogue(study).grades
    _, estimate = with_prices(grades, study.selection)
    currency = common_currency(offered(grades, study.selection))
    if currency is None:
        return {}
    if estimate is None:
        return {"units": currency}
    share = f"may be {estimate.low:g} to {estimate.high:g} times as much"
    words = f"borrowed, of {estimate.year}, {share}: {estimate.source}"
    return {"units": currency, "estimate": words}


def _refuse(faults: Sequence[Fault]) -> None:
    if faults:
        raise InputError(faults)


def _faults_of_sampling(document: Document, section: SweepSection) -> Iterator[Fault]:
    if not section.vary:
        yield document.fault(("vary",), "the mapping is empty", "at least one field of the study")
    if section.sampling == "grid" and section.points is not None:
        expected = "a count for each field, or sampling: random or latin_hypercube"
        yield document.fault(("points",), "a grid has no number of points of its own", expected)
    if section.sampling != "grid" and section.points is None:
        yield document.fault(("points",), "is missing", f"how many, for {section.sampling}")


def _faults_of_points(
    document: Document, section: SweepSection, varied: Mapping[str, Range | ValueList]
) -> Iterator[Fault]:
    """Yield a fault where two columns of the store would have one name, or there are too many."""
    names = {*section.keep, "done", "reason"}
    for name, field in varied.items():
        if path_text(field.keys) in names:
            yield document.fault(("vary", name), "is named twice, or is the name of a result", "")
        names.add(path_text(field.keys))
    for name, field in varied.items():
        for inner_name, inner in varied.items():
            if field is not inner and inner.keys[: len(field.keys)] == field.keys != inner.keys:
                # One of the two would stand in the store as if the study had it.
                problem = f"holds {path_text(inner.keys)}, which is varied too"
                yield document.fault(("vary", name), problem, f"one of {name} and {inner_name}")
    counts = [
        field.count or 1 if isinstance(field, Range) else len(field.nodes)
        for field in varied.values()
    ]
    if section.sampling == "grid" and math.prod(counts) > MOST_POINTS:
        expected = f"{MOST_POINTS:,} at most, or latin_hypercube"
        yield document.fault(("vary",), f"the grid has {math.prod(counts):.3g} points", expected)


def _varied(
    document: Document, name: str, sampling: str, faults: list[Fault]
) -> Range | ValueList | None:
    """Return what one entry of ``vary`` asks for; None, with a fault more, where it is wrong."""
    place: tuple[Key, ...] = ("vary", name)
    node = document.root.at(place)
    assert node is not None
    if isinstance(node.content, tuple) and node.content:
        parts = [item.quantity() for item in node.content]
        units = {None if part is None else part[1] for part in parts}
        if None in units or len(units) > 1:
            return ValueList(path_keys(name), node.content)
        numbers = np.array([part[0] for part in parts if part is not None])
        return ValueList(path_keys(name), node.content, units.pop() or "", numbers)
    if not isinstance(node.content, dict):
        problem = (
            "the list is empty" if node.content == () else f"{describe(node.data())} is no list"
        )
        faults.append(document.fault(place, problem, _LISTED))
        return None
    ends = (node.child(key) for key in ("from", "to", "count"))
    low, high, count = (None if end is None else end.quantity() for end in ends)
    unknown = [key for key in node.content if key not in ("from", "to", "count")]
    if unknown:
        problem = f"unknown field '{unknown[0]}'"
    elif low is None or high is None:
        problem = "has no two numbers 'from' and 'to'"
    elif low[1] != high[1]:
        problem = f"its ends are in '{low[1]}' and '{high[1]}'"
    elif sampling == "grid" and (count is None or count[1] or not 1 <= count[0] <= MOST_POINTS):
        problem = "has no whole number 'count'"
    elif sampling == "grid" and count is not None and count[0] == 1 and low[0] != high[0]:
        problem = "has a count of 1, which does not reach from one end to the other"
    elif sampling != "grid" and count is not None:
        problem = f"has a count, which {sampling} does not ask for"
    else:
        n = None if count is None else int(count[0])
        return Range(path_keys(name), low[0], high[0], low[1], n)
    faults.append(document.fault(place, problem, f"{_LISTED}; both ends in one unit"))
    return None


def _faults_of_fields(
    document: Document, base: Base, varied: Mapping[str, Range | ValueList]
) -> Iterator[Fault]:
    """Yield a fault for each field that the study cannot have.

    A value that it cannot have is no fault of the sweep: those points are kept with their reason.
    """
    base.study()
    for name, field in varied.items():
        node = field.node(field.low) if isinstance(field, Range) else field.nodes[0]
        try:
            base.study([(field.keys, node)])
        except KeyError:
            yield document.fault(("vary", name), "the study has no such field", "its path there")
        except InputError as error:
            for fault in error.faults:
                if fault.problem.startswith("unknown field"):
                    yield document.fault(("vary", name), fault.problem, fault.expected)


def _kinds(document: Document, base: Base) -> dict[str, type]:
    """Return which kept values are numbers and which texts, from the study as it is."""
    result = base.result(base.study())
    kinds: dict[str, type] = {}
    faults = []
    for index, name in enumerate(base.keep):
        problem = expected = ""
        try:
            value: Any = value_at(result, name)
        except KeyError as error:
            value = None
            problem, expected = why_no_value(error)
        if isinstance(value, dict | list):
            problem = f"{name} holds several values"
            inner = list(value) if isinstance(value, dict) else range(len(value))
            expected = ", ".join(f"{name}.{key}" for key in list(inner)[:8])
        if problem:
            faults.append(document.fault(("keep", index), problem, expected))
        kinds[name] = str if isinstance(value, str) else float
    _refuse(faults)
    return kinds


def _goals(document: Document, section: SweepSection, kinds: dict[str, type]) -> dict[str, int]:
    """Return of each number that is kept whether less of it is better; all, if none is named."""
    numbers = [name for name, kind in kinds.items() if kind is float]
    named = [(name, 1, "minimise") for name in section.minimise]
    named += [(name, -1, "maximise") for name in section.maximise]
    faults = [
        document.fault((field,), f"{describe(name)} is no number that is kept", ", ".join(numbers))
        for name, _, field in named
        if name not in numbers
    ]
    _refuse(faults)
    return {name: sign for name, sign, _ in named} or dict.fromkeys(numbers, 1)
