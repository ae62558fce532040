"""From a study with measurements to a diagnosis, and to the config that has what was found."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from designer.api import AnyStudy, as_study
from designer.diagnosis.design import declared_by, declared_of_session, spreads_of
from designer.diagnosis.diagnose import diagnose_study
from designer.diagnosis.result import Diagnosis, effects_table
from designer.documents import document
from designer.documents.document import Keys
from designer.documents.edits import scalar, with_section, with_value
from designer.documents.opened import read_input
from designer.io.config.moved import moved_to, path_from
from designer.measured.read import read_measured
from designer.model.measurements import KINDS


def diagnose(
    study: AnyStudy,
    data: Path | str | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Diagnosis:
    """Compare measured data with the model, and find the effect that the model lacks.

    Parameters
    ----------
    study : Study, Path or str
        With ``measurements``.
    data : Path or str, optional
        Measured data, instead of the study's.
    progress : callable
        Called with what is being done.

    Raises
    ------
    InputError
        If there is nothing to compare, or the data are not as they should be.
    """
    study = as_study(study)
    if data is not None and study.measurements is not None:
        study = replace(study, measurements=study.measurements.of_file(Path(data)))
    return diagnose_study(study, read_measured(study), progress)


def diagnosed_config(diagnosis: Diagnosis, folder: Path, text: str | None = None) -> str:
    """Return the text of the config with the whole model in it.

    What was fitted and what was found go under ``effects``, noise that was estimated under
    ``measurements.noise``, deviations of what a design draws under ``uncertainty``. The rest stays
    as its author laid it out, but for paths in it, which are rewritten for a config that lies in
    ``folder``. The ``text`` of the config is what its file holds, if left out.
    """
    source, measured = diagnosis.study.source.path, diagnosis.study.measurements
    assert measured is not None
    if text is None:
        text = document.decode(read_input(source), str(source))
    text = moved_to(folder, text, document.document_of(text.encode(), str(source)), source.parent)
    # The data are not always those that the config names.
    places: dict[Keys, str] = {}
    if not measured.sessions:
        files = [scalar(path_from(folder, path)) for path in measured.files]
        places["file",] = files[0] if len(files) == 1 else f"[{', '.join(files)}]"
    for number in range(len(measured.sessions)):
        declared = effects_table(declared_of_session(diagnosis, number + 1))
        if declared:
            places["sessions", number, "effects"] = json.dumps(declared)
    if noise := _estimated_noise(diagnosis):
        places |= {("noise", kind): str(size) for kind, size in noise.items()}
        places["noise", "estimated"] = f"[{', '.join(noise)}]"
    for place, value in places.items():
        text = with_value(text, ("measurements", *place), value)
    for name, spread in spreads_of(diagnosis).items():
        value = f"{{standard_deviation: {spread:.3g}}}"
        text = with_value(text, ("uncertainty", name), value)
    effects = effects_table(declared_by(diagnosis))
    return with_section(text, "effects", effects, _origin(diagnosis))


def _origin(diagnosis: Diagnosis) -> str:
    """Return where the effects come from, for whoever reads the config later."""
    measured = diagnosis.study.measurements
    assert measured is not None
    digests = ", ".join(digest[:16] for digest in diagnosis.measured.sha256.split(", "))
    lines = [f"From the diagnosis of {measured.file_names}, SHA-256 {digests}"]
    for kind, *errors in diagnosis.errors:
        was, now = (kind.scale * error.heldout.value for error in errors)
        lines.append(f"{kind.name} error on unseen rows {was:.3g} -> {now:.3g} {kind.unit}")
    return "; ".join(lines)


def _estimated_noise(diagnosis: Diagnosis) -> dict[str, float]:
    """Return the noise that nobody declared, of readings that there are."""
    measurements = diagnosis.study.measurements
    assert measurements is not None
    declared = measurements.declared_noise.keys() - {*measurements.estimated_noise}
    return {
        kind.name: float(kind.of(diagnosis.noise))
        for kind in KINDS
        if kind.name not in declared and np.isfinite(kind.of(diagnosis.measured)).any()
    }
