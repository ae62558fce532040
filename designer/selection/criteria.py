"""What a study asks of every equilibrium beside strength: quantities and their limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.cable import Cable, Cables
from designer.model.load_case import Loaded
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.statics.inverse import Statics, sag_ratio, solve_sagging
from designer.statics.modes import NEAR, TAKES_PART, frequencies_Hz
from designer.statics.stiffness import (
    largest_displacement_m_per_N,
    least_eigenvalue_N_per_m,
    upright_stiffness,
)
from designer.study import Selection
from designer.workspace.clearance import names_of, smallest_clearance, where_pairs_are_near
from designer.workspace.demand import where_each_pulls_most

ROUNDING = 1e-9
"""Relative: how exactly the solver keeps a limit that it chooses the internal forces by."""
_MOST_LOADS = 14
"""Of those of a load case, in which straight cables are searched: as many as inertia forces."""
WHERE = "searched over the poses of the case"


@dataclass(frozen=True, slots=True, eq=False)
class Criterion:
    """A quantity of an equilibrium, and the limit that a study holds it against.

    Parameters
    ----------
    id, title, formula, source, unit : str
        As those of the `Requirement`.
    quantity : callable
        Returns the quantity (n, n_cables) or (n, 1) of equilibria (n,) in one direction of loads.
    limits : tuple of float
        One limit, or the lower and upper end of a band.
    kind : str
        Whether the quantity may be ``at_most``, or has to be ``at_least`` or ``above`` the limit,
        or ``outside`` the band.
    has_ratio : bool
        Whether demand over capacity means anything.
    at_rest_after_loss : bool
        Whether it is asked of the state after the loss of a cable as well.
    detail : callable or None
        Returns what to know of it there, such as between what a distance is, of equilibria (1,).
    capacity : callable or None
        Returns what the quantity is a share of, of each cable (n_cables,) [unit]; None where it is
        in that unit itself.
    starts : callable or None
        Returns where to search from beside samples (n, n_coordinates), of all directions of the
        loads, the workspace and those samples.
    why_open : callable or None
        Returns why it is not known to fail where it does not hold there; empty where it fails.
    """

    id: str
    title: str
    formula: str
    source: str
    unit: str
    quantity: Callable[[Loaded, Statics], FloatArray]
    limits: tuple[float, ...]
    kind: Literal["at_most", "at_least", "above", "outside"]
    has_ratio: bool = True
    at_rest_after_loss: bool = False
    detail: Callable[[Loaded, Statics], str] | None = None
    capacity: Callable[[Statics], FloatArray] | None = None
    starts: Callable[[Sequence[Loaded], Workspace, FloatArray], FloatArray] | None = None
    why_open: Callable[[Statics], str] = lambda _: ""

    def severity(self, quantity: FloatArray) -> FloatArray:
        """Return what grows as the quantity comes nearer to failing, NaN where that is NaN."""
        if self.kind == "at_most":
            return quantity
        if self.kind != "outside":
            return -quantity
        low, high = self.limits
        return np.asarray(np.minimum(high / quantity, quantity / low))

    def figures(self, quantity: float) -> tuple[float, float, float, bool]:
        """Return demand, capacity, utilisation and whether it holds."""
        limit = self.limits[0]
        if self.kind == "outside":
            low, high = self.limits
            depth = min(high / quantity, quantity / low)
            is_above = quantity / low >= high / quantity
            ends = (high, quantity) if is_above else (quantity, low)
            return *ends, depth, depth < 1.0
        if self.kind == "at_most":
            return quantity, limit, quantity / limit, quantity <= limit * (1.0 + ROUNDING)
        if self.kind == "above":
            return limit, quantity, math.nan, quantity > limit
        holds = quantity >= limit - ROUNDING * abs(limit)
        if not self.has_ratio:
            return limit, quantity, math.nan, holds
        used = limit / quantity if quantity > 0.0 else math.inf if limit > 0.0 else math.nan
        return limit, quantity, min(used, 1.0) if holds else used, holds


def criteria_of(robot: Robot, workspace: Workspace, selection: Selection | None) -> list[Criterion]:
    """Return what a study asks of the equilibria of every load case beside strength."""
    return [
        *_of_cables(robot.tension_min_N, robot.sag_max),
        *_of_winches(robot),
        *_of_workspace(workspace),
        *(() if selection is None else _of_limits(selection)),
    ]


def _of_cables(least_N: float, sag_max: float) -> Iterator[Criterion]:
    """Yield what is asked of the cables whatever the region, and of the platform they hold."""
    yield Criterion(
        id="least_tension",
        title="Slack",
        formula="least tension anywhere in a cable ≥ the least that the study requires",
        source=f"robot.tension_min; {WHERE}",
        unit="N",
        quantity=lambda _, statics: statics.least_tension_N,
        limits=(least_N,),
        kind="at_least" if least_N > 0.0 else "above",
    )
    yield Criterion(
        id="stability",
        title="Stability",
        formula="lowest eigenvalue of the platform's stiffness, cables of fixed length, turns as "
        "displacements of the farthest attachment > 0",
        source=f"the potential energy has a minimum; {WHERE}",
        unit="N/m",
        quantity=lambda _, statics: least_eigenvalue_N_per_m(
            statics.robot, upright_stiffness(statics)
        )[:, None],
        limits=(0.0,),
        kind="above",
    )
    yield Criterion(
        id="sag",
        title="Sag",
        formula="largest distance of a cable from its chord ≤ this share of the chord",
        source=f"workspace.sag; {WHERE}",
        unit="",
        quantity=lambda _, statics: sag_ratio(statics),
        limits=(sag_max,),
        kind="at_most",
    )


def _of_winches(robot: Robot) -> Iterator[Criterion]:
    """Yield what is asked of the winches in every equilibrium, along a path as they turn there."""
    winches, moves = robot.winches, robot.platform.motion is not None
    kept = winches.reeving_efficiency
    paid_out = ", times that as it is paid out," if moves else ","
    losses = "" if kept == 1.0 else f", over the {kept:.4g} that its sheaves keep of it{paid_out}"
    if winches.tension_max_N is not None:
        yield Criterion(
            id="winch_tension",
            title="Winch",
            formula=f"largest tension of a cable at its exit point{losses} ≤ that of its winch",
            source=f"robot.winches.tension_max; {WHERE}",
            unit="N",
            quantity=_share_of_winch,
            limits=(1.0,),
            kind="at_most",
            at_rest_after_loss=True,  # brakes have to hold it as well
            capacity=_winch_capacity_N,
            starts=starts_of_each,
            why_open=_why_other_tensions_may_do,
        )
    if winches.motor_torque_Nm is not None:
        yield Criterion(
            id="winch_torque",
            title="Motor",
            formula="M = T (D + (2k - 1) d) / (2 i η) ≤ torque of the motor; rope in layer k, T at "
            f"the drum{'; η times that as it is paid out, not over it' if moves else ''}",
            source=f"robot.winches.motor.torque; {WHERE}",
            unit="N*m",
            quantity=_motor_torque_Nm,
            limits=(winches.motor_torque_Nm,),
            kind="at_most",
        )


def starts_of_each(
    directions: Sequence[Loaded], workspace: Workspace, places: FloatArray
) -> FloatArray:
    """Return where to search for what each cable meets; see `where_each_pulls_most`."""
    among = directions[:: -(-len(directions) // _MOST_LOADS)]
    return where_each_pulls_most([loaded.robot for loaded in among], workspace.space, places)


def _winch_capacity_N(statics: Statics) -> FloatArray:
    """Return the largest tension of each winch (n_cables,), NaN where it has no limit [N]."""
    largest_N = statics.robot.winches.largest_tensions_N(statics.robot.n_cables)
    return np.where(np.isinf(largest_N), np.nan, largest_N)


def _share_of_winch(loaded: Loaded, statics: Statics) -> FloatArray:
    """Return tension over the largest of the winch (n, n_cables), NaN where it has no limit."""
    paid_out = is_paid_out(loaded, statics)
    drum_tension_N = statics.robot.winches.drum_tension_N(statics.exit_tension_N, paid_out)
    return np.asarray(drum_tension_N / _winch_capacity_N(statics))


def is_paid_out(loaded: Loaded, statics: Statics) -> BoolArray | bool:
    """Tell which cables (n, n_cables) are paid out at poses (n,) of a path.

    At rest none: there a winch is about to haul in.
    """
    motion = statics.robot.platform.motion
    if motion is None:
        return False
    instant = motion.instants_at(statics.poses.position_m)
    before = np.clip(instant - 1, 0, len(motion.time_s) - 3)
    around = np.unique(before[:, None] + np.arange(3))
    length_m = np.full((len(motion.time_s), statics.robot.n_cables), np.nan)
    poses = Poses.at(motion.places[around])
    length_m[around] = solve_sagging(statics.robot, poses, loaded.cable).length_m
    return np.asarray((motion.speeds_m_per_s(length_m)[instant] > 0.0) & (instant[:, None] >= 0))


def _why_other_tensions_may_do(statics: Statics) -> str:
    """Return why winches that differ may do with other internal forces; empty where not."""
    differ = isinstance(statics.robot.winches.tension_max_N, np.ndarray)
    if not (differ and statics.robot.is_redundant):
        return ""
    return "tensions are chosen for the ropes; others may suit winches that differ"


def _motor_torque_Nm(loaded: Loaded, statics: Statics) -> FloatArray:
    """Return the torque of each motor (n, n_cables), its rope in the outermost layer."""
    rope_m, paid_out = rope_diameter_m(loaded.cable), is_paid_out(loaded, statics)
    return statics.robot.winches.torque_Nm(statics.exit_tension_N, rope_m, paid_out)


def rope_diameter_m(cable: Cable | Cables) -> FloatArray | float:
    """Return the diameter of all cables, or of each (n_cables,) [m]."""
    if isinstance(cable, Cables):
        return np.array([each.diameter_m for each in cable.each])
    return cable.diameter_m


def _of_workspace(workspace: Workspace) -> Iterator[Criterion]:
    """Yield what is asked of where the cables run."""
    if workspace.floor_m is not None:
        yield Criterion(
            id="floor",
            title="Floor",
            formula="lowest point of a cable ≥ height of the floor",
            source=f"workspace.floor; {WHERE}",
            unit="m",
            quantity=lambda _, statics: statics.lowest_m,
            limits=(workspace.floor_m,),
            kind="at_least",
            has_ratio=False,  # heights make none
            at_rest_after_loss=True,
        )
    if workspace.clearance_m is not None:
        yield Criterion(
            id="clearance",
            title="Clearance",
            formula="smallest distance, axis to axis ≥ the clearance that the study requires",
            source=f"workspace.clearance; {WHERE}",
            unit="m",
            quantity=lambda _, statics: smallest_clearance(statics).distance_m[:, None],
            limits=(workspace.clearance_m,),
            kind="at_least",
            at_rest_after_loss=True,
            detail=lambda _, statics: " and ".join(
                names_of(tuple(smallest_clearance(statics).pair[0]))
            ),
            starts=lambda directions, workspace, places: where_pairs_are_near(
                directions[0].robot, workspace, directions[0].cable, places
            ),
        )


def _of_limits(selection: Selection) -> Iterator[Criterion]:
    """Yield the limits of a selection that are asked of every equilibrium."""
    limits = selection.limits
    if limits.platform_frequency_Hz is not None:
        ends_Hz = limits.platform_frequency_Hz
        span = "at least {:g} Hz" if len(ends_Hz) == 1 else "outside {:g} to {:g} Hz"
        yield Criterion(
            id="platform_frequency",
            title="Platform frequency",
            formula="natural frequencies of platform and cables together at which the platform has "
            f"{TAKES_PART:.0%} of the kinetic energy or more, {span.format(*ends_Hz)}",
            source=f"selection.limits.platform_frequency; {WHERE}",
            unit="Hz",
            quantity=partial(_frequency_Hz, ends_Hz, True),
            limits=ends_Hz,
            kind="at_least" if len(ends_Hz) == 1 else "outside",
        )
    if limits.stiffness_N_per_m is not None:
        yield Criterion(
            id="stiffness",
            title="Stiffness",
            formula="smallest force over displacement of the platform in any direction, cables of "
            "fixed length ≥ the least that the study requires",
            source=f"selection.limits.stiffness; {WHERE}",
            unit="N/m",
            quantity=_stiffness_N_per_m,
            limits=(limits.stiffness_N_per_m,),
            kind="at_least",
        )
    if limits.excitation_Hz is not None:
        low, high = limits.excitation_Hz
        yield Criterion(
            id="excitation",
            title="Excitation",
            formula=f"natural frequencies outside {low:g} to {high:g} Hz, of cables and platform "
            "together, overtones too; of cables alone where the platform's inertia is not given",
            source=f"selection.limits.excitation; {WHERE}",
            unit="Hz",
            quantity=partial(_frequency_Hz, (low, high), False),
            limits=(low, high),
            kind="outside",
        )


def _frequency_Hz(
    limits: tuple[float, ...], of_platform: bool, loaded: Loaded, statics: Statics
) -> FloatArray:
    """Return the lowest natural frequency, or that deepest in a band (n, 1)."""
    body, density = loaded.moving_body, loaded.moving_density_kg_per_m
    middle, near = (0.0, NEAR) if len(limits) == 1 else (math.sqrt(math.prod(limits)), math.inf)
    figures = frequencies_Hz(statics, body, density, middle, of_platform=of_platform, near=near)
    return figures[:, None]


def _stiffness_N_per_m(_: Loaded, statics: Statics) -> FloatArray:
    """Return the smallest force over displacement (n, 1), zero where the balance is not stable."""
    softness = largest_displacement_m_per_N(statics)
    return np.asarray(np.nan_to_num(1.0 / softness, nan=0.0))[:, None]
