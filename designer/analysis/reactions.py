"""The envelope of what the cables of the design do to their supports, in every load case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from designer.arrays import FloatArray
from designer.documents.plain import Json, csv_text, plain, record
from designer.model.load_case import Loaded
from designer.model.space import named_place
from designer.progress import Advance
from designer.selection.criteria import (
    CaseLoads,
    Criterion,
    Evaluation,
    equilibria,
    evaluate,
    starts_of_each,
)
from designer.statics.inverse import Statics, platform_branch_N, reaction_N, winch_branch_N
from designer.workspace.refine import ONE_CLIMB

EXTREMES = ("largest", "horizontal", "up", "down")
"""Of which of its sizes a reaction is largest; the last two along the true vertical. Where no force
points that way the size is negative, of the one that points nearest to it."""
_CLIMB_AFTER_TURNING = replace(ONE_CLIMB, per_edge=0, per_face=0, inside=0, tolerance=1e-4)
"""Of the place after its loads were turned: there are a hundred extremes."""


@dataclass(frozen=True, slots=True, eq=False)
class Reaction:
    """What a cable does to the support of its exit point, where one size of it is largest."""

    mast: int  #: the exit point, from 1
    load_case: str  #: in which load case
    extreme: str  #: one of `EXTREMES`
    size_N: float  #: that size [N]
    force_N: FloatArray  #: (3,) all known branches of the cable together, world frame [N]
    platform_branch_N: FloatArray  #: (3,) of the branch to the platform [N]
    #: (3,) of the branch to the winch; None where nothing tells where that stands [N]
    winch_branch_N: FloatArray | None
    exit_point_m: FloatArray  #: (3,) where the cable leaves the base, world frame [m]
    #: in which direction of wind and inertia force, or without which cable
    loaded: Loaded = field(metadata={"json": lambda loaded: {"direction": loaded.words or None}})
    #: (n_coordinates,) where the platform is, see `designer.model.space` [m, rad]
    place: FloatArray = field(metadata={"json": named_place})


def sizes_N(statics: Statics) -> FloatArray:
    """Return the sizes of the reactions, in the order of `EXTREMES` (..., n_cables, 4) [N]."""
    reaction, up = reaction_N(statics), statics.robot.level[2]
    vertical = reaction @ up
    level = np.linalg.norm(reaction - vertical[..., None] * up, axis=-1)
    return np.stack([np.linalg.norm(reaction, axis=-1), level, vertical, -vertical], axis=-1)


def reactions_of(loads: Sequence[CaseLoads], progress: Advance) -> tuple[Reaction, ...]:
    """Return the extremes of each support in each load case, searched as requirements are.

    Where wind and inertia force are turned to the worst, the place follows by a short climb.
    """
    evaluations = evaluate(loads, _criteria(loads), progress, again=_CLIMB_AFTER_TURNING)
    reactions = map(_reaction, evaluations)
    order = {case.case.name: number for number, case in enumerate(loads)}
    return tuple(
        sorted(reactions, key=lambda r: (r.mast, order[r.load_case], EXTREMES.index(r.extreme)))
    )


def _criteria(loads: Sequence[CaseLoads]) -> list[Criterion]:
    """Return a criterion without a limit for each extreme of each support."""
    n_cables = loads[0].directions[0].robot.n_cables
    last: list[tuple[Statics, FloatArray]] = []  # all criteria look at the same equilibria

    def sizes(loaded: Loaded, statics: Statics) -> FloatArray:
        if not last or last[0][0] is not statics:
            of_all = sizes_N(statics)
            against = of_all[..., 2:] < 0.0
            # Of forces that point the other way the direction is sought: their least is some slack
            # cable's, which is of no interest and jumps with the internal forces.
            np.divide(of_all[..., 2:], of_all[..., :1], out=of_all[..., 2:], where=against)
            if loaded.lost_cable is not None:
                of_all = np.insert(of_all, loaded.lost_cable - 1, np.nan, axis=-2)
            last[:] = [(statics, of_all)]
        return last[0][1]

    def criterion(mast: int, extreme: str) -> Criterion:
        number = EXTREMES.index(extreme)
        return Criterion(
            id=f"{extreme} {mast}",
            title="",
            formula="",
            source="",
            unit="N",
            quantity=lambda loaded, statics: sizes(loaded, statics)[..., mast - 1, [number]],
            limits=(np.inf,),
            kind="at_most",
            at_rest_after_loss=True,
            starts=starts_of_each,
        )

    return [criterion(k, extreme) for k in range(1, n_cables + 1) for extreme in EXTREMES]


def _reaction(evaluation: Evaluation) -> Reaction:
    requirement = evaluation.requirement
    loaded, place = evaluation.loaded, requirement.place
    assert place is not None
    statics, _, _ = equilibria(loaded, evaluation.loads.workspace, place[None])
    extreme, mast = requirement.id.split()
    cable = int(mast) - 1
    column = cable - (loaded.lost_cable is not None and loaded.lost_cable <= cable)
    winch_branch = winch_branch_N(statics)
    return Reaction(
        mast=int(mast),
        load_case=requirement.load_case,
        extreme=extreme,
        size_N=float(sizes_N(statics)[0, column, EXTREMES.index(extreme)]),
        force_N=reaction_N(statics)[0, column],
        platform_branch_N=platform_branch_N(statics)[0, column],
        winch_branch_N=None if winch_branch is None else winch_branch[0, column],
        exit_point_m=loaded.robot.exit_points_m[cable],
        loaded=loaded,
        place=place,
    )


def reactions_csv(reactions: Sequence[Reaction]) -> str:
    """Return the extremes as a CSV table, a component a column; a missing number is empty."""
    rows = [dict(_cells(plain(record(reaction)))) for reaction in reactions]
    names = list(rows[0]) if rows else ["mast"]
    return csv_text([names, *([row[name] for name in names] for row in rows)])


_VECTORS = {
    **{f"{name}_N": f"{name}_{{}}_N" for name in ("force", "platform_branch", "winch_branch")},
    "exit_point_m": "exit_point_{}_m",
    "pose": "pose_{}_m",
    "rotation_vector": "rotation_vector_{}_rad",
}
"""Columns that one key becomes, with x, y and z."""


def _cells(row: Json) -> Iterator[tuple[str, object]]:
    for name, value in row.items():
        if name in _VECTORS:
            components = [None] * 3 if value is None else value
            yield from zip(map(_VECTORS[name].format, "xyz"), components, strict=True)
        else:
            yield name, value
