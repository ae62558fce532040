"""All poses: which are served, which is the worst, and what hanging cables change."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, OtherPolicy
from designer.model.region import Region
from designer.model.robot import Robot
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.design.scope import orientation_fact
from designer.report.parts import Column, Fact, Picture, Row, Statement, Table
from designer.report.pictures import Pictures
from designer.study import HangsBelow, Study, Workspace
from designer.workspace.result import Census, Extreme, WorkspaceMap


@dataclass(frozen=True, slots=True)
class WorkspaceSection:
    """Sizing over the whole workspace.

    Parameters
    ----------
    verdict : Statement
        Whether every pose has a finite cable.
    facts : tuple of Fact
        The region and how it was searched.
    extremes : Table
        Worst pose with sag (refined), worst sample, worst pose without sag.
    census : Table
        Count of samples by verdict.
    hanging : Statement
        How many poses have a cable below the platform, and what leaving them out changes.
    policies : Table or None
        The worst pose with and without those poses; None where there are none.
    verdicts : Picture or None
        The samples by verdict as a chart.
    maps : tuple of Picture
        Maps and charts.
    """

    verdict: Statement
    facts: tuple[Fact, ...]
    extremes: Table
    census: Table
    hanging: Statement
    policies: Table | None
    verdicts: Picture | None
    maps: tuple[Picture, ...]


def workspace_section(
    analysis: Analysis, findings: Findings, pictures: Pictures
) -> WorkspaceSection | None:
    """Return the section on the workspace; None if the study has none."""
    study, found = analysis.study, analysis.workspace
    if study.workspace is None or found is None:
        return None
    return WorkspaceSection(
        verdict=_statement(found),
        facts=_facts(study, found),
        extremes=_extremes(study.workspace.region, found),
        census=_census(found.census),
        hanging=_hanging(
            study.workspace,
            found,
            findings.other_policy,
            comes_from_below=_comes_from_below(analysis.built.robot, study.workspace),
        ),
        policies=_policies(study.workspace, found, findings.other_policy),
        verdicts=pictures.verdicts,
        maps=pictures.workspace,
    )


def describe_region(region: Region) -> str:
    """Return a region in words."""
    words = region.words(fmt.position, fmt.plural)
    if region.is_discrete:
        return words
    low, high = region.bounds_m[:, 2]
    return f"{words}, z from {fmt.metres(low)} to {fmt.metres(high)}"


def _statement(found: WorkspaceMap) -> Statement:
    if found.sagging is not None:
        text = (
            f"A cable of {fmt.millimetres(found.sagging.diameter_m)} of the configured family "
            "serves every pose that counts. The worst is at "
            f"{fmt.position(found.sagging.place)}."
        )
        return Statement("The workspace is served", text, "good")
    text = "There is no diameter of the configured family that serves every pose."
    if found.infeasible_pose is not None:
        where = fmt.position(found.infeasible_pose.place)
        text += f" An example of a pose that is not served is {where}."
        text += (
            " Toward such poses the needed diameter grows without bound, so the worst sample "
            "below depends on where samples happen to lie and is no design value."
        )
    return Statement("The workspace is not served", text, "bad")


def _facts(study: Study, found: WorkspaceMap) -> tuple[Fact, ...]:
    workspace = study.workspace
    assert workspace is not None
    region = workspace.region
    facts = [Fact("Region", describe_region(region)), *orientation_fact(study)]
    if not region.is_discrete:
        written = {"m²": fmt.square_metres, "m³": fmt.cubic_metres}
        facts.extend(Fact(name, written[unit](value)) for name, value, unit in region.sizes)
        spread = workspace.sampling.replace("_", " ")
        seed = f", seed {workspace.seed}" if workspace.sampling == "low_discrepancy" else ""
        facts.append(Fact("Samples", fmt.count(found.census.samples), f"{spread}{seed}"))
    if found.sagging is not None:
        facts.append(
            Fact(
                "Limit ratio at the worst pose",
                fmt.percent(found.limit_ratio),
                "at 100 % no finite cable is left",
            )
        )
    return tuple(facts)


def _extremes(region: Region, found: WorkspaceMap) -> Table:
    how = "" if region.is_discrete else ", searched between samples"
    named = (
        (f"Worst pose with sag{how}", found.sagging, "good"),
        ("Worst sample with sag", found.sampled, ""),
        ("Worst pose without sag", found.massless, ""),
    )
    columns = (
        Column("Case", is_number=False),
        Column("Position", is_number=False),
        Column("Diameter"),
        Column("Largest tension"),
    )
    rows = [_extreme(name, extreme, tone == "good") for name, extreme, tone in named]
    return Table.of(
        "The thinnest diameter of the configured cable family that was found.", columns, *rows
    )


def _extreme(name: str, extreme: Extreme | None, is_answer: bool) -> Row:
    if extreme is None:
        return Row((name, fmt.MISSING, "none", "none"), "bad" if is_answer else "muted")
    cells = (
        name,
        fmt.position(extreme.place),
        fmt.millimetres(extreme.diameter_m),
        fmt.newtons(extreme.max_tension_N),
    )
    return Row(cells, "good" if is_answer else "")


def _census(census: Census) -> Table:
    met = [verdict for verdict in Verdict if census.statuses[verdict.label] > 0]
    names = [verdict.label.replace("_", " ") for verdict in Verdict if verdict not in met]
    rows = [
        Row(
            (
                verdict.label.replace("_", " "),
                fmt.count(census.statuses[verdict.label]),
                fmt.share(census.statuses[verdict.label], census.samples),
                verdict.sentence,
            )
        )
        for verdict in met
    ]
    columns = (
        Column("Verdict", is_number=False),
        Column("Samples"),
        Column("Share"),
        Column("Meaning", is_number=False),
    )
    rest = f" No sample met another: {fmt.listing(names, 'or')}." if names else ""
    return Table.of(f"Verdicts of all samples.{rest}", columns, *rows)


def _comes_from_below(robot: Robot, workspace: Workspace) -> bool:
    """Tell whether an exit point lies below all positions of the platform."""
    up = robot.upright[2]
    corners = np.array(list(product(*workspace.region.bounds_m.T)))
    return bool((robot.exit_points_m @ up).min() < (corners @ up).min())


def _hanging(
    workspace: Workspace, found: WorkspaceMap, other: OtherPolicy | None, *, comes_from_below: bool
) -> Statement:
    census = found.census
    if census.hangs_below == 0:
        text = "In no solved sample does a cable hang below the platform."
        return Statement("There are none", text)
    share = fmt.share(census.hangs_below, census.samples)
    text = (
        f"In {share} of the samples a cable hangs below the platform: it may touch the ground "
        "or what stands on it."
    )
    if comes_from_below:
        text += " Cables that come from below, as some of this robot do, are among them."
    if workspace.hangs_below == "include":
        title = "These poses count"
        text += " All results of this report include them."
    else:
        title = "These poses are left out"
        left_out = fmt.share(census.excluded, census.samples)
        text += (
            " The study leaves such poses out, together with poses that have no finite cable: "
            f"{left_out} of the samples do not count in the results of this report."
        )
    if other is not None:
        text += " The table shows what the other choice would give."
    return Statement(title, text, "doubt")


def _policies(workspace: Workspace, found: WorkspaceMap, other: OtherPolicy | None) -> Table | None:
    if other is None:
        return None
    maps = {workspace.hangs_below: found, other.hangs_below: other.map}
    titles: dict[HangsBelow, str] = {
        "include": "These poses count",
        "exclude": "These poses are left out",
    }
    rows = []
    for policy, title in titles.items():
        here = maps[policy]
        name = f"{title}{' (as configured)' if policy == workspace.hangs_below else ''}"
        left_out = fmt.share(here.census.excluded, here.census.samples)
        row = _extreme(name, here.sagging, policy == workspace.hangs_below)
        rows.append(Row((*row.cells, left_out), row.tone))
    columns = (
        Column("Choice", is_number=False),
        Column("Worst position", is_number=False),
        Column("Diameter"),
        Column("Largest tension"),
        Column("Left out"),
    )
    return Table.of(
        "Worst pose of the configured family, with and without poses in which a cable hangs "
        "below the platform.",
        columns,
        *rows,
    )
