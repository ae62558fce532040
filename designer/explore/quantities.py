"""What the map can be coloured by; apart, since menus need it before the solver is loaded."""

from __future__ import annotations

from dataclasses import dataclass

from designer.model.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Quantity:
    """One way to colour the map."""

    key: str  #: Its name in answers
    title: str  #: As shown; values times ``scale`` are in this unit
    unit: str
    scale: float  #: From SI to the unit
    definition: str  #: What it is, in a sentence
    is_category: bool = False  #: Whether values are whole numbers that stand for something


#: In the order in which they are offered; the first comes first
QUANTITIES = (
    Quantity("utilisation", "Utilisation of the rope", "%", 100.0,
             "Largest tension anywhere in any cable over the allowable tension of the chosen "
             "rope; above 100 % it is too weak there. The allowable tension is the minimum "
             "breaking load, times what end fittings, bending and sheaves leave of it, over the "
             "safety factor."),
    Quantity("diameter", "Needed diameter", "mm", 1e3,
             "Diameter of the thinnest cable of the configured family that holds the pose, with "
             "its own weight and stretch."),
    Quantity("tension", "Largest tension", "kN", 1e-3,
             "Largest tension anywhere in any cable, with the chosen rope; without one, with "
             "the thinnest cable of the configured family that holds the pose."),
    Quantity("governing", "Governing cable", "", 1.0,
             "Number of the cable that is nearest to its allowable tension.", is_category=True),
    Quantity("sag", "Sag over chord", "%", 100.0,
             "Largest distance of a cable from the straight line between its ends, over the "
             "length of that line; of the cable that sags most."),
    Quantity("stiffness", "Stiffness", "kN/m", 1e-3,
             "Smallest force over displacement of the platform in any direction, winches held, "
             "the platform free to turn. Zero where it would not stay."),
    Quantity("frequency", "Lowest frequency", "Hz", 1.0,
             "Lowest natural frequency of platform and cables together at which it takes part, "
             "winches braked. Zero where it would not stay; not known of a body whose inertia "
             "is not given."),
    Quantity("verdict", "Verdict", "", 1.0,
             "What became of the pose: solved, proved to be impossible, or not found.",
             is_category=True),
)  # fmt: skip
BY_KEY = {one.key: one for one in QUANTITIES}
CHEAP = frozenset(BY_KEY) - {"stiffness", "frequency"}
"""What every map has; the others take longer, and are there where they are asked for."""


def category_labels(key: str, n_cables: int) -> dict[int, str]:
    """Return what the whole numbers of a category stand for."""
    if key == "verdict":
        return {int(verdict): verdict.reason for verdict in Verdict}
    return {number: f"cable {number}" for number in range(1, n_cables + 1)}
