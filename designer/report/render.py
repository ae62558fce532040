"""From a report to HTML and PDF, and into the folder: whole or not at all."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from designer.errors import Fault, InputError
from designer.io.output import output_folder, write_whole
from designer.io.results import write_results
from designer.progress import SILENT, Advance, Reporter
from designer.report.design.report import design_report
from designer.report.document import Report, Section
from designer.report.fonts import with_fonts
from designer.report.outline import add_outline
from designer.report.templates import check_templates, environment, told_in_one_line, why_no_pdf

if TYPE_CHECKING:
    from jinja2 import Environment

    from designer.analysis.analyse import Analysis

REPORT_FILES = (
    "report.html",
    "report.pdf",
    "result.json",
    "candidates.csv",
    "reactions.csv",
    "path.csv",
    "workspace.nc",
)
"""What `designer report` writes; the last four only where the study asks for them."""


def render_html(
    report: Report,
    *,
    paged: bool = False,
    user_folder: Path | None = None,
    advance: Advance = lambda _: None,
) -> str:
    """Return a report as one self-contained HTML page.

    With ``paged`` it is meant for paper: without scenes to turn. For ``user_folder`` see
    `designer.report.templates`. ``advance`` is called after each section: its figures are drawn
    when its template first asks for them.

    Raises
    ------
    jinja2.TemplateError
        If a template of the user is faulty.
    """
    templates = environment(user_folder, report.filters)
    sections = []
    for section in report.sections:
        sections.append(rendered(section, report, templates, paged=paged))
        advance(1)
    page = templates.get_template("page.html.j2")
    return with_fonts(page.render(report=replace(report, sections=tuple(sections)), paged=paged))


def rendered(
    section: Section,
    report: Report | None = None,
    templates: Environment | None = None,
    *,
    paged: bool = False,
) -> Section:
    """Return a section with the title and the body that its template makes of its context.

    Without the report that it belongs to, it is taken as one of a design report.
    """
    from markupsafe import Markup

    if section.body:  # that of a plugin
        return section
    templates = templates or environment()
    name = f"{'report' if report is None else report.name}/{section.id}.html.j2"
    variables = {**section.context, "section": section, "report": report, "paged": paged}
    shown = templates.get_template(name).make_module(variables)
    title = getattr(shown, "title", "")
    if not title:  # the template of a user need not repeat ours
        title = vars(templates.get_template(f"default/{name}").make_module(variables))["title"]
    return replace(section, title=title, body=Markup(shown))


def render_pdf(html: str) -> bytes:
    """Return the page as a PDF on A4, with an outline made from its headings.

    Title, author and date are those of the page: its ``<title>``, its generator, and the date
    that it names, so that the same page gives the same file.

    Raises
    ------
    ValueError
        If the page loads anything that is not inside it.
    """
    import plutoprint

    asked: list[str] = []

    class NothingFromOutside(plutoprint.ResourceFetcher):
        def fetch_url(self, url: str) -> plutoprint.ResourceData:
            asked.append(url)
            return plutoprint.ResourceData(b"", "text/plain")

    book = plutoprint.Book(plutoprint.PAGE_SIZE_A4)
    book.custom_resource_fetcher = NothingFromOutside()
    # Links within the page need an address to start from.
    book.load_html(html, base_url="report:/")
    stream = io.BytesIO()
    book.write_to_pdf_stream(stream)
    if asked:
        raise ValueError(f"the page loads {asked[0]}; put it into the page as a data URI")
    return add_outline(stream.getvalue(), html)


def write_report(
    analysis: Analysis,
    folder: Path | str,
    template: Path | str | None = None,
    *,
    quick: bool = False,
) -> None:
    """Write the report and all results into a folder, as `designer report` does; all or nothing.

    An earlier report in the folder is replaced. Where this machine cannot draw in space, the report
    says which pictures are left out. ``template`` is a folder of templates that come before ours;
    a ``quick`` report is page 1 in HTML alone.

    Raises
    ------
    OutputError
        If it cannot be written.
    InputError
        If a template is faulty.
    """
    templates = None if template is None else Path(template)
    if templates is not None:
        check_templates(templates)
    with output_folder(Path(folder), REPORT_FILES) as building:
        write_report_files(analysis, building, templates, quick=quick)


def write_report_files(
    analysis: Analysis,
    folder: Path,
    templates: Path | None = None,
    reporter: Reporter = SILENT,
    *,
    quick: bool = False,
) -> tuple[str, ...]:
    """Write the report and all results into an existing folder; ``quick``, page 1 alone.

    Returns a line for each section of a plugin that is left out.
    """
    report = design_report(analysis, quick=quick)
    write_pages(report, folder, templates, reporter, with_pdf=not quick)
    if not quick:
        write_results(analysis, folder)
    return report.problems


def write_pages(
    report: Report,
    folder: Path,
    templates: Path | None = None,
    reporter: Reporter = SILENT,
    *,
    with_pdf: bool = True,
) -> None:
    """Write a report as HTML and, where that can be made, as PDF, into an existing folder.

    They are named after it. Both are made before either is written, and each takes its name only
    when it is whole.
    ``templates`` is a folder of the user's.

    Raises
    ------
    InputError
        If a template of the user is faulty, or loads anything into its page.
    """
    with reporter.task("pages", (1 + with_pdf) * len(report.sections) + 1) as advance:
        with told_in_one_line(templates):
            pages = [
                render_html(report, paged=paged, user_folder=templates, advance=advance)
                for paged in ((False, True) if with_pdf else (False,))
            ]
        try:
            pdf = b"" if why_no_pdf() or not with_pdf else render_pdf(pages[1])
        except ValueError as error:
            if templates is None:
                raise
            raise InputError([Fault(str(templates), None, "", str(error))]) from error
        advance(1)
    files = {f"{report.name}.html": pages[0].encode(), f"{report.name}.pdf": pdf}
    for name, content in files.items():
        if content:
            write_whole(folder / name, content)
