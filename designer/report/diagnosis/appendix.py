"""Where the numbers of a diagnosis come from."""

from __future__ import annotations

from designer.analysis.analyse import Provenance
from designer.diagnosis.result import Diagnosis
from designer.report import format as fmt
from designer.report.parts import Fact


def provenance_facts(diagnosis: Diagnosis, provenance: Provenance) -> tuple[Fact, ...]:
    """Return program, libraries, config, data and time."""
    study = diagnosis.study
    libraries = ", ".join(f"{name} {version}" for name, version in provenance.libraries)
    facts = [
        Fact("Program", f"cdpr-designer {provenance.version}"),
        Fact("Libraries", libraries),
        Fact("Configuration", study.source.path.name),
        Fact("SHA-256 of the configuration", study.source.sha256),
    ]
    if study.measurements is not None:
        facts += [
            Fact("Measured data", study.measurements.file.name),
            Fact("SHA-256 of the data", diagnosis.measured.sha256),
        ]
    facts += [
        Fact("Computed", created(provenance)),
        Fact("On", provenance.system),
        Fact("Candidates", fmt.count(len(diagnosis.steps[0].trials) if diagnosis.steps else 0)),
        Fact("Everything in numbers", "diagnosis.json", "beside this report"),
    ]
    return tuple(facts)


def created(provenance: Provenance) -> str:
    """Return date and time of the diagnosis."""
    return provenance.created.strftime("%Y-%m-%d %H:%M %z").strip()


def internal_forces(diagnosis: Diagnosis) -> str:
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
