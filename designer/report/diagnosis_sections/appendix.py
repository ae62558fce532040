"""Where the numbers of a diagnosis come from."""

from __future__ import annotations

from designer.analysis import Provenance
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
        facts.append(Fact("Measured data", study.measurements.file.name))
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
