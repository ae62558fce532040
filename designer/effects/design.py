"""What declared effects do to the design: the robot as built, and its cables."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields, replace
from typing import Any

import numpy as np

from designer.effects.effect import Setting, as_built
from designer.errors import EffectError
from designer.model.cable import Cable, Material
from designer.model.robot import Machine, Robot

_PROBES_M = (1e-3, 7e-3, 0.05, 0.35)
"""Diameters at which a family is looked at, to tell whether an effect leaves it one."""
_SAME = 1e-9
"""Relative: beyond rounding, below what any effect does."""


def _unchanged(cable: Cable) -> Cable:
    return cable


@dataclass(frozen=True, slots=True, eq=False)
class AsBuilt:
    """The robot as built, and what its cables are there."""

    robot: Robot  #: with moved exit points, pulleys, tilt, mass
    #: from a cable of the data sheet to that cable on this machine
    change: Callable[[Cable], Cable] = _unchanged
    #: diameter whose figures stand for a whole family where the effects do not leave it one, see
    #: `material` [m]
    section_m: float | None = None
    #: the same for a rope of the catalogue, without what belongs to another rope; None where it
    #: does not differ, see `designer.study.as_built_by`
    change_of_product: Callable[[Cable], Cable] | None = None

    @property
    def of_products(self) -> AsBuilt:
        """Return the same for ropes of the catalogue."""
        return replace(self, change=self.change_of_product or self.change, change_of_product=None)

    def cable(self, cable: Cable) -> Cable:
        """Return a cable as it is on this machine.

        Where EA depends on the tension, all of it changes as the present value does.
        """
        changed = self.change(cable)
        if changed.stiffening is None or changed.axial_stiffness_N == cable.axial_stiffness_N:
            return changed
        factor = changed.axial_stiffness_N / cable.axial_stiffness_N
        return replace(changed, stiffening=changed.stiffening.scaled(1.0, factor))

    def is_family(self, material: Material) -> bool:
        """Tell whether the members of a family are one on this machine as well.

        They are where every effect scales; not where one adds, such as a film of ice or a hose
        along the cable, which is little on a thick cable and much on a thin one.
        """
        reference, *cables = (np.hstack(astuple(self._at(material, d))) for d in _PROBES_M)
        return all(np.allclose(cable, reference, rtol=_SAME, atol=0.0) for cable in cables)

    def material(self, material: Material, diameter_m: float | None = None) -> Material:
        """Return a family of cables as it is on this machine.

        Where the effects do not leave it a family, the one whose member of ``diameter_m``, or else
        of ``section_m``, is right; the others are not, see `designer.workspace.section`.

        Raises
        ------
        ValueError
            If it is no family here, and no diameter is known.
        """
        if self.is_family(material):
            return self._at(material, _PROBES_M[1])
        section_m = diameter_m or self.section_m
        if section_m is None:
            raise ValueError("the effects leave no family, and no section is given")
        return self._at(material, section_m)

    def _at(self, material: Material, diameter_m: float) -> Material:
        if self.change is _unchanged:
            return material
        cable = self.change(material.cable(diameter_m))
        area_m2 = math.pi * diameter_m**2 / 4.0
        return Material(
            density_kg_per_m3=cable.linear_density_kg_per_m / area_m2,
            youngs_modulus_Pa=cable.axial_stiffness_N / area_m2,
            allowable_stress_Pa=cable.allowable_tension_N / area_m2,
        )


SettingsOf = Callable[[Machine], Sequence[Setting]]
"""The declared effects, as they are made for a machine."""


def built_with(machine: Machine, settings_of: SettingsOf) -> AsBuilt:
    """Return the robot and its cables with the effects that act on the machine.

    Each cable meets the effects with its own figures, in the machine's declared surroundings, and
    then gets what is attached along it.

    Raises
    ------
    EffectError
        If the robot itself depends on which cable it has: then no cable can be designed for it.
    """

    def built(cable: Cable) -> Machine:
        changed = replace(machine, cable=cable)
        return as_built(changed, settings_of(changed))

    any_family = Material(6000.0, 1e11, 2e8)
    thin, thick = (built(any_family.cable(d)).robot for d in (_PROBES_M[0], _PROBES_M[-1]))
    if not _is_same(thin, thick):
        names = sorted({s.effect.id for s in settings_of(machine) if s.effect.on_machine})
        raise EffectError(
            names[-1],
            f"effects {', '.join(names)}: one of them makes the robot depend on its cable, which "
            "cannot be chosen then (expected effects that change robot or cable, not one by the "
            "other)",
        )
    attached = machine.robot.attached
    has_effects = any(s.effect.on_machine for s in settings_of(machine))
    is_changed = has_effects or bool(attached)
    return AsBuilt(
        thin, (lambda c: built(c).cable.with_attached(attached)) if is_changed else _unchanged
    )


def _is_same(robot: Robot, before: Robot) -> bool:
    pairs: list[tuple[Any, Any]] = [(robot, before), (robot.platform, before.platform)]
    return all(
        np.array_equal(getattr(mine, field.name), getattr(theirs, field.name))
        for mine, theirs in pairs
        for field in fields(mine)
        if field.name != "platform"
    )
