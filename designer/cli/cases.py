"""The line of each load case in the summary of ``designer report``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rich.markup import escape

from designer.model.load_case import STATIC

if TYPE_CHECKING:
    from designer.selection.cases import CaseFound
    from designer.selection.result import Candidate


def case_rows(chosen: Candidate) -> Iterator[tuple[str, ...]]:
    """Yield label and text of each load case; nothing where the study has none."""
    return (_case(one) for one in chosen.cases if one.case is not STATIC)


def governing_words(chosen: Candidate) -> str:
    """Return in which load case it is used most; empty where the study has none."""
    case = chosen.governing.case
    return "" if case is STATIC else f"in the load case '{escape(case.name)}'"


def _case(found: CaseFound) -> tuple[str, ...]:
    met, cable = found.verification, found.most_used()
    at = ", ".join(f"{x:.4g}" for x in met.worst_position_m[:3])
    more = f"; {escape(found.loaded.words)}" if found.loaded.words else ""
    used = f"{met.utilisation:.1%}, cable {cable} with {met.max_tension_N / 1e3:.4g} kN"
    return f"  {escape(found.case.name)}", f"{used}, at ({at}) m{more}"
