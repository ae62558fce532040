"""The verification page: every case computed, and robots that were converted, as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from designer import __version__
from designer.model.verdict import Verdict
from designer.reference.cases import CASES, Figure, ReferenceCase

CASPR, WIREX = "CASPR", "WireX"


@dataclass(frozen=True, slots=True)
class Converted:
    """A robot of another program's file, sized in one pose."""

    name: str  #: the model, with its set of cables if not the default
    source: str  #: the program it is of
    n_cables: int
    gaps: tuple[str, ...] = ()  #: what the file leaves out
    verdict: Verdict | None = None  #: of the pose; None where the robot is not sized
    diameter_mm: float | None = None  #: thinnest cable of the pose
    tension_N: float | None = None  #: largest of that cable
    reason: str = ""  #: why it is not sized


_SOLVED, _OUTSIDE = Verdict.SOLVED, Verdict.OUTSIDE_HULL
_ROPE = ("rope",)
_ALL = ("mass", "centre of mass", "rope", "pose")

ROBOTS = (
    Converted("ACROBOT", CASPR, 8, _ROPE, _SOLVED, 0.1220, 2.34644),
    Converted("CAROCA", CASPR, 8, _ROPE, _SOLVED, 1.4616, 336.520),
    Converted("CAROCA, with_rotating_pulleys", CASPR, 8, _ROPE, _SOLVED, 1.4431, 328.063),
    Converted("CAROCA, gazebo_sim", CASPR, 8, _ROPE, _SOLVED, 1.5092, 358.801),
    Converted("CoGiRo", CASPR, 8, _ROPE, _SOLVED, 1.5525, 379.680),
    Converted("FAST", CASPR, 6, _ROPE, _SOLVED, 26.4961, 110587),
    Converted("IPAnema_1", CASPR, 8, _ROPE, _SOLVED, 1.0101, 160.719),
    Converted("IPAnema_2", CASPR, 8, _ROPE, _SOLVED, 0.6517, 66.8988),
    Converted("KNTU_planar", CASPR, 4, reason="moves in a plane that lies flat"),
    Converted("MACARM", CASPR, 8, _ROPE, _SOLVED, 0.1555, 3.81109),
    Converted("NIST_RoboCrane", CASPR, 6, _ROPE, _SOLVED, 0.1549, 3.78063),
    Converted("PoCaBot_spatial", CASPR, 4, reason="four cables in one plane for a free platform"),
    Converted("PoCaBot_spatial, dualcables", CASPR, 8, _ROPE, _OUTSIDE),
    Converted("SEGESTA", CASPR, 10, _ROPE, _SOLVED, 0.0527, 0.438094),
    Converted("SpiderBot_UR3", CASPR, 8, reason="several links that move against each other"),
    Converted("Swinburne", CASPR, 8, _ROPE, _SOLVED, 0.4312, 29.2867),
    Converted("Swinburne, full_constrainted", CASPR, 8, _ROPE, _SOLVED, 0.5868, 54.2471),
    Converted("The_Cable_Robot_Simulator", CASPR, 8, _ROPE, _SOLVED, 4.0028, 2523.90),
    Converted("2DIPAnema2", WIREX, 4, _ALL, reason="four cables for six degrees of freedom"),
    Converted("CableMasterRobot", WIREX, 7, _ALL, _OUTSIDE),
    Converted("COPacabana_Handling", WIREX, 8, _ALL, _SOLVED, 0.7864, 97.4155),
    Converted("CoGiRo", WIREX, 8, _ALL, _SOLVED, 0.8152, 104.674),
    Converted("EndlessZ-PaperIAK2013", WIREX, 9, _ALL, _SOLVED, 1.0643, 178.425),
    Converted(
        "EXPO2015_Lucia", WIREX, 8, ("centre of mass", "safety factor", "pose"), _SOLVED, 4.1326,
        381.641,
    ),
    Converted("IPAnema", WIREX, 8, _ALL, _SOLVED, 1.0101, 160.719),
    Converted("IPAnema2", WIREX, 8, _ALL, _SOLVED, 0.9083, 129.960),
    Converted("MACARM", WIREX, 8, _ALL, _SOLVED, 0.7584, 90.5992),
    Converted("Segesta", WIREX, 8, _ALL, _OUTSIDE),
    Converted("WDPSS", WIREX, 8, _ALL, _SOLVED, 0.9211, 133.643),
)  # fmt: skip


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
        # Nor is it one how far from a limit ours is.
        judged = [
            abs(figure.difference)
            for figure in figures
            if figure.tolerance is not None and not figure.is_limit
        ]
        failed = sum(not figure.holds for figure in figures)
        largest = f"{max(judged):.1e}" if judged else "—"
        yield row((case.title, str(len(figures)), largest, str(failed)))
    for case, figures in computed:
        yield from ("", f"## {case.title}", "", f"{case.source}.", "", case.note, "")
        yield from table(("figure", *HEADINGS), "llrrrrl")
        yield from (row(cells(figure)) for figure in figures)
    yield from _converted()


def cells(figure: Figure) -> tuple[str, ...]:
    """Return the cells of a figure's row."""
    allowed = "—" if figure.tolerance is None else f"{figure.tolerance:.1e}"
    allowed = "up to theirs" if figure.is_limit else allowed
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
