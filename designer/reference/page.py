"""The verification page: every case computed, as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from designer import __version__
from designer.reference import robots, single_cables
from designer.reference.case import Figure, ReferenceCase
from designer.reference.converted import ROBOTS

CASES: tuple[ReferenceCase, ...] = (*robots.CASES, *single_cables.CASES)
HEADINGS = ("unit", "theirs", "ours", "difference", "allowed", "")
Computed = Sequence[tuple[ReferenceCase, Sequence[Figure]]]


def compute(tell: Callable[[str], None] = lambda title: None) -> Computed:
    """Return all cases with their figures; ``tell`` is called with each title before it."""
    computed = []
    for case in CASES:
        tell(case.title)
        computed.append((case, tuple(case.figures())))
    return computed


def markdown(computed: Computed) -> str:
    """Return the page."""
    return "\n".join(_lines(computed)) + "\n"


def _lines(computed: Computed) -> Iterator[str]:
    count = sum(len(figures) for _, figures in computed)
    outside = sum(not figure.holds for _, figures in computed for figure in figures)
    yield "# Verification"
    yield ""
    yield (
        f"Written by `designer verify` of version {__version__}: {count} figures of others beside "
        f"ours, computed as this page was written; {outside or 'none'} outside what is allowed. "
        "Differences are relative to theirs."
    )
    yield ""
    yield from table(("source", "figures", "largest difference", "outside"), "lrrr")
    for case, figures in computed:
        # What is only shown, since theirs is wrong, is no difference of ours.
        judged = [abs(figure.difference) for figure in figures if figure.tolerance is not None]
        failed = sum(not figure.holds for figure in figures)
        yield row((case.title, str(len(figures)), f"{max(judged):.1e}", str(failed)))
    for case, figures in computed:
        yield from ("", f"## {case.title}", "", f"{case.source}.", "", case.note, "")
        yield from table(("figure", *HEADINGS), "llrrrrl")
        yield from (row(cells(figure)) for figure in figures)
    yield from _converted()


def cells(figure: Figure) -> tuple[str, ...]:
    """Return the cells of a figure's row."""
    allowed = "—" if figure.tolerance is None else f"{figure.tolerance:.1e}"
    judged = "shown only" if figure.tolerance is None else "holds" if figure.holds else "FAILS"
    return (
        figure.name,
        figure.unit,
        f"{figure.theirs:.12g}",
        f"{figure.ours:.12g}",
        f"{figure.difference:+.1e}",
        allowed,
        judged,
    )


def _converted() -> Iterator[str]:
    yield from ("", "## Robots of other programs", "")
    yield (
        "Read by `designer import` and sized in one pose. Facts of one run, not computed again "
        "here, since the files are their authors' and not shipped. What a file leaves out was "
        "given as 25 kg, a centre of mass at the origin of the platform, a pose in the middle of "
        "the frame, and galvanised 7x19 wire rope with a safety factor of 5."
    )
    yield ""
    heading = ("robot", "file of", "cables", "left out", "answer", "diameter, mm", "tension, N")
    yield from table(heading, "llrllrr")
    for robot in ROBOTS:
        answer = robot.reason if robot.verdict is None else robot.verdict.reason
        figures = (robot.diameter_mm, robot.tension_N)
        texts = ("" if figure is None else f"{figure:.6g}" for figure in figures)
        left_out = ", ".join(robot.gaps)
        yield row((robot.name, robot.source, str(robot.n_cables), left_out, answer, *texts))


def table(heading: Sequence[str], sides: str) -> Iterator[str]:
    """Yield the first two lines of a table; ``sides`` says l or r for each column."""
    yield row(heading)
    yield row(["---:" if side == "r" else "---" for side in sides])


def row(cells: Sequence[str]) -> str:
    """Return a line of a table."""
    return f"| {' | '.join(cells)} |"
