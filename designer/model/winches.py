"""The winches of a robot, one for each cable and all alike."""

from __future__ import annotations

from dataclasses import dataclass

from designer import checked


@dataclass(frozen=True, slots=True, eq=False)
class Winches(checked.Value):
    """The winches of a robot; None for what is not known, or not asked for.

    Parameters
    ----------
    tension_max_N : float or None
        Largest tension that a winch may see, where its cable leaves toward the platform [N].
    """

    tension_max_N: checked.Positive | None = None
