"""The probability that a size is enough, with its confidence, and the share of each input.

Two samples are drawn. One is of plain random numbers: its draws are independent, so that the number
of those that are enough is binomial and its interval exact, which holds as well where all are. The
other is quasi-random, by which the shares come out more precise from as many draws.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from designer.analysis.uncertainty.draws import Draws, columns_of, draws_at
from designer.analysis.uncertainty.poses import (
    Checked,
    GoverningCandidates,
    largest,
    may_govern,
    searched,
)
from designer.analysis.uncertainty.shares import SCRAMBLES, Share, shares_of
from designer.arrays import FloatArray
from designer.documents.plain import Json, record
from designer.effects.design import AsBuilt
from designer.model.cable import Cable
from designer.model.load_case import LoadCase
from designer.model.robot import Robot
from designer.model.uncertainty import Input, Normal, Spread, Uncertainty, Uniform
from designer.progress import Advance, Reporter
from designer.selection.candidate import Candidate
from designer.selection.efficiency import Allowance
from designer.selection.result import SelectionResult
from designer.study import Selection, Study

_PERCENTILES = {"p05": 5.0, "median": 50.0, "p95": 95.0}
CONFIDENCE = 0.95
_ALONE, _ALONE_SLOWLY = 1024, 256
"""Draws where the modulus of the rope is all that is not certain, and nobody asked."""
_PROBES = 32
_END = 1e-3
"""Share of a distribution beyond which its ends are not probed."""
_LEAST_POINTS = 16


@dataclass(frozen=True, slots=True, eq=False)
class SizeOdds:
    """How one size fares in all draws.

    Parameters
    ----------
    candidate : Candidate
        The size.
    utilisation : array (n_draws,)
        Largest over allowable tension in each draw; infinite where a pose is not held.
    """

    candidate: Candidate = field(metadata={"json": lambda rope: rope.ids})
    utilisation: FloatArray = field(metadata={"json": None})

    also_in_files: ClassVar = ("probability", "confidence", "not_held")

    @property
    def enough(self) -> int:
        """Draws in which it holds everywhere."""
        return int((self.utilisation <= 1.0).sum())

    @property
    def not_held(self) -> int:
        """Draws in which a pose is not held at all; they count as not enough."""
        return int((~np.isfinite(self.utilisation)).sum())

    @property
    def probability(self) -> float:
        """Share of the draws in which it is enough."""
        return self.enough / len(self.utilisation)

    @property
    def probability_95(self) -> tuple[float, float]:
        """Between which the probability lies with 95 % confidence."""
        return exact_interval(self.enough, len(self.utilisation))

    @property
    def confidence(self) -> dict[str, float]:
        """The same as files of results name it."""
        low, high = self.probability_95
        return {"level": CONFIDENCE, "low": low, "high": high}


@dataclass(frozen=True, slots=True, eq=False)
class UncertaintyAnalysis:
    """What becomes of the chosen rope where inputs are not certain.

    Parameters
    ----------
    spreads : mapping
        The distribution of each input that is not certain.
    is_asked : bool
        Whether the study asks for this; else it is for the borrowed modulus alone.
    is_modulus_of_grade : bool
        Whether the distribution of the modulus is what the grade states.
    chosen : SizeOdds
        The chosen size.
    sizes : tuple of SizeOdds
        The next size down, the chosen one and the next one up, where there are.
    shares : tuple of Share
        Of each input in the variance of the chosen size's utilisation, the largest first.
    why_no_shares : str
        Why there are none, for the reader of a report.
    points : int
        Points of each scramble by which the shares were found; 0 where they need none.
    seed : int
        Of all random numbers.
    poses : int
        Poses that are solved in each draw of the chosen size.
    checked : Checked
        What a search over the region found beyond these.
    """

    spreads: Mapping[Input, Spread]
    chosen: SizeOdds
    sizes: tuple[SizeOdds, ...]
    shares: tuple[Share, ...]
    seed: int
    poses: int
    is_asked: bool = False
    is_modulus_of_grade: bool = True
    why_no_shares: str = ""
    points: int = 0
    checked: Checked = field(default_factory=Checked)

    @property
    def samples(self) -> int:
        """Number of draws."""
        return len(self.chosen.utilisation)


def exact_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return between which a probability lies with 95 % confidence.

    C. J. Clopper, E. S. Pearson, Biometrika 26 (1934): never too narrow, whatever the probability.
    ``binomtest`` of SciPy has it too, in `scipy.stats`, which takes longer to import.
    """
    from scipy.special import betaincinv

    beyond, failures = (1.0 - CONFIDENCE) / 2.0, trials - successes
    low = betaincinv(successes, failures + 1, beyond) if successes else 0.0
    high = betaincinv(successes + 1, failures, 1.0 - beyond) if failures else 1.0
    return float(low), float(high)


def uncertainty_of(
    study: Study, selection: SelectionResult | None, built: AsBuilt, reporter: Reporter
) -> UncertaintyAnalysis | None:
    """Return how likely the chosen rope is enough, and which inputs that hangs on.

    Where the study does not ask for it, a modulus that is borrowed from another rope is drawn alone
    from what its grade states. None without a rope for all cables, without an input that is not
    certain, and for a modulus alone where the loss of a cable, which takes long to follow, governs.
    """
    chosen = selection.chosen if selection is not None else None
    if selection is None or chosen is None or study.selection is None or study.selection.groups:
        return None
    uncertainty = study.uncertainty or Uncertainty()
    elasticity = chosen.grade.elasticity
    off = elasticity.uncertainty
    if study.uncertainty is None and elasticity.basis != "borrowed":
        return None
    spreads = uncertainty.spreads(Uniform(-off, off))
    if not spreads:
        return None
    sampling = _Sampling(study.selection, built, chosen, spreads, uncertainty.seed)
    poses = sampling.poses_of(chosen)
    if study.uncertainty is not None:
        full = sampling.full(selection, poses, uncertainty.samples, reporter)
        return replace(
            full, is_modulus_of_grade="modulus" in spreads and uncertainty.modulus is None
        )
    if any(pose.loaded.keeps_lengths for pose in poses):
        return None
    samples = _ALONE if all(pose.is_one_pass for pose in poses) else _ALONE_SLOWLY
    odds = SizeOdds(chosen, largest(poses, sampling.drawn(samples)))
    return sampling.result(odds, poses)


@dataclass(frozen=True, slots=True)
class _Sampling:
    """What all sizes have in common."""

    selection: Selection
    built: AsBuilt
    chosen: Candidate
    spreads: Mapping[Input, Spread]
    seed: int

    @property
    def robot(self) -> Robot:
        return self.built.robot

    @property
    def columns(self) -> dict[Input, slice]:
        return columns_of(self.spreads, self.robot)

    @property
    def width(self) -> int:
        return sum(at.stop - at.start for at in self.columns.values())

    def drawn(self, samples: int) -> Draws:
        shares = np.random.default_rng(self.seed).random((samples, self.width))
        return draws_at(self.spreads, self.robot, shares)

    def probes(self) -> Draws:
        """The middle, both ends of each coordinate, and some draws."""
        ends = np.full((2 * self.width + 1, self.width), 0.5)
        for k in range(self.width):
            ends[2 * k : 2 * k + 2, k] = _END, 1.0 - _END
        unit = np.random.default_rng(self.seed + 1).random((_PROBES, self.width))
        shares = ends if self.width == 1 else np.concatenate([ends, unit])
        return draws_at(self.spreads, self.robot, shares)

    def poses_of(self, size: Candidate) -> list[GoverningCandidates]:
        def rope_in(case: LoadCase) -> Cable:
            allowance = Allowance.of(self.selection.under(case), self.built.robot.winches)
            cable = self.built.of_products.cable(allowance.cable(size.grade, size.size))
            case_result = next(
                result for result in (*size.cases, *self.chosen.cases) if result.case is case
            )
            return cable.at_tension(case_result.verification.max_tension_N)

        return may_govern(self.chosen.cases, rope_in, self.probes())

    def full(
        self,
        selection: SelectionResult,
        poses: list[GoverningCandidates],
        samples: int,
        reporter: Reporter,
    ) -> UncertaintyAnalysis:
        """Try the sizes beside the chosen one as well, search the poses, share out the spread."""
        draws, points = self.drawn(samples), 0
        if len(self.spreads) > 1:  # of one alone, all of the spread is its own
            points = max(2 ** ((samples // (4 * SCRAMBLES)).bit_length() - 1), _LEAST_POINTS)
        around = selection.beside(self.chosen)
        steps = samples * len(around) + SCRAMBLES * points * (len(self.spreads) + 2)
        with reporter.task("uncertainty", steps) as advance:
            used = largest(poses, draws, advance)
            poses, used, checked = searched(poses, draws, used)
            odds = SizeOdds(self.chosen, used)
            sizes = tuple(
                odds
                if size is self.chosen
                else SizeOdds(size, largest(self.poses_of(size), draws, advance))
                for size in around
            )
            shares, why = self._shares(poses, points, advance)
        result = replace(
            self.result(odds, poses), is_asked=True, sizes=sizes, why_no_shares=why,
            points=points, checked=checked,
        )  # fmt: skip
        return result if shares is None else replace(result, shares=shares)

    def _shares(
        self, poses: list[GoverningCandidates], points: int, advance: Advance
    ) -> tuple[tuple[Share, ...] | None, str]:
        if not points:
            return None, ""

        def used_at(shares: FloatArray) -> FloatArray:
            return largest(poses, draws_at(self.spreads, self.robot, shares), advance)

        columns = {str(name): at for name, at in self.columns.items()}
        try:
            shares_found = shares_of(used_at, columns, points, self.seed)
        except ValueError as error:
            return (), str(error)
        return tuple(sorted(shares_found, key=lambda share: -share.first_order)), ""

    def result(self, odds: SizeOdds, poses: list[GoverningCandidates]) -> UncertaintyAnalysis:
        """Return the result of the chosen size alone; a single input has all of the spread."""
        all_of_it = tuple(Share(name, 1.0, (1.0, 1.0), 1.0, (1.0, 1.0)) for name in self.spreads)
        return UncertaintyAnalysis(
            spreads=self.spreads,
            chosen=odds,
            sizes=(odds,),
            shares=all_of_it,
            seed=self.seed,
            poses=sum(len(pose.places) for pose in poses),
        )


def uncertainty_dict(uncertainty: UncertaintyAnalysis | None) -> Json | None:
    """Return probability, utilisation, sizes and shares; None where no input is uncertain."""
    if uncertainty is None:
        return None
    odds = record(uncertainty.chosen)
    return {
        "asked": uncertainty.is_asked,
        "requirements": ["breaking_load"],  # of all that the study asks for, these are drawn
        **{name: odds[name] for name in ("probability", "confidence", "not_held")},
        "utilisation": _utilisation(uncertainty),
        "inputs": [_input(uncertainty, name) for name in uncertainty.spreads],
        "shares": uncertainty.shares,
        "shares_reason": uncertainty.why_no_shares or None,
        "sizes": uncertainty.sizes,
        "samples": uncertainty.samples,
        "share_points": uncertainty.points,
        "seed": uncertainty.seed,
        "poses": uncertainty.poses,
        "searched": uncertainty.checked,
    }


def _utilisation(uncertainty: UncertaintyAnalysis) -> Json:
    """Return what is stated, and of the draws what they have in common; infinite where not held."""
    used = uncertainty.chosen.utilisation
    finite_values = used[np.isfinite(used)]
    return {
        "stated": uncertainty.chosen.candidate.verification.utilisation,
        "mean": finite_values.mean() if len(finite_values) else np.nan,
        "standard_deviation": finite_values.std() if len(finite_values) else np.nan,
        **{name: np.percentile(used, at, method="higher") for name, at in _PERCENTILES.items()},
        "largest": used.max(),
    }


def _input(uncertainty: UncertaintyAnalysis, name: Input) -> Json:
    spread = uncertainty.spreads[name]
    if isinstance(spread, Normal):
        shape: Json = {"distribution": "normal", "standard_deviation": spread.standard_deviation}
    else:
        shape = {"distribution": "uniform", "low": spread.low, "high": spread.high}
    of_grade = name == "modulus" and uncertainty.is_modulus_of_grade
    unit = "m" if name == "exit_points" else ""
    return {"input": name, **shape, "unit": unit, "from": "grade" if of_grade else "study"}
