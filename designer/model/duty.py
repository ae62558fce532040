"""Duty classes M1 to M8 of a mechanism, and the safety factor of running ropes in each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

DutyClass = Literal["none", "M1", "M2", "M3", "M4", "M5", "M6", "M7", "M8"]
RUNNING_ROPE: Mapping[str, float] = {
    "M1": 3.15,
    "M2": 3.35,
    "M3": 3.55,
    "M4": 4.0,
    "M5": 4.5,
    "M6": 5.6,
    "M7": 7.1,
    "M8": 9.0,
}
"""Coefficient of utilisation Zp, breaking load over tension, by mechanism group."""
SOURCE = (
    "Zp of running ropes, ISO 4308-1, as printed in table 4 of the Russian federal rules for "
    "lifting appliances and by Certex; the standard itself was not available"
)
