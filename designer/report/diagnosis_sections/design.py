"""What the better model does to the design."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from dataclasses import dataclass

from designer.diagnosis.result import Choice, Diagnosis
from designer.report import format as fmt
from designer.report.parts import Column, Row, Table


@dataclass(frozen=True, slots=True)
class DesignSection:
    """What the better model does to the design.

    Parameters
    ----------
    sentence : str
        What it means for the cable.
    table : Table or None
        The choice before and after; None where the study does not ask for one.
    remarks : tuple of str
        Which effects do not reach the design.
    effects : str
        The block ``effects`` as it stands in the config that was written; may be empty.
    config : str
        Name of that config.
    """

    sentence: str
    table: Table | None
    remarks: tuple[str, ...]
    effects: str
    config: str


def design_section(diagnosis: Diagnosis) -> DesignSection:
    """Return what the better model does to the design."""
    before, after = diagnosis.design_before, diagnosis.design_after
    has_both = before is not None and after is not None
    return DesignSection(
        sentence=_sentence(diagnosis),
        table=_table(before, after) if before is not None and after is not None else None,
        remarks=_remarks(diagnosis) if has_both else (),
        effects=effects_text(diagnosis),
        config=f"{diagnosis.study.source.path.stem}.diagnosed.yaml",
    )


def effects_text(diagnosis: Diagnosis) -> str:
    """Return the block ``effects`` as YAML; empty where there are none."""
    from ruamel.yaml import YAML

    from designer.diagnosis.design import declared_by
    from designer.diagnosis_files import effects_table

    table = effects_table(declared_by(diagnosis))
    if not table:
        return ""
    stream = io.StringIO()
    yaml = YAML()
    yaml.default_flow_style = False
    yaml.dump({"effects": table}, stream)
    return stream.getvalue()


def _sentence(diagnosis: Diagnosis) -> str:
    before, after = diagnosis.design_before, diagnosis.design_after
    if before is None or after is None:
        return _why_not(diagnosis)
    if not any(s.effect.reaches_design for s in diagnosis.settings):
        if not diagnosis.findings:
            return f"Nothing was found, so the design stays: {_named(before)}."
        return f"Nothing that was found reaches the design, which stays: {_named(before)}."
    if (before.grade, before.size_id) == (after.grade, after.size_id):
        return f"The choice stays: {_named(after)}."
    return f"The choice changes from {_named(before)} to {_named(after)}."


def _why_not(diagnosis: Diagnosis) -> str:
    study = diagnosis.study
    if not study.robot.is_square:
        return (
            "The robot has more cables than degrees of freedom; designs are made for as many "
            "cables as degrees of freedom only, so no cable was chosen."
        )
    return "The study has no workspace or no selection, so no cable was chosen."


def _named(choice: Choice) -> str:
    return f"{choice.grade}, {choice.size_id}" if choice.grade else "no product holds"


def _remarks(diagnosis: Diagnosis) -> tuple[str, ...]:
    idle = [s.effect.key for s in diagnosis.settings if not s.effect.reaches_design]
    remarks = []
    if idle:
        verb = "does" if len(idle) == 1 else "do"
        what = "acts" if len(idle) == 1 else "act"
        remarks.append(
            f"{fmt.listing(idle)} {verb} not change which cable the machine needs: "
            f"{'it' if len(idle) == 1 else 'they'} {what} on readings, or on what the sizing "
            "takes at its worst."
        )
    if diagnosis.is_unexplained:
        remarks.append("What is unexplained is not in the design.")
    return tuple(remarks)


def _table(before: Choice, after: Choice) -> Table:
    def row(title: str, value: Callable[[Choice], float], shown: Callable[[float], str]) -> Row:
        was, now = value(before), value(after)
        change = now / was - 1.0 if math.isfinite(was) and math.isfinite(now) and was else math.nan
        text = fmt.signed_percent(change) if math.isfinite(change) else fmt.MISSING
        return Row((title, shown(was), shown(now), text))

    def name(choice: Choice) -> str:
        return f"{choice.grade}, {choice.size_id}" if choice.grade else "none holds"

    return Table.of(
        "The chosen cable and the worst tension in the workspace, before and after.",
        (Column("", is_number=False), Column("Before"), Column("After"), Column("Change")),
        Row(("Product", name(before), name(after), "")),
        row("Its diameter", lambda c: c.diameter_m, fmt.millimetres),
        row("Its largest tension", lambda c: c.max_tension_N, fmt.newtons),
        row("Diameter of the configured family", lambda c: c.optimum_m, fmt.millimetres),
        row("Its largest tension", lambda c: c.optimum_tension_N, fmt.newtons),
    )
