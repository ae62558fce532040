"""How long a fibre under load lasts: thermally activated flow."""

from __future__ import annotations

import math
from dataclasses import dataclass

BOLTZMANN_J_PER_K = 1.380649e-23
"""Exact in the SI since 2019."""


@dataclass(frozen=True, slots=True)
class CreepLaw:
    r"""Eyring's law: a fibre under stress σ at temperature T flows at a rate proportional to

        exp(-E / k T) sinh(σ v / k T),

    and breaks after a flow that is the same at every stress and temperature.

    Parameters
    ----------
    activation_energy_J : float
        E [J].
    activation_volume_m3 : float
        v [m³].
    reference_stress_Pa, reference_temperature_K, reference_life_s : float
        One point where the life is known: stress in the fibre [Pa], temperature [K], life [s].
    """

    activation_energy_J: float
    activation_volume_m3: float
    reference_stress_Pa: float
    reference_temperature_K: float
    reference_life_s: float

    def life_s(self, stress_Pa: float, temperature_K: float) -> float:
        """Return how long the fibre lasts [s]."""
        reference = self._log_rate(self.reference_stress_Pa, self.reference_temperature_K)
        return self.reference_life_s * math.exp(
            reference - self._log_rate(stress_Pa, temperature_K)
        )

    def stress_Pa(self, life_s: float, temperature_K: float) -> float:
        """Return the largest stress under which the fibre lasts that long [Pa]."""
        thermal_J = BOLTZMANN_J_PER_K * temperature_K
        log_rate = self._log_rate(self.reference_stress_Pa, self.reference_temperature_K)
        log_rate -= math.log(life_s / self.reference_life_s)
        flow = math.exp(log_rate + self.activation_energy_J / thermal_J)
        return thermal_J / self.activation_volume_m3 * math.asinh(flow)

    def _log_rate(self, stress_Pa: float, temperature_K: float) -> float:
        thermal_J = BOLTZMANN_J_PER_K * temperature_K
        drive = math.sinh(stress_Pa * self.activation_volume_m3 / thermal_J)
        return math.log(drive) - self.activation_energy_J / thermal_J
