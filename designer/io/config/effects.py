"""Effects that the config says the machine has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from pydantic_core import PydanticCustomError

from designer.documents.bounds import parameter_bound
from designer.documents.fields import QuantityField, WholeNumber
from designer.documents.node import Data, Key, Node, path_text, printable
from designer.effects.names import EffectName, ParameterName
from designer.spelling import did_you_mean, nearest_name
from designer.study import DeclaredEffect, Entry
from designer.units import describe, format_SI

Place = tuple[Key, ...]
_SECTION = "effects"
_MOST_LISTED = 8


@dataclass(frozen=True, slots=True)
class Refusal:
    """What is wrong at one place of the section."""

    place: Place
    problem: str
    expected: str


@dataclass(slots=True)
class Found:
    """The effects of a section, each with its place, and all that is wrong."""

    effects: list[tuple[Place, DeclaredEffect]] = field(default_factory=list)
    refusals: list[Refusal] = field(default_factory=list)

    def refuse(self, place: Place, problem: str, expected: str) -> None:
        """Add something that is wrong."""
        self.refusals.append(Refusal(place, problem, expected))


def read_effects(data: Data, n_cables: int, known: Mapping[str, EffectName]) -> Found:
    """Return what the section ``effects`` says.

    Parameters
    ----------
    data : Data
        What the file holds there.
    n_cables : int
        Number of cables of the robot.
    known : mapping of str to EffectName
        Every effect by its id.
    """
    found = Found()
    for effect_id, given in data.items() if isinstance(data, dict) else ():
        name = known.get(effect_id)
        if name is None:
            problem = f"unknown effect '{printable(effect_id)}'"
            expected = f"one of {', '.join(known)}{did_you_mean(effect_id, known)}"
            found.refuse((_SECTION, effect_id), problem, expected)
        else:
            _read_all(found, name, given, n_cables)
    return found


def effect_entries(
    data: Data, node: Node, n_cables: int, known: Mapping[str, EffectName]
) -> Iterator[Entry]:
    """Yield the rows of the table of inputs for a section without faults."""
    dimensions = {
        (name.id, parameter.name): parameter.dimension
        for name in known.values()
        for parameter in name.parameters_for(n_cables)
    }
    for place, effect in read_effects(data, n_cables, known).effects:
        if effect.cable is not None:
            yield Entry(path_text((*place, "cable")), str(effect.cable), str(effect.cable))
        for name, value in effect.parameters.items():
            given = _written(node, (*place, name))
            shown = format_SI(value, dimensions[effect.id, name])
            yield Entry(path_text((*place, name)), given, shown)


def _written(node: Node, place: Place) -> str:
    found: Node | None = node
    for key in place[1:]:
        found = None if found is None else found.child(key)
    return "default" if found is None else found.as_written()


def _read_all(found: Found, name: EffectName, given: Data, n_cables: int) -> None:
    place: Place = (_SECTION, name.id)
    if not name.takes_cable or not isinstance(given, list):
        _read_one(found, name, place, given, n_cables)
        return
    if not given:
        found.refuse(place, "an empty list", "one mapping for each cable that has this effect")
    for index, item in enumerate(given):
        _read_one(found, name, (*place, index), item, n_cables)
    _refuse_repeated_cables(found, name)


def _refuse_repeated_cables(found: Found, name: EffectName) -> None:
    seen: set[int] = set()
    for place, effect in found.effects:
        if effect.id == name.id and effect.cable is not None:
            if effect.cable in seen:
                problem = f"cable {effect.cable} has this effect already"
                found.refuse((*place, "cable"), problem, "each cable once")
            seen.add(effect.cable)


def _read_one(found: Found, name: EffectName, place: Place, given: Data, n_cables: int) -> None:
    parameters = name.parameters_for(n_cables)
    keys = ["cable"] * name.takes_cable + [one.name for one in parameters]
    if not isinstance(given, dict) or not given:
        problem = f"{_named(given)} is not a mapping with values"
        found.refuse(place, problem, f"a mapping with {_listed(keys)}")
        return
    misspelt = set(_refuse_unknown(found, place, given, keys))
    cable = None
    if name.takes_cable and "cable" not in misspelt:
        cable = _cable(found, (*place, "cable"), given, n_cables)
    values = {
        one.name: _value(found, (*place, one.name), given, one)
        for one in parameters
        if one.name not in misspelt
    }
    found.effects.append((place, DeclaredEffect(name.id, cable, values)))


def _refuse_unknown(
    found: Found, place: Place, given: Mapping[str, Data], keys: list[str]
) -> Iterator[str]:
    """Refuse what is no parameter; yield the parameters that were probably meant."""
    for key in given:
        if key not in keys:
            problem = f"unknown parameter '{printable(key)}'"
            expected = f"one of {_listed(keys)}{did_you_mean(key, keys)}"
            found.refuse((*place, key), problem, expected)
            yield nearest_name(key, keys) or key


def _cable(found: Found, place: Place, given: Mapping[str, Data], n_cables: int) -> int | None:
    if "cable" not in given:
        found.refuse(place, "is missing", f"the number of the cable, 1 to {n_cables}")
        return None
    try:
        return WholeNumber(1, n_cables).read(given["cable"])
    except PydanticCustomError as error:
        _refuse_as(found, place, error)
        return None


def _value(
    found: Found, place: Place, given: Mapping[str, Data], parameter: ParameterName
) -> float:
    if parameter.name not in given:
        if parameter.neutral is None:
            found.refuse(place, "is missing", parameter.dimension.expected)
        return parameter.neutral or 0.0
    bound = parameter_bound(parameter.dimension)
    quantity = QuantityField(
        parameter.dimension,
        parameter.above,
        bound.least if parameter.at_least is None else parameter.at_least,
        bound.most,
        bound.reason,
    )
    try:
        return quantity.read(given[parameter.name])
    except PydanticCustomError as error:
        _refuse_as(found, place, error)
        return 0.0


def _refuse_as(found: Found, place: Place, error: PydanticCustomError) -> None:
    context = error.context or {}
    found.refuse(place, context["problem"], context["expected"])


def _named(given: Data) -> str:
    return "an empty mapping" if given == {} else describe(given)


def _listed(keys: list[str]) -> str:
    return ", ".join(keys) if len(keys) <= _MOST_LISTED else f"{keys[0]} … {keys[-1]}"
