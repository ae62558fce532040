"""A robot of whatever program's file, told by its outermost element."""

from __future__ import annotations

from pathlib import Path

from designer.documents.xml import read_xml
from designer.foreign import caspr, wirex
from designer.foreign.robot import ForeignRobot


def read_foreign(
    path: Path, other: Path | None = None, cable_set: str | None = None
) -> ForeignRobot:
    """Return the robot of a CASPR model (either file of it) or of a WireX file.

    Parameters
    ----------
    path : Path
        The file.
    other : Path or None
        The other file of a CASPR model; None for the one beside it.
    cable_set : str or None
        Which set of cables of a CASPR model; None for the file's default.

    Raises
    ------
    InputError
        If a file is missing or faulty, is of another kind, or no study can hold such a robot.
    """
    root = read_xml(path)
    if root.tag in caspr.ROOTS:
        return caspr.read_caspr(path, root, other, cable_set)
    if root.tag != wirex.ROOT:
        roots = f"<{'>, <'.join(caspr.ROOTS)}> of CASPR or <{wirex.ROOT}> of WireX"
        root.refuse(f"the file holds <{root.tag}>", roots)
    return wirex.read_wirex(path, root)
