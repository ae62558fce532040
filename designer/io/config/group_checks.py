"""Checks of groups of cables: every cable of the robot in exactly one."""

from __future__ import annotations

from collections.abc import Iterator

from designer.errors import Fault
from designer.io.config.parts import Parts
from designer.io.config.schema import Anchors, Groups

_SELECTION = ("selection",)
_GROUPS = (*_SELECTION, "groups")


def each_cable_in_one_group(parts: Parts) -> Iterator[Fault]:
    """No cable is in two groups, none is left over, and none is named that is not there."""
    groups = parts.read(Groups, *_GROUPS)
    anchors = parts.read(Anchors, "robot", "anchors")
    if not groups or not anchors:
        return
    n_cables = len(anchors)
    first: dict[int, str] = {}
    for name, cables in groups.items():
        for index, cable in enumerate(cables):
            place = (*_GROUPS, name, index)
            if cable > n_cables:
                problem = f"there is no cable {cable}, the robot has {n_cables}"
                yield parts.fault(place, problem, f"a cable from 1 to {n_cables}")
            elif cable in first:
                problem = f"cable {cable} is in group '{first[cable]}' already"
                yield parts.fault(place, problem, "every cable in exactly one group")
            first.setdefault(cable, name)
    missing = [str(cable) for cable in range(1, n_cables + 1) if cable not in first]
    if missing:
        which = f"cable {missing[0]} is" if len(missing) == 1 else f"cables {_list(missing)} are"
        yield parts.fault(_GROUPS, f"{which} in no group", "every cable in exactly one group")


def limit_has_groups(parts: Parts) -> Iterator[Fault]:
    """A limit on the number of products needs groups that may differ."""
    place = (*_SELECTION, "max_distinct_products")
    if parts.raw(*place) is not None and parts.raw(*_GROUPS) is None:
        yield parts.fault(place, "has no meaning without selection.groups", "groups, or neither")


def _list(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"


GROUP_CHECKS = (each_cable_in_one_group, limit_has_groups)
