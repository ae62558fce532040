"""Readings as a model predicts them, and the residual of measured data, in units of noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.readings import InternalForces, readings_of
from designer.effects.effect import Readings, Setting, as_built
from designer.effects.registry import SHIPPED, KnownEffects
from designer.model.machine import Machine
from designer.model.measured_data import EVEN, Measured, Noise


class Predictor:
    """Predicts readings of one data set; remembers the last few machines it solved.

    Of a robot with as many cables as degrees of freedom the pose alone tells lengths and tensions.
    With more cables each row's internal forces are taken from its own readings, see
    `designer.diagnosis.readings`.

    Parameters
    ----------
    machine : Machine
        As drawn, without any effect.
    measured : Measured
        The data.
    fixed : sequence of Setting
        Effects that are declared; with those that are tried they act in the order of ``effects``.
    effects : KnownEffects
        All effects, in the order in which they act.
    """

    def __init__(
        self,
        machine: Machine,
        measured: Measured,
        fixed: Sequence[Setting] = (),
        effects: KnownEffects = SHIPPED,
    ) -> None:
        self._machine = machine
        self._measured = measured
        self._fixed = tuple(fixed)
        self._effects = effects
        self._forces = InternalForces(self.built, self._shown)
        self._known: dict[tuple[object, ...], tuple[Readings, Readings]] = {}
        self._slopes: dict[tuple[object, ...], FloatArray] = {}

    def at(self, measured: Measured) -> Predictor:
        """Return the same model for other rows; for the same rows, one without a memory."""
        return type(self)(self._machine, measured, self._fixed, self._effects)

    def built(self, settings: Sequence[Setting]) -> Machine:
        """Return the machine with the declared effects and these."""
        return as_built(self._machine, self._all(settings))

    def _all(self, settings: Sequence[Setting]) -> list[Setting]:
        """Return the effects that show in these rows, in the order in which they act."""
        all_settings = (*self._fixed, *settings)
        is_still = self._measured.settled
        return self._effects.in_order(
            s for s in all_settings if not (is_still and s.effect.needs_motion)
        )

    @property
    def row_unknowns(self) -> int:
        """Readings that each row gives up, for what they alone tell of it."""
        return self.spare_cables

    @property
    def spare_cables(self) -> int:
        """Cables beyond the degrees of freedom: internal forces of each row."""
        robot = self._machine.robot
        return max(robot.n_cables - robot.degrees_of_freedom, 0)

    def __call__(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return what the sensors would show with these effects."""
        if self.spare_cables:
            return self._remembered(settings, noise, self._with_forces)[1]
        # Effects on readings leave the machine alone, so that their slopes cost no statics.
        bodily = [s for s in settings if s.effect.on_machine is not None]
        return self._shown(self._remembered(bodily, noise, self._physical)[1], settings)

    def surroundings(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return lengths and tensions that a residual may go with.

        What is predicted; but internal forces that were taken from lengths alone hold their noise,
        with which the residual would go of itself. Then it is what the pose alone tells.
        """
        if not self.spare_cables or np.isfinite(self._measured.tension_N).any():
            return self(settings, noise)
        return self._shown(self._physical(settings, noise)[1], settings)

    def true_readings(self, settings: Sequence[Setting], noise: Noise) -> Readings:
        """Return what was measured, less what sensors and stiff ends add to it in the model."""
        displayed = self(settings, noise)
        if self.spare_cables:
            true = self._remembered(settings, noise, self._with_forces)[0]
        else:
            limp = replace(self.built(settings), flexural_rigidity_N_m2=0.0)
            true = readings_of(limp, self._measured.poses, self._measured)
        return Readings(
            self._measured.length_m - displayed.length_m + true.length_m,
            self._measured.tension_N - displayed.tension_N + true.tension_N,
        )

    def _remembered(
        self,
        settings: Sequence[Setting],
        noise: Noise,
        solve: Callable[[Sequence[Setting], Noise], tuple[Readings, Readings]],
    ) -> tuple[Readings, Readings]:
        key = (noise, *((s.effect.key, *s.values.values()) for s in settings))
        if key not in self._known:
            if len(self._known) > 64:  # more than the slopes of one fit ask for
                self._known.clear()
            self._known[key] = solve(settings, noise)
        return self._known[key]

    def remembered_slopes(
        self, key: tuple[object, ...], compute: Callable[[], FloatArray]
    ) -> FloatArray:
        """Return slopes that were computed lately: fits of parts of the rows start at one place."""
        if key not in self._slopes:
            if len(self._slopes) >= 8:  # those of the parts of one validation, and a few more
                del self._slopes[next(iter(self._slopes))]
            self._slopes[key] = compute()
        return self._slopes[key]

    def _physical(self, settings: Sequence[Setting], _: Noise) -> tuple[Readings, Readings]:
        readings = readings_of(self.built(settings), self._measured.poses, self._measured)
        return readings, readings

    def _with_forces(self, settings: Sequence[Setting], noise: Noise) -> tuple[Readings, Readings]:
        return self._forces.readings(settings, noise, self._measured)

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings can be trusted with these effects; tell if that changed."""
        if not self.spare_cables or not self._forces.trust_anew(settings, noise, self._measured):
            return False
        self._known.clear()
        self._slopes.clear()
        return True

    def _shown(self, readings: Readings, settings: Sequence[Setting]) -> Readings:
        for setting in self._all(settings):
            if setting.effect.on_readings is not None:
                readings = setting.effect.on_readings(readings, setting.values, self._measured)
        return readings


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Data, model and noise.

    Parameters
    ----------
    measured : Measured
        The data.
    predict : Predictor
        The model.
    noise : Noise
        Scale of the residual.
    """

    measured: Measured
    predict: Predictor
    noise: Noise

    @property
    def sigma(self) -> FloatArray:
        """Noise of each channel: lengths [m], then tensions [N] (2 n_cables,)."""
        n = self.measured.length_m.shape[1]
        return np.repeat([self.noise.length_m, self.noise.tension_N], n)

    @property
    def readings(self) -> FloatArray:
        """Measured lengths [m], then tensions [N] (n_rows, 2 n_cables); NaN where missing."""
        return np.hstack([self.measured.length_m, self.measured.tension_N])

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

    def residual(self, settings: Sequence[Setting]) -> FloatArray:
        """Return (measured - predicted) / noise (n_rows, 2 n_cables); NaN where not measured."""
        read, sigma, predicted = self.readings, self.sigma, self.predicted(settings).stacked
        residual = np.asarray((read - predicted) / sigma)
        unheld = np.isnan(predicted) & ~np.isnan(read)
        if unheld.any():
            # No other error is worse than a pose that the model cannot hold.
            residual[unheld] = (1e3 + 10.0 * np.abs(read) / sigma)[unheld]
        return residual


def channel_names(n_cables: int) -> list[str]:
    """Return the names of the columns of a residual."""
    return [f"{kind} {k}" for kind in ("length", "tension") for k in range(1, n_cables + 1)]
