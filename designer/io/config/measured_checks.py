"""Checks of effects and measurements that need several fields of the config at once."""

from __future__ import annotations

from collections.abc import Iterator

from designer.documents.fields import Mass
from designer.errors import Fault
from designer.io.config.columns import ColumnSection
from designer.io.config.effects import read_effects
from designer.io.config.parts import Parts
from designer.io.config.schema import MOST_CABLES, Anchors
from designer.measured.names import COVARIATE, IGNORE, cable_of, is_rotation
from designer.spelling import did_you_mean
from designer.units import describe

_COLUMNS = ("measurements", "columns")
_UNKNOWN = ("measurements", "unknown")


def effects_are_known(parts: Parts) -> Iterator[Fault]:
    """Each effect has an id, parameters and a cable that there are."""
    for refusal in read_effects(parts.raw("effects"), _n_cables(parts), parts.effects).refusals:
        yield parts.fault(refusal.place, refusal.problem, refusal.expected)


def mass_stays_positive(parts: Parts) -> Iterator[Fault]:
    """The platform still weighs something with the effect ``platform_mass``."""
    mass_kg = parts.read(Mass, "robot", "platform", "mass")
    declared = read_effects(parts.raw("effects"), _n_cables(parts), parts.effects).effects
    for place, effect in declared:
        is_negative = mass_kg is not None and mass_kg + effect.parameters.get("offset_kg", 0.0) <= 0
        if is_negative and effect.id == "platform_mass":
            expected = f"more than -{mass_kg:g} kg, minus the platform's own mass"
            yield parts.fault((*place, "offset_kg"), "leaves no mass", expected)


def columns_fit_the_robot(parts: Parts) -> Iterator[Fault]:
    """No column is mapped onto a cable that the robot lacks, or onto a point mass's rotation."""
    n_cables = _n_cables(parts)
    is_point_mass = parts.raw("robot", "platform", "attachments") is None
    for name, target in _targets(parts):
        if (cable_of(target) or 0) > n_cables:
            problem = f"{target}: the robot has {n_cables} cables"
            yield parts.fault((*_COLUMNS, name), problem, f"a cable from 1 to {n_cables}")
        elif is_rotation(target) and is_point_mass:
            expected = f"robot.platform.attachments, or '{IGNORE}'"
            yield parts.fault(
                (*_COLUMNS, name), f"{target} has no meaning for a point mass", expected
            )


def columns_go_to_different_places(parts: Parts) -> Iterator[Fault]:
    """No two columns are mapped onto one of ours."""
    first: dict[str, str] = {}
    for name, target in _targets(parts):
        if target in first:
            problem = f"{target} is already the column '{first[target]}'"
            yield parts.fault((*_COLUMNS, name), problem, f"another name of ours, or '{IGNORE}'")
        first.setdefault(target, name)


def unknowns_are_known(parts: Parts) -> Iterator[Fault]:
    """What is fitted from the start is an effect, or all exit points together."""
    names = parts.raw(*_UNKNOWN)
    together = [effect.also_called for effect in parts.effects.values() if effect.also_called]
    known = (*parts.effects, *together)
    for index, name in enumerate(names if isinstance(names, list) else ()):
        if isinstance(name, str) and name not in known:
            listed = f"{', '.join(together)}, or an effect: {', '.join(parts.effects)}"
            expected = listed + did_you_mean(name, known)
            yield parts.fault((*_UNKNOWN, index), f"{describe(name)} is not known", expected)


def unknowns_are_distinct(parts: Parts) -> Iterator[Fault]:
    """Nothing is unknown twice."""
    names = parts.raw(*_UNKNOWN)
    for index, name in enumerate(names if isinstance(names, list) else ()):
        if isinstance(name, str) and isinstance(names, list) and name in names[:index]:
            yield parts.fault((*_UNKNOWN, index), f"'{name}' is given twice", "once")


MEASURED_CHECKS = (
    effects_are_known,
    mass_stays_positive,
    columns_fit_the_robot,
    columns_go_to_different_places,
    unknowns_are_known,
    unknowns_are_distinct,
)


def _n_cables(parts: Parts) -> int:
    """Return the number of cables; as many as there may be where the anchors are faulty."""
    anchors = parts.read(Anchors, "robot", "anchors")
    return MOST_CABLES if anchors is None else len(anchors)


def _targets(parts: Parts) -> Iterator[tuple[str, str]]:
    """Yield each valid entry of the column map that is one of our columns."""
    columns = parts.raw(*_COLUMNS)
    for name in columns if isinstance(columns, dict) else ():
        section = parts.read(ColumnSection, *_COLUMNS, name)
        if section is not None and section.to not in (IGNORE, COVARIATE):
            yield name, section.to
