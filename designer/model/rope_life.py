"""What a study says of the life of running ropes."""

from __future__ import annotations

from dataclasses import dataclass

from designer import checked


@dataclass(frozen=True, slots=True)
class RopeLife(checked.Value):
    """Constants of the bending cycles that a rope bears, and how often it runs along the path.

    Parameters
    ----------
    b0, b1, b2, b3 : float
        Of `designer.physics.bending.borne_cycles`.
    wire_strength_Pa : float
        Nominal strength of the wires [Pa].
    core_factor : float
        f_C, of core and number of strands.
    source : str
        Where the constants are from.
    runs_per_day : float or None
        Runs along the path.
    days_min : float or None
        Days that the rope shall last at these.
    """

    b0: checked.Finite
    b1: checked.Finite
    b2: checked.Finite
    b3: checked.Finite
    wire_strength_Pa: checked.Positive
    source: str
    core_factor: checked.Positive = 1.0
    runs_per_day: checked.Positive | None = None
    days_min: checked.Positive | None = None
