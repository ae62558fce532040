"""The two kinds of readings, and how the report shows them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from designer.arrays import FloatArray
from designer.diagnosis.accuracy import Error, Interval, Stage
from designer.diagnosis.result import Diagnosis
from designer.model.measured_data import KINDS, Noise
from designer.report import format as fmt


@dataclass(frozen=True, slots=True)
class Quantity:
    """A kind of reading: ``length`` or ``tension``, its unit in the report, the scale from SI.

    ``noise`` is the standard deviation of one reading in SI units.
    """

    name: str
    unit: str
    scale: float
    noise: float

    @property
    def field(self) -> str:
        """What results call it."""
        return "length_m" if self.name == "length" else "tension_N"

    def error_of(self, stage: Stage) -> Error | None:
        """Return its error at a stage; None where it was not measured."""
        return stage.length_m if self.name == "length" else stage.tension_N

    def errors_of(self, stages: Iterable[Stage]) -> Iterator[tuple[str, Error]]:
        """Yield label and error of each stage that has one."""
        for stage in stages:
            error = self.error_of(stage)
            if error is not None:
                yield stage.label, error

    def shown(self, value: float) -> str:
        """Return a value in SI units as text, without its unit."""
        return fmt.number(self.scale * value, 3)

    def all_shown(self, values: FloatArray) -> list[str]:
        """Return values in SI units as texts, without their unit."""
        return [self.shown(float(value)) for value in values]

    def with_unit(self, value: float) -> str:
        """Return a value in SI units as text."""
        return f"{self.shown(value)}\u00a0{self.unit}"

    def interval(self, found: Interval) -> str:
        """Return the ends of an interval in SI units as text, without unit."""
        return f"{self.shown(found.low)} to {self.shown(found.high)}"

    def in_noise(self, value: float) -> str:
        """Return a value in units of noise."""
        ratio = value / self.noise
        return fmt.number(ratio, 2 if ratio < 10.0 else 3)


def kinds(noise: Noise) -> tuple[Quantity, Quantity]:
    """Return lengths and tensions, measured or not."""
    length, tension = (Quantity(x.name, x.unit, x.scale, x.of(noise)) for x in KINDS)
    return length, tension


def quantities(diagnosis: Diagnosis) -> Iterator[tuple[Quantity, Error, Error]]:
    """Yield each kind that was measured, with its error before and after."""
    of_name = {quantity.name: quantity for quantity in kinds(diagnosis.noise)}
    return ((of_name[kind.name], before, after) for kind, before, after in diagnosis.errors)
