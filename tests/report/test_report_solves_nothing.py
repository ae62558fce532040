"""What a report says is in the analysis: its text is built without a solver."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import pytest
from test_report_groups import YARD as GROUPS
from test_report_load_cases import CASES, FAMILY, YARD

from designer.analysis.analyse import Analysis, finished
from designer.report.design.report import design_report

SOLVERS = (
    "kernel.batch.solve_batch",
    "kernel.batch.solve_massless_batch",
    "kernel.batch.refuse_batch",
    "kernel.fixed_length.solve_thetas",
    "kernel.internal.solve_internal_poses",
    "kernel.sizes.sweep_sizes",
    "kernel.taut.solve_taut_poses",
    "kernel.underactuated.solve_underactuated_poses",
    "statics.inverse.density_matrix",
    "statics.inverse.solve_task",
    "sizing.newton.solve_task",
    "proof.encloser.share_out",
)
"""All that a pose is solved by: what calls compiled code, and straight cables in NumPy."""

UNCERTAIN = f"""{YARD}
uncertainty: {{payload: {{standard_deviation: 8 %}}, samples: 200}}
"""
POSE = f"{YARD.partition('workspace')[0]}pose: [15, 8, 3]\n"


@pytest.fixture
def without_solvers(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a pose is solved for the text of a report")

    for path in SOLVERS:
        module, _, name = path.rpartition(".")
        monkeypatch.setattr(import_module(f"designer.{module}"), name, refuse)


CONFIGS = {
    "pose": POSE,
    "load_cases": YARD + CASES,
    "family": FAMILY,
    "groups": GROUPS.replace("GRADES", "unirope-7x19-galvanised, unirope-6x19-iwrc-eips"),
    "no_groups": GROUPS.replace("GRADES", "unirope-7x19-galvanised"),
    "uncertain": UNCERTAIN,
    "outside": f"{YARD}pose: [15, 8, 9]\n",
}


@pytest.fixture(
    params=[
        pytest.param(name, marks=() if name == "pose" else pytest.mark.slow) for name in CONFIGS
    ]
)
def analysis(request: pytest.FixtureRequest, solve: Callable[[str], Analysis]) -> Analysis:
    return finished(solve(CONFIGS[request.param]))


def test_a_text_takes_no_solver(analysis: Analysis, without_solvers: None) -> None:
    assert design_report(analysis, draws=False).sections


@pytest.mark.slow
@pytest.mark.parametrize("name", ["positive", "exclude", "no_finite_cable", "too_thin"])
def test_nor_does_that_of_a_crane_of_great_span(
    name: str, analyses: dict[str, Analysis], request: pytest.FixtureRequest
) -> None:
    analysis = finished(analyses[name])
    request.getfixturevalue("without_solvers")
    assert design_report(analysis, draws=False).sections


def test_the_results_of_an_analysis_take_no_solver_either(
    solve: Callable[[str], Analysis], request: pytest.FixtureRequest
) -> None:
    analysis = finished(solve(POSE))
    request.getfixturevalue("without_solvers")
    assert analysis.to_dict()["pose"]["rest"] is not None
