"""The studies of `report_cases`, solved once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest
from report_cases import CASES, DEFAULTS, FAST

from designer.analysis.analyse import Analysis, analyse
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.progress import Advance


class Silent:
    """A reporter that shows nothing."""

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        yield lambda _: None


@pytest.fixture(scope="session")
def solve(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Analysis]:
    """Solve a config text."""

    def solved(text: str) -> Analysis:
        folder = tmp_path_factory.mktemp("study")
        config = folder / "study.yaml"
        config.write_text(text, encoding="utf-8")
        study = read_study(config)
        return analyse(study, load_catalogue(with_plugins=False), Path(folder), Silent())

    return solved


class Analyses(Mapping[str, Analysis]):
    """The cases of `report_cases`, each solved when it is first asked for."""

    def __init__(self, solve: Callable[[str], Analysis]) -> None:
        self._solve = solve
        self._solved: dict[str, Analysis] = {}

    def __getitem__(self, name: str) -> Analysis:
        if name not in self._solved:
            self._solved[name] = self._solve(FAST.format(**{**DEFAULTS, **CASES[name]}))
        return self._solved[name]

    def __iter__(self) -> Iterator[str]:
        return iter(CASES)

    def __len__(self) -> int:
        return len(CASES)


@pytest.fixture(scope="session")
def analyses(solve: Callable[[str], Analysis]) -> Analyses:
    """Every case of `report_cases`."""
    return Analyses(solve)


@pytest.fixture(scope="session")
def pose_only(solve: Callable[[str], Analysis]) -> Analysis:
    """A study without a workspace."""
    text = FAST.format(**DEFAULTS)
    return solve(text[: text.index("workspace:")])


@pytest.fixture(scope="session")
def yard(solve: Callable[[str], Analysis]) -> Analysis:
    """The shipped example of a small crane, with few samples."""
    from designer.resources import example_file

    text = example_file("yard").read_text(encoding="utf-8")
    return solve(text.replace("samples: 20000", "samples: 300"))
