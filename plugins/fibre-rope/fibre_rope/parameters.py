"""Reads the parameter file into SI numbers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from designer.units import (
    DENSITY,
    LENGTH,
    NUMBER,
    Dimension,
    QuantityError,
    read_quantity,
)

TEMPERATURE = Dimension("a temperature", "K", "20 degC")
DURATION = Dimension("a time", "s", "5 years")
ENERGY = Dimension("an energy", "J", "1.5 eV")
VOLUME = Dimension("a volume", "m^3", "45 angstrom^3")


@dataclass(frozen=True, slots=True)
class Condition:
    """Temperature [K], and how long the rope must last at it [s]."""

    temperature_K: float
    life_s: float


@dataclass(frozen=True, slots=True)
class Parameters:
    """All numbers of the parameter file, in SI units, and where they come from.

    Parameters
    ----------
    conditions : tuple of Condition
        One grade each.
    safety_factor : float
        On breaking load, as in the study.
    diameters_m : tuple of float
        Sizes [m].
    reference : Condition
        Where the creep life is known, at the load ``reference_load_fraction`` of breaking.
    reference_source : str
        Empty where it is an assumption.
    """

    conditions: tuple[Condition, ...]
    safety_factor: float
    diameters_m: tuple[float, ...]
    reference: Condition
    reference_load_fraction: float
    reference_source: str
    activation_energy_J: float
    activation_volume_m3: float
    creep_source: str
    temperature_limit_K: float
    temperature_source: str
    mass_d2: float
    breaking_load_d2: float
    breaking_load_d3: float
    ea_over_breaking_load: float
    fibre_density_kg_per_m3: float
    rope_source: str


def read_parameters(path: Path) -> Parameters:
    """Return the parameters in a file.

    Raises
    ------
    ValueError
        If a field is missing or wrong; names file and field.
    """
    try:
        root = _Field(str(path), yaml.safe_load(path.read_text(encoding="utf-8")))
    except (OSError, yaml.YAMLError) as error:
        raise ValueError(f"{path}: cannot be read: {error}") from error
    creep, rope = root["creep"], root["rope"]
    reference = creep["reference"]
    answer = Parameters(
        conditions=tuple(_condition(one) for one in root["conditions"].items()),
        safety_factor=root["safety_factor"].positive(NUMBER),
        diameters_m=tuple(sorted(one.positive(LENGTH) for one in root["diameters"].items())),
        reference=_condition(reference),
        reference_load_fraction=reference["load_fraction"].positive(NUMBER),
        reference_source=reference["source"].text(),
        activation_energy_J=creep["activation_energy"].positive(ENERGY),
        activation_volume_m3=creep["activation_volume"].positive(VOLUME),
        creep_source=creep["source"].text(),
        temperature_limit_K=root["temperature_limit"].positive(TEMPERATURE),
        temperature_source=root["temperature_source"].text(),
        mass_d2=rope["mass_d2"].positive(NUMBER),
        breaking_load_d2=rope["breaking_load_d2"].positive(NUMBER),
        breaking_load_d3=rope["breaking_load_d3"].number(NUMBER),
        ea_over_breaking_load=rope["ea_over_breaking_load"].positive(NUMBER),
        fibre_density_kg_per_m3=rope["fibre_density"].positive(DENSITY),
        rope_source=rope["source"].text(),
    )
    for k, condition in enumerate(answer.conditions):
        if condition.temperature_K > answer.temperature_limit_K:
            raise ValueError(
                f"{path}: conditions[{k}].temperature: is above temperature_limit, "
                "where this rope is not to be used"
            )
    return answer


def _condition(field: _Field) -> Condition:
    return Condition(field["temperature"].positive(TEMPERATURE), field["life"].positive(DURATION))


@dataclass(frozen=True, slots=True)
class _Field:
    """A value of the file with its path, for messages."""

    place: str
    value: Any

    def __getitem__(self, name: str) -> _Field:
        if not isinstance(self.value, dict) or name not in self.value:
            raise ValueError(f"{self._child(name)}: is missing")
        return _Field(self._child(name), self.value[name])

    def items(self) -> list[_Field]:
        """Return the items of a list that is not empty."""
        if not isinstance(self.value, list) or not self.value:
            raise ValueError(f"{self.place}: is not a list (expected at least one item)")
        return [_Field(f"{self.place}[{k}]", item) for k, item in enumerate(self.value)]

    def number(self, dimension: Dimension) -> float:
        """Return the value in SI."""
        try:
            return read_quantity(self.value, dimension)
        except QuantityError as error:
            raise ValueError(f"{self.place}: {error}") from error

    def positive(self, dimension: Dimension) -> float:
        """Return the value in SI, which must be above zero."""
        value = self.number(dimension)
        if value <= 0.0:
            raise ValueError(f"{self.place}: is not above zero (expected {dimension.expected})")
        return value

    def text(self) -> str:
        """Return a text on one line; empty for nothing."""
        return " ".join(str(self.value or "").split())

    def _child(self, name: str) -> str:
        return f"{self.place}.{name}" if ": " in self.place else f"{self.place}: {name}"
