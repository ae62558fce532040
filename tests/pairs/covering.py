"""Sets of options that together have every pair: what meets in fours meets in pairs as well."""

from __future__ import annotations

from functools import cache
from itertools import combinations
from typing import Any

from pairs.options import BY_ID, OPTIONS, base_of, study_of
from pairs.table import COMPUTED, NOT_COVERED, Outcome

MOST = 4
"""Options in a set: more of them leave no rope that holds."""
ORDER = {option.id: place for place, option in enumerate(OPTIONS)}


def covering_sets(table: dict[tuple[str, str], Outcome]) -> list[tuple[str, ...]]:
    """Return sets of options in which each pair of the table that is read stands once at least.

    Greedy: each set begins with the first pair that is left, and takes up what adds most, but
    nothing that moves it to another robot, or that one of its options is refused beside or
    overwritten by.
    """
    robots = {
        pair: _robot(*pair)
        for pair, outcome in table.items()
        if outcome.kind in (COMPUTED, NOT_COVERED)
    }
    together = {pair for pair in robots if not _overwrites(*pair)}
    left, sets = dict.fromkeys(robots), []
    while left:
        pair = next(iter(left))
        chosen, robot = pair, robots[pair]
        while len(chosen) < MOST and pair in together:
            adds = {
                option: sum(p in left and robots[p] == robot for p in _with(option, chosen))
                for option in ORDER
                if all(p in together for p in _with(option, chosen))
                and _robot(*_sorted(option, *chosen)) == robot
            }
            option = max(adds, key=lambda option: adds[option], default="")
            if not adds.get(option):
                break
            chosen = _sorted(option, *chosen)
        for each in combinations(chosen, 2):
            if robots[each] == robot:
                left.pop(each, None)
        sets.append(chosen)
    return sets


def _sorted(*ids: str) -> tuple[str, ...]:
    return tuple(sorted(ids, key=ORDER.__getitem__))


def _with(option: str, chosen: tuple[str, ...]) -> list[tuple[str, ...]]:
    return [_sorted(option, other) for other in chosen]


@cache
def _robot(*ids: str) -> str | None:
    return base_of(*(BY_ID[name] for name in ids))


@cache
def _text(robot: str, *ids: str) -> dict[str, Any]:
    return study_of(robot, *(BY_ID[name] for name in ids))


def _overwrites(first: str, second: str) -> bool:
    """Tell whether one of two options leaves nothing of the other in a study."""
    robot = _robot(first, second)
    assert robot is not None
    both, plain = study_of(robot, BY_ID[first], BY_ID[second]), _text(robot)
    alone = _text(robot, first), _text(robot, second)
    return any(text == both and other != plain for text, other in (alone, alone[::-1]))
