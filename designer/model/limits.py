"""What a study asks of the chosen rope beyond its strength."""

from __future__ import annotations

from dataclasses import dataclass

from designer import checked


@dataclass(frozen=True, slots=True)
class RopeLimits:
    """Limits that the chosen rope is checked against; None asks for nothing.

    Parameters
    ----------
    stiffness_N_per_m : float or None
        Least force per displacement of the platform, in any direction, cables of fixed length
        [N/m].
    excitation_Hz : (float, float) or None
        Band from the lowest to the highest frequency of what shakes the robot [Hz], in which no
        cable shall swing as a string.
    drum_capacity_m : float or None
        Rope that a drum takes up, beside its dead turns [m].
    """

    stiffness_N_per_m: checked.Positive | None = None
    excitation_Hz: tuple[float, float] | None = None
    drum_capacity_m: checked.Positive | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.excitation_Hz is not None:
            low, high = self.excitation_Hz
            checked.Number(above=0.0).require("excitation_Hz", low)
            checked.Number(above=low).require("excitation_Hz", high)
