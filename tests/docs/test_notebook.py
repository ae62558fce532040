"""The shipped notebook: its cells give what stands below them."""

from __future__ import annotations

import json

import pytest
from notebook import cells, run


@pytest.mark.slow
def test_outputs_of_the_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    for shipped, again in zip(cells(), run(), strict=True):
        if shipped["cell_type"] == "code":
            both = [_texts(cell) for cell in (shipped, again)]
            assert both[0] == both[1], "run `python tests/docs/notebook.py`"
    outputs = [output for cell in cells() for output in cell.get("outputs", ())]
    kinds = {kind for output in outputs for kind in output.get("data", ())}
    assert kinds == {"text/plain", "text/html", "image/png"}


def _texts(cell: dict) -> list[str]:
    """What a cell gives, without the bytes of pictures."""
    data = [output.get("data", {"text": output.get("text")}) for output in cell["outputs"]]
    return [json.dumps({**each, "image/png": ""}, sort_keys=True) for each in data]
