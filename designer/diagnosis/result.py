"""What a diagnosis came to."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from designer import __version__, checked
from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.accuracy import Error, ForwardError, Outlier, SessionError, Stage
from designer.diagnosis.calibration import Calibration
from designer.diagnosis.plan import Proposal
from designer.diagnosis.search import Step
from designer.diagnosis.structure import Correction, Structure, Whereabouts, wrong_poses
from designer.documents.plain import (
    DIAGNOSIS_FORMAT,
    Json,
    csv_text,
    finite,
    json_text,
    plain,
    record,
)
from designer.effects.effect import Effect, Readings, Setting
from designer.effects.platform_loads import PLATFORM_FORCE
from designer.effects.setting_up import POSE_DISTORTION
from designer.model.measurements import KINDS, Measured, Noise, ReadingKind
from designer.model.robot import Machine
from designer.spelling import in_runs
from designer.study import DeclaredEffect, Study

NEXT_CHECKS = {
    "cable": "winch, pulley, plugs and load cell of the cable that is named",
    "mistake": "plugs, numbers of cables, and the frame of the poses",
    "pose": "poses (tracker, frame, distance), exit points, what pulls on the platform there",
    "scatter": "wind that nobody read, sway, how well poses are measured",
    "time": "what changed with time: load, wind, temperature, homing, foundations",
}
"""What to look at, by where what is left shows; see `Event.place`."""
_COUNTED, _OF_ONE = 20.0, 0.6
"""Times the noise that a reading counts at most; share of what is left that points to a cable."""
MOST_SCATTER = 1.5
"""Times the declared noise beyond which sensors do not explain what is left."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A fitted value with its standard deviation."""

    value: float
    std: float


def _rivals(keys: Sequence[str]) -> dict[str, object]:
    ids = dict.fromkeys(key.split(" of ")[0] for key in keys)
    return {"rivals": list(ids), "rival_keys": keys}


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """An effect that the model lacked."""

    effect: Effect = field(
        metadata={"json": lambda e: {**e.identified(), "summary": e.summary, "cause": e.cause}}
    )  #: what it is
    parameters: Mapping[str, Estimate]  #: its numbers
    #: effects that this data cannot tell from it; several together are joined by ``and``
    rivals: tuple[str, ...] = field(metadata={"json": _rivals})
    #: share of the held-out mean square that goes when it is added to the others, and how far that
    #: is in doubt
    heldout_gain: float
    heldout_gain_std: float
    warnings: tuple[str, ...]  #: what speaks against its values
    #: of the rivals of what is physics, the errors of setting up: those are to be ruled out first
    rule_out: tuple[str, ...] = ()


class Reason(Enum):
    """Why an effect that fits was not kept."""

    DRIFTS = "it fits as a constant, but would have to change with a covariate"
    SMALL = "it explains less than half of what stays unexplained, which it may be bent to fit"
    IMPLAUSIBLE = "it needs values that are not plausible"
    FAINT = "its values may be chance where neighbouring rows are counted as alike"
    NO_STEP = "what is left still goes with time, so that it was no step"
    UNSTEADY = "what is left scatters the more as the rows go on, as in a wind that was not read"
    READINGS_DRIFT = "a drift of the readings explains it as well"
    UNSEEN = "it does not help on rows that no fit has seen"
    WORSE = "it makes lengths or tensions worse on rows that no fit has seen"


@dataclass(frozen=True, slots=True)
class RejectedEffect:
    """An effect that fits, but does not hold."""

    effect: str = field(metadata={"json": "id"})  #: its key
    #: what it would have to change with; empty for another reason
    covariate: str = field(default="", metadata={"json": lambda name: {"covariate": name or None}})
    #: by how much of itself, for each standard deviation of the covariate; NaN if not tried
    variation: float = float("nan")
    reason: Reason = field(
        default=Reason.DRIFTS, metadata={"json": lambda reason: {"reason": reason.name.lower()}}
    )  #: why it was not kept
    detail: str = ""  #: the values that are not plausible; else empty
    #: share of the held-out mean square that goes with it, and how far that is in doubt; NaN if not
    #: tried
    gain: float = field(default=float("nan"), metadata={"json": "heldout_gain"})
    gain_std: float = field(default=float("nan"), metadata={"json": "heldout_gain_std"})
    instead: tuple[Effect, ...] = field(default=(), metadata={"json": None})  #: what took its place


class DiagnosisVerdict(Enum):
    """The answer, by what was found, by the shape of what is left, and by its size."""

    FOUND = "found"
    IN_PART = "found_in_part"
    UNEXPLAINED = "unexplained"
    SCATTER = "scatter"
    IMPLAUSIBLE = "implausible"
    NOTHING = "nothing_to_find"


@dataclass(frozen=True, slots=True)
class RopeChoice:
    """The cable that the design asks for."""

    grade: str | None  #: None where no product holds
    size_id: str | None
    diameter_m: float  #: of the product; NaN where none holds
    max_tension_N: float
    optimum_m: float  #: of the config's continuous family; NaN where it has no finite cable
    optimum_tension_N: float
    #: largest over allowable tension of the product; NaN where none holds
    utilisation: float = math.nan


@dataclass(frozen=True, slots=True)
class Use:
    """What a given rope meets in the workspace: one that was chosen before, or hangs there now."""

    also_in_files = ("holds",)
    max_tension_N: float  #: its largest tension [N]; inf where it cannot hold a pose at all
    utilisation: float  #: largest over allowable tension

    @property
    def holds(self) -> bool:
        """Whether it stays within what is allowed."""
        return self.utilisation <= 1.0


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Diagnosis(checked.Shown):
    """Everything that the diagnosis report shows.

    Parameters
    ----------
    study, machine, measured, noise
        The problem.
    heldout : array (n_rows,) of bool
        Rows that no fit has seen.
    findings : tuple of Finding
        Effects that earned their place.
    given : tuple of Setting
        What was unknown from the start, with its values.
    withdrawn : tuple of RejectedEffect
        Effects that fitted but do not hold.
    skipped : tuple of (effect, reason)
        Effects that this data cannot show.
    steps : tuple of Step
        The search, round by round.
    stages : tuple of Stage
        Error at each point, the model as declared first.
    structure_before, structure_after : Structure
        Test for structure beyond noise.
    residual_before, residual_after : array (n_rows, 2 n_cables)
        In units of noise.
    predicted : Readings
        By the final model.
    covariates : mapping of str to array (n_rows,)
        What the residual was tested against.
    outliers : tuple of Outlier
        Readings that stand off.
    correction : Correction or None
        Where structure is left.
    proposals : tuple of Proposal
        For each pair of rivals.
    doubts : tuple of str
        Values of what was unknown from the start that an engineer would not believe.
    not_tried : tuple of str
        What the search left out for lack of time.
    imbalance : array (n_rows,) or None
        What the final model leaves out of balance, over the platform's weight; None where there are
        as many cables as degrees of freedom.
    foretold_before, foretold_after : ForwardError or None
        Pose and tensions from lengths alone, by the first and the last stage; None where no
        held-out row has all lengths.
    design_before, design_after : RopeChoice or None
        Where the study has a workspace and a selection.
    left_in : Whereabouts or None
        The reading and the rows in which structure is left; None where none is.
    kept : Use or None
        What the cable chosen before would meet by the model after, where another is chosen.
    mounted_before, mounted_after : Use or None
        What the cable on the machine meets, where its breaking load is given as well.
    predicted_before : Readings or None
        By the model as declared, unknowns fitted.
    calibration : Calibration or None
        How well the data settle what was fitted; None where nothing was.
    sessions : tuple of SessionError
        The errors of each session, where there are several.
    """

    study: Study
    machine: Machine
    measured: Measured
    noise: Noise
    heldout: BoolArray
    findings: tuple[Finding, ...]
    given: tuple[Setting, ...]
    withdrawn: tuple[RejectedEffect, ...]
    skipped: tuple[tuple[str, str], ...]
    steps: tuple[Step, ...]
    stages: tuple[Stage, ...]
    structure_before: Structure
    structure_after: Structure
    residual_before: FloatArray
    residual_after: FloatArray
    predicted: Readings
    covariates: Mapping[str, FloatArray]
    outliers: tuple[Outlier, ...]
    correction: Correction | None
    proposals: tuple[Proposal, ...]
    doubts: tuple[str, ...] = ()
    not_tried: tuple[str, ...] = ()
    imbalance: FloatArray | None = None
    foretold_before: ForwardError | None = None
    foretold_after: ForwardError | None = None
    design_before: RopeChoice | None = None
    design_after: RopeChoice | None = None
    left_in: Whereabouts | None = None
    kept: Use | None = None
    mounted_before: Use | None = None
    mounted_after: Use | None = None
    predicted_before: Readings | None = None
    calibration: Calibration | None = None
    sessions: tuple[SessionError, ...] = ()

    @property
    def strange_sessions(self) -> tuple[int, ...]:
        """Sessions that the model does not explain, while it explains others."""
        over = {error.session: error.over(self.noise) for error in self.sessions}
        strange = tuple(number for number, ratio in over.items() if ratio > MOST_SCATTER)
        return strange if len(strange) < len(over) else ()

    @property
    def final(self) -> Stage:
        """The model with everything that was found."""
        return self.stages[-1]

    @property
    def settings(self) -> tuple[Setting, ...]:
        """Found effects with their values, without those unknown from the start."""
        keys = {finding.effect.key for finding in self.findings}
        return tuple(s for s in self.final.settings if s.effect.key in keys)

    def stds_of(self, setting: Setting) -> dict[str, float]:
        """Return the standard deviation of each fitted value of an effect."""
        fitted = () if self.calibration is None else self.calibration.parameters
        return {c.parameter.name: c.std for c in fitted if c.effect.key == setting.effect.key}

    def residuals_csv(self) -> str:
        """Return the text of ``residuals.csv``: what was measured and predicted, in SI units.

        A line for each row and cable; a cell without a number is empty.
        """
        heads = [
            f"{kind.name}_{when}{kind.unit_SI}"
            for kind in KINDS
            for when in ("", "before_", "after_")
        ]
        columns = [
            kind.of(values)
            for kind in KINDS
            for values in (self.measured, self.predicted_before, self.predicted)
            if values is not None
        ]
        session = self.measured.session
        of_session = [] if session is None else ["session"]
        lines = (
            [
                number,
                *([] if session is None else [int(session[row])]),
                cable + 1,
                int(self.heldout[row]),
                *(finite(float(column[row, cable])) for column in columns),
            ]
            for row, number in enumerate(self.measured.row_numbers.tolist())
            for cable in range(self.machine.robot.n_cables)
        )
        return csv_text([["row", *of_session, "cable", "heldout", *heads], *lines])

    @property
    def errors(self) -> Iterator[tuple[ReadingKind, Error, Error]]:
        """Each kind of reading that was measured, with its error before and after."""
        for kind in KINDS:
            if kind.of(self.stages[0]) and kind.of(self.final):
                yield kind, kind.of(self.stages[0]), kind.of(self.final)

    @property
    def is_unexplained(self) -> bool:
        """Whether structure is left that no effect explains."""
        return self.structure_after.is_present

    @property
    def scatter(self) -> dict[str, float]:
        """Error on held-out rows over the noise, for each kind of reading that has one.

        Of noise that was estimated from what is left, it tells nothing.
        """
        return {
            kind.name: after.heldout.value / kind.of(self.noise)
            for kind in KINDS
            if (after := kind.of(self.final)) and math.isfinite(after.heldout.value)
        }

    @property
    def is_scattered(self) -> bool:
        """Whether more is left than the sensors explain: over 1.5 times the declared noise."""
        measurements = self.study.measurements
        declared = measurements.declared_noise if measurements else {}
        return any(x > MOST_SCATTER for name, x in self.scatter.items() if name in declared)

    @property
    def verdict(self) -> DiagnosisVerdict:
        """The answer."""
        if self.findings:
            is_complete = not (
                self.is_unexplained or self.is_scattered or self.doubts or self.strange_sessions
            )
            return DiagnosisVerdict.FOUND if is_complete else DiagnosisVerdict.IN_PART
        if self.is_unexplained:
            return DiagnosisVerdict.UNEXPLAINED
        if self.doubts:
            return DiagnosisVerdict.IMPLAUSIBLE
        is_off = self.is_scattered or bool(self.strange_sessions)
        return DiagnosisVerdict.SCATTER if is_off else DiagnosisVerdict.NOTHING

    @property
    def moves_poses(self) -> bool:
        """Whether the platform was not where the log has it, by what was found or is unknown."""
        return any(s.effect.on_poses is not None for s in self.final.settings)

    @property
    def is_smooth(self) -> bool:
        """Whether one cause that varies smoothly with position may be behind several findings."""
        rivals = (
            set.intersection(*(set(f.rivals) for f in self.findings)) if self.findings else set()
        )
        return len(self.findings) > 2 and not rivals.isdisjoint(
            (POSE_DISTORTION.id, PLATFORM_FORCE.id)
        )

    @property
    def wrong_poses(self) -> list[int]:
        """Numbers of rows in which all cables stand off, so that their poses are wrong."""
        return list(self.measured.row_numbers[wrong_poses(self.residual_after)].tolist())

    @property
    def left_out(self) -> str:
        """How many readings stand off and are in no error, in words; empty where none does."""
        counts = Counter(outlier.channel.split()[0] for outlier in self.outliers)
        parts = [
            f"{counts[kind.name]} of {np.isfinite(kind.of(self.measured)).sum()} {kind.name}s"
            for kind in KINDS
            if counts[kind.name]
        ]
        if self.wrong_poses:
            rows = ", ".join(in_runs(self.wrong_poses))
            parts.append(f"all cables of rows {rows}, whose poses are wrong")
        return ", ".join(parts)

    @property
    def next_checks(self) -> list[str]:
        """What to look at next, by cable, by pose and by time; nothing where nothing is left."""
        structure = self.structure_after
        places = {e.place for e in structure.events} | {c.place for c in structure.present[:1]}
        off = np.minimum(np.nan_to_num(np.abs(self.residual_after)), _COUNTED) ** 2
        share = off.reshape(len(off), 2, -1).sum(axis=(0, 1)) / max(float(off.sum()), 1e-300)
        worst = f"cable {np.argmax(share) + 1}, which has {share.max():.0%} of what is left"
        is_of_one = self.is_unexplained and len(share) > 1 and share.max() > _OF_ONE
        return [worst] * bool(is_of_one) + [NEXT_CHECKS[place] for place in sorted(places - {""})]

    @property
    def not_held(self) -> str:
        """How many rows are in no error, since a stage cannot hold them, in words."""
        return ", ".join(f"{s.n_not_held} {s.label}" for s in self.stages if s.n_not_held)

    def has_no_rivals(self, finding: Finding) -> bool:
        """Tell whether all of the list were tried in place of a finding, and none is as good."""
        cut_short = f"rivals of {finding.effect.key}:"
        return not (finding.rivals or any(part.startswith(cut_short) for part in self.not_tried))

    @property
    def is_positive(self) -> bool:
        """Whether the model, with what was found, is all that the data show."""
        return self.verdict in (DiagnosisVerdict.FOUND, DiagnosisVerdict.NOTHING)

    def to_dict(self) -> dict[str, Any]:
        """Return what ``diagnosis.json`` holds; a missing number is None."""
        left_in = self.left_in
        errors = {"length_m": None, "tension_N": None} | {
            f"{kind.name}_{kind.unit_SI}": {
                "before": before,
                "after": after,
                "noise": kind.of(self.noise),
                "left_out": sum(o.channel.startswith(kind.name) for o in self.outliers),
            }
            for kind, before, after in self.errors
        }
        answer = {
            "verdict": self.verdict,
            "rows": {
                "fit": int((~self.heldout).sum()),
                "heldout": int(self.heldout.sum()),
                "wrong_poses": self.wrong_poses,
                **rows_dict(self.outliers, self.measured),
            },
            "sessions": self.sessions,
            "strange_sessions": self.strange_sessions,
            "effects": self.findings,
            "withdrawn": self.withdrawn,
            "left_out": self.study.known_effects.problems,
            "skipped": reasons(self.skipped),
            "unknown": [{**record(s), "std": self.stds_of(s)} for s in self.given],
            "calibration": self.calibration and _calibration(self.calibration),
            "not_plausible": self.doubts,
            "unexplained": {
                **structure_dict(self.structure_after),
                "check_next": self.next_checks,
                "reading": left_in and left_in.reading,
                "rows": left_in.rows if left_in else [],
            },
            "scatter": {"present": self.is_scattered, **self.scatter},
            "error": errors,
            "forward": {"before": self.foretold_before, "after": self.foretold_after},
            "noise": {"source": self.noise.source},
            "stages": self.stages,
            "search": {"is_complete": not self.not_tried, "not_tried": self.not_tried},
            "balance": _balance(self.imbalance),
            "proposals": self.proposals,
            "design": {
                "before": self.design_before,
                "after": self.design_after,
                "kept": self.kept,
                "mounted": {"before": self.mounted_before, "after": self.mounted_after},
            },
        }
        return framed(answer, self.study, self.measured)

    def to_json(self) -> str:
        """Return the text of ``diagnosis.json``."""
        return json_text(self.to_dict())


def effects_table(declared: Sequence[DeclaredEffect]) -> Json:
    """Return the table ``effects`` of a config: by id; those of single cables become lists."""
    answer: Json = {}
    for effect in declared:
        values: Json = {name: float(value) for name, value in effect.parameters.items()}
        if effect.cable is None:
            answer[effect.id] = values
        else:
            answer.setdefault(effect.id, []).append({"cable": effect.cable, **values})
    return answer


def framed(answer: Json, study: Study, measured: Measured) -> Json:
    """Return an answer between what every such file begins and ends with."""
    provenance = {
        "version": __version__,
        "config_sha256": study.source.sha256,
        "data_sha256": measured.sha256,
    }
    head = {"format": DIAGNOSIS_FORMAT, "name": study.name}
    return plain({**head, **answer, "provenance": provenance})


def rows_dict(outliers: Sequence[Outlier], measured: Measured) -> Json:
    """Return what files hold of the rows of either."""
    answer: Json = {"outliers": outliers, "notes": measured.notes, "poses": "measured"}
    if not measured.has_poses:
        answer["poses"] = "estimated"
    if measured.coordinates is not None:
        answer |= {
            "poses": "measured in part",
            "coordinates": measured.coordinates.rms_residuals(measured.poses),
        }
    return answer


def structure_dict(structure: Structure) -> Json:
    """Return what files hold of a test."""
    return {"present": structure.is_present, **record(structure)}


def _calibration(calibration: Calibration) -> Json:
    """Return what files hold of how well the data settle what was fitted."""
    return {
        **record(calibration),
        "observability": {"index": "Borm and Menq O1", "value": calibration.observability},
        "correlated": [
            {
                "first": {**first.effect.identified(), "name": first.parameter.name},
                "second": {**second.effect.identified(), "name": second.parameter.name},
                "correlation": correlation,
            }
            for first, second, correlation in calibration.correlated
        ],
    }


def reasons(effects: Sequence[tuple[str, str]]) -> list[Json]:
    """Return effects by id, each with the reason."""
    return [{"id": key, "reason": reason} for key, reason in effects]


def _balance(imbalance: FloatArray | None) -> Json | None:
    """Return how far poses are from balance, over the weight, where cables let them sway."""
    if imbalance is None:
        return None
    finite = imbalance[~np.isnan(imbalance)]
    return {
        "left_median": np.median(finite) if finite.size else None,
        "left_largest": finite.max() if finite.size else None,
        "rows_not_held": imbalance.size - finite.size,
    }
