"""Time, temperature and wind from the columns of a log, and what else was recorded."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.measured.assign import Assigned
from designer.measured.names import TEMPERATURE_NAME, WIND
from designer.measured.rows import is_numeric


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
        if is_text or flaw:
            reason = "they hold text" if is_text else f"they are {flaw}"
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
