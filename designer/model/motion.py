r"""How the platform moves along a path: where it is at some instants, how fast, with what inertia.

Rows of a path are joined by a cubic spline of position and rotation vector, whose accelerations are
continuous: in time where the rows have times; else along the chords from row to row, passed at a
speed that rises and falls as half a cosine, so that acceleration starts and ends at zero. Between
rows with equal positions the position rests, and so does the turn between equal rotation vectors:
there the spline begins anew, from rest. The
rotation vector r of angle θ turns with

.. math::

    ω = \dot r + A\, r × \dot r + B\, r × (r × \dot r), \qquad
    A = (1 - \cos θ)/θ^2, \quad B = (θ - \sin θ)/θ^3

(Bullo and Murray, Proportional derivative control on the Euclidean group, 1995, eq. (2.9)), and the
platform of mass m, inertia J about its centre of mass at c from the origin of its frame asks, by
d'Alembert, for the wrench

.. math::

    F = -m\,(a + α × c + ω × (ω × c)), \qquad M = c × F - J α - ω × J ω
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.spatial import cKDTree

from designer import checked
from designer.arrays import FloatArray, IntArray, frozen_array

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Ends = Literal["at_rest", "moving"]
_INSTANTS = 400
"""Intervals of a motion at least: extremes between them differ by some 1e-5 of themselves."""
_SMALL_RAD = 0.03
"""Angle below which a series of two terms is as exact as rounding leaves the closed form."""
_LEVEL_RAD = 1e-12
"""What rounding leaves of a turn that never changes."""
_AT_REST = 1e-6
"""Over the largest speed of the platform: what rounding makes of the speed of a rope at rest."""
_APART = 1e-11
"""Over the extent of the path: by how much an instant is moved whose place another has already."""


@dataclass(frozen=True, eq=False)
class Motion(checked.Value):
    """Instants of a motion; at any other position the platform is at rest."""

    time_s: FloatArray  #: (n_instants,): Rising [s]
    #: (n_instants, 3): Of the platform's frame, world frame; no two positions alike [m, rad]
    positions_m: checked.Points
    rotation_vectors_rad: checked.Points
    #: (n_instants, 6): Of the origin of the platform's frame, and angular, along world axes [m/s,
    #: rad/s; per s]
    velocity: FloatArray
    acceleration: FloatArray
    words: str = ""  #: Where it comes from, and how it is interpolated and timed

    @property
    def places(self) -> FloatArray:
        """Position and rotation vector of each instant (n_instants, 6) [m, rad]."""
        return np.hstack([self.positions_m, self.rotation_vectors_rad])

    @property
    def turns(self) -> bool:
        """Whether the platform ever turns."""
        return bool(np.ptp(self.rotation_vectors_rad, axis=0).max() > _LEVEL_RAD)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.positions_m)

    def instants_at(self, positions_m: FloatArray) -> IntArray:
        """Return which instant is at positions (..., 3), -1 where none is (...)."""
        reach = 0.25 * _APART * _extent_m(self.positions_m)
        is_known = np.asarray(np.isfinite(positions_m).all(axis=-1, keepdims=True))
        distance, nearest = self._tree.query(np.where(is_known, positions_m, 0.0))
        return np.where(is_known[..., 0] & (distance <= reach), nearest, -1)

    def rates_at(self, positions_m: FloatArray) -> FloatArray:
        """Return ω, a and α at positions (..., 3), zeros where no instant is, (..., 9)."""
        rates = np.hstack([self.velocity[:, 3:], self.acceleration])
        instant = self.instants_at(positions_m)
        return np.where(instant[..., None] >= 0, rates[instant], 0.0)

    def speeds_m_per_s(self, length_m: FloatArray) -> FloatArray:
        """Return how fast lengths (n_instants, n_cables) grow; zero but for rounding is zero."""
        speeds = np.gradient(length_m, self.time_s, axis=0, edge_order=2)
        return np.where(np.abs(speeds) <= _AT_REST * np.abs(self.velocity).max(), 0.0, speeds)

    def inertia_wrench_N(
        self,
        positions_m: FloatArray,
        rotation: FloatArray,
        mass_kg: float,
        centre_m: FloatArray,
        inertia_kg_m2: FloatArray | None,
    ) -> FloatArray:
        """Return force and moment about the origin of the platform's frame (..., 6) [N, N·m].

        Of poses (..., 3) and (..., 3, 3), along world axes; centre of mass (3,) and inertia (3, 3)
        in the body frame. Inertia that is not known counts as none.
        """
        omega, linear, angular = np.split(self.rates_at(positions_m), 3, axis=-1)
        centre = rotation @ centre_m
        swing = np.cross(angular, centre) + np.cross(omega, np.cross(omega, centre))
        force = -mass_kg * (linear + swing)
        moment = np.cross(centre, force)
        if inertia_kg_m2 is not None:
            J = rotation @ inertia_kg_m2 @ np.swapaxes(rotation, -1, -2)
            spin = np.einsum("...ij,...j->...i", J, omega)
            moment = moment - np.einsum("...ij,...j->...i", J, angular) - np.cross(omega, spin)
        return np.concatenate([force, moment], axis=-1)


def timed(time_s: FloatArray, places: FloatArray, up: FloatArray, ends: Ends, name: str) -> Motion:
    """Return the motion through places (n_rows, 6) at times (n_rows,) [s, m, rad]."""
    spline = _spline(time_s, places, ends)
    instants = _between(time_s, -(-_INSTANTS // (len(time_s) - 1)))
    states = (spline(instants), spline(instants, 1), spline(instants, 2))
    start = "at rest at both ends" if ends == "at_rest" else "with free ends"
    words = f"a cubic spline in time through {len(time_s)} rows of {name}, {start}"
    if (places[1:] == places[:-1]).all(axis=1).any():
        words += ", and at rest between rows that are equal"
    return _motion(instants, *states, up, words)


def limited(
    places: FloatArray,
    up: FloatArray,
    reach_m: float,
    name: str,
    speed_m_per_s: float,
    acceleration_m_per_s2: float,
) -> Motion:
    """Return the motion through places (n_rows, 6) that keeps to a speed and an acceleration.

    Both hold for the origin of the platform's frame and all that is within ``reach_m`` of it, at
    every instant: |v| + reach |ω| and |a| + reach (|α| + |ω|²). Speed and ramps are the same over
    all of the path, so that its sharpest bend governs; half of the acceleration at least is left
    for the ramps [m, m/s, m/s²].
    """
    steps = np.diff(places, axis=0)
    chord = np.linalg.norm(steps[:, :3], axis=1) + reach_m * np.linalg.norm(steps[:, 3:], axis=1)
    knots = np.concatenate([[0.0], np.cumsum(chord)])
    spline = _spline(knots, places, "moving")
    fine = _between(knots, -(-10 * _INSTANTS // len(chord)))
    _, rate, bend = _rates(spline(fine), spline(fine, 1), spline(fine, 2))
    size = np.linalg.norm(np.stack([rate, bend]).reshape(2, -1, 2, 3), axis=-1)
    slope = float((size[0, :, 0] + reach_m * size[0, :, 1]).max())
    curve = float((size[1, :, 0] + reach_m * (size[1, :, 1] + size[0, :, 1] ** 2)).max())
    pace = speed_m_per_s / slope
    if curve > 0.0:
        pace = min(pace, np.sqrt(0.5 * acceleration_m_per_s2 / curve))
    push = (acceleration_m_per_s2 - curve * pace**2) / slope
    pace = min(pace, np.sqrt(2.0 * push * knots[-1] / np.pi))
    ramp_s = 0.5 * np.pi * pace / push
    steady_s = knots[-1] / pace - ramp_s
    steady_s = 0.0 if steady_s < 1e-9 * ramp_s else steady_s
    n = max(_INSTANTS // 2, 2 * len(knots))
    edges = np.cumsum([0.0, ramp_s, steady_s, ramp_s])
    counts = n // 2, n, n // 2
    spans = [np.linspace(edges[k], edges[k + 1], counts[k] + 1) for k in range(3)]
    time_s = np.unique(np.concatenate(spans))
    share = np.clip(np.minimum(time_s, edges[-1] - time_s) / ramp_s, 0.0, 1.0)
    sign = np.where(time_s > 0.5 * edges[-1], -1.0, 1.0)
    from_end = 0.5 * pace * ramp_s * (share - np.sin(np.pi * share) / np.pi)
    from_end = from_end + pace * (np.minimum(time_s, edges[-1] - time_s) - share * ramp_s)
    along = np.where(sign > 0.0, from_end, knots[-1] - from_end)
    speed = 0.5 * pace * (1.0 - np.cos(np.pi * share))
    gain = sign * push * np.sin(np.pi * share)
    at, first, second = (spline(along, order) for order in range(3))
    states = (at, first * speed[:, None], second * speed[:, None] ** 2 + first * gain[:, None])
    words = (
        f"a cubic spline along the chords of {len(places)} rows of {name}, passed within "
        f"{speed_m_per_s:g} m/s and {acceleration_m_per_s2:g} m/s² from rest to rest; the speed "
        "rises and falls as half a cosine"
    )
    return _motion(time_s, *states, up, words)


def unwrapped(turns_rad: FloatArray) -> FloatArray:
    """Return rotation vectors (n, 3) of the same rotations, each the nearest to the one before."""
    turns = [turns_rad[0]]
    for turn in turns_rad[1:]:
        size = float(np.linalg.norm(turn))
        axis = turn / size if size > 0.0 else _unit(turns[-1])
        whole = np.round((turns[-1] @ axis - size) / (2.0 * np.pi))
        turns.append(axis * (size + 2.0 * np.pi * whole))
    return np.array(turns)


def _unit(vector: FloatArray) -> FloatArray:
    size = float(np.linalg.norm(vector))
    return vector / size if size > 0.0 else np.array([1.0, 0.0, 0.0])


def _spline(knots: FloatArray, places: FloatArray, ends: Ends) -> Callable[..., FloatArray]:
    """Return the function of places (n, 6) at values of the parameter, and of their derivatives."""
    halves = places[:, :3], unwrapped(places[:, 3:])
    parts = [_resting_spline(knots, half, ends) for half in halves]

    def at(values: FloatArray, order: int = 0) -> FloatArray:
        # Accelerations jump where a rest begins or ends, and are zero on one side.
        after, before = (
            np.hstack([part(side, order) for part in parts])
            for side in (values, np.nextafter(values, -np.inf))
        )
        return np.where(np.abs(before) > np.abs(after), before, after)

    return at


def _resting_spline(knots: FloatArray, rows: FloatArray, ends: Ends) -> PPoly:
    """Return the spline of rows (n_rows, 3) that rests between equal ones."""
    from scipy.interpolate import CubicSpline, PPoly  # takes longer to import than a path to read

    rests = np.flatnonzero((rows[1:] == rows[:-1]).all(axis=1))
    at_end, at_rest = ("clamped" if ends == "at_rest" else "not-a-knot"), (1, np.zeros(3))
    pieces, begin, end = [], 0, len(rows) - 1
    for start in [*rests.tolist(), end]:
        if start > begin:
            law = at_end if begin == 0 else at_rest, at_end if start == end else at_rest
            part = slice(begin, start + 1)
            pieces.append(CubicSpline(knots[part], rows[part], bc_type=law).c)
        if start < end:
            pieces.append(np.concatenate([np.zeros((3, 1, 3)), rows[start, None, None]]))
        begin = start + 1
    return PPoly(np.concatenate(pieces, axis=1), knots)


def _between(knots: FloatArray, count: int) -> FloatArray:
    """Return the knots with each interval in ``count`` parts (count (n - 1) + 1,)."""
    parts = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(count) / count
    return np.append(parts.ravel(), knots[-1])


def _motion(
    time_s: FloatArray,
    place: FloatArray,
    first: FloatArray,
    second: FloatArray,
    up: FloatArray,
    words: str,
) -> Motion:
    place, velocity, acceleration = _rates(place, first, second)
    position = _all_apart(place[:, :3], up)
    return Motion(
        frozen_array(time_s),
        frozen_array(position),
        frozen_array(place[:, 3:]),
        frozen_array(velocity),
        frozen_array(acceleration),
        words,
    )


def _all_apart(positions_m: FloatArray, up: FloatArray) -> FloatArray:
    """Return positions, those that an earlier instant has as well moved by next to nothing."""
    apart, step = np.array(positions_m), _APART * _extent_m(positions_m)
    for _ in range(len(apart)):
        rounded = np.round(apart / step)
        _, first = np.unique(rounded, axis=0, return_index=True)
        again = np.setdiff1d(np.arange(len(apart)), first)
        if len(again) == 0:
            break
        apart[again] += 2.0 * step * np.arange(1, len(again) + 1)[:, None] * up
    return apart


def _extent_m(positions_m: FloatArray) -> float:
    """Return the size of the coordinates, as rounding sees them [m]."""
    return max(float(np.abs(positions_m).max()), 1.0)


def _rates(
    place: FloatArray, first: FloatArray, second: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return places, velocities and accelerations (n, 6) from those of their coordinates."""
    r, dr, ddr = place[:, 3:], first[:, 3:], second[:, 3:]
    angle = np.linalg.norm(r, axis=1)[:, None]
    A, B, dA, dB = _turning_terms(angle)
    along = np.sum(r * dr, axis=1)[:, None]
    rxdr, rxddr = np.cross(r, dr), np.cross(r, ddr)
    omega = dr + A * rxdr + B * np.cross(r, rxdr)
    alpha = ddr + A * rxddr + B * (np.cross(dr, rxdr) + np.cross(r, rxddr))
    alpha = alpha + along * (dA * rxdr + dB * np.cross(r, rxdr))
    return place, np.hstack([first[:, :3], omega]), np.hstack([second[:, :3], alpha])


def _turning_terms(angle: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return A and B of the module's equation, and their slopes over the angle, over it."""
    is_small = angle < _SMALL_RAD
    t = np.where(is_small, 1.0, angle)
    s, c, t2 = np.sin(t), 1.0 - np.cos(t), angle**2
    closed = (c / t**2, (t - s) / t**3, (t * s - 2.0 * c) / t**4, (t * c - 3.0 * (t - s)) / t**5)
    series = (
        0.5 - t2 / 24.0 + t2**2 / 720.0,
        1.0 / 6.0 - t2 / 120.0 + t2**2 / 5040.0,
        -1.0 / 12.0 + t2 / 180.0,
        -1.0 / 60.0 + t2 / 1260.0,
    )
    A, B, dA, dB = (np.where(is_small, *pair) for pair in zip(series, closed, strict=True))
    return A, B, dA, dB
