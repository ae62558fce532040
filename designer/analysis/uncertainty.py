r"""How likely a rope is strong enough where inputs are uncertain, and which input that hangs on.

Plain random draws give a binomial count and so an exact interval; Sobol's indices (first and total
order) come from quasi-random draws, A. Saltelli et al., Computer Physics Communications 181 (2010),
doi:10.1016/j.cpc.2009.09.018. A product of utilisations scatters, the more so the less an input
matters: so a sum of polynomials :math:`g = \sum_i g_i(x_i)` is fitted to all draws, whose variances
are known, and only the residual r = u - g is sampled. With A, B two draws, :math:`A_i` the first
with input i of the second,

.. math::

    \operatorname{Var}(\operatorname{E}(u \mid x_i)) = \operatorname{Var} g_i
        + \overline{r_B g_i(B)} + \overline{r_{A_i} g_i(B)} + \overline{r_B\,(r_{A_i} - r_A)}.

Quasi-random points make a bootstrap several times too wide: the indices are computed for a few
independent scrambles, whose means have the interval of Student's t.

The worst pose may move from draw to draw. All poses among the worst at the ends of the inputs are
kept, of every load case and direction; the region is searched again for some draws, and what is
worse joins them. A platform f times as heavy on a rope is the same platform on a rope 1/f as heavy,
stiff and strong: a draw without moved exit points is another rope on the same robot, and all of
them are solved in one compiled pass.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import ClassVar

import numpy as np

from designer.analysis.sensitivity import payload_scaled
from designer.arrays import FloatArray
from designer.documents.plain import Json, record
from designer.effects.design import AsBuilt
from designer.kernel.calling import plain
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.model.uncertainty import Input, Normal, Spread, Uncertainty, Uniform
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.progress import Advance, Reporter
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult
from designer.selection.reeving import Allowance
from designer.selection.result import SelectionResult
from designer.statics.geometry import upright_situation
from designer.statics.sizes import add_slowly, evaluate_sizes, has_fast_solver
from designer.study import Study
from designer.workspace.demand import tension_demand
from designer.workspace.refine import LIGHT, Effort, refine

CONFIDENCE = 0.95
SCRAMBLES, _DEGREE, _LEAST_POINTS = 8, 3, 16
_MODULUS_DRAWS, _MODULUS_DRAWS_SLOW = 1024, 256  # where only a borrowed modulus is uncertain
_PROBES, _END = 32, 1e-3  # random probes; share of a distribution beyond which ends are not probed
_TINY = 1e-15  # nearest share to 0 and 1: there a normal deviation has no end
_LEAST_FACTOR = 0.01  # on any input; the widest normal goes lower once in 2 million draws
_NO_SPREAD = 1e-12
_CHUNK = 256
_NEAR = 0.99  # of a draw's largest utilisation: from where on a pose may govern it
_STARTS, _STARTS_SETTLING = 24, 2
_ELSEWHERE = 256  # samples that tell whether anything is served where all kept poses are left out
_MOST_ROUNDS, _CHECKED, _CHECKED_SLOWLY = 3, 6, 2
_WORSE = 1e-6  # relative: below what a search tells apart
_GLANCE = Effort(  # how hard a robot is searched that is slow to solve
    per_edge=8, per_face=16, inside=64, starts=2, finalists=1, revisited=0, trials=6,
    from_landmarks=False, tolerance=1e-3,
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """Inputs as drawn, the rope the same on all cables."""

    payload: FloatArray  # (n,): factor on what is stated, as the next three
    modulus: FloatArray
    linear_mass: FloatArray
    breaking_load: FloatArray
    exit_points_m: FloatArray  # (n, n_cables, 3): by how much they are moved

    def __len__(self) -> int:
        return len(self.payload)

    def part(self, at: slice | list[int]) -> Draws:
        return Draws(*(getattr(self, field.name)[at] for field in fields(self)))

    def on(self, loaded: Loaded, k: int) -> Loaded:
        """Return a load case with the inputs of draw ``k``."""
        loaded = payload_scaled(loaded, float(self.payload[k]))
        robot, rope = loaded.bare
        drawn = replace(
            rope.with_rope_scaled(float(self.linear_mass[k])),
            axial_stiffness_N=self.modulus[k] * rope.axial_stiffness_N,
            allowable_tension_N=self.breaking_load[k] * rope.allowable_tension_N,
        )
        moved = replace(robot, exit_points_m=robot.exit_points_m + self.exit_points_m[k])
        return loaded.on(moved, drawn)


def columns_of(spreads: Mapping[Input, Spread], robot: Robot) -> dict[Input, slice]:
    """Return which coordinates of a draw belong to each input."""
    columns, at = {}, 0
    for name in spreads:
        columns[name] = slice(at, at + (3 * robot.n_cables if name == "exit_points" else 1))
        at = columns[name].stop
    return columns


def draws_at(spreads: Mapping[Input, Spread], robot: Robot, shares: FloatArray) -> Draws:
    """Return the inputs at shares of their distributions, from 0 to 1 (n, n_columns).

    Exit points of a planar robot stay in its plane.
    """
    shares = np.clip(shares, _TINY, 1.0 - _TINY)
    off = {name: spreads[name].at(shares[:, at]) for name, at in columns_of(spreads, robot).items()}
    names: tuple[Input, ...] = ("payload", "modulus", "linear_mass", "breaking_load")
    payload, modulus, linear_mass, breaking_load = (
        np.maximum(1.0 + off[name][:, 0] if name in off else np.ones(len(shares)), _LEAST_FACTOR)
        for name in names
    )
    moved = off.get("exit_points", np.zeros((len(shares), 3 * robot.n_cables)))
    moved = moved.reshape(-1, robot.n_cables, 3)
    if robot.is_planar:
        across = robot.level[1]
        moved = moved - (moved @ across)[..., None] * across
    return Draws(payload, modulus, linear_mass, breaking_load, moved)


@dataclass(frozen=True, slots=True, eq=False)
class GoverningCandidates:
    """A load case in one direction, and places (n_places, n_coordinates) where it may govern."""

    loaded: Loaded
    workspace: Workspace
    places: FloatArray

    @property
    def is_one_pass(self) -> bool:
        """Whether all draws without moved exit points are solved in one compiled pass.

        Wind and forces of effects do not grow with the payload, and what is attached to cables
        does not vary with the rope.
        """
        loaded = self.loaded
        still = loaded.wind is None and not loaded.bare[0].platform.centre_force_N.any()
        is_plain = loaded.robot.has_equal_cables and still and not loaded.keeps_lengths
        return is_plain and has_fast_solver(loaded.robot)

    def elsewhere(self) -> GoverningCandidates:
        """Return the same at places from all over the region."""
        landmarks = self.workspace.space.landmarks()
        return replace(self, places=np.concatenate([landmarks, self.workspace.thinned(_ELSEWHERE)]))

    def utilisation(self, draws: Draws) -> FloatArray:
        """Return largest over allowable tension (n_draws, n_places).

        Infinite where a pose is not held, -inf where the study leaves it out.
        """
        moves = bool(draws.exit_points_m.any())
        if self.is_one_pass and not moves:
            return self._as_ropes(draws)
        if (
            self.is_one_pass
            and self.loaded.robot.has_one_branch
            and self.workspace.hangs_below != "exclude"
        ):
            used = self._as_poses(draws)
        else:
            used = np.full((len(draws), len(self.places)), np.nan)
        for k in np.flatnonzero(np.isnan(used).any(axis=1)).tolist():
            drawn = draws.on(self.loaded, k)
            tension = tension_demand(drawn, self.workspace.hangs_below, self.places)
            used[k] = tension / drawn.cable.allowable_tension_N
        return used

    def _ropes(self, draws: Draws) -> FloatArray:
        """Return mass per length, EA and allowable tension of each draw (n, 3); ice stays."""
        loaded, bare = self.loaded, self.loaded.bare[1]
        added = (draws.linear_mass - 1.0) * bare.rope_density_kg_per_m
        return np.column_stack(
            [
                loaded.cable.linear_density_kg_per_m + added,
                draws.modulus * bare.axial_stiffness_N,
                draws.breaking_load * bare.allowable_tension_N,
            ]
        )

    def _as_ropes(self, draws: Draws) -> FloatArray:
        """Solve each draw as another rope on the same robot."""
        robot, figures = self.loaded.robot, self._ropes(draws) / draws.payload[:, None]
        order = np.argsort(figures[:, 0], kind="stable")
        ropes = [Cable(math.nan, *row) for row in figures[order].tolist()]
        poses, cells = Poses.at(self.places), np.arange(len(self.places))
        exclude = self.workspace.hangs_below == "exclude"
        meets = evaluate_sizes(robot, poses, ropes, cells, len(cells), leaves_out_hanging=exclude)
        rows, at = np.nonzero(meets.failed)
        if len(rows):
            add_slowly(meets, robot, poses, ropes, rows, at, cells, exclude)
        used = np.empty_like(meets.utilisation)
        used[order] = np.where(meets.failed, np.inf, meets.utilisation)
        return used

    def _as_poses(self, draws: Draws) -> FloatArray:
        """Solve each draw with moved exit points as another pose; NaN where no solution was found.

        Geometry s times as large, on ropes with 1/s of the weight over stiffness, has the same
        angles and strains, with s times the tension over weight: each draw is put to the scale at
        which its rope has the stated weight over stiffness.
        """
        from designer.kernel.batch import solve_batch

        robot, cable, count = self.loaded.robot, self.loaded.cable, len(self.places)
        density, stiffness, allowable = self._ropes(draws).T
        stated = cable.linear_density_kg_per_m / cable.axial_stiffness_N
        scale = density / stiffness / stated
        force = scale * cable.linear_density_kg_per_m / density  # stated rope over the drawn one
        exits = (robot.exit_points_m + draws.exit_points_m) @ robot.upright.T
        at = (scale[:, None, None] * self.places[:, :3]).reshape(-1, 3)
        every = np.repeat(scale[:, None, None] * exits, count, axis=0)
        situation = upright_situation(robot, Poses.at(at), every)
        load = np.repeat(draws.payload * force, count)[:, None] * robot.loads_N()
        weight, ones = cable.weight_N_per_m, np.ones(robot.n_cables)
        solution = solve_batch(
            robot,
            situation._replace(load=plain(load)),
            weight / cable.axial_stiffness_N * ones,
            ones,
            cable.allowable_tension_N / weight * ones,
            1.0 / weight,
            sag_max=robot.sag_max,
        )
        solved = solution.verdict == Verdict.SOLVED
        used = np.where(solved, solution.load_factor, np.nan).reshape(len(draws), count)
        return np.asarray(used * (cable.allowable_tension_N / allowable / force)[:, None])


def largest(
    poses: Sequence[GoverningCandidates], draws: Draws, progress: Advance = lambda _: None
) -> FloatArray:
    """Return the largest utilisation of each draw (n,); infinite where not held or not served."""
    utilisation = np.empty(len(draws))
    for start in range(0, len(draws), _CHUNK):
        rows = slice(start, start + _CHUNK)
        part = draws.part(rows)
        highest = np.maximum.reduce([pose.utilisation(part).max(axis=1) for pose in poses])
        # Where hanging cables leave a pose out, the worst is at the border of that, which moves.
        gone = np.flatnonzero(np.isneginf(highest)).tolist()
        if gone:
            elsewhere = [pose.elsewhere().utilisation(part.part(gone)) for pose in poses]
            highest[gone] = np.maximum.reduce([values.max(axis=1) for values in elsewhere])
        utilisation[rows] = highest
        progress(len(part))
    return np.where(np.isneginf(utilisation), np.inf, utilisation)


def may_govern(
    cases: Sequence[CaseResult], rope_in: Callable[[LoadCase], Cable], probes: Draws
) -> list[GoverningCandidates]:
    """Return the poses, of each load case and direction, that are among the worst in a probe.

    ``cases`` are what was found with the chosen rope, ``rope_in`` gives the rope to ask about.
    """

    def of_case(case: CaseResult, rope: Cable) -> Iterator[GoverningCandidates]:
        """Yield the direction that asked for most, at many poses; the others at one."""
        robot, worst = case.loaded.bare[0], case.verification.worst_place[None]
        settles = case.loaded.keeps_lengths
        starts = case.sampled.worst_places[: _STARTS_SETTLING if settles else _STARTS]
        rest = [] if settles else [case.workspace.space.landmarks()]
        places = np.unique(np.concatenate([worst, starts, *rest]), axis=0)
        yield GoverningCandidates(case.loaded.on(robot, rope), case.workspace, places)
        for loaded in case.case.on(robot, rope):
            if loaded.words != case.loaded.words:
                yield GoverningCandidates(loaded, case.workspace, worst)

    every = [pose for case in cases for pose in of_case(case, rope_in(case.case))]
    used = [pose.utilisation(probes) for pose in every]
    highest = np.maximum.reduce([values.max(axis=1) for values in used])[:, None]
    near = [(values >= _NEAR * highest).any(axis=0) for values in used]
    return [
        replace(pose, places=pose.places[is_near])
        for pose, is_near in zip(every, near, strict=True)
        if is_near.any()
    ]


@dataclass(frozen=True, slots=True)
class Checked:
    """What a search over the region found beyond the poses that are kept."""

    draws: int = 0  # how many were searched, in each round
    rounds: int = 0
    missed: float = 0.0  # by how much the last round found more, as utilisation


def searched(
    poses: list[GoverningCandidates], draws: Draws, used: FloatArray
) -> tuple[list[GoverningCandidates], FloatArray, Checked]:
    """Search the region in telling draws; what is worse than the known poses joins them.

    Load cases on kept lengths, which take long to follow, are left out of the search.
    """
    survey = Checked()
    for turn in range(1, _MOST_ROUNDS + 1):
        is_slow = not all(has_fast_solver(pose.loaded.robot) for pose in poses)
        rows = _telling(used)[: _CHECKED_SLOWLY if is_slow else _CHECKED]
        found = [_worse(poses, draws.part([row]), float(used[row]), is_slow) for row in rows]
        exceeding = [pair for pair in found if pair is not None]
        survey = Checked(len(rows), turn, max((more for _, more in exceeding), default=0.0))
        if not exceeding:
            break
        new = [pose for pose, _ in exceeding]
        poses, used = [*poses, *new], np.maximum(used, largest(new, draws))
    return poses, used, survey


def _telling(used: FloatArray) -> list[int]:
    """Return the draws nearest to 100 %, and the largest, least, quartile, median and first."""
    finite = np.flatnonzero(np.isfinite(used))
    if not len(finite):
        return []
    order = finite[np.argsort(used[finite], kind="stable")]
    nearest = finite[np.abs(used[finite] - 1.0).argmin()]
    rows = [nearest, order[-1], order[0], *order[[len(order) // 4, len(order) // 2]], finite[0]]
    return [int(row) for row in dict.fromkeys(rows)]


def _worse(
    poses: Sequence[GoverningCandidates], draw: Draws, used: float, is_slow: bool
) -> tuple[GoverningCandidates, float] | None:
    """Return a pose that a draw uses more than the known ones, and by how much."""
    governing = max(poses, key=lambda pose: float(pose.utilisation(draw).max()))
    if governing.loaded.keeps_lengths:
        return None

    def demand(places: FloatArray) -> FloatArray:
        return np.asarray(replace(governing, places=places).utilisation(draw)[0])

    effort = _GLANCE if is_slow else LIGHT
    (worst,) = refine(governing.workspace.space, demand, governing.places, effort)
    if not worst.demand > used * (1.0 + _WORSE):
        return None
    return replace(governing, places=worst.place[None]), worst.demand - used


@dataclass(frozen=True, slots=True)
class Share:
    """Share of one input in the variance of the utilisation, with intervals of 95 %."""

    input: str
    first_order: float  # by how much the variance would fall if this input alone were certain
    first_order_95: tuple[float, float] = field(metadata={"json": "first_order_confidence"})
    total_order: float  # with all that the input does together with others
    total_order_95: tuple[float, float] = field(metadata={"json": "total_order_confidence"})


def shares_of(
    used_at: Callable[[FloatArray], FloatArray], columns: dict[str, slice], points: int, seed: int
) -> tuple[Share, ...]:
    """Return the shares of inputs in the variance of a function on the unit cube.

    ``used_at`` maps shares of distributions (n, n_columns) to the utilisation (n,); ``columns`` are
    the coordinates of each input; ``points``, a power of two, are those of each scramble, so that
    it is computed ``SCRAMBLES · points · (n_inputs + 2)`` times.

    Raises
    ------
    ValueError
        If the function is not finite everywhere, or does not vary: then there are no shares.
    """
    from scipy.special import eval_legendre, stdtrit

    children = np.random.default_rng(seed).spawn(SCRAMBLES)
    unit = np.array([_saltelli(columns.values(), points, child) for child in children])
    used = used_at(unit.reshape(-1, unit.shape[-1])).reshape(unit.shape[:-1])
    if not np.isfinite(used).all():
        percent = 100.0 * float((~np.isfinite(used)).mean())
        raise ValueError(
            f"in {percent:.3g} % of the draws a pose is not held, so that the utilisation "
            "has no variance"
        )
    if np.ptp(used) <= _NO_SPREAD * float(np.abs(used).max()):
        raise ValueError("the utilisation does not vary")
    # Legendre's polynomials (..., width, degree), of mean zero and variance one
    degree = np.arange(1, _DEGREE + 1)
    powers = np.sqrt(2 * degree + 1) * eval_legendre(degree, 2.0 * unit[..., None] - 1.0)
    indices = np.array([_indices(used, powers, columns.values(), k) for k in range(SCRAMBLES)])
    mean = indices.mean(axis=0)
    off = stdtrit(SCRAMBLES - 1, 0.975) * indices.std(axis=0, ddof=1) / np.sqrt(SCRAMBLES)
    table = np.stack([mean, mean - off, mean + off]).tolist()  # (3, 2, n_inputs)
    return tuple(
        Share(name, first[0], (first[1], first[2]), total[0], (total[1], total[2]))
        for name, (first, total) in zip(
            columns, np.transpose(table, (2, 1, 0)).tolist(), strict=True
        )
    )


def _saltelli(columns: Collection[slice], points: int, rng: np.random.Generator) -> FloatArray:
    """Return two draws A and B, then A with each input of B: (n_inputs + 2, n_points, width)."""
    from scipy.stats import qmc

    unit = qmc.Sobol(2 * max(at.stop for at in columns), rng=rng).random(points)
    base, second = unit[:, ::2], unit[:, 1::2]  # the first coordinates are the most even
    mixed = [base.copy() for _ in columns]
    for draw, at in zip(mixed, columns, strict=True):
        draw[:, at] = second[:, at]
    return np.stack([base, second, *mixed])


def _indices(
    used: FloatArray, powers: FloatArray, columns: Collection[slice], k: int
) -> FloatArray:
    """Return first and total order (2, n_inputs) by scramble ``k``, of a sum fitted to the others.

    Of the function (n_scrambles, n_inputs + 2, n_points) and polynomials (..., width, degree).
    """
    remaining = np.arange(len(used)) != k
    fitted = powers[remaining].reshape(used[remaining].size, -1)
    design = np.column_stack([np.ones(len(fitted)), fitted])
    constant, *factors = np.linalg.lstsq(design, used[remaining].ravel(), rcond=None)[0]
    factor = np.reshape(factors, powers.shape[-2:])
    parts = (powers[k] * factor).sum(axis=-1)  # (n_inputs + 2, n_points, width)
    rest = used[k] - constant - parts.sum(axis=-1)
    sums, residuals = parts[:2].sum(axis=-1), rest[:2]
    variance = (factor**2).sum() + 2.0 * np.mean(sums * residuals) + residuals.var()
    shares = []
    for i, at in enumerate(columns):
        base, second = parts[:2, :, at].sum(axis=-1)
        change = rest[2 + i] - rest[0]
        first_order = (factor[at] ** 2).sum() + np.mean(
            second * (rest[1] + rest[2 + i]) + rest[1] * change
        )
        total = (factor[at] ** 2).sum() + np.mean((second - base) * change + 0.5 * change**2)
        shares.append((first_order, total))
    return np.asarray(np.array(shares).T / variance)


def exact_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return between which a probability lies with 95 % confidence.

    C. J. Clopper, E. S. Pearson, Biometrika 26 (1934): never too narrow, whatever the probability.
    ``binomtest`` of `scipy.stats` has it too, and takes longer to import.
    """
    from scipy.special import betaincinv

    beyond, failures = (1.0 - CONFIDENCE) / 2.0, trials - successes
    low = betaincinv(successes, failures + 1, beyond) if successes else 0.0
    high = betaincinv(successes + 1, failures, 1.0 - beyond) if failures else 1.0
    return float(low), float(high)


@dataclass(frozen=True, slots=True, eq=False)
class SizeOdds:
    """How one size fares in all draws."""

    candidate: Candidate = field(metadata={"json": lambda rope: rope.ids})
    utilisation: FloatArray = field(metadata={"json": None})  # of each draw; infinite if not held

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
        return self.enough / len(self.utilisation)

    @property
    def probability_95(self) -> tuple[float, float]:
        return exact_interval(self.enough, len(self.utilisation))

    @property
    def confidence(self) -> dict[str, float]:
        low, high = self.probability_95
        return {"level": CONFIDENCE, "low": low, "high": high}


@dataclass(frozen=True, slots=True, eq=False)
class UncertaintyAnalysis:
    """What becomes of the chosen rope where inputs are uncertain."""

    spreads: Mapping[Input, Spread]
    chosen: SizeOdds
    sizes: tuple[SizeOdds, ...]  # the next size down, the chosen one and the next one up
    shares: tuple[Share, ...]  # of each input, the largest first
    seed: int
    poses: int  # solved in each draw of the chosen size
    is_asked: bool = False  # by the study; else it is for the borrowed modulus alone
    is_modulus_of_grade: bool = True
    why_no_shares: str = ""
    points: int = 0  # of each scramble; 0 where a single input has all of the spread
    checked: Checked = field(default_factory=Checked)

    @property
    def samples(self) -> int:
        return len(self.chosen.utilisation)

    def to_dict(self) -> Json:
        """Return probability, utilisation, sizes and shares as ``result.json`` has them."""
        odds, used = record(self.chosen), self.chosen.utilisation
        finite = used[np.isfinite(used)]
        percentiles = {"p05": 5.0, "median": 50.0, "p95": 95.0}
        return {
            "asked": self.is_asked,
            "requirements": ["breaking_load"],  # of all that the study asks for, these are drawn
            **{name: odds[name] for name in ("probability", "confidence", "not_held")},
            "utilisation": {
                "stated": self.chosen.candidate.verification.utilisation,
                "mean": finite.mean() if len(finite) else np.nan,
                "standard_deviation": finite.std() if len(finite) else np.nan,
                **{k: np.percentile(used, at, method="higher") for k, at in percentiles.items()},
                "largest": used.max(),
            },
            "inputs": [self._input(name, spread) for name, spread in self.spreads.items()],
            "shares": self.shares,
            "shares_reason": self.why_no_shares or None,
            "sizes": self.sizes,
            "samples": self.samples,
            "share_points": self.points,
            "seed": self.seed,
            "poses": self.poses,
            "searched": self.checked,
        }

    def _input(self, name: Input, spread: Spread) -> Json:
        if isinstance(spread, Normal):
            shape: Json = {
                "distribution": "normal", "standard_deviation": spread.standard_deviation,
            }  # fmt: skip
        else:
            shape = {"distribution": "uniform", "low": spread.low, "high": spread.high}
        source = "grade" if name == "modulus" and self.is_modulus_of_grade else "study"
        return {
            "input": name,
            **shape,
            "unit": "m" if name == "exit_points" else "",
            "from": source,
        }


def uncertainty_of(
    study: Study, selection: SelectionResult | None, built: AsBuilt, reporter: Reporter
) -> UncertaintyAnalysis | None:
    """Return how likely the chosen rope is enough, and which inputs that hangs on.

    Where the study does not ask for it, a modulus that is borrowed from another rope is drawn alone
    from what its grade states. None without a rope for all cables, without an uncertain input, and
    for a modulus alone where the loss of a cable, which takes long to follow, governs.
    """
    chosen = None if selection is None else selection.chosen
    if selection is None or chosen is None or study.selection is None or study.selection.groups:
        return None
    stated, elasticity, robot = study.uncertainty, chosen.grade.elasticity, built.robot
    uncertainty, off = stated or Uncertainty(), elasticity.uncertainty
    spreads = uncertainty.spreads(Uniform(-off, off))
    if not spreads or (stated is None and elasticity.basis != "borrowed"):
        return None
    columns = columns_of(spreads, robot)
    width = sum(at.stop - at.start for at in columns.values())

    def drawn(samples: int) -> Draws:
        unit = np.random.default_rng(uncertainty.seed).random((samples, width))
        return draws_at(spreads, robot, unit)

    # Probes: the middle, both ends of each coordinate, and some draws.
    ends = np.full((2 * width + 1, width), 0.5)
    for k in range(width):
        ends[2 * k : 2 * k + 2, k] = _END, 1.0 - _END
    some = np.random.default_rng(uncertainty.seed + 1).random((_PROBES, width))
    probes = draws_at(spreads, robot, ends if width == 1 else np.concatenate([ends, some]))

    def poses_of(size: Candidate) -> list[GoverningCandidates]:
        def rope_in(case: LoadCase) -> Cable:
            assert study.selection is not None
            allowance = Allowance.of(study.selection.under(case), robot.winches)
            cable = built.of_products.cable(allowance.cable(size.grade, size.size))
            found = next(r for r in (*size.cases, *chosen.cases) if r.case is case)
            return cable.at_tension(found.verification.max_tension_N)

        return may_govern(chosen.cases, rope_in, probes)

    poses = poses_of(chosen)
    alone = tuple(Share(name, 1.0, (1.0, 1.0), 1.0, (1.0, 1.0)) for name in spreads)
    if stated is None:
        if any(pose.loaded.keeps_lengths for pose in poses):
            return None
        is_fast = all(pose.is_one_pass for pose in poses)
        odds = SizeOdds(
            chosen, largest(poses, drawn(_MODULUS_DRAWS if is_fast else _MODULUS_DRAWS_SLOW))
        )
        n_poses = sum(len(pose.places) for pose in poses)
        return UncertaintyAnalysis(spreads, odds, (odds,), alone, uncertainty.seed, n_poses)
    points = 0
    if len(spreads) > 1:
        points = max(
            2 ** ((uncertainty.samples // (4 * SCRAMBLES)).bit_length() - 1), _LEAST_POINTS
        )
    draws, around, shares, why = drawn(uncertainty.samples), selection.beside(chosen), alone, ""
    steps = len(draws) * len(around) + SCRAMBLES * points * (len(spreads) + 2)
    with reporter.task("uncertainty", steps) as advance:
        poses, used, checked = searched(poses, draws, largest(poses, draws, advance))
        odds = SizeOdds(chosen, used)
        sizes = tuple(
            odds if size is chosen else SizeOdds(size, largest(poses_of(size), draws, advance))
            for size in around
        )
        if points:
            try:
                found = shares_of(
                    lambda unit: largest(poses, draws_at(spreads, robot, unit), advance),
                    {str(name): at for name, at in columns.items()}, points, uncertainty.seed,
                )  # fmt: skip
                shares = tuple(sorted(found, key=lambda share: -share.first_order))
            except ValueError as error:
                shares, why = (), str(error)
    return UncertaintyAnalysis(
        spreads, odds, sizes, shares, uncertainty.seed, sum(len(pose.places) for pose in poses),
        is_asked=True,
        is_modulus_of_grade="modulus" in spreads and uncertainty.modulus is None,
        why_no_shares=why, points=points, checked=checked,
    )  # fmt: skip
