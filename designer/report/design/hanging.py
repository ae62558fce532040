"""Cables that hang as none should: far longer than their chord, or below the floor."""

from __future__ import annotations

from collections.abc import Iterator

from designer.analysis.analyse import Analysis
from designer.report import format as fmt
from designer.report.parts import Statement
from designer.statics.task import LONG
from designer.workspace.hanging import Hanging


def hanging_statements(analysis: Analysis) -> Iterator[Statement]:
    """Yield in how many samples cables hang so, how far and where, and what could be done."""
    found, workspace = analysis.hanging, analysis.study.workspace
    whose = "the design" if analysis.qualities is not None else "what each sample needs"
    if found.long is not None:
        text = (
            f"With {whose}, a cable is longer than {fmt.trimmed(LONG)} times its chord in "
            f"{fmt.share(found.long.samples, found.samples)} of the samples: it hangs all but "
            f"slack. {_worst(found.long)} has {fmt.trimmed(found.long.extreme, 3)} times its chord."
        )
        yield Statement("Cables far longer than their chord", f"{text} {_advice(analysis)}", "bad")
    if found.below_floor is not None and workspace is not None and workspace.floor_m is not None:
        below = found.below_floor
        text = (
            f"With {whose}, a cable hangs below the floor at {fmt.metres(workspace.floor_m)} in "
            f"{fmt.share(below.samples, found.samples)} of the samples. {_worst(below)} reaches "
            f"down to {fmt.metres(below.extreme)}."
        )
        yield Statement("Cables below the floor", f"{text} {_advice(analysis)}", "bad")


def _worst(found: Hanging) -> str:
    return f"Cable {found.cable} at {fmt.position(found.place)}"


def _advice(analysis: Analysis) -> str:
    robot = analysis.built.robot
    least = (
        "A least tension (robot.tension_min) keeps cables from hanging so, where they can; or "
        if robot.is_redundant
        else ""
    )
    advice = f"{least}make the region smaller, or leave out poses with a cable below the platform."
    return f"{advice[0].upper()}{advice[1:]}"
