"""What the templates of a diagnosis get: numbers and domain objects; None for no section.

Beside it every template of a diagnosis gets `shared`. Each figure is drawn when a template first
asks for it, and once.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import groupby

import numpy as np

from designer.diagnosis.accuracy import Interval
from designer.diagnosis.figures import Layout, carriers_chart, errors_chart, rows_chart
from designer.diagnosis.free_poses import ABSORBED
from designer.diagnosis.result import MOST_SCATTER, Diagnosis, Finding
from designer.diagnosis.search import EffectTrial
from designer.diagnosis.statistics import SIGNIFICANCE
from designer.diagnosis.structure import Carrier
from designer.diagnosis.words import grouped, quantities
from designer.report import format as fmt
from designer.report.document import MOST_ROWS, Drawing, vector

Context = Mapping[str, object]

_ABOUT_AS_FAR = 0.9
"""Share of the earlier error of position above which a model is no better to a reader."""
_MOST_CARRIERS = 6
_MOST_TRIALS = 6
"""As many rows as leave the table beside its text on one page; the JSON has all."""
_MOST_CORRELATED = 12
_MOST_OUTLIERS = 30
"""Half a page."""


def shared(diagnosis: Diagnosis) -> Context:
    """Return what every template gets: results, what was measured, groups of findings, figures."""
    return {
        "diagnosis": diagnosis,
        "quantities": list(quantities(diagnosis)),
        "groups": grouped(diagnosis.findings),
        "drawings": DiagnosisDrawings(diagnosis),
        "significance": SIGNIFICANCE,
        "most_rows": MOST_ROWS,
    }


def verdict(diagnosis: Diagnosis) -> Context:
    """The answer in one or two sentences."""
    before, after = diagnosis.foretold_before, diagnosis.foretold_after
    improves = (  # else nothing that concerns lengths was found
        before is not None
        and after is not None
        and after.position_m.value <= _ABOUT_AS_FAR * before.position_m.value
    )
    return {
        "doubtful": any(f.rivals or f.warnings for f in diagnosis.findings),
        "foretold": (before, after) if improves else None,
    }


def first_page(diagnosis: Diagnosis) -> Context:
    """The answer, and how sure it is."""
    findings = diagnosis.findings
    alone = [finding for finding in findings if diagnosis.has_no_rivals(finding)]
    scatter = max(diagnosis.scatter.values(), default=0.0)
    return {
        **verdict(diagnosis),
        "hidden": [key for key, why in diagnosis.skipped if why.startswith(ABSORBED)],
        "significances": [_significance(diagnosis, group) for group in grouped(findings)],
        "without_rivals": grouped(alone),
        "scatter": scatter if scatter > MOST_SCATTER else None,
    }


def _significance(diagnosis: Diagnosis, group: Iterable[Finding]) -> Context:
    trials = [_trial_of(diagnosis, finding) for finding in group]
    gains = [f for f in group if math.isfinite(f.heldout_gain)]
    return {
        "group": group,
        "chance": max((trial.chance for trial in trials if trial is not None), default=None),
        "gains": [
            f"{fmt.percent(f.heldout_gain, 3)} ± {fmt.percent(f.heldout_gain_std, 2)}"
            for f in gains
        ],
    }


def _trial_of(diagnosis: Diagnosis, finding: Finding) -> EffectTrial | None:
    """Return the trial in which an effect was found; None where it came by exchange."""
    key = finding.effect.key
    for step in diagnosis.steps:
        if step.added is not None and step.added.key == key:
            return next(t for t in step.trials if t.effect.key == key)
    return None


def found(diagnosis: Diagnosis) -> Context | None:
    """What was found; None where nothing was, and nothing withdrawn."""
    return {} if diagnosis.findings or diagnosis.withdrawn else None


_WHEN = ("before", "after")


def errors(diagnosis: Diagnosis) -> Context:
    """The errors at each stage."""
    before, after = diagnosis.foretold_before, diagnosis.foretold_after
    foretold: list[tuple[str, float, Interval, Interval]] = []
    unsolved = 0
    if before is not None and after is not None:
        rows = (
            ("Position of the platform [mm]", 1e3, before.position_m, after.position_m),
            ("Its orientation [mrad]", 1e3, before.turn_rad, after.turn_rad),
            ("Tensions at the winches [N]", 1.0, before.tension_N, after.tension_N),
        )
        foretold = [
            (name, scale, was, now)
            for name, scale, was, now in rows
            if was is not None and now is not None
        ]
        unsolved = max(stage.n_rows - stage.n_solved for stage in (before, after))
    n_cables = diagnosis.machine.robot.n_cables
    prefix = "Cable " if n_cables < 5 else ""
    measured = [quantity for quantity, *_ in quantities(diagnosis)]
    files = diagnosis.study.measurements.sessions if diagnosis.study.measurements else ()
    return {
        "session_heads": [
            "Session",
            "File",
            ("Rows", ""),
            *((f"{q.name.capitalize()} {when} [{q.unit}]", "") for q in measured for when in _WHEN),
        ],
        "sessions": [
            [
                str(error_of_session.session),
                files[error_of_session.session - 1].file_names if files else "",
                str(error_of_session.n_rows),
                *(q.shown(error) for q in measured for error in getattr(error_of_session, q.field)),
            ]
            for error_of_session in diagnosis.sessions
        ],
        "foretold": foretold,
        "unsolved": unsolved,
        "cable_heads": [(f"{prefix}{k}", "") for k in range(1, n_cables + 1)],
    }


def calibration(diagnosis: Diagnosis) -> Context | None:
    """How well the data settle what was fitted; None where nothing was."""
    if diagnosis.calibration is None:
        return None
    unknown = {setting.effect.key for setting in diagnosis.given}
    by_effect = groupby(diagnosis.calibration.parameters, lambda fitted: fitted.effect.key)
    return {
        "fitted": [(key, key in unknown, list(fitted)) for key, fitted in by_effect],
        "not_settled": [
            fitted.label for fitted in diagnosis.calibration.parameters if not fitted.is_settled
        ],
        "correlated": list(diagnosis.calibration.correlated),
        "most_correlated": _MOST_CORRELATED,
    }


def residual(diagnosis: Diagnosis) -> Context:
    """What the residual goes with, and the residual itself."""
    before = {c.name: c for c in diagnosis.structure_before.carriers}
    after = {c.name: c for c in diagnosis.structure_after.carriers}
    stages = (before, after) if diagnosis.findings else (after, after)
    names = dict.fromkeys(n for pair in zip(before, after, strict=False) for n in pair)
    residuals = diagnosis.residual_before, diagnosis.residual_after
    return {
        "carriers": [(name, *(stage.get(name) for stage in stages)) for name in names],
        "within": [float(np.mean(np.abs(r[np.isfinite(r)]) < 2.0)) for r in residuals],
    }


def unexplained(diagnosis: Diagnosis) -> Context | None:
    """What is left unexplained; None where nothing is."""
    return {"most_carriers": _MOST_CARRIERS} if diagnosis.is_unexplained else None


def search(diagnosis: Diagnosis) -> Context:
    """The best candidates of each round, and what became of them."""
    return {
        "found": {finding.effect.key for finding in diagnosis.findings},
        "withdrawn": {gone.effect for gone in diagnosis.withdrawn},
        "most_trials": _MOST_TRIALS,
    }


def design(diagnosis: Diagnosis) -> Context:
    """What the better model does to the design, and the effects for the config, as YAML."""
    from designer.diagnosis.design import declared_by
    from designer.diagnosis.result import effects_table
    from designer.documents.edits import block

    uses = (
        ("After", "the one chosen before", diagnosis.kept),
        ("Before", "on the machine", diagnosis.mounted_before),
        ("After", "on the machine", diagnosis.mounted_after),
    )
    table = effects_table(declared_by(diagnosis))
    before, after = diagnosis.design_before, diagnosis.design_after
    names = ("diameter_m", "max_tension_N", "utilisation", "optimum_m", "optimum_tension_N")
    changes = []  # relative, of each figure of the design; NaN where there is none
    if before is not None and after is not None:
        ratios = [getattr(after, name) / getattr(before, name) for name in names]
        changes = [ratio - 1.0 if math.isfinite(ratio) else math.nan for ratio in ratios]
    return {
        "config": f"{diagnosis.study.source.path.stem}.diagnosed.yaml",
        "effects": f"{block({'effects': table})}\n" if table else "",
        "changes": changes,
        "uses": [use for use in uses if use[2] is not None],
    }


def data(diagnosis: Diagnosis) -> Context:
    """What was measured, what stands off, and what these data cannot show."""
    imbalance, balance = diagnosis.imbalance, None
    if imbalance is not None and not np.isnan(imbalance).all():
        balance = float(np.nanmedian(imbalance)), float(np.nanmax(imbalance))
    return {
        "n_heldout": int(diagnosis.heldout.sum()),
        "imbalance": balance,
        "outliers": sorted(diagnosis.outliers, key=lambda outlier: -abs(outlier.size)),
        "most_outliers": _MOST_OUTLIERS,
    }


def assumptions(_: Diagnosis) -> Context:
    """What the diagnosis rests on."""
    return {}


# Figures.

_MAX_PANELS = 4
"""Panels side by side that are still wide enough to be read."""
_MAX_ON_FIRST_PAGE = 3
"""The same, in the panel of the first page."""


class DiagnosisDrawings:
    """Figures by name; None where nothing is drawn."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._diagnosis = diagnosis

    @cached_property
    def errors(self) -> Drawing | None:
        """The error at each stage."""
        return vector(errors_chart(self._diagnosis))

    @cached_property
    def rows(self) -> Drawing | None:
        """The residual of every reading over the rows."""
        return vector(rows_chart(self._diagnosis))

    @cached_property
    def strongest(self) -> Drawing | None:
        """The residual against what it goes with most, for the first page."""
        diagnosis = self._diagnosis
        structure = diagnosis.structure_after
        carriers = diagnosis.structure_before.carriers
        if diagnosis.is_unexplained:
            carriers = structure.present or structure.carriers
        layout: Layout = "overlaid" if diagnosis.findings else "after"
        return self._carriers(carriers[:_MAX_ON_FIRST_PAGE], "diagnosis-first", layout)

    @cached_property
    def carriers_before(self) -> Drawing | None:
        """The residual against what it went with before."""
        carriers = self._diagnosis.structure_before.carriers[:_MAX_PANELS]
        layout: Layout = "stacked" if self._diagnosis.findings else "after"
        return self._carriers(carriers, "diagnosis-carriers", layout)

    @cached_property
    def carriers_after(self) -> Drawing | None:
        """What is left; None without findings, as that is the whole residual."""
        if not self._diagnosis.findings:
            return None
        carriers = self._diagnosis.structure_after.carriers[:_MAX_PANELS]
        return self._carriers(carriers, "diagnosis-left", "after")

    def _carriers(self, carriers: Sequence[Carrier], key: str, layout: Layout) -> Drawing | None:
        names = [carrier.name for carrier in carriers]
        return vector(carriers_chart(self._diagnosis, names, key, layout)) if names else None
