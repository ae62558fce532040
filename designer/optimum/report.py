"""The document on an optimisation, and all files that it writes."""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path

import numpy as np
from markupsafe import Markup

from designer.documents.document import document_of
from designer.documents.plain import json_text
from designer.io.config.moved import moved_to
from designer.io.output import write_whole
from designer.optimum import figures
from designer.optimum.optimise import Optimum
from designer.progress import SILENT, Reporter
from designer.report import format as fmt
from designer.report.comparison import write_comparison
from designer.report.document import MOST_ROWS, Drawing, Report, Section, vector
from designer.report.phrases import paragraphs
from designer.report.render import write_pages
from designer.report.templates import environment


def optimum_report(optimum: Optimum, created: datetime) -> Report:
    """Return the document on an optimisation."""
    lines = [line for line in optimum.comparison.answers if line.differs]
    contexts: dict[str, dict[str, object]] = {
        "answer": {"robots": _robots(optimum)},
        "variables": {"profiles": _profiles(optimum)},
        "differences": {"lines": lines},
        "trust": {
            "convergence": _convergence(optimum),
            "spreads": _spreads(optimum),
            "most_rows": MOST_ROWS,
        },
    }
    if not lines:
        del contexts["differences"]
    sections = (Section(key, context={"optimum": optimum, **contexts[key]}) for key in contexts)
    title = optimum.given.study.name
    return Report.of("optimise", title, "Optimisation of the robot", created, sections)


def write_optimum(
    optimum: Optimum,
    folder: Path,
    target: Path | None = None,
    templates: Path | None = None,
    reporter: Reporter = SILENT,
) -> None:
    """Write the pages, ``optimise.json``, ``designs.csv``, the comparison and the study.

    Into an existing folder; relative paths in the study are as they are from ``target``, where the
    folder's files are to be in the end.
    """
    report = optimum_report(optimum, datetime.now().astimezone())
    write_pages(report, folder, templates, reporter)
    source = Path(optimum.plan.document.name)
    name = f"{source.stem}.optimised.yaml"
    write_comparison(optimum.comparison, (source.name, name), folder, templates)
    document = document_of(optimum.text.encode(), optimum.plan.document.name)
    files = {
        "comparison.json": f"{json_text(optimum.comparison.to_dict())}\n",
        "optimise.json": f"{optimum.to_json()}\n",
        "designs.csv": optimum.to_csv(),
        name: moved_to(target or folder, optimum.text, document, source.parent),
    }
    for file, text in files.items():
        write_whole(folder / file, text.encode())


def headline(optimum: Optimum) -> str:
    """Return what came out, in a line."""
    return _sentence(optimum, "headline").unescape()


def trust_lines(optimum: Optimum) -> list[str]:
    """Return how far the answer is to be believed, a sentence each."""
    return [line.unescape() for line in paragraphs(_sentence(optimum, "reliability"))]


def variable_rows(optimum: Optimum) -> list[tuple[str, str, str, str]]:
    """Return of each variable its name, given and optimised value, and bounds; "" for no value."""
    rows = []
    for variable, best in zip(optimum.plan.variables, optimum.best.values, strict=True):
        given, chosen, low, high = (
            "" if value is None else f"{value:g} {variable.unit}".rstrip()
            for value in (variable.given, best, variable.low, variable.high)
        )
        rows.append((variable.name, given, chosen, f"{low} to {high}"))
    return rows


def _sentence(optimum: Optimum, macro: str) -> Markup:
    template = environment().get_template("optimise/sentences.html.j2")
    return Markup(vars(template.make_module({"optimum": optimum}))[macro]())


def _robots(optimum: Optimum) -> Drawing | None:
    study = optimum.optimised.study
    region = None if study.workspace is None else study.workspace.region
    aim_m = study.robot.exit_points_m.mean(axis=0)
    if region is not None:
        aim_m = region.bounds_m.mean(axis=0)
    elif study.pose is not None:
        aim_m = study.pose.position_m
    return vector(figures.robots(optimum.given.study.robot, study.robot, region, aim_m))


def _axis(optimum: Optimum) -> tuple[float, str]:
    """Return scale and title of an axis of the objective."""
    objective = optimum.plan.objective
    unit = objective.dimension.unit
    if unit == "m":
        return 1e3, f"{objective.title} [mm]"
    if unit == "N":
        name, size = fmt.force_unit(abs(optimum.best.value))
        return 1.0 / size, f"{objective.title} [{name}]"
    return 1.0, f"{objective.title} [{fmt.printed(unit)}]" if unit else objective.title


def _profiles(optimum: Optimum) -> Drawing | None:
    """Return the objective over each variable; None where no design on the way holds."""
    if not any(math.isfinite(x) for profile in optimum.profiles for x in profile.objective):
        return None
    scale, title = _axis(optimum)
    curves = [
        figures.Curve(
            f"{variable.name} [{variable.unit}]" if variable.unit else variable.name,
            np.array(profile.values),
            scale * np.array(profile.objective),
            variable.given,
            value,
        )
        for variable, profile, value in zip(
            optimum.plan.variables, optimum.profiles, optimum.best.values, strict=False
        )
    ]
    return vector(figures.profiles(curves, title))


def _convergence(optimum: Optimum) -> Drawing | None:
    """Return the objective of every design; None where none holds."""
    given, *trials = optimum.searched.trials
    holds = np.array([trial.holds for trial in trials], dtype=np.bool_)
    if not holds.any():
        return None
    scale, title = _axis(optimum)
    sign = optimum.plan.objective.sign
    values = np.array([sign * scale * trial.value for trial in trials])
    starts = np.array([trial.start for trial in trials])
    before = sign * scale * given.value if given.holds else None
    named = title if sign > 0 else f"− {title}"
    return vector(figures.convergence(values, starts, holds, before, named))


def _spreads(optimum: Optimum) -> list[float]:
    """Return the largest spread of each start's last population; NaN where it has none."""
    spreads = [float(spread.max()) for spread in optimum.searched.spreads]
    return spreads + [math.nan] * (optimum.plan.starts - len(spreads))
