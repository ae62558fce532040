"""What an effect is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from designer.arrays import FloatArray
from designer.model.machine import Machine
from designer.model.measured_data import Measured

Values = Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """What the sensors would show.

    Parameters
    ----------
    length_m, tension_N : array (n_rows, n_cables)
        Lengths [m] and winch-side tensions [N]; NaN where the machine cannot hold the pose.
    """

    length_m: FloatArray
    tension_N: FloatArray


@dataclass(frozen=True, slots=True)
class Parameter:
    """One number of an effect.

    Parameters
    ----------
    name, unit : str
        As in config and result files.
    neutral : float
        The value at which the effect does nothing.
    typical : float
        Size of a change worth looking at: scale of the fit and step of its slopes.
    bounds : tuple of float
        What the fit may try.
    plausible : tuple of float
        What an engineer would believe; a value outside is reported with a warning.
    """

    name: str
    unit: str
    neutral: float
    typical: float
    bounds: tuple[float, float]
    plausible: tuple[float, float]


NEEDS: Mapping[str, str] = {
    "time": "a column time_s",
    "temperature": "a column temperature_C that varies",
    "wind": "columns wind_x_m_per_s … that vary",
    "motion": "samples of a motion (settled: false)",
    "tension": "measured tensions",
    "length": "measured lengths",
    "rotation": "a platform that can turn",
}
"""What an effect may need in the data to be seen, in words."""

MachineChange = Callable[[Machine, Values], Machine]
ReadingChange = Callable[[Readings, Values, Measured], Readings]
StartsFrom = Callable[[Measured, FloatArray], Sequence[Values]]


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """A physical effect.

    Parameters
    ----------
    id : str
        As in config and result files.
    summary : str
        What it is, in a few words.
    law : str
        How it changes machine or reading.
    source : str
        Where the law comes from.
    parameters : tuple of Parameter
        Its numbers.
    on_machine, on_readings : callable or None
        Exactly one of them.
    needs : frozenset of str
        What the data must have, of `NEEDS`.
    cable : int or None
        The one cable it concerns, from 1; None for all.
    starts : tuple of mapping
        Values to start a fit from, beside the typical ones.
    starts_from : callable or None
        From the data and the residual without it (n_rows, 2 n_cables): values to start from.
    reaches_design : bool
        Whether it changes what cable the machine needs.
    """

    id: str
    summary: str
    law: str
    source: str
    parameters: tuple[Parameter, ...]
    on_machine: MachineChange | None = None
    on_readings: ReadingChange | None = None
    needs: frozenset[str] = frozenset()
    cable: int | None = None
    starts: tuple[Values, ...] = ()
    starts_from: StartsFrom | None = None
    reaches_design: bool = False

    @property
    def key(self) -> str:
        """Id, with the cable where it concerns only one."""
        return self.id if self.cable is None else f"{self.id} of cable {self.cable}"

    @property
    def neutral(self) -> dict[str, float]:
        """Values at which it does nothing."""
        return {p.name: p.neutral for p in self.parameters}


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """An effect with values for its parameters."""

    effect: Effect
    values: Values


def as_built(machine: Machine, settings: Sequence[Setting]) -> Machine:
    """Return the machine changed by all effects that act on it, in their order."""
    for setting in settings:
        if setting.effect.on_machine is not None:
            machine = setting.effect.on_machine(machine, setting.values)
    return machine


Builder = Callable[[Machine], list[Effect]]
"""Makes the effects of one kind that a machine may have: one, or one for each cable."""
