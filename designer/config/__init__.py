"""Reads the config file: YAML in, a checked and frozen `designer.study.Study` in SI out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from designer.study import Study


def read_study(path: Path) -> Study:
    """Return the study that the config file describes.

    Parameters
    ----------
    path : Path
        A YAML file.

    Raises
    ------
    designer.errors.InputError
        If anything is wrong with it; carries every fault, a hundred at most, in the order of the
        lines.
    """
    from designer.config.reader import study_from  # geometry, which grade files do not need

    return study_from(path)
