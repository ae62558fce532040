"""What each hook takes, in a few lines.

Libraries are imported where they are needed: this module is loaded by every command that looks at
plugins.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from designer.plugins import hookimpl

if TYPE_CHECKING:
    from collections.abc import Callable

    from designer.analysis.analyse import Analysis
    from designer.exports.formats import Format
    from designer.exports.robot import Export, ExportedRobot
    from designer.foreign.robot import ForeignRobot, Importer


def anchor_span(config: Path) -> None:
    """Print the largest distance between two exit points of a study."""
    import typer
    from scipy.spatial.distance import pdist

    import designer

    points_m = designer.read_study(config).robot.exit_points_m
    typer.echo(f"{pdist(points_m).max():.3f} m")


@hookimpl
def register_commands() -> list[Callable[..., object]]:
    """Return the functions that become commands: `designer anchor-span CONFIG`."""
    return [anchor_span]


def longest(maker: str) -> None:
    """Print the grade of a maker with the most sizes."""
    import typer

    import designer

    grades = (g for g in designer.catalogue().grades if maker in g.manufacturer)
    typer.echo(max(grades, key=lambda grade: len(grade.sizes)).id)


@hookimpl
def register_catalog_commands() -> list[Callable[..., object]]:
    """Return the functions that become commands of `designer catalog`: `longest MAKER`."""
    return [longest]


def read_points(path: Path) -> ForeignRobot:
    """Return a point mass on the exit points of a file: x, y and z [m] in each line."""
    from designer.errors import InputError
    from designer.foreign.robot import ForeignRobot

    points = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        try:
            x, y, z = map(float, line.split())
        except ValueError:
            raise InputError.at(path, "is no point", "x y z in metres", line=number) from None
        points.append((x, y, z))
    return ForeignRobot(str(path), path.stem, "list of points", tuple(points), None)


@hookimpl
def register_importers() -> list[Importer]:
    """Return what `designer import` reads files with, by how their names end."""
    from designer.foreign.robot import Importer

    return [Importer(".points", read_points)]


def write_points(exported: ExportedRobot, stem: str) -> Export:
    """Return the exit points as a file, and what it leaves out."""
    from designer.exports.robot import Export

    rows = (" ".join(f"{x:g}" for x in point) for point in exported.robot.exit_points_m)
    text = "".join(f"{row}\n" for row in rows)
    return Export({f"{stem}.points": text.encode()}, ("all but the exit points",))


@hookimpl
def register_exporters() -> list[Format]:
    """Return the formats: `designer export CONFIG --to points`."""
    from designer.exports.formats import Format

    return [Format("points", write_points, ".points", needs_cables=False)]


def anchor_heights(analysis: Analysis) -> tuple[str, str]:
    """Return title and body of a section; its name, `anchor-heights`, is what links point to."""
    from markupsafe import Markup

    heights_m = analysis.study.robot.exit_points_m[:, 2]
    items = (Markup("<li>{:.2f} m</li>").format(height_m) for height_m in heights_m)
    return "Anchor heights", Markup("<ol>{}</ol>").format(Markup("").join(items))


@hookimpl
def register_report_sections() -> list[Callable[[Analysis], tuple[str, str] | None]]:
    """Return the functions that give the design report a section each."""
    return [anchor_heights]


def in_feet(length_m: float) -> str:
    """Return a length in feet, for ``{{ length_m | in_feet }}`` in templates of pages."""
    return f"{length_m / 0.3048:.1f} ft"


@hookimpl
def register_template_filters() -> list[Callable[..., object]]:
    """Return the functions that become filters of templates."""
    return [in_feet]
