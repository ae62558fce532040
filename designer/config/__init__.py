"""Reads the config file: YAML in, a checked and frozen `designer.study.Study` in SI out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from designer.config.grade_family import MaterialOf
    from designer.effects.known import KnownEffects
    from designer.study import Study


def read_study(
    path: Path,
    known_effects: KnownEffects | None = None,
    material_of: MaterialOf | None = None,
) -> Study:
    """Return the study that the config file describes.

    Parameters
    ----------
    path : Path
        A YAML file.
    known_effects : KnownEffects or None
        Which effects it may declare; None for ours alone, without those of plugins.
    material_of : callable or None
        Returns the continuous family of a grade that ``cable`` may name, see
        `designer.catalogue.family`; None for a study that gives the figures of its cable.

    Raises
    ------
    designer.errors.InputError
        If anything is wrong with it; carries every fault, a hundred at most, in the order of the
        lines.
    """
    from designer.config.reader import study_from  # geometry, which grade files do not need

    if known_effects is None:
        return study_from(path, material_of=material_of)
    return study_from(path, known_effects, material_of)
