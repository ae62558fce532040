"""Frozen values of a cable and of a continuous family of cables."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Annotated

import numpy as np

from designer import checked
from designer.arrays import FloatArray, IntArray

STANDARD_GRAVITY_M_PER_S2 = 9.81
"""Gravitational acceleration used throughout, as in Riehl et al., ICRA 2010 [m/s²]."""
STEEL_EXPANSION_PER_K = 12e-6
"""Thermal expansion of steel, EN 1993-1-1:2005, 3.2.6 [1/K]."""
Unlimited = Annotated[float, checked.Number(above=0.0, finite=False)]
"""A figure that may be ``inf``."""


@dataclass(frozen=True, slots=True)
class Stiffening:
    """EA of a rope that depends on its tension: linear between the points, constant beyond.

    Parameters
    ----------
    tension_N : tuple of float
        Tensions, ascending [N].
    axial_stiffness_N : tuple of float
        EA at each of them [N].
    """

    tension_N: tuple[float, ...]
    axial_stiffness_N: tuple[float, ...]

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
    """What is clipped along a cable, such as a power line or a hose: it weighs, and bears nothing.

    Parameters
    ----------
    linear_density_kg_per_m : float
        Its mass per unstrained length of the cable [kg/m].
    diameter_m : float
        Its diameter, in wind and ice [m].
    """

    linear_density_kg_per_m: checked.NotNegative = 0.0
    diameter_m: checked.NotNegative = 0.0

    def on(self, rope: Cable) -> Cable:
        """Return a bare rope with this along it."""
        density = rope.linear_density_kg_per_m + self.linear_density_kg_per_m
        return replace(rope, linear_density_kg_per_m=density, attached=self)


NOTHING_ATTACHED = Attached()


@dataclass(frozen=True, slots=True)
class Cable:
    """One cable that can be bought or computed.

    Parameters
    ----------
    diameter_m : float
        Nominal diameter [m]; NaN where it is not known.
    linear_density_kg_per_m : float
        Mass per unstrained length, with what is attached along it [kg/m].
    axial_stiffness_N : float
        EA, force per strain [N]; ``inf`` for an inextensible cable.
    allowable_tension_N : float
        Largest tension the design may use, safety factor included [N].
    expansion_per_K : float
        Strain per change of temperature [1/K].
    stiffening : Stiffening or None
        How EA depends on the tension; None where it does not. ``axial_stiffness_N`` is then one
        value of it, which `designer.selection.stiffening` takes at the largest tension met.
    attached : Attached
        What is clipped along it; all other figures but the mass are those of the rope alone.
    """

    diameter_m: float
    linear_density_kg_per_m: checked.Positive
    axial_stiffness_N: Unlimited
    allowable_tension_N: Unlimited
    expansion_per_K: checked.Finite = STEEL_EXPANSION_PER_K
    stiffening: Stiffening | None = None
    attached: Attached = NOTHING_ATTACHED

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.diameter_m <= 0.0:
            raise ValueError(f"diameter_m must be above 0, not {self.diameter_m:g}")

    @property
    def weight_N_per_m(self) -> float:
        """Weight per unstrained length [N/m]."""
        return self.linear_density_kg_per_m * STANDARD_GRAVITY_M_PER_S2

    @property
    def rope_density_kg_per_m(self) -> float:
        """Mass per unstrained length of the rope alone [kg/m]."""
        return self.linear_density_kg_per_m - self.attached.linear_density_kg_per_m

    @property
    def diameters_m(self) -> tuple[float, ...]:
        """Diameters that wind and ice find: of the rope, and of what is attached [m]."""
        return tuple(d for d in (self.diameter_m, self.attached.diameter_m) if d != 0.0)

    def with_rope_scaled(self, factor: float) -> Cable:
        """Return the cable with a rope so many times as heavy; what is attached stays."""
        density = factor * self.rope_density_kg_per_m + self.attached.linear_density_kg_per_m
        return replace(self, linear_density_kg_per_m=density)

    def at_tension(self, tension_N: float) -> Cable:
        """Return the cable with its EA at a tension [N]; itself where EA does not depend on it."""
        if self.stiffening is None or not math.isfinite(tension_N):
            return self
        return replace(self, axial_stiffness_N=self.stiffening.at(tension_N))


@dataclass(frozen=True, slots=True, eq=False)
class Cables:
    """The cables of a robot where they differ: by exit point, or all of them from pose to pose.

    Its figures have the names of those of a `Cable`, as arrays (n_cables,), or (n_poses, 1).

    Parameters
    ----------
    each : sequence of Cable
        One for each exit point, in that order; or those that ``of_pose`` counts.
    of_pose : array (n_poses,) or None
        Which of them is on all winches in each pose.
    """

    each: Sequence[Cable]
    of_pose: IntArray | None = None
    linear_density_kg_per_m: FloatArray = field(init=False)
    weight_N_per_m: FloatArray = field(init=False)
    axial_stiffness_N: FloatArray = field(init=False)
    allowable_tension_N: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        if not self.each:
            raise ValueError("there must be a cable at least")
        for name in [figure.name for figure in fields(self) if not figure.init]:
            figures = np.array([getattr(cable, name) for cable in self.each])
            of_poses = figures if self.of_pose is None else figures[self.of_pose][:, None]
            object.__setattr__(self, name, of_poses)


@dataclass(frozen=True, slots=True, eq=False)
class MaterialsByPose:
    """Families of cables that differ from pose to pose, as `Cables`.

    Its figures have the names of those of a `Material`, as arrays (n_poses,).
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


@dataclass(frozen=True, slots=True)
class Material(checked.Value):
    """A family of cables that differ in section only.

    All three figures refer to the circle of the nominal diameter, so that a real rope, which
    fills only a part of that circle, is a ``Material`` as well as a solid rod is.

    Parameters
    ----------
    density_kg_per_m3 : float
        Mass per length over the area of the nominal circle [kg/m³].
    youngs_modulus_Pa : float
        EA over the area of the nominal circle [Pa].
    allowable_stress_Pa : float
        Allowable tension over the area of the nominal circle, safety factor included [Pa].
    """

    density_kg_per_m3: checked.Positive
    youngs_modulus_Pa: Unlimited
    allowable_stress_Pa: checked.Positive

    @property
    def elastic_compliance_per_m(self) -> float:
        """Weight per length over EA, κ = g ρ / E: the same for every section [1/m]."""
        return STANDARD_GRAVITY_M_PER_S2 * self.density_kg_per_m3 / self.youngs_modulus_Pa

    @property
    def strength_length_m(self) -> float:
        """Length whose own weight reaches the allowable stress, σ / (g ρ) [m]."""
        return self.allowable_stress_Pa / (STANDARD_GRAVITY_M_PER_S2 * self.density_kg_per_m3)

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
