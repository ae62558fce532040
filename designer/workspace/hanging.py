"""Samples in which a cable hangs as none should: far longer than its chord, or below the floor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.space import named_pose
from designer.model.workspace import Workspace
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.task import LONG
from designer.workspace.demand import is_counted


@dataclass(frozen=True, slots=True)
class Hanging:
    """Samples in which a cable hangs too far, and the worst of them.

    Parameters
    ----------
    samples : int
        How many there are.
    extreme : float
        The largest length over chord; or the height of the lowest point [m].
    cable : int
        Which cable, counted from 1.
    place : tuple of float
        In which sample, see `designer.model.space` [m, rad].
    """

    samples: int
    extreme: float
    cable: int
    place: tuple[float, ...]


def _named(name: str, extreme: str) -> dict[str, Any]:
    """Return how files of results name one of the two kinds, and its worst value."""

    def named(worst: Hanging | None) -> dict[str, Any]:
        if worst is None:
            return {name: {"samples": 0}}
        pose = named_pose(np.array(worst.place))
        return {
            name: {"samples": worst.samples, extreme: worst.extreme, "cable": worst.cable, **pose}
        }

    return {"json": named}


@dataclass(frozen=True, slots=True)
class HangingCables:
    """What hangs too far over a workspace; None where nothing does.

    Parameters
    ----------
    samples : int
        Samples looked at: those that are solved and count.
    long : Hanging or None
        Cables longer than `LONG` times their chord.
    below_floor : Hanging or None
        Cables that hang below the floor; None also where the study has no floor.
    """

    samples: int = field(default=0, metadata={"json": None})
    long: Hanging | None = field(default=None, metadata=_named("long_cables", "length_over_chord"))
    below_floor: Hanging | None = field(default=None, metadata=_named("below_floor", "lowest_m"))

    def notes(self) -> Iterator[tuple[str, str]]:
        """Yield a heading and a few words for each of the two that there is."""
        kinds = (
            ("long cables", self.long, "times its chord"),
            ("below floor", self.below_floor, "m"),
        )
        for heading, hanging, unit in kinds:
            if hanging is not None:
                share = f"{hanging.samples / self.samples:.2%} of the samples"
                yield (
                    heading,
                    f"{share}, cable {hanging.cable} at the worst {hanging.extreme:.4g} {unit}",
                )


def look_at(
    hanging_cables: HangingCables,
    values: FloatArray,
    statics: Statics,
    counts: BoolArray,
    floor_m: float | None,
) -> HangingCables:
    """Return what was found before with these samples (n, n_coordinates) added, if they count.

    No cable may hang below ``floor_m``, upright frame [m].
    """
    long = _add(hanging_cables.long, values, statics.length_over_chord, counts, LONG, sign=1.0)
    below = hanging_cables.below_floor
    if floor_m is not None:
        below = _add(below, values, statics.lowest_m, counts, floor_m, sign=-1.0)
    return HangingCables(hanging_cables.samples + int(counts.sum()), long, below)


def survey_hanging(robot: Robot, workspace: Workspace, cable: Cable | Cables) -> HangingCables:
    """Return which samples of the workspace have such a cable, with these cables on the machine."""
    hanging_cables = HangingCables()
    for places in workspace.places():
        statics = solve_sagging(robot, Poses.at(places), cable)
        counts = is_counted(statics, workspace.hangs_below)
        hanging_cables = look_at(hanging_cables, places, statics, counts, workspace.floor_m)
    return hanging_cables


def _add(
    before: Hanging | None,
    places: FloatArray,
    values: FloatArray,
    counts: BoolArray,
    limit: float,
    *,
    sign: float,
) -> Hanging | None:
    """Count samples with a value beyond the limit; `sign` tells on which side of it."""
    excess = sign * (values - limit)
    beyond = counts[:, None] & (excess > 0.0)
    if not beyond.any():
        return before
    at, cable = np.unravel_index(np.where(beyond, excess, 0.0).argmax(), excess.shape)
    samples = int(beyond.any(axis=1).sum())
    hanging = Hanging(samples, float(values[at, cable]), int(cable) + 1, tuple(places[at].tolist()))
    if before is None:
        return hanging
    farthest = max(before, hanging, key=lambda candidate: sign * candidate.extreme)
    total = before.samples + samples
    return Hanging(total, farthest.extreme, farthest.cable, farthest.place)
