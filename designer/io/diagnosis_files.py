"""The config with what a diagnosis found in it."""

from __future__ import annotations

import io
from functools import partial
from pathlib import Path

import numpy as np

from designer.diagnosis.as_json import effects_table
from designer.diagnosis.design import declared_by
from designer.diagnosis.result import Diagnosis
from designer.documents.modeline import with_schema_moved
from designer.documents.opened import read_input
from designer.io.config.moved import path_from


def diagnosed_config(diagnosis: Diagnosis, folder: Path, text: str | None = None) -> str:
    """Return the text of the config with the whole model in it.

    What was fitted and what was found go under ``effects``, noise that was estimated under
    ``measurements.noise``. Comments and order are kept. Paths in it, which are relative to the
    config, are rewritten for a config that lies in ``folder``. The ``text`` of the config is
    what its file holds, if left out.
    """
    from ruamel.yaml import YAML

    source = diagnosis.study.source.path
    yaml = YAML()
    yaml.width = 100
    document = yaml.load(read_input(source).decode("utf-8-sig") if text is None else text)
    document["effects"] = effects_table(declared_by(diagnosis))
    document.yaml_set_comment_before_after_key("effects", before=_origin(diagnosis))
    if estimated := _estimated_noise(diagnosis):
        noise = document["measurements"].setdefault("noise", {})
        noise.update({**estimated, "estimated": list(estimated)})
    moved = partial(path_from, folder)
    if document.get("catalogues"):
        document["catalogues"] = [moved(source.parent / path) for path in document["catalogues"]]
    if (control := document.get("document")) and control.get("logo"):
        control["logo"] = moved(source.parent / control["logo"])
    assert diagnosis.study.measurements is not None
    # The data are not always those that the config names.
    document["measurements"]["file"] = moved(diagnosis.study.measurements.file)
    written = io.StringIO()
    yaml.dump(document, written)
    return with_schema_moved(written.getvalue(), source.parent, moved)


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
