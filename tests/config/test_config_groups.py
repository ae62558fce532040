"""Groups of cables in a config: every cable in exactly one."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.study import CableGroup, Study

StudyOf = Callable[[str], Study]
FaultsOf = Callable[[str], list[Fault]]

GROUPS = "  groups: {near: [1, 2], far: [3]}\n"


def test_groups_and_their_default_limit(valid: str, study_of: StudyOf) -> None:
    selection = study_of(valid + GROUPS).selection
    assert selection is not None
    assert selection.groups == (CableGroup("near", (1, 2)), CableGroup("far", (3,)))
    assert selection.max_distinct_products is None


def test_limit(valid: str, study_of: StudyOf) -> None:
    selection = study_of(f"{valid}{GROUPS}  max_distinct_products: 1\n").selection
    assert selection is not None
    assert selection.max_distinct_products == 1


@pytest.mark.parametrize("text", ["", "  groups:\n"])
def test_no_groups(valid: str, study_of: StudyOf, text: str) -> None:
    selection = study_of(valid + text).selection
    assert selection is not None
    assert selection.groups == ()


def test_the_table_of_inputs_has_them(valid: str, study_of: StudyOf) -> None:
    entries = {e.field: e.given for e in study_of(valid + GROUPS).source.entries}
    assert entries["selection.groups.near"] == "[1, 2]"
    assert entries["selection.max_distinct_products"] == "default"


@pytest.mark.parametrize(
    ("text", "field", "problem"),
    [
        ("groups: {a: [1, 2], b: [2, 3]}", "a", "cable 2 is in group 'a' already"),
        ("groups: {a: [1, 1], b: [2, 3]}", "a[1]", "cable 1 is in group 'a' already"),
        ("groups: {a: [1, 2]}", "", "cable 3 is in no group"),
        ("groups: {a: [1]}", "", "cables 2 and 3 are in no group"),
        ("groups: {a: [1, 2, 3, 4]}", "a[3]", "there is no cable 4, the robot has 3"),
        ("groups: {a: [1, 2, 3], b: []}", "b", "the list has 0 values"),
        ("groups: {a: [0, 1, 2, 3]}", "a[0]", "0 is out of range"),
        ("groups: {a: [1.5, 2, 3]}", "a[0]", "1.5 is not a whole number"),
        ("groups: {a: [one, 2, 3]}", "a[0]", "'one' is not a number"),
        ("groups: {a: 1, b: [2, 3]}", "a", "1 is not a list"),
        ("groups: {}", "", "the mapping is empty"),
        ("groups: [1, 2, 3]", "", "a list is not a mapping"),
    ],
)
def test_one_line_for_a_mistake(
    valid: str, faults_of: FaultsOf, text: str, field: str, problem: str
) -> None:
    faults = faults_of(f"{valid}  {text}\n")
    assert [fault.problem for fault in faults] == [problem]
    assert faults[0].field.startswith("selection.groups")
    assert field.removeprefix("a") in faults[0].field
    assert faults[0].line == valid.count("\n") + 1
    assert faults[0].expected


@pytest.mark.parametrize("limit", ["0", "two", "1.5", "[1]"])
def test_limit_must_be_a_whole_number(valid: str, faults_of: FaultsOf, limit: str) -> None:
    faults = faults_of(f"{valid}{GROUPS}  max_distinct_products: {limit}\n")
    assert [fault.field for fault in faults] == ["selection.max_distinct_products"]
    assert faults[0].expected == "a whole number from 1 to 64"


def test_limit_without_groups(valid: str, faults_of: FaultsOf) -> None:
    faults = faults_of(f"{valid}  max_distinct_products: 2\n")
    assert [fault.problem for fault in faults] == ["has no meaning without selection.groups"]


def test_a_selection_needs_a_workspace(valid: str, faults_of: FaultsOf) -> None:
    start, end = valid.index("workspace:"), valid.index("selection:")
    (fault,) = faults_of(valid[:start] + valid[end:])
    assert (fault.field, fault.line) == ("selection", valid[:start].count("\n") + 1)
    assert "workspace" in fault.problem
