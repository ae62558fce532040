"""From the log of a built machine to measured poses, lengths, tensions and surroundings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.documents.columns import (
    POSITION,
    QUATERNION,
    TEMPERATURE_NAME,
    TIME_NAME,
    WIND,
    length_names,
    tension_names,
)
from designer.documents.opened import open_input, reason
from designer.documents.table import LogTable, is_bag, read_bag, read_table
from designer.errors import Fault, InputError
from designer.measured.assign import (
    Assigned,
    assign,
    complete,
    coordinates_of,
    exclude_coordinates,
    orientation,
)
from designer.measured.rows import (
    EPOCH_S,
    Rows,
    cell_faults,
    is_numeric,
    joined,
    thinned,
    usable_rows,
    utc,
)
from designer.measured.sense import sense_faults, unit_faults
from designer.model.measurements import KINDS, Measured, Measurements
from designer.model.robot import Poses
from designer.study import Study

MOST_FAULTS = 100


def read_measured(study: Study) -> Measured:
    """Return what was measured on the machine that the study describes.

    Columns go by the names of `designer.documents.columns`; the config's ``measurements.columns``
    translates others. Cells that are empty, ``nan`` or ``NA`` hold nothing. Of a long log all rows
    are checked, and `designer.measured.rows.MOST_ROWS` returned.

    Raises
    ------
    InputError
        If the config names no measurements or the file is not as it should be; carries every
        fault, a hundred at most.
    """
    measurements = study.measurements
    if measurements is None:
        expected = "a mapping with the file of measured data and the cable on the machine"
        raise InputError([study.source.fault("measurements", "is missing", expected)])
    if measurements.sessions:
        return _of_sessions(study, measurements)
    tables = [table for path in measurements.files for table in _tables(path, study, measurements)]
    with np.errstate(over="ignore", invalid="ignore"):  # numbers without bounds become faults
        parts = assign(tables, study, measurements)
        wrong_cells = [fault for part in parts for fault in cell_faults(part)]
        assigned = joined(parts, settled=measurements.settled)
        if not measurements.has_poses:
            assigned.faults.extend(exclude_coordinates(assigned, measurements))
        complete(assigned, study, measurements)
        rows = usable_rows(assigned, study.robot.n_cables, measurements)
        faults = [*assigned.table.faults, *assigned.faults, *wrong_cells]
        faults += rows.faults if len(parts) == 1 or not faults else []
        _refuse([*faults, *quaternion_faults(assigned, rows.kept)])
    table = assigned.table
    rows = thinned(rows, settled=measurements.settled)
    if measurements.has_poses:
        position = _stacked(assigned, POSITION, rows.kept)
        poses = Poses.at(position)
        if not study.robot.is_point_mass:
            rotation = orientation(
                assigned.rotation, _stacked(assigned, assigned.rotation, rows.kept)
            )
            poses = Poses(frozen_array(position), frozen_array(rotation))
        has_moved = np.ptp(poses.position_m, axis=0).max() > 1e-6
        has_turned = poses.rotation.ndim > 2 and np.ptp(poses.rotation, axis=0).max() > 1e-6
        if not has_moved and not has_turned:
            problem = "all rows are at one pose, so nothing can be told apart"
            raise InputError.at(table.name, problem, "different poses")
    else:
        poses = Poses.at(np.full((int(rows.kept.sum()), 3), np.nan))
    measured = _measured(assigned, rows, poses, study.robot.n_cables, settled=measurements.settled)
    if not measurements.has_poses:
        coordinates = coordinates_of(assigned, measurements, rows.kept)
        measured = replace(measured, has_poses=False, coordinates=coordinates)
        _refuse_unsettled_poses(study, measurements, measured, table)
        return measured
    suspects = (*(effect.id for effect in study.effects), *measurements.unknown)
    effects = study.known_effects.effects
    is_homed = not any(effect.shifts_lengths and effect.is_among(suspects) for effect in effects)
    _refuse(unit_faults(study.robot, measured, table.name, is_homed=is_homed))
    _refuse(sense_faults(study.robot, measured, table, is_homed=is_homed))
    return measured


def _of_sessions(study: Study, measurements: Measurements) -> Measured:
    """Return the rows of all sessions, each read as if there were no other."""
    parts: list[Measured] = []
    faults: list[Fault] = []
    for number in range(1, len(measurements.sessions) + 1):
        effects = (*study.effects, *study.effects_of_session(number))
        session_study = replace(
            study, measurements=measurements.of_session(number), effects=effects
        )
        try:
            parts.append(read_measured(session_study))
        except InputError as error:
            faults.extend(error.faults)
    _refuse(faults)
    return concatenate_sessions(parts)


def _refuse(faults: list[Fault]) -> None:
    if faults:
        raise InputError(faults[:MOST_FAULTS])


def _tables(path: Path, study: Study, measurements: Measurements) -> list[LogTable]:
    """Return the table in a file, or those in a bag."""
    if is_bag(path):
        return read_bag(path, [column.name for column in measurements.columns])
    try:
        file = open_input(path)
    except FileNotFoundError:
        problem = f"there is no file {path}"
    except (OSError, ValueError) as error:
        problem = f"{path} cannot be read: {reason(error)}"
    else:
        with file:
            return [read_table(file, str(path))]
    expected = "a CSV file, relative to this file"
    raise InputError([study.source.fault(measurements.place, problem, expected)])


def _stacked(assigned: Assigned, names: tuple[str, ...], mask: BoolArray) -> FloatArray:
    """Return columns side by side (n_kept, n_names), NaN for those that there are not."""
    empty = np.full(assigned.table.n_rows, np.nan)
    columns = [assigned.ours[name].values if name in assigned.ours else empty for name in names]
    return np.stack(columns, axis=1)[mask]


def _refuse_unsettled_poses(
    study: Study, measurements: Measurements, measured: Measured, table: LogTable
) -> None:
    """Refuse rows without poses that readings only just settle, or that lack a noise.

    Nothing is left then to test the model with, or to weigh lengths against tensions with.
    """
    robot = study.robot
    if not robot.has_enough_cables:
        problem = "poses of a platform with fewer cables than degrees of freedom cannot be told"
        raise InputError.at(table.name, problem, "measured poses")
    n_readings = int(measured.n_readings.max())
    has_tensions = np.isfinite(measured.tension_N).any()
    # Of lengths alone, internal forces are not asked for.
    n_unknowns = robot.n_cables if has_tensions else robot.degrees_of_freedom
    if n_readings <= n_unknowns:
        spare = n_unknowns - robot.degrees_of_freedom
        unknown = f"{robot.degrees_of_freedom} of the pose"
        unknown += f" and {spare} of internal forces" if spare else ""
        problem = f"rows have at most {n_readings} readings, for {n_unknowns} unknowns: {unknown}"
        expected = f"more than {n_unknowns}, so lengths and tensions; or measured poses"
        raise InputError.at(table.name, problem, expected)
    expected = "a standard deviation of each kind of reading"
    _refuse(
        [
            study.source.fault(
                f"measurements.noise.{kind.name}",
                f"is missing, and weighs {kind.name}s where poses are unknown",
                expected,
            )
            for kind in KINDS
            if np.isfinite(kind.of(measured)).any() and kind.name not in measurements.declared_noise
        ]
    )


def _measured(
    assigned: Assigned, rows: Rows, poses: Poses, n_cables: int, *, settled: bool
) -> Measured:
    notes = [*assigned.notes, *rows.notes]
    mask = rows.kept
    lengths, tensions = (names(n_cables) for names in (length_names, tension_names))
    notes += [
        f"{column.name} has no reading"
        for column in assigned.present(lengths + tensions)
        if np.isnan(column.values[mask]).all()
    ]
    row_numbers = np.flatnonzero(mask).astype(np.int64) + 1
    row_numbers.setflags(write=False)
    time = varying(assigned, TIME_NAME, mask, notes)
    if time is not None and (time[0] >= EPOCH_S or assigned.ours[TIME_NAME].first_time):
        notes.append(f"{assigned.ours[TIME_NAME].name} is counted from {utc(time[0])}")
        time = frozen_array(time - time[0])
    return Measured(
        poses=poses,
        length_m=frozen_array(_stacked(assigned, lengths, mask)),
        tension_N=frozen_array(_stacked(assigned, tensions, mask)),
        settled=settled,
        time_s=time,
        temperature_C=temperature_C(assigned, mask, time, notes),
        wind_m_per_s=wind_m_per_s(assigned, mask, time, notes),
        covariates=covariates(assigned, mask, notes),
        row_numbers=row_numbers,
        notes=tuple(notes),
        thinned=rows.thinned,
        sha256=assigned.table.sha256,
    )


def quaternion_faults(assigned: Assigned, mask: BoolArray) -> list[Fault]:
    """Return the rows whose quaternion is not of unit length within a hundredth."""
    columns = assigned.present(QUATERNION)
    if len(columns) < len(QUATERNION):
        return []
    norm = np.sqrt(sum(column.values**2 for column in columns))
    rows = np.flatnonzero(mask & np.isfinite(norm) & (np.abs(norm - 1.0) > 0.01))
    faults = (
        assigned.table.fault(
            int(row), columns[0].name, f"has a quaternion of length {norm[row]:.4g}", "1 within 1 %"
        )
        for row in rows
    )
    return assigned.table.first_few(faults, len(rows), "such quaternions")


def varying(assigned: Assigned, name: str, mask: BoolArray, notes: list[str]) -> FloatArray | None:
    """Return one of our columns (n_kept,); None, and a note, where it is always the same."""
    column = assigned.ours.get(name)
    if column is None:
        return None
    values = frozen_array(column.values[mask])
    if flaw := _flaw(values):
        notes.append(f"{column.name} left out, {flaw}")
        return None
    return values


def temperature_C(
    assigned: Assigned, mask: BoolArray, time: FloatArray | None, notes: list[str]
) -> FloatArray | None:
    """Return the temperature in each row [°C]; None where not recorded or always the same."""
    values = varying(assigned, TEMPERATURE_NAME, mask, notes)
    if values is None:
        return None
    return _filled(values, time, assigned.ours[TEMPERATURE_NAME].name, notes)


def wind_m_per_s(
    assigned: Assigned, mask: BoolArray, time: FloatArray | None, notes: list[str]
) -> FloatArray | None:
    """Return the wind in each row (n_rows, 3) [m/s]; None where not recorded or always the same."""
    present = {name: assigned.ours[name] for name in WIND if name in assigned.ours}
    if not present:
        return None
    wind = np.zeros((int(mask.sum()), 3))
    for axis, name in enumerate(WIND):
        if name in present:
            wind[:, axis] = present[name].values[mask]
        else:
            notes.append(f"the wind is taken as horizontal: there is no {name}")
    names = ", ".join(column.name for column in present.values())
    flaws = [_flaw(component) for component in wind.T]
    if "empty" in flaws or all(flaws):
        notes.append(f"{names} left out, {'one is empty' if 'empty' in flaws else flaws[0]}")
        return None
    filled = [_filled(wind[:, axis], time, name, notes) for axis, name in enumerate(WIND)]
    return frozen_array(np.stack(filled, axis=1))


def covariates(assigned: Assigned, mask: BoolArray, notes: list[str]) -> dict[str, FloatArray]:
    """Return every other column of numbers that differ from row to row."""
    reasons: dict[str, list[str]] = {}
    used: dict[str, FloatArray] = {}
    for name, column in assigned.covariates.items():
        values = column.values[mask]
        is_text = not is_numeric(column) and not column.is_empty
        flaw = _flaw(values)
        if is_text or flaw or column.first_time:
            reason = f"they are {flaw}" if flaw else "they hold times"
            reason = "they hold text" if is_text else reason
            reasons.setdefault(reason, []).append(name)
        else:
            used[name] = frozen_array(values)
    notes += [f"left out, since {reason}: {', '.join(names)}" for reason, names in reasons.items()]
    return used


def _flaw(values: FloatArray) -> str:
    """Return why values tell nothing; empty where they differ from row to row."""
    present = values[~np.isnan(values)]
    if not present.size:
        return "empty"
    return "the same in all rows" if np.ptp(present) == 0.0 else ""


def _filled(values: FloatArray, time: FloatArray | None, name: str, notes: list[str]) -> FloatArray:
    """Return the values with gaps bridged in proportion to the time, else to the row."""
    missing = np.isnan(values)
    if not missing.any():
        return values
    place = np.arange(float(len(values))) if time is None else time
    count = int(missing.sum())
    rows = f"{count} row" + "s" * (count != 1)
    notes.append(f"{name} is missing in {rows} and taken from those around")
    return frozen_array(np.interp(place, place[~missing], values[~missing]))


# Sessions.


def concatenate_sessions(sessions: Sequence[Measured]) -> Measured:
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
    recorded: list[set[str]] = [{*part.columns, *part.covariates} for part in sessions]
    if missing := sorted(recorded[0].union(*recorded) - recorded[0].intersection(*recorded)):
        notes.append(f"left out, since not every session has them: {', '.join(missing)}")
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
        time_s=_times_of(sessions),
        temperature_C=_concatenated([part.temperature_C for part in sessions]),
        wind_m_per_s=_concatenated([part.wind_m_per_s for part in sessions]),
        covariates={k: np.concatenate([part.covariates[k] for part in sessions]) for k in shared},
        row_numbers=np.concatenate(
            [part.row_numbers + n for part, n in zip(sessions, firsts, strict=True)]
        ),
        notes=tuple(notes),
        thinned="; ".join(thinned),
        sha256=", ".join(part.sha256 for part in sessions),
        session=np.repeat(np.arange(1, len(sessions) + 1), counts),
    )


def _concatenated(columns: Sequence[FloatArray | None]) -> FloatArray | None:
    present = [values for values in columns if values is not None]
    return np.concatenate(present) if len(present) == len(columns) else None


def _times_of(sessions: Sequence[Measured]) -> FloatArray | None:
    """Return times that go on from session to session, a mean step between two of them."""
    times: list[FloatArray] = []
    for part in sessions:
        if part.time_s is None:
            return None
        step = float(np.ptp(part.time_s)) / max(part.n_rows - 1, 1)
        shift = times[-1][-1] + step - part.time_s[0] if times else 0.0
        times.append(part.time_s + shift)
    return np.concatenate(times)
