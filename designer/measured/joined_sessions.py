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
    counts = [part.n_rows for part in sessions]
    firsts = np.cumsum([0, *(part.row_numbers[-1] for part in sessions[:-1])]).tolist()
    notes = [
        f"row 1 of session {number} is counted as row {first + 1}"
        for number, first in enumerate(firsts[1:], start=2)
    ]
    notes += _left_out(sessions)
    for number, part in enumerate(sessions, start=1):
        notes += [f"session {number}: {note}" for note in part.notes]
    shared = [k for k in sessions[0].covariates if all(k in part.covariates for part in sessions)]
    thinned = [f"session {k}: {part.thinned}" for k, part in enumerate(sessions, 1) if part.thinned]
    rotations = [
        np.broadcast_to(part.poses.rotation, (part.n_rows, 3, 3))
        for part in sessions
        if part.poses.rotation.ndim > 2
    ]
    positions = np.concatenate([part.poses.position_m for part in sessions])
    return Measured(
        Poses(positions, np.concatenate(rotations)) if rotations else Poses.at(positions),
        np.concatenate([part.length_m for part in sessions]),
        np.concatenate([part.tension_N for part in sessions]),
        settled=sessions[0].settled,
        time_s=_times(sessions),
        temperature_C=_joined([part.temperature_C for part in sessions]),
        wind_m_per_s=_joined([part.wind_m_per_s for part in sessions]),
        covariates={k: np.concatenate([part.covariates[k] for part in sessions]) for k in shared},
        row_numbers=np.concatenate(
            [part.row_numbers + n for part, n in zip(sessions, firsts, strict=True)]
        ),
        notes=tuple(notes),
        thinned="; ".join(thinned),
        sha256=", ".join(part.sha256 for part in sessions),
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
    for part in sessions:
        if part.time_s is None:
            return None
        step = float(np.ptp(part.time_s)) / max(part.n_rows - 1, 1)
        shift = times[-1][-1] + step - part.time_s[0] if times else 0.0
        times.append(part.time_s + shift)
    return np.concatenate(times)
