"""The studies of `report_cases`, solved once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from altered import altered
from report_cases import CASES, CLEARANCE_KEPT, CLEARANCE_NOT_KEPT, DEFAULTS, FAST

from designer.analysis.analyse import Analysis
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
    """Return the analysis of a config text, each stage of which is computed when it is read."""

    def solved(text: str) -> Analysis:
        folder = tmp_path_factory.mktemp("study")
        config = folder / "study.yaml"
        config.write_text(text, encoding="utf-8")
        study = read_study(config)
        catalogue = load_catalogue(with_plugins=False)
        return Analysis.begin(study, catalogue, Path(folder), Silent())

    return solved


class Analyses(Mapping[str, Analysis]):
    """The cases of `report_cases`, each solved when it is first asked for."""

    def __init__(self, solve: Callable[[str], Analysis]) -> None:
        self._solve = solve
        self._solved: dict[str, Analysis] = {}

    def __getitem__(self, name: str) -> Analysis:
        if name not in self._solved:
            self._solved[name] = self._renamed() if name == "markup" else self._of(name)
        return self._solved[name]

    def _of(self, name: str) -> Analysis:
        return self._solve(FAST.format(**{**DEFAULTS, **CASES[name]}))

    def _renamed(self) -> Analysis:
        """The first case under another name, which changes no number."""
        assert CASES["markup"].keys() == {"name"}
        study = self["positive"].study
        return altered(self["positive"], study=replace(study, name=CASES["markup"]["name"][1:-1]))

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


@pytest.fixture(scope="session")
def kept(solve: Callable[[str], Analysis]) -> Analysis:
    """Six cables with a rope that keeps its clearance."""
    return solve(CLEARANCE_KEPT)


@pytest.fixture(scope="session")
def not_kept(solve: Callable[[str], Analysis]) -> Analysis:
    """Six cables of the family, which do not keep a clearance of 0.4 m."""
    return solve(CLEARANCE_NOT_KEPT)
