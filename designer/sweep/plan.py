"""What a sweep varies, and with which values: known whole before the first study is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.documents.document import Document
from designer.documents.node import Key, Node, path_text

MOST_POINTS = 10_000_000


@dataclass(frozen=True, slots=True)
class Range:
    """Evenly spread values of a field, in the unit that both ends have in the file."""

    keys: tuple[Key, ...]
    low: float
    high: float
    unit: str
    count: int | None = None

    def values(self) -> FloatArray:
        """Return those of a grid."""
        return np.linspace(self.low, self.high, self.count or 1)

    def at(self, share: FloatArray) -> FloatArray:
        """Return those at shares of the range, each from 0 to 1."""
        return self.low + share * (self.high - self.low)

    def node(self, value: float) -> Node:
        """Return a value as the study would have it."""
        return Node(1, f"{float(value)!r} {self.unit}".rstrip(), is_plain=not self.unit)


@dataclass(frozen=True, slots=True)
class Choice:
    """Values of a field that are told one by one; ``numbers`` are they if all are numbers."""

    keys: tuple[Key, ...]
    nodes: tuple[Node, ...]
    unit: str = ""
    numbers: FloatArray | None = None

    @property
    def labels(self) -> FloatArray | np.ndarray:
        """What the store holds for each."""
        texts = [node.as_written() for node in self.nodes]
        return np.array(texts, dtype=object) if self.numbers is None else self.numbers


@dataclass(frozen=True, slots=True)
class Column:
    """The values of one field at all points, and those as the store holds them."""

    varied: Range | Choice
    values: np.ndarray

    @property
    def name(self) -> str:
        """The field's path, such as ``robot.platform.mass``."""
        return path_text(self.varied.keys)

    @property
    def stored(self) -> np.ndarray:
        """Numbers, or texts, one a point."""
        return self.values if isinstance(self.varied, Range) else self.varied.labels[self.values]

    def node(self, point: int) -> Node:
        """Return the value at a point as the study would have it."""
        value = self.values[point]
        return (
            self.varied.node(value) if isinstance(self.varied, Range) else self.varied.nodes[value]
        )


@dataclass(frozen=True, slots=True)
class Plan:
    """A sweep: the study it starts from, its points, what is kept of each.

    Parameters
    ----------
    document : Document
        The study, as it is written.
    columns : tuple of Column
        The fields that are varied.
    keep : tuple of str
        Paths into ``result.json``.
    kinds : mapping
        Of each of those, whether it is a number (`float`) or a text (`str`).
    goals : mapping
        Of numbers that are kept: 1 for the less the better, -1 for the more the better.
    digest : str
        SHA-256 of all that the results depend on.
    """

    document: Document
    columns: tuple[Column, ...]
    keep: tuple[str, ...]
    kinds: Mapping[str, type]
    goals: Mapping[str, int]
    digest: str

    @property
    def n_points(self) -> int:
        """How many studies there are."""
        return len(self.columns[0].values)

    def changes(self, point: int) -> list[tuple[tuple[Key, ...], Node]]:
        """Return what a point changes in the study."""
        return [(column.varied.keys, column.node(point)) for column in self.columns]


def columns_of(
    varied: tuple[Range | Choice, ...], sampling: str, points: int, seed: int
) -> tuple[Column, ...]:
    """Return the values at all points.

    Parameters
    ----------
    varied : tuple of Range or Choice
        In the order of the file; on a grid the last varies fastest.
    sampling : str
        ``grid``, ``random`` or ``latin_hypercube``.
    points, seed : int
        For the last two.

    References
    ----------
    McKay, Beckman and Conover, Technometrics 21 (1979): Latin hypercubes.
    """
    if sampling == "grid":
        axes = [
            field.values() if isinstance(field, Range) else np.arange(len(field.nodes))
            for field in varied
        ]
        grids = np.meshgrid(*axes, indexing="ij")
        return tuple(Column(field, grid.ravel()) for field, grid in zip(varied, grids, strict=True))
    from scipy.stats import qmc

    if sampling == "random":
        shares = np.random.default_rng(seed).random((points, len(varied)))
    else:
        shares = qmc.LatinHypercube(len(varied), rng=seed).random(points)
    return tuple(
        Column(
            field,
            field.at(share)
            if isinstance(field, Range)
            else np.minimum((share * len(field.nodes)).astype(int), len(field.nodes) - 1),
        )
        for field, share in zip(varied, shares.T, strict=True)
    )
