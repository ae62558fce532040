"""One machine that was measured several times: what differs between the times, and what it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from designer.arrays import BoolArray
from designer.diagnosis.problem import Predictor
from designer.effects.effect import Effect, Readings, Setting
from designer.model.machine import Machine
from designer.model.measured_data import EVEN, Measured, Noise
from designer.model.measurements import Measurements
from designer.model.robot import Poses


def may_be_of_session(effect: Effect) -> bool:
    """Tell whether an effect may have come about between two sessions, and is looked for in one.

    Those are errors of setting up, zeros of load cells, and exit points that have been moved.
    """
    return effect.cause == "setting_up" or effect.id in ("anchor_offset", "tension_bias")


GOES_ON = "goes on from session to session, and their clocks do not tell how far"
"""Why an effect is not looked for."""


def goes_on(effect: Effect) -> bool:
    """Tell whether an effect, such as creep, counts the time since it began."""
    return "time" in effect.needs and not effect.needs_motion


def is_unknown(effect: Effect, measurements: Measurements) -> bool:
    """Tell whether an effect is unknown from the start, of the machine or of its session."""
    if effect.session is None:
        return effect.is_among(measurements.unknown)
    own = measurements.sessions[effect.session - 1]
    return replace(effect, session=None).is_among(own.unknown)


def with_those_of_sessions(effects: Sequence[Effect], measurements: Measurements) -> list[Effect]:
    """Return effects, then those that may be, or are unknown, of one session, for each of them."""
    numbers = range(1, len(measurements.sessions) + 1)
    own = [(effect, effect.of_session(k)) for k in numbers for effect in effects]
    return [
        *effects,
        *(e for effect, e in own if may_be_of_session(effect) or is_unknown(e, measurements)),
    ]


def beside_given(effect: Effect, given: Sequence[Effect], n_sessions: int) -> Effect:
    """Return an effect without the numbers that are unknown wherever it acts.

    That is what another effect has as unknown of the machine, of its own session, or of every
    session, and not of another cable.
    """
    here = [e for e in given if e is not effect and e.cable in (None, effect.cable)]
    ids = {e.id for e in here if e.session in (None, effect.session)}
    if effect.session is None and n_sessions:
        of_each = [{e.id for e in here if e.session == k + 1} for k in range(n_sessions)]
        of_every = set.intersection(*of_each)
        if effect.id in of_every:
            return replace(effect, parameters=())
        ids |= of_every
    return effect.beside(ids)


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
        for rows, part, own in self._acting(settings):
            yield rows, part.built(own)

    def placed(self, settings: Sequence[Setting]) -> Measured:
        """Return the rows in the poses that the platform had, as these effects have it."""
        placed = [part.placed(own).poses for _, part, own in self._acting(settings)]
        rotations = [p.rotation for p in placed]
        is_turned = rotations[0].ndim > 2
        positions = np.concatenate([p.position_m for p in placed])
        poses = Poses(positions, np.concatenate(rotations) if is_turned else rotations[0])
        return replace(self.measured, poses=poses)

    def __call__(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return what the sensors would show with these effects."""
        return _joined([part(own, noise) for _, part, own in self._acting(settings)])

    def surroundings(self, settings: Sequence[Setting], noise: Noise = EVEN) -> Readings:
        """Return lengths and tensions that a residual may go with."""
        return _joined([part.surroundings(own, noise) for _, part, own in self._acting(settings)])

    def true_readings(self, settings: Sequence[Setting], noise: Noise) -> Readings:
        """Return what was measured, less what sensors and stiff ends add to it in the model."""
        return _joined([part.true_readings(own, noise) for _, part, own in self._acting(settings)])

    def distrust(self, settings: Sequence[Setting], noise: Noise) -> tuple[float, float]:
        """Return how much more than noise readings were off at most in a session."""
        of_each = [part.distrust(own, noise) for _, part, own in self._acting(settings)]
        return max(length for length, _ in of_each), max(tension for _, tension in of_each)

    def trust_as(self, known: Sequence[Setting], effects: Sequence[Effect], noise: Noise) -> None:
        """Trust readings of each session as with a known model; see `Predictor`."""
        for _, part, own in self._acting(known):
            acting = [e for e in effects if e.session in (None, part.session)]
            part.trust_as(own, acting, noise)

    def trust_anew(self, settings: Sequence[Setting], noise: Noise) -> bool:
        """Judge anew how far readings of each session can be trusted; tell if that changed."""
        changes = [part.trust_anew(own, noise) for _, part, own in self._acting(settings)]
        return any(changes)


def _joined(readings: Sequence[Readings]) -> Readings:
    return Readings(
        np.concatenate([each.length_m for each in readings]),
        np.concatenate([each.tension_N for each in readings]),
    )
