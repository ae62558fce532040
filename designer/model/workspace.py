"""Which poses the cable must serve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Annotated, Literal

import numpy as np

from designer import checked
from designer.arrays import FloatArray, frozen_array
from designer.model.load_case import LoadCase
from designer.model.region import CHUNK, Region, Sampling
from designer.model.robot import SAG_AT_MOST, SAG_MAX
from designer.model.space import Orientations, Space
from designer.model.verdict import Verdict

HangsBelow = Literal["include", "exclude"]


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Workspace(checked.Value):
    """Which poses the cable must serve.

    Parameters
    ----------
    region : Region
        Prism, rectangle or list of points, world frame.
    samples, sampling, seed
        Number of poses to try (a list of points is taken whole), ``low_discrepancy`` (Sobol) or in
        a ``grid``, and seed of the Sobol scrambling.
    hangs_below : str
        ``include`` or ``exclude`` poses in which a cable hangs below the platform.
    clearance_m : float or None
        Least distance that cables shall keep from each other and from the platform [m]; None asks
        for none.
    orientations : Orientations
        How the platform shall be turned at every position.
    floor_m : float or None
        Height along the vertical that no cable shall hang below [m]; None for no floor.
    sag_max : float
        Largest sag over chord of the cables, see `Robot.sag_max`.
    proof_s : float
        Longest time for a proof that the chosen rope holds in all poses [s]; zero for none,
        infinite for as many boxes as it may take.
    """

    region: Region
    samples: checked.Count = 20_000
    sampling: Sampling = "low_discrepancy"
    seed: Annotated[int, checked.Number(least=0)] = 0
    hangs_below: HangsBelow = "include"
    clearance_m: checked.NotNegative | None = None
    orientations: Orientations = field(default_factory=Orientations)
    floor_m: checked.Finite | None = None
    sag_max: Annotated[float, checked.Number(above=0.0, most=SAG_AT_MOST)] = SAG_MAX
    proof_s: Annotated[float, checked.Number(least=0.0, finite=False)] = 0.0

    @property
    def space(self) -> Space:
        """All poses, as places: positions in every orientation."""
        return Space(self.region, self.orientations)

    def of_case(self, case: LoadCase) -> Workspace:
        """Return the workspace of a load case, which may have a region of its own."""
        if case.region is None:
            return self
        orientations = case.orientations or self.orientations
        return replace(self, region=case.region, orientations=orientations)

    def positions_m(self) -> Iterator[FloatArray]:
        """Yield the sample positions in pieces that have about `CHUNK` places at most (n, 3) [m].

        Memory stays flat, however many there are.
        """
        size = max(CHUNK // self.orientations.count, 1)
        draw = self.samples, self.sampling, self.seed
        is_short = self.samples <= CHUNK
        for chunk in (
            _cached_samples_m(self.region, *draw) if is_short else self.region.samples_m(*draw)
        ):
            yield from (chunk[start : start + size] for start in range(0, len(chunk), size))

    def places(self) -> Iterator[FloatArray]:
        """Yield the sample places in chunks (at most about `CHUNK`, n_coordinates) [m, rad].

        The orientations of a position follow one another in one chunk.
        """
        return map(self.space.places, self.positions_m())

    def with_fewer_samples(self, most: int) -> Workspace:
        """Return the same with so many samples at most, which of a list are points of it."""
        if self.sample_count <= most:
            return self
        return replace(self, samples=most, region=self.region.with_fewer_points(most))

    def thinned(self, most: int) -> FloatArray:
        """Return about `most` places (n, n_coordinates), fairly drawn from all samples [m, rad].

        Drawn are positions, from the whole of the region; each comes in all its orientations.
        """
        count = max(most // self.orientations.count, 1)
        rng = np.random.default_rng(self.seed)
        drawn, draws = np.empty((0, 3)), np.empty(0)
        for positions in self.positions_m():
            drawn = np.concatenate([drawn, positions])
            draws = np.concatenate([draws, rng.random(len(positions))])
            lowest = np.sort(np.argsort(draws)[:count])
            drawn, draws = drawn[lowest], draws[lowest]
        return self.space.places(drawn)

    @property
    def served(self) -> tuple[Verdict, ...]:
        """Verdicts of a pose at which nothing is wrong: it is held, or `hangs_below` leaves it out.

        What no finite cable holds is left out too, see `designer.workspace.demand.is_left_out`.
        """
        if self.hangs_below == "include":
            return (Verdict.SOLVED,)
        return Verdict.SOLVED, Verdict.NO_FINITE_CABLE

    def not_served(self, statuses: Mapping[str, int]) -> list[Verdict]:
        """Return the verdicts, of samples counted by their labels, at which something is wrong."""
        return [v for v in Verdict if statuses[v.label] > 0 and v not in self.served]

    @property
    def sample_count(self) -> int:
        """How many positions there are to try, for a progress bar (an estimate)."""
        return sum(map(len, self.positions_m())) if self.region.is_discrete else self.samples


@lru_cache(maxsize=8)
def _cached_samples_m(
    region: Region, count: int, sampling: Sampling, seed: int
) -> tuple[FloatArray, ...]:
    """Return the samples of a region: every candidate of a selection is tried at the same."""
    return tuple(map(frozen_array, region.samples_m(count, sampling, seed)))
