"""The page of a check: what the declared model leaves of new data, nothing searched."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from designer.analysis.provenance import Provenance
from designer.diagnosis.check import Check
from designer.report import format as fmt
from designer.report.blocks import (
    MOST_ROWS,
    Box,
    Bullets,
    Column,
    Fact,
    Facts,
    Heads,
    Report,
    Section,
    Statement,
    Table,
)
from designer.report.design.provenance import facts_of
from designer.report.diagnosis import words
from designer.report.diagnosis.quantity import kinds
from designer.report.render import write_pages


def check_report(check: Check, provenance: Provenance) -> Report[None]:
    """Return the report on a check."""
    sections = (
        Section.of("answer", "Does the model stand?", _verdict(check), *_tables(check)),
        _left(check),
        _provenance(check, provenance),
    )
    about = "Check of the declared model", check.study, provenance
    return Report.of("check", *about, None, sections)


def write_check(check: Check, folder: Path, templates: Path | None = None) -> None:
    """Write ``check.html`` and ``check.pdf`` into an existing folder."""
    write_pages(check_report(check, Provenance.now()), folder, templates)


def _verdict(check: Check) -> Statement:
    text = " ".join(check.remarks())
    if check.is_positive:
        return Statement("The declared model stands", text, "good")
    return Statement("The declared model does not stand", text, "bad")


def _tables(check: Check) -> Iterator[Table]:
    numbers = map(Column, ("Root mean square", "95 %", "Median"))
    heads: Heads = ("Reading", "Model", *numbers)
    caption = "What each model leaves, outliers and all, with 95 % intervals by block bootstrap."
    yield Table.of(caption, heads, *_errors(check))
    values = [
        (setting.effect.key, p.label, f"{setting.values[p.name]:.6g} {p.unit}".strip())
        for setting in check.declared.settings
        for p in setting.effect.parameters
    ]
    if values:
        yield Table.of(
            "Declared effects that act on these data.",
            ("Effect", "Parameter", Column("Value")),
            *values,
            kind="narrow",
        )


def _errors(check: Check) -> Iterator[tuple[str, ...]]:
    length, tension = kinds(check.noise)
    for kind in (length, tension):
        for label, model in check.models:
            left = model.length_m if kind is length else model.tension_N
            if left is not None:
                rms, ends = kind.with_unit(left.rms.value), kind.interval(left.rms)
                yield kind.name, label, rms, ends, kind.with_unit(left.median)
    for label, model in check.models:
        if model.foretold is not None and model.foretold.n_solved:
            off = model.foretold.position_m
            rms, ends = length.with_unit(off.value), length.interval(off)
            yield "pose by the lengths alone", label, rms, ends, fmt.MISSING


def _left(check: Check) -> Section | None:
    """Return what the declared model's residual goes with; None where nothing could be tested."""
    carriers = check.structure.carriers[:MOST_ROWS]
    if not carriers:
        return None
    rows = (
        (words.covariate(c.name), fmt.percent(c.fraction_of_variance, 2), words.chance(c.chance))
        for c in carriers
    )
    table = Table.of(
        "What is left with the declared effects: share of the variance that goes with each "
        "covariate, where it shows most, and the chance of as much by accident.",
        ("Covariate", Column("Share"), Column("Chance")),
        *rows,
        kind="narrow",
    )
    events = tuple(fmt.capital(event.text) for event in check.structure.events)
    return Section.of("left", "What is left", Bullets(events) if events else None, table)


def _provenance(check: Check, provenance: Provenance) -> Section:
    noise, measurements = check.noise, check.study.measurements
    facts = [
        *facts_of(provenance, check.study),
        Fact("SHA-256 of the data", check.measured.sha256),
        *(Fact(f"Noise of a {k.name}", k.with_unit(k.noise), noise.source) for k in kinds(noise)),
        Fact("Everything in numbers", "diagnosis.json", "beside this page"),
    ]
    if measurements is not None:
        facts.insert(0, Fact("Measured data", measurements.file.name))
    return Section.of("provenance", "Provenance", Box.of("loose", Facts(tuple(facts))))
