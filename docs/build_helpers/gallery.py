"""The reports of the shipped studies and a page that shows them, made anew for other code."""

import base64
import hashlib
from dataclasses import replace
from functools import cache
from pathlib import Path

from sphinx.util.logging import getLogger

import designer
from designer.report.design.drawings import Drawings
from designer.report.design.report import report_from
from designer.report.figures.opengl import why_no_scenes
from designer.report.render import write_pages
from designer.resources import data_folder, example_names, example_summary

SAMPLES = 1000
"""Of a workspace at most, and nothing is proved: a build of the docs is to take minutes."""
LEFT_OUT = ("fast-as-built",)
"""The example 'fast' has the same telescope."""
_LOGGER = getLogger(__name__)


def draw(folder, names):
    """Make the report, the picture and the words of these studies if this code has not yet."""
    catalogue = designer.catalogue(with_plugins=False)
    for name in names:
        stamp = folder / name / "stamp"
        if not _is_made(stamp):
            _LOGGER.info("report of %s, for the gallery", name)
            stamp.parent.mkdir(parents=True, exist_ok=True)
            _draw(name, catalogue, stamp.parent)
            stamp.write_text(_stamp())


def _is_made(stamp):
    """Return whether a report is there, made with this code."""
    return stamp.is_file() and stamp.read_text() == _stamp()


@cache
def _stamp():
    """Return the digest of all that the reports are made with, but for libraries."""
    digest = hashlib.sha256(f"{SAMPLES} samples".encode())
    folders = (Path(designer.__file__).parent, data_folder("catalog"), data_folder("reports"))
    for folder in (*folders, Path(__file__).parent):
        for path in sorted(folder.rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                digest.update(str(path.relative_to(folder)).encode() + path.read_bytes())
    return digest.hexdigest()


def names():
    """Return the studies that are shown."""
    return [name for name in example_names() if name not in LEFT_OUT]


def _draw(name, catalogue, folder):
    """Write ``report.html``, ``report.pdf``, ``picture.png`` and ``words.md`` of a study."""
    study = designer.read_study(designer.example_file(name), with_plugins=False).unproved
    few = min(study.workspace.samples, SAMPLES)
    study = replace(study, workspace=replace(study.workspace, samples=few))
    analysis = designer.analyse(study, catalogue)
    drawings = Drawings(analysis, True, why_no_scenes())
    write_pages(report_from(drawings), folder)
    if drawings.cover is not None:  # no machine without OpenGL has one
        picture = base64.b64decode(drawings.cover.bitmap.partition(",")[2])
        (folder / "picture.png").write_bytes(picture)
    (folder / "words.md").write_text(_words(analysis), encoding="utf-8")


def _words(analysis):
    """Return what was chosen, in a sentence."""
    chosen, robot = analysis.selection.chosen, analysis.study.robot
    cables = f"{robot.n_cables} cables, {robot.platform.mass_kg:g} kg"
    if chosen is None:
        return f"{cables}: no rope that the study allows holds every pose.\n"
    used = chosen.verification.utilisation
    rope = f"{chosen.size.id} of {chosen.grade.product} ({chosen.grade.id})"
    return f"{cables}: {rope}, {chosen.total_mass_kg:.3g} kg in all, {used:.0%} used at worst.\n"


def page(folder):
    """Return the gallery: for each study its picture, what was chosen, and its report."""
    made = (name for name in names() if _is_made(folder / name / "stamp"))
    return "\n".join(_entry(name, folder / name) for name in made)


def _entry(name, folder):
    title = designer.read_study(designer.example_file(name), with_plugins=False).name
    words = (folder / "words.md").read_text(encoding="utf-8")
    report = f"reports/{name}/report.html"
    lines = [f"## {title}", f"{example_summary(name)}.", words]
    if (folder / "picture.png").is_file():
        lines.append(
            f'<a href="{report}"><img src="reports/{name}/picture.png" width="560" '
            f'alt="{title}: exit points, cables and the region"></a>'
        )
    pdf = (folder / "report.pdf").is_file()
    as_pdf = f' or <a href="reports/{name}/report.pdf">as PDF</a>' if pdf else ""
    study = f"<code>designer init --example {name}</code>"
    lines.append(f'<p>The <a href="{report}">report</a>{as_pdf}. The study: {study}</p>')
    return "\n\n".join(lines) + "\n"
