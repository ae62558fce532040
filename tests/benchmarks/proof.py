"""How near the proved bound comes to what was found, for the ropes that the examples choose.

    python tests/benchmarks/proof.py [STUDY …]

For each study the chosen rope: largest utilisation found, proved bound and their gap, the share of
the volume that is proved to hold, and boxes. What counts as near enough is 0.1 %.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import designer
from designer.study import as_built_by

EXAMPLES = Path(designer.__file__).parent / "examples"


def main() -> None:
    """Print a line a study."""
    names = sys.argv[1:] or sorted(path.stem for path in EXAMPLES.glob("*.yaml"))
    print("study         rope        found      bound      gap %     share %  boxes")
    for name in names:
        study = designer.read_study(EXAMPLES / f"{name}.yaml")
        assert study.workspace is not None
        study = replace(study, workspace=replace(study.workspace, samples=1000))
        _print(name, study)


def _print(name: str, study: designer.Study) -> None:
    from designer.grades.registry import load_catalogue
    from designer.selection.select import select

    built = as_built_by(study)
    found = select(
        built.robot, study.workspace, study.selection, load_catalogue(()).grades, built=built,
        load_cases=study.load_cases, proof_s=math.inf,
    )  # fmt: skip
    if found.chosen is None or found.proof is None:
        print(f"{name:14}no rope chosen")
        return
    proof = found.proof
    gap = 100.0 * (proof.bound / proof.found - 1.0)
    print(
        f"{name:14}{found.chosen.size.id:12}{proof.found:<11.6f}{proof.bound:<11.6f}{gap:<10.4f}"
        f"{100.0 * proof.fraction:<9.4f}{proof.boxes}",
        flush=True,
    )


if __name__ == "__main__":
    main()
