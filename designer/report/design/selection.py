"""The choice of a rope: what was chosen and where it is known from, and all that was tried."""

from __future__ import annotations

import math
from collections.abc import Iterator

from designer.grades.grade import TRUST_MEANING, Grade, Reference
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
from designer.report.design.candidates import (
    alternatives_table,
    best_table,
    fallen_table,
    front_sentence,
    main_dominators,
    pareto_table,
    thin_table,
)
from designer.report.design.source import Source
from designer.report.pictures import chart, scene
from designer.selection.cases import FEW_AT_FIRST
from designer.selection.objectives import MEANINGS
from designer.selection.result import SelectionResult
from designer.selection.usable import Usable, UsableSize


def section(source: Source) -> Section | None:
    """Return what was chosen and tried; None if the study asks for no rope."""
    selection = source.analysis.selection
    if selection is None:
        return None
    chosen = selection.chosen
    alternatives = alternatives_table(selection)
    grades = _grades_chart(selection) if source.draws else None
    trusts = {outcome.grade.trust for outcome in selection.outcomes}
    letters = (f"Trust {k}: {meaning}." for k, meaning in TRUST_MEANING.items() if k in trusts)
    return Section.of(
        "selection",
        "The choice of a rope",
        _statement(selection),
        Box.of("loose", sources(chosen.grade)) if chosen else None,
        " ".join((_tried(selection), *letters)),
        *(_front(selection, draws=source.draws) if selection.front else ()),
        Box.of("keep", Subheading("fallen", "Why the others fell out"), fallen_table(selection)),
        main_dominators(selection),
        thin_table(selection.outcomes),
        Box.of("keep", Subheading("candidates", "Grades"), grades) if grades else None,
        best_table(selection) if selection.front else None,
        *(_usable(source, selection, selection.usable) if selection.usable else ()),
        Subheading("alternatives", "Grades that would hold") if alternatives else None,
        alternatives,
    )


def product_name(grade: Grade) -> str:
    """Return product and maker in one line."""
    return f"{grade.product}, maker {grade.manufacturer}"


def _statement(selection: SelectionResult) -> Statement:
    chosen = selection.chosen
    if chosen is None:
        reason = selection.reason or "no reason is known"
        return Statement("No rope was found", f"{fmt.capital(reason)}.", "bad")
    held = sum(outcome.outcome == "fits" for outcome in selection.outcomes)
    first = MEANINGS[selection.objectives[0]]
    most = "largest" if first.more_is_better else "least"
    text = (
        f"{chosen.size.id} of {chosen.grade.id} has the {most} {first.word} of the sizes that hold "
        f"every pose: {fmt.plural(held, 'grade')} of {len(selection.outcomes)} can serve the "
        "workspace."
    )
    return Statement("A rope was found", text, "good")


def sources(grade: Grade) -> Facts:
    """Return what is known of a grade, and where from."""
    elasticity, notes = grade.elasticity, (f"{note.removesuffix('.')}." for note in grade.notes)
    return Facts(
        (
            Fact("Grade", grade.id),
            Fact("Product", grade.product),
            Fact("Maker", grade.manufacturer),
            Fact("Construction", f"{grade.construction}, core {grade.core}, {grade.finish}"),
            Fact("Standard", grade.standard or "not given"),
            _reference(grade.source),
            Fact("Trust", f"{grade.trust}: {TRUST_MEANING[grade.trust]}"),
            Fact(
                "Modulus" if grade.modulus else "Stiffness",
                f"{elasticity.figure}, {fmt.plus_minus(elasticity.uncertainty)}",
                f"{elasticity.basis}: {elasticity.source}",
            ),
            *_limits(grade),
            *(Fact("Computed", f"{c.figure.replace('_', ' ')}: {c.how}") for c in grade.computed),
            *([Fact("Notes", " ".join(notes))] if grade.notes else []),
        )
    )


def _limits(grade: Grade) -> Iterator[Fact]:
    limits = grade.limits
    if limits is not None and limits.temperature_C is not None:
        lowest, highest = limits.temperature_C
        yield Fact("Temperature", f"{lowest:g} to {highest:g} °C", limits.source)
    if limits is not None and limits.creep is not None:
        yield Fact("Creep", limits.creep, limits.source)


def _reference(source: Reference) -> Fact:
    """Return where a table was read, with a link if its address is one of the web."""
    parts = (source.publisher, source.document, source.date)
    text = ", ".join(part for part in parts if part)
    url = source.url or ""
    is_web = url.startswith(("https://", "http://"))
    return Fact("Table read from", text, note=url, link=url if is_web else "")


def _tried(selection: SelectionResult) -> str:
    """Return what was solved, in a sentence."""
    candidates = selection.candidates
    if not candidates:
        return "No size was solved."
    held = sum(c.verification.holds for c in candidates)
    is_whole = all(one.is_whole for c in candidates for one in c.cases)
    few = f"{FEW_AT_FIRST} samples of each load case, those compared further in every one"
    return (
        f"{fmt.plural(len(candidates), 'size')} of {fmt.plural(len(selection.outcomes), 'grade')} "
        f"were solved in {'every sample' if is_whole else few}, each with its own mass, stiffness "
        f"and breaking load; "
        f"{fmt.count(held)} of them hold. They were compared by "
        f"{fmt.listing(MEANINGS[o].title for o in selection.objectives)}; the first decides."
    )


def _front(selection: SelectionResult, *, draws: bool) -> tuple[Block, ...]:
    several = len(selection.front) > 1
    heading = Subheading("pareto", "Pareto-optimal sizes") if several else None
    picture = _pareto_chart(selection) if draws and several else None
    return Box.of("keep", heading, front_sentence(selection), picture), pareto_table(selection)


def _pareto_chart(selection: SelectionResult) -> Picture | None:
    from designer.report.figures.charts_selection import pareto_chart

    caption = "Every size that holds, by what sizes are compared by"
    if not any(MEANINGS[objective].more_is_better for objective in selection.objectives):
        caption += "; better is further left and further down"
    caption += (
        ". A size of which a figure is not known is not in that panel. Numbers are the rows of the "
        "table below."
    )
    return chart(caption, "Clouds of points with a lower left edge", pareto_chart(selection))


def _grades_chart(selection: SelectionResult) -> Picture | None:
    """Return sizes and need of each grade; None where no grade has a diameter that would do."""
    from designer.report.figures.charts_selection import candidates_chart

    outcomes = (*selection.outcomes, *selection.alternatives)
    if not any(math.isfinite(outcome.continuous_diameter_m) for outcome in outcomes):
        return None
    caption = (
        "Each grade: the sizes that are sold, the diameter that the workspace needs, the best size "
        "that holds and the mass of all cables of it."
    )
    if selection.alternatives:
        caption += " A star marks grades that the study does not allow."
    return chart(caption, "A row for each grade", candidates_chart(selection))


def _usable(source: Source, selection: SelectionResult, found: Usable) -> tuple[Block, ...]:
    """Return where each size of one grade may go: as a curve if sizes differ, and in space."""
    if not found.sizes:
        return ()
    heading, table = Subheading("usable", "Where each size may go"), usable_table(found)
    picture: Picture | None = None
    if found.differs and source.draws:
        picture = _layers(source, found) or _usable_chart(selection, found)
    shown = table if picture is None else Box.of("lead", picture, table)
    return (Box.of("keep", heading, shown),)


def _usable_chart(selection: SelectionResult, found: Usable) -> Picture:
    from designer.report.figures.charts_shares import usable_chart

    drawn = usable_chart(found, selection.chosen)
    return chart(usable_caption(selection, found), "A curve that climbs to all", drawn)


def usable_caption(selection: SelectionResult, found: Usable) -> str:
    """Return the caption of how much of the workspace each size serves.

    Only of the chosen size is it proved between the samples that it serves all.
    """
    text = f"How much of the workspace each size of {found.grade.id} serves."
    whole = next((one.size for one in found.sizes if one.fraction == 1.0), None)
    if selection.chosen is None or whole is not selection.chosen.size:
        return text
    return f"{text} The chosen {whole.id} is the thinnest that serves all of it."


def _layers(source: Source, found: Usable) -> Picture | None:
    if source.maps is None or not source.draws_scenes:
        return None
    from designer.report.figures.scenes import usable_scene

    drawn = usable_scene(source.maps, found)
    return scene(layers_caption(found), "The region in layers", drawn, kind="space")


def layers_caption(found: Usable) -> str:
    """Return the caption of the layers that sizes serve."""
    text = f"Where sizes of {found.grade.id} may go, a part of the region cut away:"
    if found.is_nested:
        return f"{text} each serves its own layer and those of all thinner ones."
    return (
        f"{text} each part has the colour of the thinnest of them that serves there. Not all "
        "thicker ones serve there too; the table says which."
    )


def usable_table(found: Usable) -> Table:
    """Return how much each size serves, up to the thinnest from which on all serve all."""
    has_volume = found.sizes[0].volume_m3 is not None
    of_what = "of the region" if has_volume else "of the points"
    volume = (Column("Volume", "m³"),) if has_volume else ()
    first = found.first_for_good
    shown = len(found.sizes) if first is None else first + 1
    caption = (
        f"How much of the workspace each size of {found.grade.id} serves with its own figures, "
        f"by {fmt.count(found.samples)} samples."
    )
    if not found.is_nested:
        caption += " The sizes are not nested: some serve less than a thinner one."
    if shown < len(found.sizes):
        caption += " All thicker ones serve all of it."
    columns = ("Size", Column("Diameter", "mm"), Column("Serves", of_what), *volume)
    return Table.of(caption, columns, *map(_usable_row, found.sizes[:shown]))


def _usable_row(one: UsableSize) -> Row:
    cells = [one.size.id, fmt.fixed(1e3 * one.size.diameter_m, 1), fmt.share(one.fraction)]
    if one.volume_m3 is not None:
        cells.append(fmt.number(one.volume_m3))
    note = ""
    if one.lost_fraction > 0.0:
        note = f"Does not serve {fmt.share(one.lost_fraction)} of it that a thinner size serves."
    return Row(tuple(cells), "" if one.fraction > 0.0 else "muted", note)
