"""What cables meet over the samples of a workspace, in one direction of a load case."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable
from designer.model.load_case import Loaded
from designer.model.robot import Poses
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.selection.stiffening import StiffnessSearch
from designer.selection.verify import Sampled, verify_sizes
from designer.workspace.demand import is_left_out, rope_demand, settled

FEW_SAMPLES = 64
"""Poses in which lengths are kept, for each candidate."""


def sampled_at_tension(
    loaded: Sequence[Loaded], workspace: Workspace, progress: Advance = lambda _: None
) -> list[tuple[Loaded, Sampled]]:
    """Solve the samples with each of the cables, as stiff as at the tension that it meets there."""
    solved = list(zip(loaded, over_samples(loaded, workspace, progress), strict=True))
    searches = [StiffnessSearch() for _ in solved]
    unsettled: Sequence[int] = range(len(solved))
    while unsettled:
        trials: dict[int, Loaded] = {}
        for k in unsettled:
            candidate, sampled = solved[k]
            tension_N = sampled.verification(candidate.cable).max_tension_N
            trial = searches[k].next_of(candidate, tension_N)
            if trial is not None:
                trials[k] = trial
        again = over_samples(list(trials.values()), workspace)
        for (k, trial), sampled in zip(trials.items(), again, strict=True):
            solved[k] = trial, sampled
        unsettled = list(trials)
    return solved


def over_samples(
    loaded: Sequence[Loaded], workspace: Workspace, progress: Advance = lambda _: None
) -> list[Sampled]:
    """Solve the samples with each of the cables, all in one direction of one case."""
    if not loaded:
        return []
    if any(candidate.keeps_lengths for candidate in loaded):
        return [over_kept_lengths(candidate, workspace, FEW_SAMPLES) for candidate in loaded]
    # Which poses are left out the compiled sweep cannot tell: its down is the load.
    if workspace.hangs_below == "exclude" and loaded[0].robot.cable_load_direction is not None:
        return [_one_by_one(candidate, workspace) for candidate in loaded]
    if loaded[0].case.changes_robot:
        return [
            verify_sizes(candidate.robot, workspace, [candidate.cable])[0] for candidate in loaded
        ]
    cables = [candidate.cable for candidate in loaded]
    return verify_sizes(loaded[0].robot, workspace, cables, progress=progress)


def over_kept_lengths(loaded: Loaded, workspace: Workspace, samples: int) -> Sampled:
    """Return what a cable meets on kept lengths, over some samples."""
    places = np.concatenate([workspace.space.landmarks(), workspace.thinned(samples)])
    loss = settled(loaded, Poses.at(places))
    counts = ~is_left_out(loss.before, workspace.hangs_below)
    tension = np.where(counts, loss.largest_tension_N, -np.inf)
    longest = np.nan_to_num(loss.before.length_m[counts]).max(axis=0, initial=0.0)
    return _sampled(loaded.cable, places, tension, longest)


def _one_by_one(loaded: Loaded, workspace: Workspace) -> Sampled:
    """Return what a cable meets over the samples, which poses count told by the true vertical."""
    demand = partial(rope_demand, loaded.robot, loaded.cable, workspace.hangs_below)
    every = (workspace.space.landmarks(), *workspace.places())
    batches = [batch for batch in every if len(batch)]  # a list of points has no landmarks
    tension, lengths, _ = np.split(
        np.concatenate([demand(batch) for batch in batches]), [1, 1 + loaded.robot.n_cables], axis=1
    )
    longest = np.maximum(lengths, 0.0).max(axis=0)
    return _sampled(loaded.cable, np.concatenate(batches), tension[:, 0], longest)


def _sampled(
    cable: Cable, places: FloatArray, tension_N: FloatArray, longest_m: FloatArray
) -> Sampled:
    """Put together what a cable meets; the tension is minus infinite where a pose is left out."""
    used = tension_N / cable.allowable_tension_N
    counts = ~np.isneginf(used)
    order = np.argsort(-used, kind="stable")[: counts.sum()]
    return Sampled(
        worst_places=places[order[:8]],
        utilisation=float(used.max()) if counts.any() else np.inf,
        longest_m=longest_m,
        samples=len(places),
        counted=int(np.isfinite(used).sum()),
        overloaded=int((used > 1.0).sum()),
        not_held=int(np.isposinf(used).sum()),
        is_complete=True,
    )
