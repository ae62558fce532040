"""The document on an optimisation, and all files that it writes."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np

from designer.documents.document import document_of
from designer.documents.plain import json_text
from designer.io.config.moved import moved_to
from designer.io.output import write_whole
from designer.optimum.measures import Measure
from designer.optimum.result import Optimum
from designer.optimum.variables import Variable
from designer.progress import SILENT, Reporter
from designer.report import format as fmt
from designer.report.blocks import (
    Block,
    Column,
    Fact,
    Facts,
    Picture,
    Report,
    Row,
    Section,
    Statement,
    Table,
    plain_report,
)
from designer.report.comparison import change, shown, write_comparison
from designer.report.figures import optimum as figures
from designer.report.render import write_pages

_MOST_REASONS = 8
_ASKS = {"less": "less than the study", "more": "more", "other": "something else"}
_ENDED = {
    "settled": "the search had settled",
    "evaluations": "the starts had used up their budget of designs",
    "time": "the time was up",
    "asked": "it was asked to end, and answers with the best so far",
}


def optimum_report(found: Optimum, created: datetime) -> Report[None]:
    """Return the document on an optimisation."""
    sections = (
        Section.of("answer", "What came out", *_answer(found)),
        Section.of("variables", "What was chosen", *_chosen(found)),
        _differences(found),
        Section.of("trust", "How far to believe it", *_trust(found)),
    )
    title = found.given.study.name
    return plain_report("optimise", title, "Optimisation of the robot", created, sections)


def write_optimum(
    found: Optimum,
    folder: Path,
    target: Path | None = None,
    templates: Path | None = None,
    reporter: Reporter = SILENT,
) -> None:
    """Write the pages, ``optimise.json``, ``designs.csv``, the comparison and the study.

    Into an existing folder; relative paths in the study are as they are from ``target``, where the
    folder's files are to be in the end.
    """
    report = optimum_report(found, datetime.now().astimezone())
    write_pages(report, folder, templates, reporter)
    source = Path(found.plan.document.name)
    names = source.name, optimised_name(found)
    write_comparison(found.comparison, names, folder, templates)
    comparison = json_text(found.comparison.to_dict())
    write_whole(folder / "comparison.json", f"{comparison}\n".encode())
    write_whole(folder / "optimise.json", f"{found.to_json()}\n".encode())
    write_whole(folder / "designs.csv", found.to_csv().encode())
    document = document_of(found.text.encode(), found.plan.document.name)
    text = moved_to(target or folder, found.text, document, source.parent)
    write_whole(folder / optimised_name(found), text.encode())


def optimised_name(found: Optimum) -> str:
    """Return the name of the file of the optimised study."""
    return f"{Path(found.plan.document.name).stem}.optimised.yaml"


def value_text(measure: Measure, value: float | None) -> str:
    """Return a value of the objective as a reader wants it."""
    if value is not None and measure.dimension.unit == "m^3":
        return fmt.cubic_metres(value)
    return shown(measure.path, value)


def headline(found: Optimum) -> str:
    """Return what came out, in a line."""
    objective, gain = found.plan.objective, found.gain
    before, after = (value_text(objective, one) for one in (found.before, found.after))
    title = objective.title if objective.title == objective.path else fmt.capital(objective.title)
    if found.is_better and gain is not None and found.given_holds:
        return f"{title}: {before} → {after}, {fmt.signed_percent(gain)}"
    if found.is_better:
        return f"{title}: {after}; the robot as given does not hold as asked"
    if found.holds:
        return f"Nothing better was found than the robot as given, {before}"
    return "No design was found that holds as asked"


def trust_lines(found: Optimum) -> list[str]:
    """Return how far the answer is to be believed, a sentence each."""
    plan, searched = found.plan, found.searched
    tried = len(searched.trials) - 1
    lines = [
        f"Found, not proved the best: {fmt.plural(tried, 'design')} tried in "
        f"{searched.elapsed_s:.0f} s, until {_ENDED[searched.ended]}."
    ]
    if found.off is not None:
        poses = f", with {fmt.plural(plan.samples, 'pose')} of each design,"
        lines.append(
            f"Verified in full: {value_text(plan.objective, found.after)}; the search"
            f"{poses if found.given.study.workspace else ''} had "
            f"{value_text(plan.objective, found.best.value)} ({fmt.signed_percent(found.off)})."
        )
    if found.rejected:
        count = fmt.plural(len(found.rejected), "design")
        lines.append(f"{count} looked better in the search, and did not hold in full.")
    if found.unverified:
        count = fmt.plural(found.unverified, "other design")
        lines.append(
            f"{count} looked better in the search and may hold: the budget of full verifications "
            "was used up."
        )
    if found.worsened:
        each = (f"{one.label} {change(one)}" for one in found.worsened)
        lines.append(f"Paid with what was not asked for: {fmt.listing(each)}.")
    for one, value, asked in zip(plan.variables, found.best.values, found.demands, strict=True):
        if asked:
            given = "" if one.given is None else f" in place of {_number(one, one.given)}"
            lines.append(
                f"{one.name} is what the study asks for, not what the robot is: this design asks "
                f"for {_ASKS[asked]}, {_number(one, value)}{given}."
            )
    lines.append(_starts_text(found))
    outside = [
        one.name for one in plan.variables if one.given is not None and not one.is_within(one.given)
    ]
    if outside:
        lines.append(f"Outside the bounds in the robot as given: {fmt.listing(outside)}.")
    at_bounds = [
        f"{one.name} at its {bound} bound"
        for one, value in zip(plan.variables, found.best.values, strict=True)
        if (bound := one.bound_at(value))
    ]
    if at_bounds:
        lines.append(f"Wider bounds may give more: {fmt.listing(at_bounds)}.")
    return lines


def _starts_text(found: Optimum) -> str:
    agree = sum(found.agrees(one) for one in found.starts)
    n = len(found.starts)
    if found.reasons and all(one is None for one in found.starts):
        why, count = found.reasons[0]
        return f"No start came to a design that holds; of {fmt.plural(count, 'design')}: {why}."
    if n == 1:
        return "One start only: whether another comes to the same place is not known."
    if agree == n:
        return f"All {n} starts came to this place, within 2 % of each range."
    known = [one.value for one in found.starts if one is not None]
    apart = max(known) / min(known) - 1.0 if len(known) > 1 and min(known) > 0.0 else float("nan")
    spread = f"; their objectives lie {fmt.percent(apart)} apart" if np.isfinite(apart) else ""
    return (
        f"{agree} of {n} starts came to this place by itself{spread}: the optimum is flat, or "
        "there are several, or the budget was short."
    )


def _answer(found: Optimum) -> tuple[Block | None, ...]:
    tone = "good" if found.is_better else "doubt" if found.holds else "bad"
    plan = found.plan
    text = " ".join(trust_lines(found)[:2])
    if plan.region_stays:
        text += " The region to serve stays where it was, though the study has it over the anchors."
    return (
        Statement(headline(found), text, tone),  # type: ignore[arg-type]
        _picture(found),
    )


def _picture(found: Optimum) -> Picture:
    before, after = found.given.study.robot, found.optimised.study.robot
    workspace = found.optimised.study.workspace
    region = None if workspace is None else workspace.region
    pose = found.optimised.study.pose
    where = after.exit_points_m.mean(axis=0)
    if region is not None:
        where = region.bounds_m.mean(axis=0)
    elif pose is not None:
        where = pose.position_m
    return Picture(
        "The robot as given and optimised, from above and from the side, the platform in the "
        "middle of where it goes. Arrows show where exit points move.",
        "",
        svg=figures.robots(before, after, region, where),
    )


def _chosen(found: Optimum) -> tuple[Block | None, ...]:
    rows = []
    for one, value in zip(found.plan.variables, found.best.values, strict=True):
        bound = one.bound_at(value)
        ends = fmt.trimmed(one.low, 6), fmt.trimmed(one.high, 6)
        bounds = f"{ends[0]} to {ends[1]} {one.unit}".rstrip().replace(" ", "\u00a0")
        note = f"at its {bound} bound" if bound else ""
        given = "—" if one.given is None else _number(one, one.given)
        fields = ", ".join(one.fields)
        rows.append((one.name, fields, given, _number(one, value), bounds, note))
    heads = ("Variable", "Fields", Column("As given"), Column("Optimised"), "Bounds", "")
    caption = "What was chosen; an offset is a change of what the study has."
    blocks: list[Block | None] = [Table.of(caption, heads, *rows, kind="long")]
    if found.plan.limits:
        blocks.append(_limits(found))
    if np.isfinite([x for one in found.profiles for x in one.objective]).any():
        blocks += [
            Picture(
                "What each variable does by itself, the others as optimised: how exactly it has to "
                "be met. Ring: optimised; dashed: as given; dotted, red: a design that does not "
                "hold.",
                "",
                svg=figures.profiles(_curves(found), _axis(found)[1]),
            ),
        ]
    return tuple(blocks)


def _number(one: Variable, value: float) -> str:
    return f"{fmt.trimmed(value, 6)} {one.unit}".rstrip()


def _limits(found: Optimum) -> Table:
    rows = []
    for limit in found.plan.limits:
        value = limit.measure.value(found.comparison.b)
        tone = "bad" if limit in found.breaches else ""
        what = f"{limit.words} {value_text(limit.measure, limit.value)}"
        cells = (fmt.capital(limit.measure.title), what, value_text(limit.measure, value))
        rows.append(Row(cells, tone))  # type: ignore[arg-type]
    heads = ("Constraint", "Limit", Column("Verified"))
    return Table.of("Constraints, and what the optimised robot has.", heads, *rows)


def _axis(found: Optimum) -> tuple[float, str]:
    """Return scale and title of an axis of the objective."""
    objective = found.plan.objective
    unit = objective.dimension.unit
    if unit == "m":
        return 1e3, f"{objective.title} [mm]"
    if unit == "N":
        name, size = fmt.force_unit(abs(found.best.value))
        return 1.0 / size, f"{objective.title} [{name}]"
    return 1.0, f"{objective.title} [{fmt.printed(unit)}]" if unit else objective.title


def _curves(found: Optimum) -> list[figures.Curve]:
    scale = _axis(found)[0]
    return [
        figures.Curve(
            f"{one.name} [{one.unit}]" if one.unit else one.name,
            np.array(profile.values),
            scale * np.array(profile.objective),
            one.given,
            value,
        )
        for one, profile, value in zip(
            found.plan.variables, found.profiles, found.best.values, strict=False
        )
    ]


def _differences(found: Optimum) -> Section | None:
    lines = [line for line in found.comparison.answers if line.differs]
    if not lines:
        return None
    rows = (
        (fmt.capital(one.label), shown(one.path, one.a), shown(one.path, one.b), change(one))
        for one in lines
    )
    heads = ("Answer", Column("As given"), Column("Optimised"), Column("Change"))
    return Section.of(
        "differences",
        "What changes with it",
        Table.of(
            "Both robots, analysed in full; comparison.html has all.", heads, *rows, kind="long"
        ),
    )


def _trust(found: Optimum) -> tuple[Block | None, ...]:
    plan, trials = found.plan, found.searched.trials
    scale, title = _axis(found)
    sign = plan.objective.sign
    values = np.array([sign * scale * one.value for one in trials[1:]])
    starts = np.array([one.start for one in trials[1:]])
    holds = np.array([one.holds for one in trials[1:]], dtype=np.bool_)
    first = trials[0]
    chart = ""
    if holds.any():
        before = sign * scale * first.value if first.holds else None
        named = title if sign > 0 else f"− {title}"
        chart = figures.convergence(values, starts, holds, before, named)
    heads = ("Start", Column("Seed"), Column("Best in the search"), "Same place", Column("Spread"))
    spreads = [*found.searched.spreads, *[np.array([np.nan])] * plan.starts]
    rows = [
        (
            str(k + 1),
            str(plan.seed + k),
            fmt.MISSING if one is None else value_text(plan.objective, one.value),
            "yes" if found.agrees(one) else "no",
            fmt.percent(float(spreads[k].max())) if np.isfinite(spreads[k]).all() else fmt.MISSING,
        )
        for k, one in enumerate(found.starts)
    ]
    return (
        *trust_lines(found),
        Picture("Every design that holds, and the best so far.", "", svg=chart) if chart else None,
        Table.of(
            "Each start. Same place: within 2 % of each range from the answer. Spread: largest "
            "standard deviation of the last population, over the range.",
            heads,
            *rows,
        ),
        Facts(
            (
                Fact(
                    "Method",
                    "differential evolution; then a simplex, and lines, about the best",
                ),
                Fact("Of each design", f"{fmt.plural(plan.samples, 'pose')}, half on the border"),
                Fact("Budget", f"{fmt.plural(plan.budget.evaluations, 'design')}"),
            )
        ),
        _reasons(found),
    )


def _reasons(found: Optimum) -> Table | None:
    if not found.reasons:
        return None
    rows = ((fmt.count(count), why) for why, count in found.reasons[:_MOST_REASONS])
    caption = "Designs that do not hold, by reason; designs.csv has each. They led the search away."
    return Table.of(caption, (Column("Designs"), "Reason"), *rows)
