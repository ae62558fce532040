"""Rows of several sessions, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from designer.arrays import FloatArray
from designer.model.measured_data import Measured
from designer.model.robot import Poses


def one_after_the_other(sessions: Sequence[Measured]) -> Measured:
    """Return the rows of all sessions, of measured poses.

    Their times follow one another, and so do the numbers of their rows. What is not recorded in
    every session is left out, with a note.
    """
    counts = [each.n_rows for each in sessions]
    firsts = np.cumsum([0, *(each.row_numbers[-1] for each in sessions[:-1])]).tolist()
    notes = [
        f"row 1 of session {number} is counted as row {first + 1}"
        for number, first in enumerate(firsts[1:], start=2)
    ]
    notes += _left_out(sessions)
    for number, each in enumerate(sessions, start=1):
        notes += [f"session {number}: {note}" for note in each.notes]
    shared = [k for k in sessions[0].covariates if all(k in each.covariates for each in sessions)]
    thinned = [f"session {k}: {each.thinned}" for k, each in enumerate(sessions, 1) if each.thinned]
    rotations = [
        np.broadcast_to(each.poses.rotation, (each.n_rows, 3, 3))
        for each in sessions
        if each.poses.rotation.ndim > 2
    ]
    positions = np.concatenate([each.poses.position_m for each in sessions])
    return Measured(
        Poses(positions, np.concatenate(rotations)) if rotations else Poses.at(positions),
        np.concatenate([each.length_m for each in sessions]),
        np.concatenate([each.tension_N for each in sessions]),
        settled=sessions[0].settled,
        time_s=_times(sessions),
        temperature_C=_joined([each.temperature_C for each in sessions]),
        wind_m_per_s=_joined([each.wind_m_per_s for each in sessions]),
        covariates={k: np.concatenate([each.covariates[k] for each in sessions]) for k in shared},
        row_numbers=np.concatenate(
            [each.row_numbers + n for each, n in zip(sessions, firsts, strict=True)]
        ),
        notes=tuple(notes),
        thinned="; ".join(thinned),
        sha256=", ".join(each.sha256 for each in sessions),
        session=np.repeat(np.arange(1, len(sessions) + 1), counts),
    )


def _left_out(sessions: Sequence[Measured]) -> Iterator[str]:
    recorded: list[set[str]] = [{*each.columns, *each.covariates} for each in sessions]
    in_any, in_every = recorded[0], recorded[0]
    for names in recorded[1:]:
        in_any, in_every = in_any | names, in_every & names
    missing = sorted(in_any - in_every)
    if missing:
        yield f"left out, since not every session has them: {', '.join(missing)}"


def _joined(columns: Sequence[FloatArray | None]) -> FloatArray | None:
    present = [values for values in columns if values is not None]
    return np.concatenate(present) if len(present) == len(columns) else None


def _times(sessions: Sequence[Measured]) -> FloatArray | None:
    """Return times that go on from session to session, a mean step between two of them."""
    times: list[FloatArray] = []
    for each in sessions:
        if each.time_s is None:
            return None
        step = float(np.ptp(each.time_s)) / max(each.n_rows - 1, 1)
        shift = times[-1][-1] + step - each.time_s[0] if times else 0.0
        times.append(each.time_s + shift)
    return np.concatenate(times)
