"""Damaged files end in one line, or in a robot; never in a traceback."""

from __future__ import annotations

import random

import pytest
from models import FREE, LIMITS, bodies, cables, link, wirex, write_caspr

from designer.errors import InputError
from designer.foreign.study import ImportAnswers, gaps, read_foreign, study_text

_SWAPS = [
    ("<", ">"), ("1", "x"), ("2", "1e400"), ("0", "nan"), ("link", "lonk"), ("num", "none"),
    ("cable", "cabel"), ("radius", "radii"), ("3R3T", "1R2T"), ("q_initial", "q_min"),
    ("SPATIAL_EULER_XYZ", "PLANAR_XZ"), ("mass", "mess"), ("5", "-5"), ("location", "place"),
]  # fmt: skip


def spoilt(text: str, rng: random.Random) -> str:
    at = rng.randrange(len(text))
    end = at + rng.randint(1, 60)
    kind = rng.randrange(4)
    if kind == 0:
        return text[:at] + text[end:]
    if kind == 1:
        return text[:end] + text[at:end] + text[end:]
    if kind == 2:
        return text[:at] + chr(rng.choice([0, 9, 34, 38, 48, 60, 955, 0x1F600])) + text[at + 1 :]
    old, new = rng.choice(_SWAPS)
    return text[:at] + text[at:].replace(old, new, 1)


@pytest.mark.slow
def test_damaged_files(tmp_path) -> None:
    rng = random.Random(3)
    whole = bodies(link(joint=f"{FREE} {LIMITS}")), cables(), wirex()
    read = 0
    for number in range(450):
        which = number % 3
        texts = list(whole)
        texts[which] = spoilt(texts[which], rng)
        path = write_caspr(tmp_path, texts[0], texts[1])
        if which == 2:
            path = tmp_path / "rig.wcrfx"
            path.write_text(texts[2], encoding="utf-8")
        try:
            gaps(study_text(read_foreign(path), ImportAnswers()))
            read += 1
        except InputError as error:
            assert len(str(error).splitlines()) == 1
    assert 20 < read < 430
