"""All poses: which are served, which is the worst, and what hanging cables change."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.findings import OtherPolicy
from designer.analysis.governing_ropes import GoverningRopes
from designer.model.region import Region
from designer.model.robot import Robot
from designer.model.verdict import Verdict
from designer.model.workspace import HangsBelow, Workspace
from designer.report import format as fmt
from designer.report.blocks import (
    Block,
    Box,
    Column,
    Fact,
    Facts,
    Picture,
    Row,
    Section,
    Statement,
    Subheading,
    Table,
)
from designer.report.design.comparison import compared
from designer.report.design.source import Source
from designer.report.design.workspace_figures import rope_figures, workspace_figures
from designer.report.phrases import described_region, orientation_words
from designer.report.pictures import chart
from designer.study import Study
from designer.workspace.result import Census, Extreme, WorkspaceMap


def section(source: Source) -> Section | None:
    """Return what is known of all poses; None if the study has no workspace.

    Of the ropes of the answer where there are any, else of the configured family.
    """
    study, found = source.analysis.study, source.analysis.workspace
    if study.workspace is None or found is None:
        return None
    ropes, maps = source.analysis.ropes, source.rope_maps
    if ropes is None:
        title = "The workspace at rest" if study.load_cases else "The workspace"
        return Section.of("workspace", title, *_of_family(source, study, found))
    return Section.of(
        "workspace",
        "The workspace with the chosen rope",
        _served(ropes, source.analysis),
        _facts(study, study.workspace, found),
        *(rope_figures(maps, ropes) if maps is not None else ()),
        _hanging_share(source),
    )


def family(source: Source) -> Section | None:
    """Return what all poses ask of the configured family, where a rope is the answer."""
    study, found = source.analysis.study, source.analysis.workspace
    if study.workspace is None or found is None or source.analysis.ropes is None:
        return None
    outcome = source.analysis.findings.chosen_outcome
    return Section.of(
        "family",
        "The configured cable family",
        *_of_family(source, study, found),
        *(compared(source.analysis, outcome) if outcome else ()),
    )


def _of_family(source: Source, study: Study, found: WorkspaceMap) -> Iterator[Block | None]:
    assert study.workspace is not None
    other = source.analysis.findings.other_policy
    yield _statement(found)
    if source.analysis.ropes is None:
        yield _facts(study, study.workspace, found)
    yield _extremes(study.workspace.region, found)
    yield _weight_effect(found)
    yield Box.of("keep", _verdicts(found.census) if source.draws else None, _census(found.census))
    hanging = _hanging(source.analysis.built.robot, study.workspace, found, other)
    heading = Subheading("hanging", "Cables below the platform") if other is not None else None
    yield Box.of("keep", heading, hanging)
    yield _policies(study.workspace, found, other) if other is not None else None
    yield from _figures(source)


def _served(rope: GoverningRopes, analysis: Analysis) -> Statement:
    """Return to how much the ropes are used at most, and where."""
    used = float(rope.used(rope.worst))
    text = (
        f"{rope.name} is used to {fmt.utilisation(used)} at most, in the load case "
        f"'{rope.load_case}' at {fmt.position(rope.place)}."
    )
    chosen = analysis.chosen
    if chosen is not None and chosen.governing.loaded.keeps_lengths:
        text += " That is with winches that hold the pose; on kept lengths, after the loss of a "
        text += "cable or a change of temperature, more is asked for, see the load cases."
    return Statement("Every pose is held", text, "good" if used <= 1.0 else "bad")


def _hanging_share(source: Source) -> str:
    share, study = source.analysis.findings.hanging, source.analysis.study
    assert study.workspace is not None
    if share is None:
        return ""
    if share == 0.0:
        return "In no sample does a cable hang below the platform with it."
    return (
        f"With it a cable hangs below the platform in {fmt.percent(share)} of the samples; these "
        f"{'count' if study.workspace.hangs_below == 'include' else 'are left out'}."
    )


def _figures(source: Source) -> tuple[Block, ...]:
    if source.maps is None:
        return ()
    first, *rest = workspace_figures(source.maps, draws_scenes=source.draws_scenes)
    if isinstance(first, Picture):
        first = replace(first, kind="space")
    return Box.of("keep", Subheading("maps", "Maps"), first), *rest


def _verdicts(census: Census) -> Picture | None:
    """Return the samples by verdict; None for a single one, of which the table says enough."""
    from designer.report.figures.charts_shares import parts, verdict_chart

    if len(parts(census)) < 2:
        return None
    alternative = "A bar with a part for each verdict"
    return chart("All samples by verdict.", alternative, verdict_chart(census))


def _statement(found: WorkspaceMap) -> Statement:
    if found.sagging is not None:
        text = (
            f"A cable of {fmt.millimetres(found.sagging.diameter_m)} of the configured family "
            "serves every pose that counts. The worst is at "
            f"{fmt.position(found.sagging.place)}; its self-weight ratio there is "
            f"{fmt.percent(found.limit_ratio)}."
        )
        return Statement("The workspace is feasible", text, "good")
    text = "There is no diameter of the configured family that serves every pose."
    if found.infeasible_pose is not None:
        text += (
            " An example of a pose that is not served is "
            f"{fmt.position(found.infeasible_pose.place)}."
            " Toward such poses the needed diameter grows without bound, so the worst sample "
            "below depends on where samples happen to lie and is no design value."
        )
    return Statement("The workspace is not feasible", text, "bad")


def _facts(study: Study, workspace: Workspace, found: WorkspaceMap) -> Facts:
    region = workspace.region
    facts = [Fact("Region", described_region(region))]
    if (orientation := orientation_words(study)) is not None:
        facts.append(Fact("Orientation", *orientation))
    if not region.is_discrete:
        written = {"m": fmt.metres, "m²": fmt.square_metres, "m³": fmt.cubic_metres}
        facts.extend(Fact(name, written[unit](value)) for name, value, unit in region.sizes)
        spread = workspace.sampling.replace("_", " ")
        seed = f", seed {workspace.seed}" if workspace.sampling == "low_discrepancy" else ""
        facts.append(Fact("Samples", fmt.count(found.census.samples), f"{spread}{seed}"))
    return Facts(tuple(facts))


def _extremes(region: Region, found: WorkspaceMap) -> Table:
    how = "" if region.is_discrete else ", searched between samples"
    return Table.of(
        "The thinnest diameter of the configured cable family that was found.",
        ("Case", "Position", Column("Diameter"), Column("Largest tension")),
        _extreme(f"Worst pose{how}", found.sagging, is_answer=True),
        _extreme("Worst sample", found.sampled),
        _extreme("Worst pose, rope weight ignored", found.massless),
    )


def _weight_effect(found: WorkspaceMap) -> str:
    if found.massless is None and not found.census.is_all_left_out:
        return (
            "Straight weightless cables do not hold every pose; toward such a pose their tension "
            "can grow without bound, so that they have no worst pose to compare with."
        )
    if found.sagging is None or found.massless is None:
        return ""
    diameter = fmt.factor(found.sagging.diameter_m / found.massless.diameter_m)
    tension = fmt.factor(found.sagging.max_tension_N / found.massless.max_tension_N)
    return (
        f"The effect of rope weight is a factor of {diameter} in diameter and of {tension} in "
        "tension, each at its own worst pose."
    )


def _extreme(name: str, extreme: Extreme | None, *, is_answer: bool = False) -> Row:
    if extreme is None:
        return Row((name, fmt.MISSING, "none", "none"), "bad" if is_answer else "muted")
    cells = (
        name,
        fmt.position(extreme.place),
        fmt.millimetres(extreme.diameter_m),
        fmt.newtons(extreme.max_tension_N),
    )
    return Row(cells, "good" if is_answer else "")


def _census(census: Census) -> Table | str:
    names = {verdict: verdict.label.replace("_", " ") for verdict in Verdict}
    met = [verdict for verdict in Verdict if census.statuses[verdict.label] > 0]
    others = [name for verdict, name in names.items() if verdict not in met]
    rows = (
        (names[verdict], fmt.count(amount), fmt.share(amount, census.samples), verdict.sentence)
        for verdict in met
        for amount in [census.statuses[verdict.label]]
    )
    if len(met) == 1:
        return f"All {fmt.count(census.samples)} samples: {names[met[0]]}. {met[0].sentence}"
    rest = f" No sample met another: {fmt.listing(others, 'or')}." if others else ""
    columns = ("Verdict", Column("Samples"), Column("Share"), "Meaning")
    return Table.of(f"Verdicts of all samples.{rest}", columns, *rows)


def _hanging(
    robot: Robot, workspace: Workspace, found: WorkspaceMap, other: OtherPolicy | None
) -> Statement:
    census = found.census
    if census.hangs_below == 0:
        text = "In no solved sample does a cable hang below the platform."
        return Statement("No cable below the platform", text)
    text = (
        f"In {fmt.share(census.hangs_below, census.samples)} of the samples a cable hangs below "
        "the platform: it may touch the ground or what stands on it."
    )
    up = robot.upright[2]
    corners = np.array(list(product(*workspace.region.bounds_m.T)))
    if (robot.exit_points_m @ up).min() < (corners @ up).min():
        text += " Cables that come from below, as some of this robot do, are among them."
    if workspace.hangs_below == "include":
        text += " All results of this report include them."
    else:
        text += (
            " The study leaves such poses out, together with poses that have no finite cable: "
            f"{fmt.share(census.excluded, census.samples)} of the samples do not count in the "
            "results of this report."
        )
    if other is not None:
        text += " The table shows what the other choice would give."
    return Statement(_POLICIES[workspace.hangs_below], text, "doubt")


_POLICIES: dict[HangsBelow, str] = {
    "include": "These poses count",
    "exclude": "These poses are left out",
}


def _policies(workspace: Workspace, found: WorkspaceMap, other: OtherPolicy) -> Table:
    maps = {workspace.hangs_below: found, other.hangs_below: other.map}
    rows = []
    for policy, title in _POLICIES.items():
        is_ours = policy == workspace.hangs_below
        census = maps[policy].census
        name = f"{title}{' (as configured)' if is_ours else ''}"
        row = _extreme(name, maps[policy].sagging, is_answer=is_ours)
        left_out = fmt.share(census.excluded, census.samples)
        rows.append(Row((*row.cells, left_out), row.tone))
    numbers = (Column("Diameter"), Column("Largest tension"), Column("Left out"))
    return Table.of(
        "Worst pose of the configured family, with and without poses in which a cable hangs "
        "below the platform.",
        ("Choice", "Worst position", *numbers),
        *rows,
    )
