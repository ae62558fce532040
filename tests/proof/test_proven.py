"""The proof in the choice of a rope: what it finds takes the place of what the samples met."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import designer.selection.select as choosing
from designer.analysis.analyse import analyse
from designer.grades.grade import Grade
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.proof.prove import Proof
from designer.report.design.sections import proof_statement
from designer.resources import example_file
from designer.selection.cases import CaseResult
from designer.selection.select import select
from designer.study import Study

_SIZES = ("5/32 in", "3/16 in", "7/32 in", "1/4 in")


def _study(samples: int, proof_s: float) -> Study:
    study = read_study(example_file("yard"))
    assert study.workspace is not None
    return replace(study, workspace=replace(study.workspace, samples=samples, proof_s=proof_s))


def _grades() -> list[Grade]:
    """One grade with few sizes, for speed."""
    (grade,) = (g for g in load_catalogue(()).grades if g.id == "unirope-7x19-galvanised")
    return [replace(grade, sizes=tuple(s for s in grade.sizes if s.id in _SIZES))]


@pytest.mark.slow
def test_a_worst_pose_that_the_samples_missed_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    def blind(found: tuple[CaseResult, ...]) -> tuple[CaseResult, ...]:
        """Take an easy pose for the worst one, and no search between the samples."""
        easy = [
            replace(
                one,
                verification=replace(
                    one.verification,
                    worst_place=np.array([15.0, 9.0, 4.0]),
                    max_tension_N=0.5 * one.verification.max_tension_N,
                    utilisation=0.5 * one.verification.utilisation,
                    is_refined=True,
                ),
            )
            for one in found
        ]
        return tuple(easy)

    study = _study(20, 1000.0)
    assert study.workspace is not None
    assert study.selection is not None
    grades = _grades()
    honest = select(study.robot, study.workspace, study.selection, grades)
    monkeypatch.setattr(
        choosing, "refine_governing", lambda candidates: list(map(blind, candidates))
    )
    caught = select(
        study.robot, study.workspace, study.selection, grades, proof_s=study.workspace.proof_s
    )
    assert honest.chosen is not None
    assert caught.chosen is not None
    assert caught.chosen.size.id == honest.chosen.size.id
    ours, theirs = caught.chosen.verification, honest.chosen.verification
    assert ours.utilisation == pytest.approx(theirs.utilisation, rel=1e-3)
    assert caught.proof is not None
    assert caught.proof.status == "proved"
    assert ours.utilisation <= caught.proof.bound <= 1.0015 * theirs.utilisation


@pytest.mark.slow
def test_the_proof_is_in_the_result() -> None:
    analysis = analyse(_study(200, 1000.0))
    assert analysis.selection is not None
    assert analysis.selection.proof is not None
    told = analysis.to_dict()["proof"]
    assert told["status"] == "proved"
    assert told["fraction_proved"] == 1.0
    assert 1.0 < told["utilisation_bound"] / told["utilisation_found"] < 1.0011
    statement = proof_statement(analysis.selection.proof)
    assert statement.title.startswith("Proved for all poses: at most ")


def test_what_is_shown_is_not_more_than_is_proved() -> None:
    proved = Proof("proved", bound=0.88511, found=0.8842, fraction=1.0)
    assert proof_statement(proved).title.endswith("at most 88.6\u00a0%")
    partial = Proof("partial", found=0.9, fraction=0.99997)
    assert proof_statement(partial).title == "Found, not proved: 99.9\u00a0% of the volume"


@pytest.mark.slow
def test_no_time_is_no_proof() -> None:
    told = analyse(_study(50, 0.0)).to_dict()["proof"]
    assert told["status"] == "off"
    assert told["utilisation_bound"] is None
