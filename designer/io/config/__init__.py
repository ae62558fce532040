"""Reads the config file: YAML in, a checked and frozen `designer.study.Study` in SI out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from designer.effects.known import KnownEffects
    from designer.plugins.find import Plugins
    from designer.study import Study


def read_study(
    path: Path,
    known_effects: KnownEffects | None = None,
    plugins: Plugins | None = None,
) -> Study:
    """Return the study that the config file describes.

    Parameters
    ----------
    path : Path
        A YAML file.
    known_effects : KnownEffects or None
        Which effects it may declare; None for ours alone, without those of plugins.
    plugins : Plugins or None
        Whose grades ``cable`` may name; None for ours and those that the file itself adds.

    Raises
    ------
    designer.errors.InputError
        If anything is wrong with it; carries every fault, a hundred at most, in the order of the
        lines.
    """
    from designer.io.config.reader import study_from  # geometry, which grade files do not need

    if known_effects is None:
        return study_from(path, plugins=plugins)
    return study_from(path, known_effects, plugins)
