"""Frozen values of a cable, of a continuous family of cables, and of what ropes cost."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from designer import checked
from designer.arrays import FloatArray, IntArray

STANDARD_GRAVITY_M_PER_S2 = 9.81
"""Gravitational acceleration used throughout, as in Riehl et al., ICRA 2010 [m/s²]."""
STEEL_EXPANSION_PER_K = 12e-6
"""Thermal expansion of steel, EN 1993-1-1:2005, 3.2.6 [1/K]."""
Trust = Literal["A", "B", "C"]
"""How far the figures of a rope are to be trusted: a maker's own, a seller's, third hand."""
SizeUnits = Literal["metric", "imperial"]
"""What the sizes of a rope are stepped in: millimetres or inches."""
Preference = Literal["metric", "imperial", "none"]
"""Units of the sizes that take the place of others as good as they are."""
MaterialName = Literal[
    "steel", "stainless", "hmpe", "vectran", "pbo", "aramid", "polyester", "nylon",
    "polyester and nylon", "polypropylene", "other",
]  # fmt: skip
"""What a rope bears its load with, as a study names it."""
Unlimited = Annotated[float, checked.Number(above=0.0, finite=False)]
"""A figure that may be ``inf``."""


@dataclass(frozen=True, slots=True)
class Stiffening:
    """EA of a rope that depends on its tension: linear between the points, constant beyond."""

    tension_N: tuple[float, ...]  #: Tensions, ascending [N]
    axial_stiffness_N: tuple[float, ...]  #: EA at each of them [N]

    def at(self, tension_N: float) -> float:
        """Return EA at a tension [N]."""
        tensions, stiffnesses = self.tension_N, self.axial_stiffness_N
        above = bisect_right(tensions, tension_N)
        if above == 0 or above == len(tensions):
            return stiffnesses[0] if above == 0 else stiffnesses[-1]
        share = (tension_N - tensions[above - 1]) / (tensions[above] - tensions[above - 1])
        return stiffnesses[above - 1] + share * (stiffnesses[above] - stiffnesses[above - 1])

    def scaled(self, tension: float, stiffness: float) -> Stiffening:
        """Return the same with each tension and each EA times a factor."""
        return Stiffening(
            tuple(tension * value for value in self.tension_N),
            tuple(stiffness * value for value in self.axial_stiffness_N),
        )


@dataclass(frozen=True, slots=True)
class Attached(checked.Value):
    """What is clipped along a cable, such as a hose: it weighs, and bears nothing."""

    #: Its mass per unstrained length of the cable [kg/m]
    linear_density_kg_per_m: checked.NotNegative = 0.0
    diameter_m: checked.NotNegative = 0.0  #: Its diameter, in wind and ice [m]


AttachedEach = tuple[Attached, ...]
"""What is clipped along each of the cables: one entry if all are alike, none for nothing."""


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Cable:
    """One cable that can be bought or computed.

    Parameters
    ----------
    diameter_m : float
        Nominal diameter [m]; NaN where it is not known.
    linear_density_kg_per_m : float or array (n_cables,)
        Mass per unstrained length, with what is attached along it [kg/m]; of each cable of the
        robot where that differs.
    axial_stiffness_N : float
        EA, force per strain [N]; ``inf`` for an inextensible cable.
    allowable_tension_N : float
        Largest tension the design may use, safety factor included [N].
    expansion_per_K : float
        Strain per change of temperature [1/K].
    stiffening : Stiffening or None
        How EA depends on the tension; None where it does not. ``axial_stiffness_N`` is then one
        value of it, which `designer.selection.cases` takes at the largest tension met.
    attached : tuple of Attached
        What is clipped along it, see `AttachedEach`; all other figures but the mass are those of
        the rope alone.
    """

    diameter_m: float
    linear_density_kg_per_m: checked.Positives
    axial_stiffness_N: Unlimited
    allowable_tension_N: Unlimited
    expansion_per_K: checked.Finite = STEEL_EXPANSION_PER_K
    stiffening: Stiffening | None = None
    attached: AttachedEach = ()

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.diameter_m <= 0.0:
            raise ValueError(f"diameter_m must be above 0, not {self.diameter_m:g}")

    @property
    def weight_N_per_m(self) -> float | FloatArray:
        """Weight per unstrained length, as the mass [N/m]."""
        return self.linear_density_kg_per_m * STANDARD_GRAVITY_M_PER_S2

    @property
    def mean_density_kg_per_m(self) -> float:
        """Mean over the cables of the mass per unstrained length [kg/m]."""
        return float(np.mean(self.linear_density_kg_per_m))

    @property
    def attached_density_kg_per_m(self) -> float | FloatArray:
        """Mass per unstrained length of what is attached, of each cable where it differs [kg/m]."""
        return _alike_or_each([line.linear_density_kg_per_m for line in self.attached])

    @property
    def rope_density_kg_per_m(self) -> float:
        """Mass per unstrained length of the rope alone [kg/m]."""
        return float(np.mean(self.linear_density_kg_per_m - self.attached_density_kg_per_m))

    def width_m(self, film_m: float) -> float | FloatArray:
        """Return what wind and ice find: diameters of the rope and of what is attached [m].

        A film makes each of them, where there is one, so much thicker.
        """
        films = [line.diameter_m + film_m * (line.diameter_m > 0.0) for line in self.attached]
        return self.diameter_m + film_m + _alike_or_each(films)

    def with_attached(self, attached: AttachedEach) -> Cable:
        """Return a bare rope with something along it."""
        laden = replace(self, attached=attached)
        density = self.linear_density_kg_per_m + laden.attached_density_kg_per_m
        return replace(laden, linear_density_kg_per_m=density)

    def with_rope_scaled(self, factor: float) -> Cable:
        """Return the cable with a rope so many times as heavy; what is attached stays."""
        density = factor * self.rope_density_kg_per_m + self.attached_density_kg_per_m
        return replace(self, linear_density_kg_per_m=density)

    def without(self, cable: int) -> Cable:
        """Return what is on a robot without one of its cables, counted from 1."""
        if len(self.attached) < 2:
            return self
        density = np.delete(self.linear_density_kg_per_m, cable - 1)
        attached = self.attached[: cable - 1] + self.attached[cable:]
        return replace(self, linear_density_kg_per_m=density, attached=attached)

    def at_tension(self, tension_N: float) -> Cable:
        """Return the cable with its EA at a tension [N]; itself where EA does not depend on it."""
        if self.stiffening is None or not math.isfinite(tension_N):
            return self
        return replace(self, axial_stiffness_N=self.stiffening.at(tension_N))


def _alike_or_each(figures: Sequence[float]) -> float | FloatArray:
    """Return the figure of all cables, 0 of none, or those of each (n_cables,)."""
    return np.array(figures) if len(figures) > 1 else sum(figures)


@dataclass(frozen=True, slots=True, eq=False)
class Cables:
    """The cables of a robot where they differ: by exit point, or all of them from pose to pose.

    Its figures have the names of those of a `Cable`, as arrays (n_cables,), or (n_poses, 1), or
    (n_poses, n_cables) where what is attached to the cables differs.
    """

    #: One for each exit point, in that order; or those that ``of_pose`` counts
    each: Sequence[Cable]
    of_pose: IntArray | None = None  #: (n_poses,): Which of them is on all winches in each pose
    linear_density_kg_per_m: FloatArray = field(init=False)
    weight_N_per_m: FloatArray = field(init=False)
    axial_stiffness_N: FloatArray = field(init=False)
    allowable_tension_N: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        if not self.each:
            raise ValueError("there must be a cable at least")
        for name in [figure.name for figure in fields(self) if not figure.init]:
            figures = np.array([getattr(cable, name) for cable in self.each])
            if self.of_pose is not None:
                figures = figures[self.of_pose].reshape(len(self.of_pose), -1)
            elif figures.ndim == 2:  # of each cable what is on its own exit point
                figures = np.diagonal(figures)
            object.__setattr__(self, name, figures)


@dataclass(frozen=True, slots=True, eq=False)
class MaterialsByPose:
    """Families of cables that differ from pose to pose, as `Cables`.

    Its figures have the names of those of a `Material`, as arrays (n_poses,), or
    (n_poses, n_cables) where what is attached to the cables differs.
    """

    each: Sequence[Material]
    of_pose: IntArray
    density_kg_per_m3: FloatArray = field(init=False)
    youngs_modulus_Pa: FloatArray = field(init=False)
    allowable_stress_Pa: FloatArray = field(init=False)
    elastic_compliance_per_m: FloatArray = field(init=False)
    strength_length_m: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        for name in [figure.name for figure in fields(self) if not figure.init]:
            figures = np.array([getattr(family, name) for family in self.each])
            object.__setattr__(self, name, figures[self.of_pose])


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Material(checked.Value):
    """A family of cables that differ in section only.

    All three figures refer to the circle of the nominal diameter, so that a real rope, which
    fills only a part of that circle, is a ``Material`` as well as a solid rod is.

    Parameters
    ----------
    density_kg_per_m3 : float or array (n_cables,)
        Mass per length over the area of the nominal circle [kg/m³]; of each cable of the robot
        where what is attached to them differs.
    youngs_modulus_Pa : float
        EA over the area of the nominal circle [Pa].
    allowable_stress_Pa : float
        Allowable tension over the area of the nominal circle, safety factor included [Pa].
    """

    density_kg_per_m3: checked.Positives
    youngs_modulus_Pa: Unlimited
    allowable_stress_Pa: checked.Positive

    @property
    def elastic_compliance_per_m(self) -> float | FloatArray:
        """Weight per length over EA, κ = g ρ / E: the same for every section [1/m]."""
        return STANDARD_GRAVITY_M_PER_S2 * self.density_kg_per_m3 / self.youngs_modulus_Pa

    @property
    def strength_length_m(self) -> float | FloatArray:
        """Length whose own weight reaches the allowable stress, σ / (g ρ) [m]."""
        return self.allowable_stress_Pa / (STANDARD_GRAVITY_M_PER_S2 * self.density_kg_per_m3)

    @property
    def averaged(self) -> Material:
        """The family with the mean density of the cables, to be told of in one figure."""
        return replace(self, density_kg_per_m3=float(np.mean(self.density_kg_per_m3)))

    def cable(self, diameter_m: float) -> Cable:
        """Return the member of the family with this nominal diameter."""
        area_m2 = math.pi * diameter_m**2 / 4.0
        return Cable(
            diameter_m=diameter_m,
            linear_density_kg_per_m=self.density_kg_per_m3 * area_m2,
            axial_stiffness_N=self.youngs_modulus_Pa * area_m2,
            allowable_tension_N=self.allowable_stress_Pa * area_m2,
        )

    def diameter_for_tension_m(self, tension_N: float) -> float:
        """Return the diameter that carries ``tension_N`` at the allowable stress [m]."""
        return math.sqrt(4.0 * tension_N / (math.pi * self.allowable_stress_Pa))


_SAME_DIAMETER = 2e-3
"""Relative: 9.53 mm is the size of 3/8 in, and no grade has two sizes so near."""


@dataclass(frozen=True, slots=True)
class RopePrice:
    """The price of a metre of one size, of a date such as ``2026-03`` or ``2026-03-31``.

    The size is named by its id, or by its diameter [m] where ``size_id`` is empty. ``line`` is
    that of the list's file.
    """

    grade: str
    size_id: str
    diameter_m: float
    price_per_m: float
    date: str
    line: int

    @property
    def size(self) -> str:
        """The size as a message names it."""
        return self.size_id or f"{self.diameter_m * 1e3:g} mm"

    def is_for(self, size_id: str, diameter_m: float) -> bool:
        """Tell whether it is for a size of its grade."""
        if self.size_id:
            return self.size_id.casefold() == size_id.casefold()
        return math.isclose(self.diameter_m, diameter_m, rel_tol=_SAME_DIAMETER)


@dataclass(frozen=True, slots=True)
class PriceList:
    """Offers in one currency, from a file."""

    path: Path
    currency: str
    offers: tuple[RopePrice, ...]

    @property
    def name(self) -> str:
        """The file's name without its folder."""
        return self.path.name

    @property
    def dates(self) -> tuple[str, str]:
        """The earliest and the latest date."""
        dates = [offer.date for offer in self.offers]
        return min(dates), max(dates)

    def offers_of(self, grade: str) -> tuple[RopePrice, ...]:
        """Return the offers of one grade."""
        return tuple(offer for offer in self.offers if offer.grade == grade)
