"""The config with what a diagnosis found in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from designer.diagnosis.as_json import effects_table
from designer.diagnosis.design import declared_by
from designer.diagnosis.result import Diagnosis
from designer.documents.document import decode, document_of
from designer.documents.edits import scalar, with_section, with_value
from designer.documents.opened import read_input
from designer.io.config.moved import moved_to, path_from


def diagnosed_config(diagnosis: Diagnosis, folder: Path, text: str | None = None) -> str:
    """Return the text of the config with the whole model in it.

    What was fitted and what was found go under ``effects``, noise that was estimated under
    ``measurements.noise``. The rest stays as its author laid it out, but for paths in it, which
    are rewritten for a config that lies in ``folder``. The ``text`` of the config is what its
    file holds, if left out.
    """
    source, measured = diagnosis.study.source.path, diagnosis.study.measurements
    assert measured is not None
    if text is None:
        text = decode(read_input(source), str(source))
    text = moved_to(folder, text, document_of(text.encode(), str(source)), source.parent)
    # The data are not always those that the config names.
    places: dict[tuple[str, ...], str] = {("file",): scalar(path_from(folder, measured.file))}
    if noise := _estimated_noise(diagnosis):
        places |= {("noise", kind): str(size) for kind, size in noise.items()}
        places["noise", "estimated"] = f"[{', '.join(noise)}]"
    for place, value in places.items():
        text = with_value(text, ("measurements", *place), value)
    effects = effects_table(declared_by(diagnosis))
    return with_section(text, "effects", effects, _origin(diagnosis))


def _origin(diagnosis: Diagnosis) -> str:
    """Return where the effects come from, for whoever reads the config later."""
    measured = diagnosis.study.measurements
    assert measured is not None
    lines = [
        f"From the diagnosis of {measured.file.name}, SHA-256 {diagnosis.measured.sha256[:16]}"
    ]
    for kind, scale, unit in (("length", 1e3, "mm"), ("tension", 1.0, "N")):
        before, last = (
            stage.length_m if kind == "length" else stage.tension_N
            for stage in (diagnosis.stages[0], diagnosis.final)
        )
        if before is not None and last is not None:
            was, now = scale * before.heldout.value, scale * last.heldout.value
            lines.append(f"{kind} error on unseen rows {was:.3g} -> {now:.3g} {unit}")
    return "; ".join(lines)


def _estimated_noise(diagnosis: Diagnosis) -> dict[str, float]:
    """Return the noise that nobody declared, of readings that there are."""
    declared, measured, noise = diagnosis.study.measurements, diagnosis.measured, diagnosis.noise
    assert declared is not None
    kinds = {
        "length": (declared.length_noise_m, measured.length_m, noise.length_m),
        "tension": (declared.tension_noise_N, measured.tension_N, noise.tension_N),
    }
    return {
        kind: float(size)
        for kind, (declared_size, readings, size) in kinds.items()
        if (declared_size is None or kind in declared.estimated_noise)
        and np.isfinite(readings).any()
    }
