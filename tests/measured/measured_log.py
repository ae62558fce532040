"""A small robot and its log, to spoil."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from designer.arrays import FloatArray
from designer.errors import Fault, InputError
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Measured

POINT = """\
robot:
  anchors: [[0, 0, 12], [30, 0, 12.5], [14, 26, 11.5]]
  platform: {mass: 1.8}
"""
BODY = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9]]
  platform: {mass: 100, attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1]]}
"""
COLUMNS_LINE = 8  # of the config


class Log:
    """A log that can be changed cell by cell, and the config around it.

    Parameters
    ----------
    folder : Path
        Where both are written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.robot = POINT
        self.columns = "{}"
        self.settled = True
        rng = random.Random(4)
        self.names = ["time_s", "x_m", "y_m", "z_m"]
        self.names += [f"length_{cable}_m" for cable in (1, 2, 3)]
        self.names += [f"tension_{cable}_N" for cable in (1, 2, 3)]
        self.rows = [
            [str(10 * row), *(f"{rng.uniform(2, 9):.3f}" for _ in self.names[1:])]
            for row in range(30)
        ]

    @property
    def path(self) -> Path:
        """The CSV file."""
        return self.folder / "log.csv"

    @property
    def config(self) -> Path:
        """The config file."""
        return self.folder / "robot.yaml"

    def add(self, name: str, values: list[object] | object) -> None:
        """Add a column, of one value or of one for each row."""
        cells = values if isinstance(values, list) else [values] * len(self.rows)
        self.names.append(name)
        for row, cell in zip(self.rows, cells, strict=True):
            row.append(str(cell))

    def drop(self, *names: str) -> None:
        """Leave out columns."""
        for name in names:
            place = self.names.index(name)
            for row in (self.names, *self.rows):
                del row[place]

    def rename(self, old: str, new: str) -> None:
        """Give a column another name."""
        self.names[self.names.index(old)] = new

    def set(self, row: int, name: str, cell: object) -> None:
        """Set a cell in a row, counted from 1."""
        self.rows[row - 1][self.names.index(name)] = str(cell)

    def cell(self, row: int, name: str) -> str:
        """Return a cell in a row, counted from 1."""
        return self.rows[row - 1][self.names.index(name)]

    def numbers(self, name: str) -> FloatArray:
        """Return a column as numbers."""
        return np.array([float(self.cell(row + 1, name)) for row in range(len(self.rows))])

    def text(self) -> str:
        """The CSV file as text."""
        return "".join(",".join(row) + "\n" for row in (self.names, *self.rows))

    def read(self, raw: bytes | None = None) -> Measured:
        """Write both files and read them."""
        self.path.write_bytes(self.text().encode() if raw is None else raw)
        return self.read_config()

    def write_config(self) -> None:
        """Write the config alone."""
        self.config.write_text(
            self.robot
            + "cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}\n"
            "measurements:\n  file: log.csv\n  cable: {linear_mass: 0.1, axial_stiffness: 3 MN}\n"
            f"  columns: {self.columns}\n  settled: {str(self.settled).lower()}\n",
            encoding="utf-8",
        )

    def read_config_as_it_is(self) -> Measured:
        """Read what the config names."""
        return read_measured(read_study(self.config))

    def read_config(self) -> Measured:
        """Write the config alone and read what it names."""
        self.write_config()
        return self.read_config_as_it_is()

    def faults(self, raw: bytes | None = None) -> list[Fault]:
        """Return all faults."""
        with pytest.raises(InputError) as caught:
            self.read(raw)
        return list(caught.value.faults)


def body_log(folder: Path) -> Log:
    """Return the log of a body with four cables, lengths only, without an orientation."""
    log = Log(folder)
    log.robot = BODY
    log.drop("tension_1_N", "tension_2_N", "tension_3_N")
    log.add("length_4_m", [5 + 0.1 * row for row in range(len(log.rows))])
    return log
