"""Effects that the config says the machine has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pydantic_core import PydanticCustomError

from designer.documents.bounds import parameter_bound
from designer.documents.document import Data, Flaw, Keys, printable
from designer.documents.fields import QuantityField, WholeNumber
from designer.effects.effect import Effect, Parameter
from designer.spelling import did_you_mean, nearest_name
from designer.study import DeclaredEffect
from designer.units import describe

_SECTION: Keys = ("effects",)
_MAX_LISTED = 8
"""Names of parameters in a message; of more, the first and the last are enough."""


@dataclass(slots=True)
class DeclaredEffects:
    """The effects of a section, each with its place, and all that is wrong."""

    n_cables: int
    section: Keys = _SECTION
    effects: list[tuple[Keys, DeclaredEffect]] = field(default_factory=list)
    flaws: list[Flaw] = field(default_factory=list)

    def refuse(self, keys: Keys, problem: str, expected: str) -> None:
        """Add something that is wrong."""
        self.flaws.append(Flaw(keys, problem, expected))

    def read(self, place: Keys, kind: QuantityField | WholeNumber, content: Data) -> float | None:
        """Return a value; None, and a refusal, for one that is none of its kind."""
        try:
            return kind.read(content)
        except PydanticCustomError as error:
            context = error.context or {}
            self.refuse(place, context["problem"], context["expected"])
            return None


def read_effects(
    data: Data, n_cables: int, effects_by_id: Mapping[str, Effect], section: Keys = _SECTION
) -> DeclaredEffects:
    """Return what a section ``effects`` says, of all effects that are known by their ids."""
    declared_effects = DeclaredEffects(n_cables, section)
    for effect_id, content in data.items() if isinstance(data, dict) else ():
        effect = effects_by_id.get(effect_id)
        if effect is None:
            problem = f"unknown effect '{printable(effect_id)}'"
            expected = f"one of {', '.join(effects_by_id)}{did_you_mean(effect_id, effects_by_id)}"
            declared_effects.refuse((*section, effect_id), problem, expected)
        else:
            _read_all(declared_effects, effect, content)
    return declared_effects


def _read_all(declared_effects: DeclaredEffects, effect: Effect, data: Data) -> None:
    place: Keys = (*declared_effects.section, effect.id)
    if not effect.takes_cable or not isinstance(data, list):
        _read_one(declared_effects, effect, place, data)
        return
    if not data:
        declared_effects.refuse(
            place, "an empty list", "one mapping for each cable that has this effect"
        )
    for index, item in enumerate(data):
        _read_one(declared_effects, effect, (*place, index), item)
    seen: set[int] = set()
    for earlier, declared in declared_effects.effects:
        if declared.id == effect.id and declared.cable is not None:
            if declared.cable in seen:
                problem = f"cable {declared.cable} has this effect already"
                declared_effects.refuse((*earlier, "cable"), problem, "each cable once")
            seen.add(declared.cable)


def _read_one(declared_effects: DeclaredEffects, effect: Effect, place: Keys, data: Data) -> None:
    parameters = effect.parameters_for(declared_effects.n_cables)
    keys = ["cable"] * effect.takes_cable + [parameter.name for parameter in parameters]
    if not isinstance(data, dict) or not data:
        problem = f"{'an empty mapping' if data == {} else describe(data)} is not a mapping"
        declared_effects.refuse(place, f"{problem} with values", f"a mapping with {_listed(keys)}")
        return
    misspelt = set()  # what was probably meant by names that are no parameters
    for key in data:
        if key not in keys:
            problem = f"unknown parameter '{printable(key)}'"
            expected = f"one of {_listed(keys)}{did_you_mean(key, keys)}"
            declared_effects.refuse((*place, key), problem, expected)
            misspelt.add(nearest_name(key, keys) or key)
    cable = None
    if effect.takes_cable and "cable" not in misspelt:
        at = (*place, "cable")
        if "cable" in data:
            number = declared_effects.read(
                at, WholeNumber(1, declared_effects.n_cables), data["cable"]
            )
            cable = None if number is None else int(number)
        else:
            declared_effects.refuse(
                at, "is missing", f"the number of the cable, 1 to {declared_effects.n_cables}"
            )
    values = {
        parameter.name: _value(declared_effects, (*place, parameter.name), data, parameter)
        for parameter in parameters
        if parameter.name not in misspelt
    }
    declared_effects.effects.append((place, DeclaredEffect(effect.id, cable, values)))


def _value(
    declared_effects: DeclaredEffects,
    place: Keys,
    content: Mapping[str, Data],
    parameter: Parameter,
) -> float:
    if parameter.name not in content:
        if not parameter.is_optional:
            declared_effects.refuse(place, "is missing", parameter.dimension.expected)
        return parameter.neutral
    return declared_effects.read(place, field_of(parameter), content[parameter.name]) or 0.0


def field_of(parameter: Parameter) -> QuantityField:
    """Return how a parameter is read: within its own limits, and those of its unit."""
    bound = parameter_bound(parameter.dimension)
    least = bound.least if parameter.at_least is None else parameter.at_least
    return QuantityField(parameter.dimension, parameter.above, least, bound.most, bound.reason)


def _listed(keys: list[str]) -> str:
    return ", ".join(keys) if len(keys) <= _MAX_LISTED else f"{keys[0]} … {keys[-1]}"
