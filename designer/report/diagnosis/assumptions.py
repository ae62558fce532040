"""What a diagnosis rests on."""

from __future__ import annotations

from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.blocks import Bullets, Section


def section(diagnosis: Diagnosis) -> Section:
    """Return what the diagnosis rests on."""
    items = (
        _poses(diagnosis),
        "Static equilibrium in each row. Each cable is an elastic catenary; lengths are unstrained "
        "at 20 °C, tensions are those at the winch.",
        _internal_forces(diagnosis),
        "Noise is equal for all cables of a kind. Readings of one row may share an error, and rows "
        "that follow one another may be alike: standard deviations and chances are clustered by "
        "row and by block, and take account of how long the noise lasts.",
        "Held-out rows are contiguous blocks. Noise, effects, values and what is withdrawn for its "
        "values or for structure are decided without them. At the end, a finding has to take at "
        "least 1\u00a0% off their mean square, and more than twice the standard deviation of that "
        "gain over their blocks; else it is withdrawn as well. They also enter errors, the last "
        "test for structure and the list of outliers.",
        "Fits use a robust loss, so that single wild readings weigh little.",
        "Only effects that the program knows can be found. An effect that is found explains the "
        "data; that it is the cause remains to be checked on the machine.",
    )
    shown = Bullets(tuple(item for item in items if item))
    return Section.of("assumptions", "Assumptions and limits", shown, kind="keep")


def _poses(diagnosis: Diagnosis) -> str:
    if diagnosis.measured.has_poses:
        return (
            "Each pose is taken as measured, without an error of its own; what is compared are "
            "lengths and tensions."
        )
    return (
        "No pose was measured. Each is estimated from the row's own readings, anew with every "
        "model, which gives up as many readings of a row as there are cables; only what "
        "contradicts the others is held against the model, and errors are smaller than those of "
        "readings against measured poses."
    )


def _internal_forces(diagnosis: Diagnosis) -> str:
    """Return where the tensions come from where the pose alone does not tell them; else nothing."""
    robot = diagnosis.machine.robot
    if robot.is_redundant:
        spare = robot.n_cables - robot.degrees_of_freedom
        given_up = "one reading" if spare == 1 else f"{spare} readings"
        return (
            f"The robot has {fmt.plural(spare, 'cable')} to spare. The internal forces of each row "
            f"are taken from its own lengths and tensions, which gives up {given_up} of the row; "
            "only what contradicts the others is held against the model."
        )
    if not robot.has_enough_cables:
        return (
            "The robot has fewer cables than degrees of freedom, so it sways. The tensions are "
            "those of straight cables that come nearest to balance."
        )
    return ""
