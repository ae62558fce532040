"""What the better model does to the design."""

from __future__ import annotations

import math
from collections.abc import Iterator

from markupsafe import Markup

from designer.diagnosis.result import Diagnosis, RopeChoice
from designer.report import format as fmt
from designer.report.blocks import Column, Heads, Listing, Row, Section, Table


def section(diagnosis: Diagnosis) -> Section:
    """Return what the better model does to the design, and the effects for the config."""
    effects = effects_text(diagnosis)
    config = Markup('<span class="id">{}</span>').format(config_name(diagnosis))
    if effects:
        how = Markup(
            "The config {}, beside this report, holds the whole model: what was declared, fitted "
            "and found. A design report made from it uses it everywhere; "
            '<span class="id">designer diagnose --check</span> holds it against later data, with '
            "nothing fitted anew."
        ).format(config)
    else:
        how = Markup("The config {}, beside this report, holds no effects.").format(config)
    return Section.of(
        "design",
        "What it means for the design",
        consequence(diagnosis),
        _table(diagnosis),
        how,
        _mounted(diagnosis) if effects else None,
        Listing(effects) if effects else None,
    )


def on_first_page(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return what it means for the cable, and in numbers."""
    numbers = f"{_numbers(diagnosis)} {_mounted(diagnosis)}".strip()
    return tuple(text for text in (consequence(diagnosis), numbers) if text)


def config_name(diagnosis: Diagnosis) -> str:
    """Return the name of the config that is written."""
    return f"{diagnosis.study.source.path.stem}.diagnosed.yaml"


def effects_text(diagnosis: Diagnosis) -> str:
    """Return the block ``effects`` as YAML; empty where there are none."""
    from designer.diagnosis.as_json import effects_table
    from designer.diagnosis.design import declared_by
    from designer.documents.edits import block

    table = effects_table(declared_by(diagnosis))
    return f"{block({'effects': table})}\n" if table else ""


def consequence(diagnosis: Diagnosis) -> str:
    """Return what the better model means for the cable, and which effects do not reach it."""
    before, after = diagnosis.design_before, diagnosis.design_after
    if before is None or after is None:
        if diagnosis.study.robot.has_enough_cables:
            return "The study has no workspace or no selection, so no cable was chosen."
        return (
            "The robot has fewer cables than degrees of freedom; no cables hold such a robot in a "
            "pose that one chooses, so none was chosen."
        )
    if after is before:
        what = "Nothing was found, so the design stays as it is"
        if diagnosis.findings:
            what = "Nothing that was found reaches the design, which stays as it is"
        text = f"{what}: {_named(before)}."
    elif (before.grade, before.size_id) == (after.grade, after.size_id):
        text = f"The choice stays: {_named(after)}."
    else:
        text = f"The choice changes from {_named(before)} to {_named(after)}."
    return " ".join((text, *_remarks(diagnosis)))


def _numbers(diagnosis: Diagnosis) -> str:
    before, after = diagnosis.design_before, diagnosis.design_after
    if before is None or after is None:
        return ""
    parts = list(_utilisation(diagnosis, before, after))
    for what, was, now, shown in (
        ("The largest tension in it", before.max_tension_N, after.max_tension_N, fmt.newtons),
        ("The best diameter of the configured family", before.optimum_m, after.optimum_m,
         fmt.millimetres),
    ):  # fmt: skip
        if not math.isfinite(now):
            continue
        if after is before or not math.isfinite(was):
            parts.append(f"{what} is {shown(now)}.")
        else:
            change = fmt.signed_percent(now / was - 1.0)
            parts.append(f"{what} goes from {shown(was)} to {shown(now)} ({change}).")
    return " ".join(parts)


def _utilisation(diagnosis: Diagnosis, before: RopeChoice, after: RopeChoice) -> Iterator[str]:
    """Yield how far the cable is used, and how far the one chosen before would be."""
    if after.grade:
        is_same = before.grade == after.grade and before.size_id == after.size_id
        was = before.utilisation if is_same else after.utilisation
        yield _use("Its utilisation", was, after.utilisation)
    if diagnosis.kept is not None:
        used = fmt.utilisation(diagnosis.kept.utilisation)
        yield f"The one chosen before would be used to {used}."


def _use(what: str, before: float, after: float) -> str:
    was, now = fmt.utilisation(before), fmt.utilisation(after)
    return f"{what} is {now}." if was == now else f"{what} goes from {was} to {now}."


def _mounted(diagnosis: Diagnosis) -> str:
    before, after = diagnosis.mounted_before, diagnosis.mounted_after
    if before is None or after is None:
        rope = diagnosis.study.measurements
        if diagnosis.design_after is None or (rope and rope.minimum_breaking_load_N):
            return ""
        return (
            "Whether the rope on the machine holds is not said: "
            "measurements.cable gives no minimum_breaking_load."
        )
    what = "The utilisation of the rope on the machine"
    text = _use(what, before.utilisation, after.utilisation)
    return text if after.utilisation <= 1.0 else f"{text} That rope is overloaded."


def _named(choice: RopeChoice) -> str:
    return f"{choice.grade}, {choice.size_id}" if choice.grade else "no product holds"


def _remarks(diagnosis: Diagnosis) -> Iterator[str]:
    idle = [s.effect.key for s in diagnosis.settings if not s.effect.reaches_design]
    if idle:
        verb, it = ("does", "it changes") if len(idle) == 1 else ("do", "they change")
        yield (
            f"{fmt.capital(fmt.listing(idle))} {verb} not reach the design: {it} nothing that "
            "the sizing counts."
        )
    of_rope = [s.effect.key for s in diagnosis.settings if s.effect.of_rope]
    if of_rope:
        verb = "belongs" if len(of_rope) == 1 else "belong"
        yield (
            f"{fmt.capital(fmt.listing(of_rope))} {verb} to the rope on the machine; a new rope is "
            "chosen by its own data sheet."
        )
    if diagnosis.is_unexplained:
        yield "What is unexplained is not in the design."


def _table(diagnosis: Diagnosis) -> Table | None:
    before, after = diagnosis.design_before, diagnosis.design_after
    if before is None or after is None:
        return None
    numbers = ("Its diameter", "Its largest tension", "Utilisation")
    optimum = ("Optimum of the configured family", "Its largest tension")
    when, rows = "", [_row("As declared", before)]
    if after is not before:
        when, names = ", before and after", ("diameter_m", "max_tension_N", "utilisation")
        ratios = (
            getattr(after, name) / getattr(before, name)
            for name in (*names, "optimum_m", "optimum_tension_N")
        )
        changes = (fmt.signed_percent(r - 1.0) if math.isfinite(r) else fmt.MISSING for r in ratios)
        rows = [_row("Before", before), _row("After", after)]
        rows.append(Row(("Change", "", *changes), "muted"))
    others = (
        ("After", "the one chosen before", diagnosis.kept),
        ("Before", "on the machine", diagnosis.mounted_before),
        ("After", "on the machine", diagnosis.mounted_after),
    )
    for title, name, use in others:  # these have no optimum
        if use is not None:
            figures = fmt.newtons(use.max_tension_N), fmt.utilisation(use.utilisation)
            rows.append(Row((title, name, "", *figures, "", "")))
    columns: Heads = ("", "Product", *map(Column, (*numbers, *optimum)))
    caption = f"The chosen cable and the largest tension in the workspace{when}."
    return Table.of(caption, columns, *rows)


def _row(title: str, choice: RopeChoice) -> Row:
    chosen, optimum = fmt.newtons_alike(choice.max_tension_N, choice.optimum_tension_N)
    diameter, optimum_diameter = map(fmt.millimetres, (choice.diameter_m, choice.optimum_m))
    used = fmt.utilisation(choice.utilisation)
    return Row((title, _named(choice), diameter, chosen, used, optimum_diameter, optimum))
