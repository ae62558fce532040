"""Readings as a model predicts them by statics, and the residual of data in units of noise.

Of a robot with cables to spare the internal forces of each row are taken from its own readings; see
`designer.statics.balance`. Of a machine that was measured several times each session is predicted
by itself: its effects, its rows, its clock.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.statistics import MAD_TO_STD
from designer.effects.effect import Effect, Readings, Setting, as_built
from designer.effects.registry import SHIPPED, KnownEffects
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.load_case import AIR_DENSITY_KG_PER_M3
from designer.model.measurements import UNIT_NOISE, Measured, Noise
from designer.model.robot import Machine, Poses
from designer.statics.balance import InternalBalance, imbalance, solve_taut, solve_underactuated
from designer.statics.inverse import Statics, solve_sagging


def readings_of(machine: Machine, poses: Poses, measured: Measured | None = None) -> Readings:
    """Return unstrained lengths and winch-side tensions of a machine in poses (n_rows,).

    Robots with as many cables as degrees of freedom are solved exactly, those with fewer as
    `designer.statics.balance` has it. With more, the tensions nearest to balance are taken,
    see `designer.statics.balance`.
    """
    force = None if measured is None else added_force_N(machine, measured)
    if machine.robot.is_redundant:
        length, tension, span = solve_taut(machine.robot, poses, machine.cables, force)
        return Readings(length - straightened_m(machine, tension, span), tension)
    if machine.robot.is_square:  # hangs in the way that it was tightened to, better ones or not
        statics = solve_sagging(machine.robot, poses, machine.cables, force)
    else:
        statics = solve_underactuated(machine.robot, poses, machine.cables, force)
    return with_stiff_ends(machine, statics, true_readings(statics))


def with_stiff_ends(machine: Machine, statics: Statics, true: Readings) -> Readings:
    """Return the true readings of a balance, less what bending stiffness takes off the lengths."""
    if machine.flexural_rigidity_N_m2 == 0.0:
        return true
    span = statics.geometry().horizontal_distance_m
    return replace(true, length_m=true.length_m - straightened_m(machine, true.tension_N, span))


def added_force_N(machine: Machine, measured: Measured) -> FloatArray | None:
    """Return wind and late load on the platform, base frame (n_rows, 3) [N]; None without."""
    forces = []
    if machine.drag_area_m2 != 0.0 and measured.wind_m_per_s is not None:
        wind = measured.wind_m_per_s
        speed = np.linalg.norm(wind, axis=1, keepdims=True)
        forces.append(0.5 * AIR_DENSITY_KG_PER_M3 * machine.drag_area_m2 * speed * wind)
    if machine.late_load_kg != 0.0 and measured.time_s is not None:
        down = -machine.robot.upright[2]
        weight_N = STANDARD_GRAVITY_M_PER_S2 * machine.late_load_kg * down
        is_late = measured.time_s >= machine.late_load_from_s
        forces.append(is_late[:, None] * weight_N)
    return np.asarray(sum(forces)) if forces else None


def straightened_m(machine: Machine, tension_N: FloatArray, span_m: FloatArray) -> FloatArray:
    r"""Return what bending stiffness takes off the lengths [m].

    A cable of chord c under tension T, w_⊥ = w X / c across it, sags with the slope
    w_⊥ (c - 2 s)/(2 T); clamped ends bring the slope to zero within δ = √(EI/T). The arc is longer
    than the chord by half the square of the slope, which two thin layers reduce by
    3 δ w_⊥² c² / (8 T²).
    """
    rigidity = machine.flexural_rigidity_N_m2
    if rigidity == 0.0:
        return np.zeros_like(tension_N)
    # Odd in the rigidity, so that its slope at zero can be taken from both sides.
    layer = np.sign(rigidity) * np.sqrt(abs(rigidity) / tension_N)
    load = machine.cables.weight_N_per_m * span_m  # w_⊥ c
    return np.asarray(load**2 * 3.0 * layer / (8.0 * tension_N**2))


_TOLERANCE = 1e-5
"""Of the noise: far below what the slopes of a fit would show."""
_DISTRUST_RANGE = (0.7, 2.8)
"""Residual over the distrust within which the latter stays. A new distrust, a power of two, is at
most a factor of two below the residual; √2 more on either side keep it from swinging."""


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """What internal forces are taken with."""

    #: (n_rows, 2 n_cables): what sensors and stiff ends add to lengths [m] and tensions [N]
    added: FloatArray
    #: by how much more than noise lengths and tensions are off. As long as the model is off,
    #: readings are trusted to no more than that: else cables would be let slack to make up for an
    #: exit point in the wrong place.
    distrust: tuple[float, float] = (1.0, 1.0)
    near: Statics | None = None  #: the balance that it came from

    def with_distrust(self, measured: Measured, displayed: Readings, noise: Noise) -> Guess:
        """Return the guess with a distrust that suits what is displayed."""
        sigma = noise.of_channels(measured.length_m.shape[1])
        length, tension = np.hsplit(np.abs(measured.readings - displayed.stacked) / sigma, 2)
        distrust = (_distrust(length, self.distrust[0]), _distrust(tension, self.distrust[1]))
        return replace(self, distrust=distrust)

    def is_near(self, previous: Guess, noise: Noise) -> bool:
        """Tell whether another guess would give the same, to a small share of the noise."""
        change = np.abs(self.added - previous.added)
        is_still = change <= _TOLERANCE * noise.of_channels(change.shape[1] // 2)
        return bool(is_still.all()) and self.distrust == previous.distrust


def _distrust(off: FloatArray, before: float) -> float:
    """Return how far readings are off in units of noise; as before where that is about right."""
    finite = off[~np.isnan(off)]
    size = MAD_TO_STD * float(np.median(finite)) if finite.size else 0.0
    if _DISTRUST_RANGE[0] <= size / before <= _DISTRUST_RANGE[1]:
        return before
    return float(2.0 ** np.floor(np.log2(max(size, 1.0))))


@dataclass(frozen=True, eq=False)
class Built:
    """A machine with effects on it, and the rows in the poses that it had."""

    machine: Machine  #: with the effects
    measured: Measured  #: the rows

    @cached_property
    def _balance(self) -> InternalBalance:
        machine, measured = self.machine, self.measured
        force_N = added_force_N(machine, measured)
        return InternalBalance(machine.robot, measured.poses, machine.cables, force_N)

    def balanced(self, guess: Guess, noise: Noise, near: Statics | None = None) -> Statics:
        """Return the balance whose true lengths and tensions suit the readings."""
        length_m, tension_N = np.hsplit(self.measured.readings - guess.added, 2)
        doubt = noise.length_m * guess.distrust[0], noise.tension_N * guess.distrust[1]
        return self._balance.nearest(length_m, tension_N, doubt, near)


def true_readings(statics: Statics) -> Readings:
    """Return unstrained lengths and winch-side tensions."""
    return Readings(statics.length_m, statics.exit_tension_N)


# Slopes that were taken lately, which are good near the place where they were taken.
#
# What a reading gains by a parameter hardly changes while this and the others move by little. So a
# fit that nears its end, or that adds an effect to a model, asks for few slopes anew. The price is
# a fit off by a small share of its standard deviations; one that goes to the end asks for exact
# slopes.

_OWN_CHANGE, _OTHER_CHANGE = 0.02, 0.3
"""By how much values of the effect itself, and of others, may have moved, over `_Values.unit`."""
_MAX_PLACES = 12
"""Those of the parts of one validation, and a few more."""


class _Values(NamedTuple):
    """Values of an effect, those at which it does nothing, and what counts as a change.

    That is a typical change, or a tenth of the way from doing nothing where that is more.
    """

    values: FloatArray
    neutral: FloatArray
    unit: FloatArray


_Place = Mapping[str, _Values]


@dataclass(frozen=True, slots=True, eq=False)
class _CachedSlopes:
    place: _Place
    trust: Hashable
    slopes: dict[str, FloatArray]


@dataclass(eq=False)
class SlopeCache:
    """Remembers slopes by the values of all effects; the latest places only."""

    _taken: list[_CachedSlopes] = field(init=False, default_factory=list)

    def of(
        self,
        settings: Sequence[Setting],
        trust: Hashable,
        compute: Callable[[Setting], FloatArray],
        *,
        nearly: bool,
    ) -> FloatArray:
        """Return the slopes (…, n_parameters) of all effects at their values.

        Those of a place near by will do where ``nearly``; ``trust`` is what else slopes depend on,
        and ``compute`` returns those in the parameters of one of the settings.
        """
        place = {s.effect.key: _values_of(s) for s in settings}
        slopes: dict[str, FloatArray] = {}
        for cached in reversed([t for t in self._taken if t.trust == trust]):
            usable = _usable_slopes(place, cached, nearly=nearly) - slopes.keys()
            slopes |= {key: cached.slopes[key] for key in usable}
            if usable:  # those in use are the last to go
                self._taken.remove(cached)
                self._taken.append(cached)
        fresh = {s.effect.key: compute(s) for s in settings if s.effect.key not in slopes}
        if fresh:
            self._taken = [*self._taken[1 - _MAX_PLACES :], _CachedSlopes(place, trust, fresh)]
        slopes |= fresh
        return np.concatenate([slopes[s.effect.key] for s in settings], axis=-1)


def _values_of(setting: Setting) -> _Values:
    effect = setting.effect
    values = np.array([setting.values[p.name] for p in effect.parameters])
    neutral = np.array([p.neutral for p in effect.parameters])
    typical = np.array([p.typical for p in effect.parameters])
    return _Values(values, neutral, np.maximum(typical, 0.1 * np.abs(values - neutral)))


def _usable_slopes(place: _Place, cached: _CachedSlopes, *, nearly: bool) -> set[str]:
    """Return the effects whose slopes, taken elsewhere, are good at a place."""
    moved = {key: _distance(key, place, cached.place) for key in {**place, **cached.place}}
    own_limit, other_limit = (_OWN_CHANGE, _OTHER_CHANGE) if nearly else (0.0, 0.0)
    if max(moved.values()) > other_limit:
        return set()
    return {key for key in cached.slopes if key in place and moved[key] <= own_limit}


def _distance(key: str, place: _Place, cached: _Place) -> float:
    """Return how far an effect's values are apart; without the effect it does nothing."""
    at_place, at_cached = place.get(key), cached.get(key)
    present = at_place or at_cached
    assert present is not None
    a, b = (
        present.neutral if values is None else values.values for values in (at_place, at_cached)
    )
    return float(np.max(np.abs(a - b) / present.unit))


# The model.

Kind = tuple[object, ...]
"""A set of effects, whatever their values, with the noise that is assumed."""

_MAX_MACHINES = 8
"""Machines that are kept: effects on readings, one after the other, leave the machine alone."""
_MAX_ITERATIONS = 12
"""Turns at most: what sensors add depends little on internal forces, so that few will do."""


def kind_of(settings: Sequence[Setting], noise: Noise) -> Kind:
    """Return what a guess is remembered by."""
    return (noise, *(setting.effect.key for setting in settings))


@dataclass(eq=False)
class Predictor:
    """Predicts readings of one data set; remembers the last few machines it solved.

    Of a robot with as many cables as degrees of freedom the pose alone tells lengths and tensions.
    With more cables each row's internal forces are taken from its own readings, see
    `designer.diagnosis.problem`.
    """

    machine: Machine  #: as drawn, without any effect
    measured: Measured  #: the data
    #: effects that are declared; with those that are tried they act in the order of ``effects``
    fixed: tuple[Setting, ...] = ()
    effects: KnownEffects = SHIPPED  #: all effects, in the order in which they act
    #: the session that the rows are of, from 1, where there are several; effects of others do not
    #: act
    session: int | None = None
    _guesses: dict[Kind, Guess] = field(init=False, default_factory=dict)
    _solutions: dict[Kind, tuple[Readings, Readings]] = field(init=False, default_factory=dict)
    _built: dict[Kind, tuple[Measured, Built]] = field(init=False, default_factory=dict)
    slopes: SlopeCache = field(init=False, default_factory=SlopeCache)

    def at(self, measured: Measured) -> Predictor:
        """Return the same model for other rows; for the same rows, one without a memory."""
        return replace(self, measured=measured)

    def built(self, settings: Sequence[Setting]) -> Machine:
        """Return the machine with the declared effects and these."""
        return as_built(self.machine, self._all(settings))

    def placed(self, settings: Sequence[Setting]) -> Measured:
        """Return the rows in the poses that the platform had, as these effects have it."""
        poses = self.measured.poses
        for setting in self._all(settings):
            if setting.effect.on_poses is not None:
                poses = setting.effect.on_poses(poses, setting.values)
        return replace(self.measured, poses=poses)

    def _built_with(self, settings: Sequence[Setting]) -> Built:
        """Return machine and rows as these effects have them, from the latest where it is there."""
        bodily = (s for s in settings if s.effect.on_machine or s.effect.on_poses)
        key = tuple((s.effect.key, *s.values.values()) for s in bodily)
        rows, built = self._built.get(key, (None, None))
        if built is None or rows is not self.measured:
            built = Built(self.built(settings), self.placed(settings))
            if len(self._built) >= _MAX_MACHINES:
                self._built.clear()
            self._built[key] = self.measured, built
        return built

    def _all(self, settings: Sequence[Setting]) -> list[Setting]:
        """Return the effects that show in these rows, in the order in which they act."""
        all_settings = (*self.fixed, *settings)
        is_still = self.measured.settled
        return self.effects.in_order(
            s
            for s in all_settings
            if s.effect.session in (None, self.session)
            if not (is_still and s.effect.needs_motion)
        )

    def machines(self, settings: Sequence[Setting]) -> Iterator[tuple[BoolArray, Machine]]:
        """Yield the machine with the declared effects and these, and its rows (n_rows,)."""
        yield np.ones(self.measured.n_rows, dtype=np.bool_), self.built(settings)

    @property
    def row_unknowns(self) -> int:
        """Readings that each row gives up, for what they alone tell of it."""
        return self.spare_cables

    @property
    def spare_cables(self) -> int:
        """Cables beyond the degrees of freedom: internal forces of each row."""
        robot = self.machine.robot
        return max(robot.n_cables - robot.degrees_of_freedom, 0)

    def __call__(self, settings: Sequence[Setting], noise: Noise = UNIT_NOISE) -> Readings:
        """Return what the sensors would show with these effects."""
        if self.spare_cables:
            return self._remembered(settings, noise, self._with_forces)[1]
        # Effects on readings leave the machine alone, so that their slopes cost no statics.
        bodily = [s for s in settings if s.effect.on_readings is None]
        return self._shown(self._remembered(bodily, noise, self._physical)[1], settings)

    def surroundings(self, settings: Sequence[Setting], noise: Noise = UNIT_NOISE) -> Readings:
        """Return lengths and tensions that a residual may go with.

        What is predicted; but internal forces that were taken from lengths alone hold their noise,
        with which the residual would go of itself. Then it is what the pose alone tells.
        """
        if not self.spare_cables or np.isfinite(self.measured.tension_N).any():
            return self(settings, noise)
        return self._shown(self._physical(settings, noise)[1], settings)

    def true_readings(self, settings: Sequence[Setting], noise: Noise) -> Readings:
        """Return what was measured, less what sensors and stiff ends add to it in the model."""
        displayed = self(settings, noise)
        if self.spare_cables:
            true = self._remembered(settings, noise, self._with_forces)[0]
        else:
            limp = replace(self.built(settings), flexural_rigidity_N_m2=0.0)
            placed = self.placed(settings)
            true = readings_of(limp, placed.poses, placed)
        measured = self.measured.readings
        return Readings(*np.hsplit(measured - displayed.stacked + true.stacked, 2))

    def _remembered(
        self,
        settings: Sequence[Setting],
        noise: Noise,
        solve: Callable[[Sequence[Setting], Noise], tuple[Readings, Readings]],
    ) -> tuple[Readings, Readings]:
        key = (noise, *((s.effect.key, *s.values.values()) for s in settings))
        if key not in self._solutions:
            if len(self._solutions) > 64:  # more than the slopes of one fit ask for
                self._solutions.clear()
            self._solutions[key] = solve(settings, noise)
        return self._solutions[key]

    def distrust(self, settings: Sequence[Setting], noise: Noise) -> tuple[float, float]:
        """Return how much more than noise readings were off with these effects; see `Guess`."""
        guess = self._guesses.get(kind_of(settings, noise))
        return guess.distrust if guess else (1.0, 1.0)

    def _physical(self, settings: Sequence[Setting], _: Noise) -> tuple[Readings, Readings]:
        built = self._built_with(settings)
        readings = readings_of(built.machine, built.measured.poses, built.measured)
        return readings, readings

    def _with_forces(self, settings: Sequence[Setting], noise: Noise) -> tuple[Readings, Readings]:
        kind = kind_of(settings, noise)
        guess, *answer = self._settled(settings, noise, judges=kind not in self._guesses)
        self._guesses[kind] = guess  # near what it will be for the next values of these effects
        return answer[0], answer[1]

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings can be trusted with these effects; tell if that changed.

        Between two calls it stays, so that residuals have slopes.
        """
        if not self.spare_cables:
            return False
        kind = kind_of(settings, noise)
        before = self._guesses.get(kind)
        guess = self._guesses[kind] = self._settled(settings, noise, judges=True)[0]
        if before is not None and before.distrust == guess.distrust:
            return False
        self._solutions.clear()
        return True

    def trust_as(self, known: Sequence[Setting], effects: Sequence[Effect], noise: Noise) -> None:
        """Trust readings with effects that were not tried yet as with those of a known model.

        Losses of two models are to be compared, of which one has the other's effects and more.
        """
        kind = (noise, *(effect.key for effect in effects))
        guess = self._guesses.get(kind_of(known, noise))
        if guess is not None:
            self._guesses.setdefault(kind, guess)

    def _settled(
        self, settings: Sequence[Setting], noise: Noise, *, judges: bool
    ) -> tuple[Guess, Readings, Readings]:
        """Repeat until what sensors and stiff ends add, and how far readings are off, agree.

        What they add depends on the internal forces in turn, though little.
        """
        built, sensing = self._built_with(settings), self._sensing(settings)
        initial = Guess(np.zeros_like(built.measured.readings))
        guess = self._guesses.get(kind_of(settings, noise), initial)
        # Of two ways to hold a row, where there are two, the first judgement chooses.
        start = None if judges else guess.near
        if start is not None:  # what these values add to it
            _, displayed, guess = _displayed(built, sensing, start, guess)
        for _ in range(_MAX_ITERATIONS):
            balance = built.balanced(guess, noise, start)
            start = None if judges else balance
            before = guess
            true, displayed, guess = _displayed(built, sensing, balance, before)
            if judges:
                guess = guess.with_distrust(built.measured, displayed, noise)
            if guess.is_near(before, noise):
                break
        return guess, true, displayed

    def _shown(self, readings: Readings, settings: Sequence[Setting]) -> Readings:
        return _shown(self._built_with(settings), self._sensing(settings), readings)

    def _sensing(self, settings: Sequence[Setting]) -> list[Setting]:
        """Return the effects that act on readings, in the order in which they do."""
        return [s for s in self._all(settings) if s.effect.on_readings is not None]


def _displayed(
    built: Built, sensing: Sequence[Setting], balance: Statics, guess: Guess
) -> tuple[Readings, Readings, Guess]:
    """Return true and displayed readings of a balance, and the guess that it leads to."""
    true = true_readings(balance)
    displayed = _shown(built, sensing, with_stiff_ends(built.machine, balance, true))
    added = np.nan_to_num(displayed.stacked - true.stacked)
    return true, displayed, replace(guess, added=added, near=balance)


def _shown(built: Built, sensing: Sequence[Setting], readings: Readings) -> Readings:
    for setting in sensing:
        assert setting.effect.on_readings is not None
        # Of a law that takes the machine, as the other effects have it.
        more = {"machine": built.machine} if setting.effect.takes_machine else {}
        readings = setting.effect.on_readings(readings, setting.values, built.measured, **more)
    return readings


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Data, model and noise."""

    measured: Measured  #: the data
    predict: Predictor  #: the model
    noise: Noise  #: scale of the residual

    @property
    def sigma(self) -> FloatArray:
        """Noise of each channel: lengths [m], then tensions [N] (2 n_cables,)."""
        return self.noise.of_channels(self.measured.length_m.shape[1])

    def free_readings(self, mask: BoolArray) -> int:
        """Return how many of the readings taken (n_rows, 2 n_cables) are left to test the model.

        A row of a redundant robot gives up one for each cable to spare, for its internal forces,
        and as many as its degrees of freedom where its pose was not measured.
        """
        given_up = self.predict.row_unknowns
        return int(np.maximum(mask.sum(axis=1) - given_up, 0).sum())

    def predicted(self, settings: Sequence[Setting]) -> Readings:
        """Return what the sensors would show with these effects."""
        return self.predict(settings, self.noise)

    def surroundings(self, settings: Sequence[Setting]) -> Readings:
        """Return lengths and tensions that a residual may go with; see `Predictor`."""
        return self.predict.surroundings(settings, self.noise)

    def used(self, rows: BoolArray) -> BoolArray:
        """Return what is read in some rows (n_rows,), by the columns of `misfit`."""
        return rows[:, None] & self.measured.is_read

    def in_noise(self, settings: Sequence[Setting]) -> FloatArray:
        """Return what is predicted, by the columns of `misfit`; coordinates from what was read."""
        predicted = self.predicted(settings)
        off = predicted.coordinates_off
        return np.hstack([predicted.stacked / self.sigma, *([] if off is None else [-off])])

    def misfit(self, settings: Sequence[Setting]) -> FloatArray:
        """Return what a fit makes small: the residual, then that of coordinates of poses in part.

        In units of noise (n_rows, 2 n_cables, or 6 more); NaN where not measured.
        """
        off = self.predicted(settings).coordinates_off
        residual = self.residual(settings)
        if off is None:
            return residual
        return np.where(self.measured.is_read, np.hstack([residual, off]), np.nan)

    def residual(self, settings: Sequence[Setting]) -> FloatArray:
        """Return (measured - predicted) / noise (n_rows, 2 n_cables); NaN where not measured."""
        read, sigma, predicted = (
            self.measured.readings,
            self.sigma,
            self.predicted(settings).stacked,
        )
        residual = np.asarray((read - predicted) / sigma)
        unheld = np.isnan(predicted) & ~np.isnan(read)
        if unheld.any():
            # No other error is worse than a pose that the model cannot hold.
            residual[unheld] = (1e3 + 10.0 * np.abs(read) / sigma)[unheld]
        return residual

    def holds(self, settings: Sequence[Setting]) -> BoolArray:
        """Tell which rows (n_rows,) the model can hold, as far as they were read."""
        unheld = np.isnan(self.predicted(settings).stacked) & ~np.isnan(self.measured.readings)
        return np.asarray(~unheld.any(axis=1))


def imbalance_of(predict: Predictor, settings: Sequence[Setting]) -> FloatArray | None:
    """Return what a model leaves out of balance in each row, over the weight (n_rows,).

    None where there are enough cables to balance every pose; see `designer.statics.balance`.
    """
    if predict.machine.robot.has_enough_cables:
        return None
    placed = predict.placed(settings)
    imbalances = np.full(placed.n_rows, np.nan)
    for rows, machine in predict.machines(settings):
        rows_placed = placed if rows.all() else placed.part(rows)
        force = added_force_N(machine, rows_placed)
        statics = solve_underactuated(machine.robot, rows_placed.poses, machine.cables, force)
        imbalances[rows] = imbalance(statics)
    return imbalances


def channel_names(n_cables: int) -> list[str]:
    """Return the names of the columns of a residual."""
    return [f"{kind} {k}" for kind in ("length", "tension") for k in range(1, n_cables + 1)]


# Several sessions.


@dataclass(eq=False)
class SessionsPredictor(Predictor):
    """Predicts readings of several sessions, each by itself: its effects, its rows, its clock."""

    @cached_property
    def parts(self) -> list[tuple[BoolArray, Predictor]]:
        """The rows (n_rows,) of each session, and what predicts them."""
        numbers = self.measured.session
        assert numbers is not None
        rows_of = [(int(number), numbers == number) for number in np.unique(numbers)]
        return [(rows, self._of(number, self.measured.part(rows))) for number, rows in rows_of]

    def _of(self, number: int, measured: Measured) -> Predictor:
        return Predictor(self.machine, measured, self.fixed, self.effects, number)

    def at(self, measured: Measured) -> Predictor:
        """Return the same model for other rows; those of no session are as of the first."""
        return (
            self._of(1, measured) if measured.session is None else replace(self, measured=measured)
        )

    def _acting(
        self, settings: Sequence[Setting]
    ) -> Iterator[tuple[BoolArray, Predictor, list[Setting]]]:
        """Yield rows and predictor of each session, with the effects that act in it."""
        for rows, part in self.parts:
            yield rows, part, [s for s in settings if s.effect.session in (None, part.session)]

    def machines(self, settings: Sequence[Setting]) -> Iterator[tuple[BoolArray, Machine]]:
        """Yield the machine as it was in each session, and its rows (n_rows,)."""
        for rows, part, acting in self._acting(settings):
            yield rows, part.built(acting)

    def placed(self, settings: Sequence[Setting]) -> Measured:
        """Return the rows in the poses that the platform had, as these effects have it."""
        placed = [part.placed(acting).poses for _, part, acting in self._acting(settings)]
        rotations = [p.rotation for p in placed]
        is_turned = rotations[0].ndim > 2
        positions = np.concatenate([p.position_m for p in placed])
        poses = Poses(positions, np.concatenate(rotations) if is_turned else rotations[0])
        return replace(self.measured, poses=poses)

    def __call__(self, settings: Sequence[Setting], noise: Noise = UNIT_NOISE) -> Readings:
        """Return what the sensors would show with these effects."""
        return _concatenated([part(acting, noise) for _, part, acting in self._acting(settings)])

    def surroundings(self, settings: Sequence[Setting], noise: Noise = UNIT_NOISE) -> Readings:
        """Return lengths and tensions that a residual may go with."""
        return _concatenated(
            [part.surroundings(acting, noise) for _, part, acting in self._acting(settings)]
        )

    def true_readings(self, settings: Sequence[Setting], noise: Noise) -> Readings:
        """Return what was measured, less what sensors and stiff ends add to it in the model."""
        return _concatenated(
            [part.true_readings(acting, noise) for _, part, acting in self._acting(settings)]
        )

    def distrust(self, settings: Sequence[Setting], noise: Noise) -> tuple[float, float]:
        """Return how much more than noise readings were off at most in a session."""
        of_each = [part.distrust(acting, noise) for _, part, acting in self._acting(settings)]
        return max(length for length, _ in of_each), max(tension for _, tension in of_each)

    def trust_as(self, known: Sequence[Setting], effects: Sequence[Effect], noise: Noise) -> None:
        """Trust readings of each session as with a known model; see `Predictor`."""
        for _, part, acting_settings in self._acting(known):
            acting = [e for e in effects if e.session in (None, part.session)]
            part.trust_as(acting_settings, acting, noise)

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings of each session can be trusted; tell if that changed."""
        changes = [part.trust_anew(acting, noise) for _, part, acting in self._acting(settings)]
        return any(changes)


def _concatenated(readings: Sequence[Readings]) -> Readings:
    return Readings(
        np.concatenate([part.length_m for part in readings]),
        np.concatenate([part.tension_N for part in readings]),
    )
