"""The cables of the design in figures: lengths and tensions at poses, and for the workshop."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from designer import checked
from designer.analysis.analyse import Analysis
from designer.arrays import BoolArray, FloatArray, IntArray
from designer.documents.columns import POSITION, ROTATION_VECTOR, length_names, tension_names
from designer.documents.plain import csv_text
from designer.grades.grade import Grade, Size
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.winches import DEAD_TURNS, Drum
from designer.progress import Advance
from designer.selection.assignment import DesignCable
from designer.selection.reeving import Spooled, spooled_on
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.rest import find_equilibria, spread_poses
from designer.study import Study, declared_settings

_STARTS, _ROWS_AT_ONCE = 48, 16
_FULL = 1.0 + 1e-9
"""Utilisation where a cable was made for a pose, with what rounding adds."""
_MAX_NAMED_ROWS = 12
"""Rows that are named one by one."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Lengths(checked.Shown):
    """What the winches have to pay out.

    Parameters
    ----------
    cable : DesignCable
        With which cables.
    statics : Statics
        The poses (n_poses), solved.
    outside : array (n_poses,) of bool
        Which poses lie outside the study's region.
    """

    cable: DesignCable
    statics: Statics
    outside: BoolArray

    @property
    def utilisation(self) -> FloatArray:
        """Largest over allowable tension of each cable (n_poses, n_cables); NaN if not solved."""
        return np.asarray(self.statics.cable_tension_N / self.cable.cable.allowable_tension_N)

    @property
    def holds(self) -> BoolArray:
        """Which poses (n_poses,) are solved, with no cable beyond its allowable tension."""
        return np.asarray(self.statics.is_solved & ~(self.utilisation > _FULL).any(axis=-1))

    @property
    def stroke_m(self) -> FloatArray:
        """Longest less shortest unstrained length of each cable (n_cables,) [m]."""
        length = self.statics.length_m[self.statics.is_solved]
        return np.ptp(length, axis=0) if len(length) else np.full(length.shape[1], np.nan)

    def remarks(self) -> Iterator[str]:
        """Yield which poses are not held, beyond the allowable tension, or outside the region."""
        is_solved = self.statics.is_solved
        beyond = is_solved & ~self.holds
        yield from named_rows(~is_solved, "not held, see the verdict")
        if beyond.any():
            used = f"{self.utilisation[beyond].max():.1%}"
            yield from named_rows(beyond, f"beyond the allowable tension, up to {used} of it")
        yield from named_rows(self.outside, "outside the region that the study asks for")

    def to_csv(self, names: Sequence[str], values: FloatArray) -> str:
        """Return a table with the given columns (n_poses, n_names) first.

        Then the unstrained lengths, the tensions at the exit points, and the verdict; empty cells
        where a pose is not solved.
        """
        n_cables = self.statics.robot.n_cables
        rows = [[*names, *length_names(n_cables), *tension_names(n_cables), "verdict"]]
        figures = np.hstack([self.statics.length_m, self.statics.exit_tension_N])
        for coordinates, row, verdict in zip(values, figures, self.statics.verdict, strict=True):
            exactly = ["" if np.isnan(x) else repr(float(x)) for x in coordinates]
            solved = ["" if np.isnan(x) else f"{x:.10g}" for x in row]
            rows.append([*exactly, *solved, Verdict(int(verdict)).label])
        return csv_text(rows)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FoundPoses(checked.Shown):
    """Every equilibrium that was found on given lengths, stable ones of a row first.

    Parameters
    ----------
    cable : DesignCable
        With which cables.
    n_rows : int
        For how many rows of lengths.
    row : array (n_found,) of int
        Which of them each is of, from 0.
    place : array (n_found, 6)
        Position and rotation vector [m, rad].
    exit_tension_N : array (n_found, n_cables)
        Tension at the exit points [N].
    is_stable : array (n_found,) of bool
        Whether the platform stays there.
    is_allowed : array (n_found,) of bool
        Whether no cable is beyond its allowable tension.
    """

    cable: DesignCable
    n_rows: int
    row: IntArray
    place: FloatArray
    exit_tension_N: FloatArray
    is_stable: BoolArray
    is_allowed: BoolArray

    def to_csv(self, names: Sequence[str], values: FloatArray) -> str:
        """Return a table with the given columns (n_rows, n_names) first, a line each equilibrium.

        Then pose, tensions, whether it is stable, and its number in the row; empty cells, and
        solution 0, in a row without any.
        """
        tensions = tension_names(self.exit_tension_N.shape[1])
        columns = (*POSITION, *ROTATION_VECTOR, *tensions, "is_stable", "solution")
        lines = [[*names, *columns]]
        for row, numbers in enumerate(values):
            exactly = ["" if np.isnan(x) else repr(float(x)) for x in numbers]
            of_row = np.flatnonzero(self.row == row)
            for number, k in enumerate(of_row, start=1):
                figures = (f"{x:.10g}" for x in (*self.place[k], *self.exit_tension_N[k]))
                stable = "true" if self.is_stable[k] else "false"
                lines.append([*exactly, *figures, stable, str(number)])
            if not len(of_row):
                lines.append([*exactly, *[""] * (len(columns) - 1), "0"])
        return csv_text(lines)


def poses_of(
    analysis: Analysis, length_m: FloatArray, advance: Advance = lambda _: None
) -> FoundPoses | None:
    """Return all poses found on unstrained lengths (n_rows, n_cables) [m], at rest.

    The cables are those of `design_cable_of`; None if there are none. Searched from many starts,
    so that more may exist. ``advance`` is called with the number of rows solved.
    """
    cable = design_cable_of(analysis)
    if cable is None:
        return None
    robot = analysis.built.robot.at_rest
    starts = spread_poses(robot, _STARTS)
    pieces = []
    for first in range(0, len(length_m), _ROWS_AT_ONCE):
        rows = length_m[first : first + _ROWS_AT_ONCE]
        equilibria = find_equilibria(robot, cable.cable, rows, starts, with_unstable=True)
        statics, is_stable = equilibria.found.statics, equilibria.found.is_stable
        used = (statics.cable_tension_N / cable.cable.allowable_tension_N).max(axis=-1)
        for row, which in enumerate(equilibria.which):
            numbers, start = np.unique(which, return_index=True)
            start = start[numbers >= 0]
            start = start[np.argsort(~is_stable[row, start], kind="stable")]
            place = Poses(statics.poses.position_m[row], statics.poses.rotations[row])
            piece = (np.full(len(start), first + row), place.part(start).place)
            figures = statics.exit_tension_N[row, start], is_stable[row, start]
            pieces.append((*piece, *figures, used[row, start] <= _FULL))
        advance(len(rows))
    return FoundPoses(cable, len(length_m), *map(np.concatenate, zip(*pieces, strict=True)))


def design_cable_of(analysis: Analysis) -> DesignCable | None:
    """Return the cables of the design; None if there are none.

    The ropes of the answer, else the thinnest of the configured family that holds the workspace
    or, where there is none, the configured pose.
    """
    if analysis.qualities is not None:
        return analysis.qualities.cable
    if analysis.workspace is not None or analysis.pose is None or not analysis.is_positive:
        return None
    diameter_m = float(analysis.pose.sizing.diameter_m)
    name = f"{1e3 * diameter_m:.4g} mm of the configured family"
    return DesignCable(analysis.pose.material.cable(diameter_m), name)


def lengths_of(analysis: Analysis, poses: Poses, *, in_motion: bool = False) -> Lengths | None:
    """Solve poses (n_poses,) with the cables of the design; None if there is no such cable.

    At rest unless they are instants of the path of the study, passed ``in_motion``.

    The cables are those of `design_cable_of`.
    """
    cable = design_cable_of(analysis)
    if cable is None:
        return None
    workspace, robot = analysis.study.workspace, analysis.built.robot
    robot = robot if in_motion else robot.at_rest
    outside = np.zeros(poses.shape, dtype=bool)
    if workspace is not None and not workspace.region.is_discrete:
        outside = ~workspace.region.contains(poses.position_m)
    return Lengths(cable, solve_sagging(robot, poses, cable.cable), outside)


def scope_of_lengths(study: Study, *, in_motion: bool) -> Iterator[str]:
    """Yield what of a study is not in such lengths, a sentence each."""
    if study.load_cases:
        state = "in motion" if in_motion else "at rest"
        yield f"These are of the platform {state}, without the load cases of the study."
    unseen = [s.effect.key for s in declared_settings(study) if not s.effect.reaches_design]
    if unseen:
        yield (
            f"Lengths of the ropes themselves, at poses in the robot's frame: {', '.join(unseen)} "
            "of the study's effects do not reach a design, and are not in them."
        )


def named_rows(which: BoolArray, fault: str, what: str = "poses") -> Iterator[str]:
    """Yield how many rows have a fault, and the first of them by number; nothing where none has."""
    rows = [row for row, is_affected in enumerate(which, start=1) if is_affected]
    if rows:
        named = ", ".join(map(str, rows[:_MAX_NAMED_ROWS])) + " …" * (len(rows) > _MAX_NAMED_ROWS)
        yield f"{len(rows)} of {len(which)} {what} {fault}: row {named}"


@dataclass(frozen=True, slots=True)
class FabricatedCable:
    """One cable: what it is of, and its longest and shortest unstrained length [m]."""

    number: int
    grade: Grade
    size: Size
    longest_m: float
    shortest_m: float
    drum: Drum | None  # That of the study, and the rope on it
    spooled: Spooled | None

    @property
    def turns(self) -> float:
        """Turns of the study's drum, or the suggested one, from the shortest to the longest."""
        if self.spooled is not None:
            return self.spooled.turns
        return self.stroke_m / self.grade.drum_turn_m(self.size)

    @property
    def stroke_m(self) -> float:
        """How far the cable runs."""
        return self.longest_m - self.shortest_m

    @property
    def suggested_drum_m(self) -> float:
        """Diameter of drums and sheaves that the rope's table suggests; NaN without one."""
        ratio = self.grade.sheave_ratio
        return math.nan if ratio is None else ratio.suggested * self.size.diameter_m

    @property
    def least_drum_m(self) -> float:
        """The least diameter that the rope's table allows; NaN without one."""
        ratio = self.grade.sheave_ratio
        return math.nan if ratio is None else ratio.minimum * self.size.diameter_m

    @property
    def order_m(self) -> float:
        """The longest length with the dead turns, rounded up to a decimetre."""
        turn_m, dead_turns = self.grade.drum_turn_m(self.size), DEAD_TURNS
        if self.drum is not None:
            turn_m, dead_turns = self.drum.turn_m(self.size.diameter_m), self.drum.dead_turns
        dead_m = 0.0 if math.isnan(turn_m) else dead_turns * turn_m
        return math.ceil(10.0 * (self.longest_m + dead_m)) / 10.0


def spooled_of(analysis: Analysis) -> tuple[Spooled, ...]:
    """Return what becomes of each rope on its drum; nothing without ropes, or without a drum."""
    drum, assignment = analysis.built.robot.winches.drum, analysis.assignment
    if drum is None or not assignment.is_found:
        return ()
    lengths = assignment.verification.longest_m, assignment.verification.shortest_m
    return spooled_on(drum, *lengths, [rope.size.diameter_m for rope in assignment.by_cable])


def fabricated_cables(analysis: Analysis) -> list[FabricatedCable]:
    """Return each cable of the design; none where no ropes were found or asked for."""
    if not analysis.assignment.is_found:
        return []
    verification = analysis.assignment.verification
    lengths = zip(verification.longest_m.tolist(), verification.shortest_m.tolist(), strict=True)
    ropes = zip(analysis.assignment.by_cable, lengths, strict=True)
    drum, on_drum = analysis.built.robot.winches.drum, spooled_of(analysis)
    return [
        FabricatedCable(
            k + 1, rope.grade, rope.size, *ends_m, drum, on_drum[k] if on_drum else None
        )
        for k, (rope, ends_m) in enumerate(ropes)
    ]
