"""How config and result files spell an effect: its id and its parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace

from designer.units import Dimension


@dataclass(frozen=True, slots=True)
class ParameterName:
    """One number of an effect.

    Parameters
    ----------
    name : str
        As in the files, with its SI unit; ``{cable}`` stands for the number of a cable, from 1.
    dimension : Dimension
        What kind of quantity it is.
    neutral : float or None
        Value of a parameter that is left out; None where it must be given.
    above, at_least : float or None
        Limits beyond which it has no meaning.
    """

    name: str
    dimension: Dimension
    neutral: float | None = None
    above: float | None = None
    at_least: float | None = None


@dataclass(frozen=True, slots=True)
class EffectName:
    """One effect.

    Parameters
    ----------
    id : str
        As in the files.
    parameters : tuple of ParameterName
        Its numbers.
    takes_cable : bool
        Whether it concerns one cable, to be named with it, so that it may stand more than once.
    """

    id: str
    parameters: tuple[ParameterName, ...]
    takes_cable: bool = False

    def parameters_for(self, n_cables: int) -> tuple[ParameterName, ...]:
        """Return the parameters on a robot with so many cables."""
        return tuple(one for each in self.parameters for one in _expanded(each, n_cables))


def _expanded(parameter: ParameterName, n_cables: int) -> list[ParameterName]:
    if "{cable}" not in parameter.name:
        return [parameter]
    return [
        replace(parameter, name=parameter.name.format(cable=cable))
        for cable in range(1, n_cables + 1)
    ]
