"""How near cables come to each other and to the platform."""

from __future__ import annotations

from designer.report import format as fmt
from designer.report.blocks import Box, Column, Fact, Facts, Picture, Row, Section, Statement, Table
from designer.report.design.scope import in_first_orientation
from designer.report.design.source import Source
from designer.report.pictures import chart
from designer.workspace.interference import Interference


def section(source: Source) -> Section | None:
    """Return how near things come; None if the study asks for no clearance, or no cable holds."""
    qualities = source.analysis.qualities
    if qualities is None or qualities.interference is None:
        return None
    found = qualities.interference
    facts = (
        Fact("Clearance asked for", fmt.millimetres(found.clearance_m), "from axis to axis"),
        Fact("Cable", qualities.cable.name),
        Fact("Samples", fmt.count(found.samples), "and a search between them"),
    )
    drawn = _map(source) if source.draws else None
    return Section.of(
        "clearance",
        "Clearance",
        clearance_statement(found),
        Facts(facts) if drawn is None else Box.of("lead keep", drawn, Facts(facts)),
        _table(found),
        "Cables are taken in their true shape. Two cables that share an exit point or an "
        "attachment are not compared: there they part. Near its own attachment a cable is meant to "
        "be near the platform, so its last piece, a quarter of the platform's extent long, does "
        "not count.",
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
    asked = fmt.millimetres(found.clearance_m)
    text = f"{fmt.capital(nearest)}, {where}; less than the {asked} asked for {share}."
    return Statement("The clearance is not kept", text, "bad")


def _table(found: Interference) -> Table | None:
    named = (("Two cables", found.among_cables), ("A cable and the platform", found.to_platform))
    rows = [
        Row(
            (
                name,
                fmt.listing(nearest.names),
                fmt.millimetres(nearest.distance_m),
                fmt.millimetres(nearest.error_m),
                fmt.position(nearest.place[:3]),
                fmt.position(nearest.point_m),
            ),
            "bad" if nearest.distance_m < found.clearance_m else "",
        )
        for name, nearest in named
        if nearest is not None
    ]
    if not rows:
        return None
    return Table.of(
        "Where they come nearest. A polyline stands for each cable; the bound says how much the "
        "true distance in that pose can be smaller.",
        (
            *("Between", "Which", Column("Smallest distance"), Column("Less by at most")),
            *("Platform at", "Nearest at"),
        ),
        *rows,
    )


def _map(source: Source) -> Picture | None:
    from designer.report.figures.sections import clearance_map

    return chart(
        "Smallest distance between two cables, or between a cable and the platform, at the middle "
        f"height of the region{in_first_orientation(source.analysis.study)}.",
        "A map in plan",
        clearance_map(source.analysis),
    )
