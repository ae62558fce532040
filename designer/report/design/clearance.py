"""How near cables come to each other and to the platform."""

from __future__ import annotations

from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.parts import Column, Fact, Picture, Row, Statement, Table
from designer.workspace.interference import Interference, Nearest


@dataclass(frozen=True, slots=True)
class ClearanceSection:
    """Clearances over the workspace.

    Parameters
    ----------
    verdict : Statement
        Whether the clearance that the study asks for is kept.
    facts : tuple of Fact
        What was asked for, and how it was looked at.
    nearest : Table or None
        Where two cables, and where a cable and the platform, come nearest; None where nothing is
        compared.
    map : Picture or None
        Over a section at the middle height.
    """

    verdict: Statement
    facts: tuple[Fact, ...]
    nearest: Table | None
    map: Picture | None


def clearance_section(analysis: Analysis, picture: Picture | None) -> ClearanceSection | None:
    """Return the section on clearance; None if the study asks for none, or no cable holds."""
    qualities = analysis.qualities
    if qualities is None or qualities.interference is None:
        return None
    found = qualities.interference
    return ClearanceSection(
        verdict=clearance_statement(found),
        facts=_facts(found, qualities.cable.name),
        nearest=_table(found),
        map=picture,
    )


def clearance_statement(found: Interference) -> Statement:
    """Return whether the clearance is kept, and where it is least."""
    worst = found.worst
    if worst is None:
        text = (
            "All cables share a point with each other, where they part, and the platform has no "
            "body that they could touch."
        )
        return Statement("There is nothing to compare", text)
    asked = fmt.millimetres(found.clearance_m)
    nearest = f"{fmt.listing(worst.names)} come as near as {fmt.millimetres(worst.distance_m)}"
    where = f"with the platform at {fmt.position(worst.place[:3])}"
    if not found.is_violated:
        text = f"At the worst, {nearest}, {where}."
        return Statement("The clearance is kept", text, "good")
    share = (
        f"in {fmt.share(found.violating, found.samples)} of the samples"
        if found.violating
        else "though only between the samples"
    )
    text = f"{nearest[0].upper()}{nearest[1:]}, {where}; less than the {asked} asked for {share}."
    return Statement("The clearance is not kept", text, "bad")


def _facts(found: Interference, cable: str) -> tuple[Fact, ...]:
    return (
        Fact("Clearance asked for", fmt.millimetres(found.clearance_m), "from axis to axis"),
        Fact("Cable", cable),
        Fact(
            "Samples",
            fmt.count(found.samples),
            "and a search between them",
        ),
    )


def _table(found: Interference) -> Table | None:
    named = (("Two cables", found.among_cables), ("A cable and the platform", found.to_platform))
    rows = [_row(name, nearest, found) for name, nearest in named if nearest is not None]
    if not rows:
        return None
    columns = (
        Column("Between", is_number=False),
        Column("Which", is_number=False),
        Column("Smallest distance"),
        Column("Less by at most"),
        Column("Platform at", is_number=False),
        Column("Nearest at", is_number=False),
    )
    return Table.of(
        "Where they come nearest. A polyline stands for each cable; the bound says how much the "
        "true distance in that pose can be smaller.",
        columns,
        *rows,
    )


def _row(name: str, nearest: Nearest, found: Interference) -> Row:
    cells = (
        name,
        fmt.listing(nearest.names),
        fmt.millimetres(nearest.distance_m),
        fmt.millimetres(nearest.error_m),
        fmt.position(nearest.place[:3]),
        fmt.position(nearest.point_m),
    )
    return Row(cells, "bad" if nearest.distance_m < found.clearance_m else "")
