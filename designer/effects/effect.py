"""What an effect is: its law, its parameters, and what it needs, in one record."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Literal

import numpy as np

from designer.arrays import FloatArray
from designer.model.measurements import Measured
from designer.model.robot import Machine, Poses
from designer.statics.geometry import cable_geometry
from designer.units import Dimension

Values = Mapping[str, float]
_UNIT_SUFFIX = re.compile(r"_(N_m2|m_per_N|m2|per_K|per_m|rad|kg|m|N|s)$")


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """What the sensors would show."""

    #: (n_rows, n_cables): lengths [m] and winch-side tensions [N]; NaN where the machine cannot
    #: hold the pose
    length_m: FloatArray
    tension_N: FloatArray  #: (n_rows, n_cables)
    #: (n_rows, 6): of poses that were measured in part: measured less estimated, over the noise
    coordinates_off: FloatArray | None = None

    @property
    def stacked(self) -> FloatArray:
        """Lengths, then tensions (n_rows, 2 n_cables)."""
        return np.hstack([self.length_m, self.tension_N])


@dataclass(frozen=True, slots=True)
class Size:
    """How large a parameter is, in the unit of its dimension."""

    typical: float  #: size of a change worth looking at: scale of the fit and step of its slopes
    bounds: tuple[float, float]  #: what the fit may try
    #: what an engineer would believe; a value outside is reported with a warning
    plausible: tuple[float, float]
    #: the value at which it does nothing, where that depends on the machine
    neutral: float | None = None


def any_machine(machine: Machine) -> bool:
    """Tell that a machine may have an effect, whatever it is."""
    return True


@dataclass(frozen=True, slots=True)
class Parameter:
    """One number of an effect."""

    #: as in config and result files, with its SI unit; ``{cable}`` stands for the number of a
    #: cable, from 1, where there is one for each
    name: str
    dimension: Dimension  #: what kind of quantity it is; the unit follows from it
    size: Size | Callable[[Machine], Size]  #: its size, or a function that gives it for a machine
    neutral: float = 0.0  #: the value at which the effect does nothing
    is_optional: bool = False  #: whether a config may leave it out, which makes it neutral
    above: float | None = None  #: limits beyond which it has no meaning
    at_least: float | None = None
    #: tells whether it means anything on a machine; where not, it is left out
    can_have: Callable[[Machine], bool] = any_machine
    #: ids of effects with the same number: beside those, it is left out
    part_of: tuple[str, ...] = ()
    #: whether it only says how the effect acts, such as a phase, and alone does nothing
    is_shape: bool = False
    #: whether it is the time from which on the effect acts at once, so that it has no slope
    is_step_time: bool = False

    @property
    def label(self) -> str:
        """Its name without the unit: ``offset_1_m`` is ``offset 1``."""
        return _UNIT_SUFFIX.sub("", self.name).replace("_", " ")

    @property
    def unit(self) -> str:
        """Its SI unit as one reads it: ``N·m²``; empty for a plain number."""
        return self.dimension.unit.replace("*", "·").replace("^2", "²").replace("^3", "³")

    @property
    def typical(self) -> float:
        """Of its `Size` on the machine that it was made for, as the two below."""
        return self.size_here.typical

    @property
    def bounds(self) -> tuple[float, float]:
        """What the fit may try."""
        return self.size_here.bounds

    @property
    def plausible(self) -> tuple[float, float]:
        """What an engineer would believe."""
        return self.size_here.plausible

    @property
    def size_here(self) -> Size:
        """Its size on the machine that it was made for."""
        assert isinstance(self.size, Size), f"{self.name} was made for no machine"
        return self.size

    def is_plausible(self, value: float) -> bool:
        """Whether an engineer would believe a value."""
        return self.plausible[0] <= value <= self.plausible[1]

    def sized(self, machine: Machine) -> Parameter:
        """Return it with its size on a machine."""
        size = self.size if isinstance(self.size, Size) else self.size(machine)
        if not isinstance(size, Size):
            raise TypeError(f"the size of {self.name} is {type(size).__name__}, not a Size")
        neutral = self.neutral if size.neutral is None else size.neutral
        return replace(self, size=size, neutral=neutral)

    def of_cables(self, n_cables: int) -> list[Parameter]:
        """Return it, or one for each cable."""
        if "{cable}" not in self.name:
            return [self]
        numbers = range(1, n_cables + 1)
        return [replace(self, name=self.name.format(cable=cable)) for cable in numbers]


NEEDS: Mapping[str, str] = {
    "time": "a column time_s",
    "temperature": "a column temperature_C that varies",
    "wind": "columns wind_x_m_per_s … that vary",
    "motion": "samples of a motion (settled: false)",
    "tension": "measured tensions",
    "length": "measured lengths",
    "rotation": "a platform that can turn",
    "pose": "measured poses",
    "pulleys": "declared pulleys",
    "reversals": "cables that pay out and haul in, row after row",
}
"""What an effect may need in the data to be seen, in words."""

ALL_ANCHORS, ALL_ATTACHMENTS = "anchors", "attachments"
"""What ``measurements.unknown`` calls the offsets of all exit points, or attachments, together."""
OF_CABLE = " of cable "
"""Between an effect's id and the cable, where it concerns only one."""
OF_SESSION = " of session "
"""Before the number of the session, where an effect concerns only one."""

MachineChange = Callable[..., Machine]
"""From a machine and `Values` to the machine with the effect."""
ReadingChange = Callable[..., Readings]
"""From `Readings`, `Values` and `Measured` to the readings with the effect."""
PoseChange = Callable[..., Poses]
"""From poses as they were measured and `Values` to those that the robot truly had."""
Cause = Literal["physics", "setting_up"]
"""What the machine does, or an error of frames, points, scales and clocks in setting it up."""
StartsFrom = Callable[..., Sequence[Values]]
"""From `Measured` and a residual to values."""


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """A physical effect: as its file has it, or made for a machine by `on`."""

    id: str  #: as in config and result files
    summary: str  #: what it is, in a few words; ``{cable}`` stands for the cable that it concerns
    law: str  #: how it changes machine or reading
    source: str  #: where the law comes from
    parameters: tuple[Parameter, ...]  #: its numbers
    #: exactly one of them: ``on_machine(machine, values)`` returns the changed machine,
    #: ``on_readings(readings, values, measured)`` the changed readings, ``on_poses(poses, values)``
    #: the poses of the platform where those are as they were measured
    on_machine: MachineChange | None = None
    on_readings: ReadingChange | None = None
    on_poses: PoseChange | None = None
    #: ``setting_up`` where it is no physics but an error in setting up the measurements, which is
    #: to be thought of first; see `Cause`
    cause: Cause = "physics"
    needs: frozenset[str] = frozenset()  #: what the data must have, of `NEEDS`
    #: whether it concerns one cable, so that it may stand more than once; the law is then given
    #: ``cable=``, its number from 1
    takes_cable: bool = False
    #: whether the law is given ``machine=``: with the readings of all rows the one that has all
    #: other effects, else the one that the effect was made for
    takes_machine: bool = False
    can_have: Callable[[Machine], bool] = any_machine  #: tells whether a machine may have it at all
    starts: tuple[Values, ...] = ()  #: values to start a fit from, beside the typical ones
    #: from the data and the residual without it (n_rows, 2 n_cables), in m and N: values to start
    #: from
    starts_from: StartsFrom | None = None
    #: in how many places it looks for a start: its gain by chance is that many times as probable
    looks: int = 1
    reaches_design: bool = False  #: whether it changes what cable the machine needs
    #: whether it is a property of the rope that is on the machine, which another rope would not
    #: have; see `designer.study.as_built_by`
    of_rope: bool = False
    #: whether it depends on the way that the cables went from row to row
    follows_rows: bool = False
    #: whether it leaves only changes of the lengths to go by, not the lengths themselves
    shifts_lengths: bool = False
    #: whether it may come about between two sessions, so that it is looked for in each; what is of
    #: setting up may in any case
    between_sessions: bool = False
    #: ids of effects that are named in its place where they do about as well together
    parts: tuple[str, ...] = ()
    also_called: str = ""  #: what ``measurements.unknown`` calls it for all cables together
    cable: int | None = None  #: the one cable it concerns, from 1, once it is made for a machine
    session: int | None = None  #: the one session of measurements it concerns, from 1; None for all

    @property
    def key(self) -> str:
        """Id, with the cable and the session where it concerns only one."""
        of_cable = "" if self.cable is None else f"{OF_CABLE}{self.cable}"
        return f"{self.id}{of_cable}" + (f"{OF_SESSION}{self.session}" if self.session else "")

    def identified(self) -> dict[str, object]:
        """Return by what files name it."""
        of_session = {"session": self.session} if self.session else {}
        return {"id": self.id, "cable": self.cable, **of_session}

    @property
    def neutral(self) -> dict[str, float]:
        """Values at which it does nothing."""
        return {p.name: p.neutral for p in self.parameters}

    @property
    def needs_motion(self) -> bool:
        """Whether poses at rest do not show it."""
        return "motion" in self.needs

    @property
    def strength(self) -> list[bool]:
        """Which of its parameters make it act, the others being its shape."""
        return [not p.is_shape for p in self.parameters]

    def is_among(self, names: Sequence[str]) -> bool:
        """Tell whether one of the names, as in ``measurements.unknown``, is its own."""
        called = {self.id, self.key, self.also_called} - {""}
        ids = {name.partition(OF_CABLE)[0] for name in names} if self.cable is None else set()
        return not called.isdisjoint(ids | set(names))

    def parameters_for(self, n_cables: int) -> tuple[Parameter, ...]:
        """Return the parameters on a robot with so many cables."""
        return tuple(
            numbered for parameter in self.parameters for numbered in parameter.of_cables(n_cables)
        )

    def is_part_of(self, effect: Effect) -> bool:
        """Tell whether another effect has all of its numbers."""
        return all(effect.id in p.part_of for p in self.parameters)

    def beside(self, ids: Collection[str]) -> Effect:
        """Return it without the numbers that effects of these ids have as well."""
        unshared = tuple(p for p in self.parameters if not set(p.part_of) & set(ids))
        return replace(self, parameters=unshared)

    def on(self, machine: Machine) -> list[Effect]:
        """Return what a machine may have of it: the effect, one for each cable, or none."""
        if not self.can_have(machine):
            return []
        n_cables = machine.robot.n_cables
        sized = tuple(p.sized(machine) for p in self.parameters if p.can_have(machine))
        effect = replace(self, parameters=sized)
        effect = replace(effect, parameters=effect.parameters_for(n_cables))
        if self.takes_machine:
            effect = effect._given(machine=machine)
        if not self.takes_cable:
            return [effect]
        return [
            replace(effect._given(cable=k), cable=k, summary=self.summary.format(cable=k))
            for k in range(1, n_cables + 1)
        ]

    def of_session(self, session: int) -> Effect:
        """Return it for the rows of one session alone."""
        start = self.starts_from

        def starts_there(measured: Measured, residual: FloatArray) -> Sequence[Values]:
            assert start is not None
            rows = np.asarray(measured.session == session)
            return start(measured.part(rows), residual[rows])

        return replace(
            self,
            session=session,
            summary=f"{self.summary} in session {session}",
            starts_from=start and starts_there,
        )

    def _given(self, **more: object) -> Effect:
        return replace(
            self,
            on_machine=self.on_machine and partial(self.on_machine, **more),
            on_readings=self.on_readings and partial(self.on_readings, **more),
            on_poses=self.on_poses and partial(self.on_poses, **more),
            starts_from=self.starts_from and partial(self.starts_from, **more),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """An effect with values for its parameters."""

    effect: Effect = field(metadata={"json": Effect.identified})
    values: Values


def as_built(machine: Machine, settings: Sequence[Setting]) -> Machine:
    """Return the machine changed by all effects that act on it, in their order."""
    for setting in settings:
        if setting.effect.on_machine is not None:
            machine = setting.effect.on_machine(machine, setting.values)
    return machine


def per_cable(values: Values, name: str, n_cables: int) -> FloatArray:
    """Return what a parameter such as ``offset_{cable}_m`` is for each cable (n_cables,)."""
    return np.array([values[name.format(cable=cable)] for cable in range(1, n_cables + 1)])


def is_in_space(machine: Machine) -> bool:
    """Tell whether a robot is not planar."""
    return not machine.robot.is_planar


def can_turn(machine: Machine) -> bool:
    """Tell whether a platform is a body, not a point mass."""
    return not machine.robot.is_point_mass


def moves_along(axis: int, machine: Machine) -> bool:
    """Tell whether a robot moves along an axis, 0 to 2, which may be across its plane."""
    return not machine.robot.is_planar or bool(abs(machine.robot.level[1, axis]) < 1.0 - 1e-9)


def sized_by(
    scale: Callable[[Machine], float],
    typical: float,
    bounds: tuple[float, float],
    plausible: tuple[float, float],
    neutral: float | None = None,
) -> Callable[[Machine], Size]:
    """Return a size in proportion to something of the machine, such as its weight."""

    def size(machine: Machine) -> Size:
        unit = scale(machine)
        return Size(
            typical * unit,
            (bounds[0] * unit, bounds[1] * unit),
            (plausible[0] * unit, plausible[1] * unit),
            None if neutral is None else neutral * unit,
        )

    return size


def weight_N(machine: Machine) -> float:
    """Return the weight of the platform [N]."""
    return machine.robot.weight_N


def platform_extent_m(machine: Machine) -> float:
    """Return the largest extent of the attachment points along an axis [m]; 0 of a point mass."""
    return float(np.ptp(machine.robot.attachments_m, axis=0).max())


def frame_size_m(machine: Machine) -> float:
    """Return the largest extent of the exit points along an axis [m]."""
    return float(np.ptp(machine.robot.exit_points_m, axis=0).max())


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """Of each cable in each row (n_rows, n_cables)."""

    horizontal_N: FloatArray  #: its horizontal force on the exit point [N]
    mean_N: FloatArray  #: its tension half way down [N]


def pull_of(machine: Machine, measured: Measured, tension_N: FloatArray) -> Pull:
    """Return the pull of parabolas between the exit points and the measured poses.

    With H the horizontal force, w the weight per length, chord c over X and drop D: the upward
    force at the exit is H D / X + w c / 2, which with H makes the tension there.
    """
    across, slope, half = _chords(machine, measured)
    square, mixed = 1.0 + slope**2, slope * half
    inside = np.maximum(mixed**2 - square * (half**2 - tension_N**2), 0.0)
    level = np.maximum((np.sqrt(inside) - mixed) / square, 0.0)
    drop = 0.5 * machine.cables.weight_N_per_m * slope * across
    return Pull(level, np.maximum(tension_N - drop, 0.0))


@lru_cache(maxsize=2)
def _chords(machine: Machine, measured: Measured) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return X [m], D / X and w c / 2 [N]; kept, as many tensions are asked of one machine."""
    geometry = cable_geometry(machine.robot, measured.poses)
    across = np.maximum(geometry.horizontal_distance_m, 1e-9)
    half = 0.5 * machine.cables.weight_N_per_m * geometry.chord_m
    return across, geometry.drop_m / across, half
