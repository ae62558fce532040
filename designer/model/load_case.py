r"""Load cases: what acts on platform and cables, as a change of the robot and of its cables.

Wind of speed v has the pressure :math:`q = \tfrac12 \varrho v^2`, with 1.25 kg/m³ for air (EN
1991-1-4, 4.5). On the platform it makes the force :math:`q\,C_d A`, at a point of the body, the
centre of mass unless given; on a cable, per unstrained length, :math:`q\,C_d\,d`, along the wind
and at full speed whatever the cable's inclination. Ice of thickness t adds the weight
:math:`\pi t (d + t) \varrho_i g` and makes the cable :math:`d + 2 t` thick in the wind. What is
attached along a cable is a second cylinder beside the rope: in the full wind, and iced all around,
as the rope is.

The load per unstrained length is then one constant vector for all cables, so that each is still a
catenary, in the plane of that vector and its chord: the robot is solved in a frame whose z axis
points against it (`Robot.cable_load_direction`), with a cable of that weight, and what acts on the
platform as forces in the world.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Annotated, Any

import numpy as np

from designer import checked, spelling
from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable
from designer.model.region import Region
from designer.model.robot import Platform, Robot
from designer.model.space import Orientations

MAX_WRENCHES = 64
"""The corners of a box in all six parts of a wrench."""


@dataclass(frozen=True, slots=True, eq=False)
class WrenchSet(checked.Value):
    """Wrenches on a platform, of which any one may act."""

    #: (n, 6): As `Platform.wrench_N`, each for itself; of a box its corners [N, N·m]
    wrenches_N: Annotated[FloatArray, checked.Shape((None, 6))]
    is_box: bool = False  #: Whether all wrenches between them may act as well, each part for itself

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if not 1 <= len(self.wrenches_N) <= MAX_WRENCHES:
            raise ValueError(f"a set has 1 to {MAX_WRENCHES} wrenches, not {len(self.wrenches_N)}")

    @classmethod
    def between(cls, first_N: FloatArray, last_N: FloatArray) -> WrenchSet:
        """Return the box between two wrenches (6,), by its corners."""
        ends = [sorted({float(a), float(b)}) for a, b in zip(first_N, last_N, strict=True)]
        return cls(np.array(list(product(*ends))), is_box=True)

    @property
    def bounds_N(self) -> FloatArray:
        """Least and greatest of each part (2, 6)."""
        return np.array([self.wrenches_N.min(axis=0), self.wrenches_N.max(axis=0)])

    def scaled(self, factor: float) -> WrenchSet:
        """Return the same, so many times as large."""
        return replace(self, wrenches_N=factor * self.wrenches_N)

    def neighbours(self, wrench_N: FloatArray, step: float) -> Iterator[FloatArray]:
        """Yield the wrenches of a box by a step, of half its width, from one (6,) of them."""
        if not self.is_box:
            return
        lower, upper = self.bounds_N
        for part in np.flatnonzero(upper > lower):
            for along in (-step, step):
                moved = wrench_N[part] + 0.5 * along * (upper - lower)[part]
                moved = min(max(moved, lower[part]), upper[part])
                if moved != wrench_N[part]:
                    other = wrench_N.copy()
                    other[part] = moved
                    yield other


AIR_DENSITY_KG_PER_M3 = 1.25
"""EN 1991-1-4, 4.5; of every wind in this program, measured or assumed [kg/m³]."""
_SAME_DIRECTION = 1e-12
"""Between the loads of two cables: rounding."""
FIRST_WINDS = 8
EACH = "each"
"""Of a lost cable: each in turn."""
MAX_DIRECTIONS = 512
"""Of a load case with a set of wrenches: each is solved in all samples, for all ropes."""


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Wind(checked.Value):
    """Wind that blows with one speed everywhere.

    Parameters
    ----------
    speed_m_per_s : float
        Its speed [m/s].
    cable_drag_coefficient : float
        C_d of the cables, on their diameter.
    count : int or None
        How many directions are tried, horizontal, evenly spread from +x. None for all: a search
        starts from `FIRST_WINDS` of them.
    direction : array (3,) or None
        Where it blows to, instead of these; its length does not count.
    """

    speed_m_per_s: checked.NotNegative
    cable_drag_coefficient: checked.NotNegative
    count: checked.Count | None = None
    direction: checked.Vector | None = None

    @property
    def pressure_Pa(self) -> float:
        """Dynamic pressure [Pa]."""
        return 0.5 * AIR_DENSITY_KG_PER_M3 * self.speed_m_per_s**2

    def directions(self, robot: Robot) -> FloatArray:
        """Return unit vectors of where it blows to (n, 3), world frame.

        Of all directions, those that a search starts from. On a planar robot, whose guides bear
        what is across its plane, the two along the plane are the worst of all horizontal ones.
        """
        if self.direction is not None:
            return (self.direction / np.linalg.norm(self.direction))[None]
        if robot.is_planar:
            return np.array([robot.level[0], -robot.level[0]])
        count = self.count or FIRST_WINDS
        turn = 2.0 * math.pi * np.arange(count) / count
        return np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn]) @ robot.level


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Ice(checked.Value):
    """Ice all around the cables."""

    thickness_m: checked.NotNegative
    density_kg_per_m3: checked.Positive = 900.0

    def linear_density_kg_per_m(self, cable: Cable) -> float | FloatArray:
        """Return its mass per length on a cable, of each where they differ [kg/m]."""
        if self.thickness_m == 0.0:
            return 0.0
        around_m = cable.width_m(self.thickness_m)
        return math.pi * self.thickness_m * around_m * self.density_kg_per_m3


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """A robot and its cables under one load case, in one direction of wind and inertia."""

    case: LoadCase
    bare: tuple[Robot, Cable]  #: What it was put on
    robot: Robot  #: With what acts on the platform, and the direction of the load on its cables
    cable: Cable  #: With the load per length in place of its weight
    #: (3,): Unit vectors of where the wind blows to and the inertia force points, world frame
    wind: FloatArray | None = None
    inertia: FloatArray | None = None
    lost_cable: int | None = None  #: The cable that is gone, from 1; the robot above still has it
    #: (6,): That of the case's set of wrenches, without the dynamic factor [N, N·m]
    wrench_N: FloatArray | None = None

    @property
    def is_direction_searched(self) -> bool:
        """Whether its wind, inertia force or wrench is the worst of many, to be searched."""
        return next(self.perturbed(1.0), None) is not None

    def perturbed(self, step: float) -> Iterator[Loaded]:
        """Yield the same with wind, inertia force or wrench changed a little: by a step aside."""
        robot, lost, wrench_N = self.bare[0], self.lost_cable, self.wrench_N
        if self.wind is not None and self.case.searches_wind(robot):
            for along in _aside(self.wind, robot.level[:2], step):
                yield self.case.under(*self.bare, along, self.inertia, lost, wrench_N)
        if self.inertia is not None:
            for along in _aside(self.inertia, free_axes(robot), step):
                yield self.case.under(*self.bare, self.wind, along, lost, wrench_N)
        if wrench_N is not None and self.case.wrench_set is not None:
            for other_N in self.case.wrench_set.neighbours(wrench_N, step):
                yield self.case.under(*self.bare, self.wind, self.inertia, lost, other_N)

    @property
    def growth(self) -> float:
        """Strain of the unstrained lengths by the change of temperature."""
        change_K = self.case.temperature_change_K
        return change_K * self.cable.expansion_per_K if change_K else 0.0

    @property
    def moving_body(self) -> Platform:
        """The platform with the mass and inertia that are accelerated: no dynamic factor.

        Its inertia is not known where the case changes the mass and says no more.
        """
        case, body = self.case, self.bare[0].platform
        inertia = body.inertia_kg_m2 if case.mass_kg is None else None
        if case.inertia_kg_m2 is not None:
            inertia = case.inertia_kg_m2
        return replace(body, mass_kg=case.mass_on(body), inertia_kg_m2=inertia)

    @property
    def moving_density_kg_per_m(self) -> float | FloatArray:
        """Mass per length of the cables with ice: wind loads them, and adds none."""
        cable, ice = self.bare[1], self.case.ice
        around = 0.0 if ice is None else ice.linear_density_kg_per_m(cable)
        return cable.linear_density_kg_per_m + around

    @property
    def keeps_lengths(self) -> bool:
        """Whether the winches are braked, so that the platform settles: after a loss, by warmth."""
        return self.lost_cable is not None or self.growth != 0.0

    def on(self, robot: Robot, cable: Cable) -> Loaded:
        """Return the same case in the same directions on another robot or cable."""
        directions = self.wind, self.inertia, self.lost_cable, self.wrench_N
        return self.case.under(robot, cable, *directions)

    @property
    def words(self) -> str:
        """Its directions, wrench and lost cable, for the reader of a report; empty without any."""
        named = (("wind", self.wind), ("inertia force", self.inertia))
        parts = [f"{name} along {_row(along)}" for name, along in named if along is not None]
        if self.wrench_N is not None:
            parts.append(f"force {_row(self.wrench_N[:3])} N")
            if self.wrench_N[3:].any():
                parts.append(f"moment {_row(self.wrench_N[3:])} N·m")
        if self.lost_cable is not None:
            parts.append(f"without cable {self.lost_cable}")
        return ", ".join(parts)


def _row(vector: FloatArray) -> str:
    return spelling.vector(np.round(vector, 3), 6)


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class LoadCase:
    """One load case: what it changes of a study. None leaves that as the study has it.

    Parameters
    ----------
    name : str
        Its name.
    mass_kg : float or None
        Mass of the platform with its payload [kg].
    inertia_kg_m2 : array (3, 3) or None
        As `Platform.inertia_kg_m2`, of the platform with its payload [kg·m²].
    wrench_N : array (6,) or None
        Constant force and moment on the platform, as `Platform.wrench_N` [N, N·m].
    wrench_set : WrenchSet or None
        Instead of that: wrenches of which any one may act.
    dynamic_factor : float
        Factor on weight and wrench of the platform, not on the cables' own weight.
    acceleration_m_per_s2 : float
        Of the platform [m/s²]; its inertia force acts at the centre of mass, without the dynamic
        factor, in its worst direction.
    wind, ice
        On platform and cables, and around the cables.
    cable_lost : int, ``each`` or None
        A cable that is gone, from 1, or each in turn.
    temperature_change_K : float or None
        By how much the cables get warmer after the pose was reached, their lengths kept [K].
    expansion_per_K : float or None
        Their strain by it, instead of that of the rope [1/K].
    safety_factor, termination_efficiency : float or None
        Instead of those of the selection.
    region : Region or None
        Instead of that of the workspace.
    orientations : Orientations or None
        Those of such a region, instead of the workspace's.
    """

    name: str
    mass_kg: checked.Positive | None = None
    wrench_N: checked.Wrench | None = None
    dynamic_factor: checked.Factor = 1.0
    acceleration_m_per_s2: checked.NotNegative = 0.0
    wind: Wind | None = None
    ice: Ice | None = None
    cable_lost: int | str | None = None
    temperature_change_K: checked.Finite | None = None
    expansion_per_K: checked.Finite | None = None
    safety_factor: checked.Factor | None = None
    termination_efficiency: checked.Efficiency | None = None
    region: Region | None = None
    orientations: Orientations | None = None
    inertia_kg_m2: Annotated[FloatArray, checked.Shape((3, 3))] | None = None
    wrench_set: WrenchSet | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        lost = self.cable_lost
        if isinstance(lost, str) and lost != EACH:
            raise ValueError(f"cable_lost must be a cable or '{EACH}', not '{lost}'")
        if isinstance(lost, int):
            checked.Number(least=1).require("cable_lost", lost)
        if self.wrench_set is not None and self.wrench_N is not None:
            raise ValueError("wrench_N and wrench_set exclude each other")

    @property
    def changes_robot(self) -> bool:
        """Whether the robot as loaded depends on the cable, whose drag and weight tilt its load."""
        return self.wind is not None and self.wind.cable_drag_coefficient > 0.0

    def searches_wind(self, robot: Robot) -> bool:
        """Whether any direction of the wind may be the worst, beside those of `on`."""
        is_any = self.wind is not None and self.wind.count is None and self.wind.direction is None
        return is_any and not robot.is_planar

    def on(self, robot: Robot, cable: Cable) -> Iterator[Loaded]:
        """Yield robot and cable in all directions of this case: of wind, inertia, loss, wrench.

        The inertia force points along 14 directions in space, 8 in a plane: any other direction is
        within 37° of one of them. What is worst between them is for a search to find, by `under`.
        """
        for directions in product(*self._directions(robot)):
            yield self.under(robot, cable, *directions)

    def direction_count(self, robot: Robot) -> int:
        """Return how many directions `on` yields."""
        return math.prod(map(len, self._directions(robot)))

    def _directions(self, robot: Robot) -> tuple[Sequence[Any], ...]:
        """Return the directions of wind and inertia, the lost cables and the wrenches (6,)."""
        winds = [None] if self.wind is None else list(self.wind.directions(robot))
        pushes = [None] if self.acceleration_m_per_s2 == 0.0 else list(_inertia_directions(robot))
        lost: list[int | None] = [None]
        if self.cable_lost is not None:
            any_cable = self.cable_lost == EACH
            lost = list(range(1, robot.n_cables + 1)) if any_cable else [int(self.cable_lost)]
        wrenches = [None] if self.wrench_set is None else list(self.wrench_set.wrenches_N)
        return winds, pushes, lost, wrenches

    def mass_on(self, body: Platform) -> float:
        """Return the mass of a platform in this case, with what it weighs beyond its drawing."""
        return body.mass_kg if self.mass_kg is None else self.mass_kg + body.mass_offset_kg

    def wrench_on(self, body: Platform, wrench_N: FloatArray | None = None) -> FloatArray:
        """Return force and moment (6,) on it, likewise, or under one of the set [N, N·m]."""
        wrench = self.wrench_N if wrench_N is None else wrench_N
        return body.wrench_N if wrench is None else wrench + body.wrench_offset_N

    def under(
        self,
        robot: Robot,
        cable: Cable,
        wind: FloatArray | None = None,
        inertia: FloatArray | None = None,
        lost_cable: int | None = None,
        wrench_N: FloatArray | None = None,
    ) -> Loaded:
        """Return robot and cable in one direction of wind and inertia force (3,), unit vectors.

        And under one wrench (6,) of the set of the case [N, N·m].
        """
        bare, body, factor = (robot, cable), robot.platform, self.dynamic_factor
        mass = self.mass_on(body)
        wrench = factor * self.wrench_on(body, wrench_N)
        centre, drag = body.centre_force_N, body.drag_force_N
        if inertia is not None:
            centre = centre + mass * self.acceleration_m_per_s2 * inertia
        if self.wind is not None and wind is not None:
            drag = self.wind.pressure_Pa * (body.drag_area_m2 or 0.0) * wind
        body = replace(body, mass_kg=factor * mass, wrench_N=wrench)
        body = replace(body, centre_force_N=centre, drag_force_N=drag)
        if body.motion is not None:
            inertia_kg_m2 = body.inertia_kg_m2 if self.inertia_kg_m2 is None else self.inertia_kg_m2
            body = replace(body, moving_mass_kg=mass, inertia_kg_m2=inertia_kg_m2)
        loaded = replace(robot, platform=body)
        # Weight, ice and drag of a cable per unstrained length, in the world frame.
        ice = self.ice or Ice(0.0)
        density: float | FloatArray = cable.linear_density_kg_per_m
        density = density + ice.linear_density_kg_per_m(cable)
        if self.wind is not None and wind is not None:
            load = np.multiply.outer(-STANDARD_GRAVITY_M_PER_S2 * density, robot.level[2])
            per_m2 = self.wind.pressure_Pa * self.wind.cable_drag_coefficient
            load = load + np.multiply.outer(per_m2 * cable.width_m(2.0 * ice.thickness_m), wind)
            size: FloatArray = np.asarray(np.linalg.norm(load, axis=-1))
            along = (load / size[..., None]).reshape(-1, 3)
            if not np.allclose(along, along[0], rtol=0.0, atol=_SAME_DIRECTION):
                raise ValueError("wind loads cables to which different things are attached apart")
            loaded = replace(loaded, cable_load_direction=along[0])
            density = (size if size.ndim else float(size)) / STANDARD_GRAVITY_M_PER_S2
        if self.wind is not None or self.ice is not None:
            cable = replace(cable, linear_density_kg_per_m=density)
        if self.expansion_per_K is not None:
            cable = replace(cable, expansion_per_K=self.expansion_per_K)
        return Loaded(self, bare, loaded, cable, wind, inertia, lost_cable, wrench_N)


STATIC = LoadCase("static")
"""What a study without load cases is solved for."""


def _aside(along: FloatArray, axes: FloatArray, step: float) -> Iterator[FloatArray]:
    """Yield unit vectors by a step aside from one (3,) among those that axes (n, 3) span.

    Each way across it; a step along it would turn nothing.
    """
    *across, _ = np.linalg.svd(axes - np.outer(axes @ along, along), full_matrices=False)[2]
    for side in across:
        for direction in (along + step * side, along - step * side):
            yield direction / np.linalg.norm(direction)


def free_axes(robot: Robot) -> FloatArray:
    """Return the axes along which forces move the platform, (3, 3), in a plane (2, 3)."""
    return robot.level[[0, 2]] if robot.is_planar else np.eye(3)


def _inertia_directions(robot: Robot) -> FloatArray:
    """Return unit vectors of a force that moves the platform (n, 3)."""
    axes = free_axes(robot)
    steps = np.array(list(product((-1.0, 0.0, 1.0), repeat=len(axes))))
    size = np.abs(steps).sum(axis=1)
    steps = steps[(size > 0.0) & ((len(axes) == 2) | (size != 2.0))]
    return np.asarray(steps / np.linalg.norm(steps, axis=1, keepdims=True) @ axes)
