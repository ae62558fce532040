"""All that the report's template shows, as text: `ReportContext` is the template's whole world.

A template of your own gets one variable, ``report``, which is a `ReportContext`. Every number in
it is formatted already. Parts that a study has no results for are None.
"""

from __future__ import annotations

from dataclasses import dataclass

from designer.analysis.analyse import Analysis
from designer.analysis.findings import find
from designer.report.design.appendix import (
    AssumptionsSection,
    LeftOutSection,
    ProvenanceSection,
    assumptions_section,
    created,
    left_out_section,
    provenance_section,
)
from designer.report.design.clearance import ClearanceSection, clearance_section
from designer.report.design.first_page import FirstPage, first_page
from designer.report.design.groups import GroupsSection, groups_section
from designer.report.design.inputs import InputsSection, inputs_section
from designer.report.design.pose import PoseSection, pose_section
from designer.report.design.selection import SelectionSection, selection_section
from designer.report.design.stiffness import StiffnessSection, stiffness_section
from designer.report.design.workspace import WorkspaceSection, workspace_section
from designer.report.pictures import Pictures


@dataclass(frozen=True, slots=True)
class Heading:
    """A section of the report: the id that links point to, its number and its title."""

    id: str
    number: int
    title: str


@dataclass(frozen=True, slots=True)
class ReportContext:
    """Everything that the template shows.

    Parameters
    ----------
    title : str
        Name of the study.
    generator : str
        This program and its version.
    created, created_iso : str
        Date and time of the analysis, to read and as ISO 8601.
    missing : str
        Why pictures in space are left out, and what to install; empty where they are not.
    headings : tuple of Heading
        The sections that this report has, in order; ids are ``answer``, ``inputs``, ``pose``,
        ``workspace``, ``selection``, ``groups``, ``stiffness``, ``clearance``, ``left-out``,
        ``assumptions``, ``nomenclature`` and ``provenance``.
    first_page : FirstPage
        The answer, what it rests on, and what to do where it is no.
    inputs : InputsSection
        What the study asks for.
    pose : PoseSection or None
        The configured pose.
    workspace : WorkspaceSection or None
        All poses.
    selection : SelectionSection or None
        The choice of a rope.
    groups : GroupsSection or None
        Products for groups of cables.
    stiffness : StiffnessSection or None
        How far a force moves the platform.
    clearance : ClearanceSection or None
        How near cables come to each other and to the platform.
    left_out : LeftOutSection or None
        Grades that were not considered.
    assumptions : AssumptionsSection
        Figures within the text of the assumptions.
    provenance : ProvenanceSection
        Where the numbers come from.
    """

    title: str
    generator: str
    created: str
    created_iso: str
    missing: str
    headings: tuple[Heading, ...]
    first_page: FirstPage
    inputs: InputsSection
    pose: PoseSection | None
    workspace: WorkspaceSection | None
    selection: SelectionSection | None
    groups: GroupsSection | None
    stiffness: StiffnessSection | None
    clearance: ClearanceSection | None
    left_out: LeftOutSection | None
    assumptions: AssumptionsSection
    provenance: ProvenanceSection

    def heading(self, section_id: str) -> Heading:
        """Return the heading of a section that this report has."""
        return next(heading for heading in self.headings if heading.id == section_id)


def build_context(analysis: Analysis, pictures: Pictures) -> ReportContext:
    """Return what the report shows of an analysis.

    Parameters
    ----------
    analysis : Analysis
        All results.
    pictures : Pictures
        Figures drawn from them.
    """
    findings = find(analysis)
    return ReportContext(
        title=analysis.study.name,
        generator=f"cdpr-designer {analysis.provenance.version}",
        created=created(analysis),
        created_iso=analysis.provenance.created.isoformat(timespec="seconds"),
        missing=pictures.missing,
        headings=_headings(analysis),
        first_page=first_page(analysis, findings, pictures.robot),
        inputs=inputs_section(analysis),
        pose=pose_section(analysis, pictures.loop_chart, pictures.pose_scene),
        workspace=workspace_section(analysis, findings, pictures),
        selection=selection_section(analysis, findings, pictures),
        groups=groups_section(analysis, pictures.groups),
        stiffness=stiffness_section(analysis, pictures.stiffness),
        clearance=clearance_section(analysis, pictures.clearance),
        left_out=left_out_section(analysis),
        assumptions=assumptions_section(analysis),
        provenance=provenance_section(analysis),
    )


def _headings(analysis: Analysis) -> tuple[Heading, ...]:
    qualities = analysis.qualities
    present = {
        "answer": ("The answer", True),
        "inputs": ("Inputs", True),
        "pose": ("The configured pose", analysis.pose is not None),
        "workspace": ("The workspace", analysis.workspace is not None),
        "selection": ("The choice of a rope", analysis.selection is not None),
        "groups": ("Products for groups of cables", analysis.groups is not None),
        "stiffness": ("Stiffness", qualities is not None and qualities.stiffness is not None),
        "clearance": ("Clearance", qualities is not None and qualities.interference is not None),
        "left-out": ("Grades left out", analysis.study.selection is not None),
        "assumptions": ("Assumptions and limits", True),
        "nomenclature": ("Names of quantities", True),
        "provenance": ("Provenance", True),
    }
    shown = [(name, title) for name, (title, is_shown) in present.items() if is_shown]
    return tuple(Heading(name, k, title) for k, (name, title) in enumerate(shown, start=1))
