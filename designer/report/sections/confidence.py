"""How sure the answer is: distance from the boundary, sampling, doubts about the figures."""

from __future__ import annotations

from collections.abc import Iterator

from designer.analysis import Analysis
from designer.catalogue.grade import TRUST_MEANING
from designer.region import PointList
from designer.report import format as fmt
from designer.report.findings import Findings
from designer.report.parts import Statement
from designer.selection.result import Candidate

_NEAR_BOUNDARY = 0.9


def confidence(analysis: Analysis, findings: Findings) -> tuple[Statement, ...]:
    """Return what a reviewer should know before relying on the answer."""
    chosen = analysis.selection.chosen if analysis.selection else None
    statements = [*_margin(analysis, findings), *_sampling(analysis)]
    if chosen is not None:
        statements += [_trust(chosen), _modulus(chosen, findings), *_doubt(chosen)]
    return tuple(statements)


def _margin(analysis: Analysis, findings: Findings) -> Iterator[Statement]:
    rope = findings.chosen_limit_ratio
    workspace, pose = analysis.workspace, analysis.pose
    place, whose = "worst", "the configured family"
    if rope is not None:
        ratio, whose = rope, "the chosen grade"
    elif workspace is not None and workspace.sagging is not None:
        ratio = workspace.limit_ratio
    elif workspace is None and pose is not None and pose.sizing.statics.is_solved:
        ratio, place = pose.limit_ratio, "configured"
    else:
        return
    text = (
        f"At the {place} pose the limit ratio of {whose} is {fmt.percent(ratio)}. This is the "
        "share of the allowable stress that a cable of unlimited thickness would spend on its "
        "own weight; at 100 % no finite cable is left."
    )
    if rope is not None and workspace is not None and workspace.sagging is not None:
        text += f" For the configured family it is {fmt.percent(workspace.limit_ratio)}."
    near = ratio > _NEAR_BOUNDARY
    yield Statement("Margin to the boundary", text, "bad" if near else "")


def _sampling(analysis: Analysis) -> Iterator[Statement]:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.sampled is None:
        return
    assert analysis.study.workspace is not None
    if isinstance(analysis.study.workspace.region, PointList):
        yield Statement("Positions", "Every point of the list was solved; nothing lies between.")
        return
    best = f"the worst of {fmt.count(workspace.census.samples)} samples"
    text = (
        f"In the configured family {best} needs {fmt.millimetres(workspace.sampled.diameter_m)} "
        f"and meets {fmt.newtons(workspace.sampled.max_tension_N)}. A search between the samples "
        f"found {fmt.millimetres(workspace.sagging.diameter_m)} and "
        f"{fmt.newtons(workspace.sagging.max_tension_N)}. The searched value counts, here and "
        "for the ropes."
    )
    yield Statement("Sampled and searched maximum", text)


def _trust(chosen: Candidate) -> Statement:
    letter = chosen.grade.trust
    text = f"Trust {letter}: {TRUST_MEANING[letter]}. Ask the maker for a certificate."
    return Statement("Figures of the rope", text, "" if letter == "A" else "doubt")


def _modulus(chosen: Candidate, findings: Findings) -> Statement:
    modulus = chosen.grade.modulus
    text = f"The modulus is {modulus.basis}, known to ± {fmt.trimmed(100 * modulus.uncertainty)} %."
    if findings.modulus_utilisation is not None:
        low, high = sorted(findings.modulus_utilisation)
        text += f" Over that range the utilisation at the worst pose is {_range(low, high)}."
        if high > 1.0 >= chosen.verification.utilisation:
            return Statement("Modulus", f"{text} So it may exceed what is allowed.", "bad")
    return Statement("Modulus", text)


def _range(low: float, high: float) -> str:
    first, last = fmt.utilisation(low), fmt.utilisation(high)
    return f"{first} throughout" if first == last else f"{first} to {last}"


def _doubt(chosen: Candidate) -> Iterator[Statement]:
    if chosen.size.doubt:
        yield Statement(f"Doubt about {chosen.size.id}", f"{chosen.size.doubt}.", "doubt")
