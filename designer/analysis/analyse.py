"""The pipeline: from a study to everything that the report shows."""

from __future__ import annotations

import platform
import shutil
import weakref
from dataclasses import dataclass, field, replace
from datetime import datetime
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np

from designer import __version__
from designer.analysis.carries import Carries, carries_of
from designer.analysis.group_slopes import GroupSlopes, group_slopes
from designer.analysis.requirements import requirements_of
from designer.analysis.uncertainty.uncertainty import UncertaintyAnalysis, uncertainty_of
from designer.analysis.verification import SecondAnswer, second_answers
from designer.effects.design import AsBuilt
from designer.errors import InputError
from designer.grades.registry import Catalogue, load_catalogue
from designer.model.cable import Material
from designer.model.requirement import Answer, Requirement, State, answer_of
from designer.model.verdict import Verdict
from designer.progress import SILENT, Reporter
from designer.proof.prove import Budget
from designer.proof.servable import Servable, servable
from designer.selection.family_need import CaseNeed, family_needs, most_needed
from designer.selection.groups.choose import choose_groups_of
from designer.selection.groups.result import GroupChoice
from designer.selection.qualities import Qualities, qualities_of
from designer.selection.result import Candidate, SelectionResult
from designer.selection.select import select
from designer.sizing.limit import limit_ratio
from designer.sizing.loop import LoopSizing, size_by_loop
from designer.sizing.newton import Sizing, size_poses
from designer.statics.inverse import MasslessStatics, solve_massless
from designer.statics.rest import RestingPlaces, resting_places
from designer.study import (
    Selection,
    Study,
    Workspace,
    as_built_by,
    require_answerable,
    require_enough_cables,
)
from designer.workspace.hanging import HangingCables
from designer.workspace.result import WorkspaceMap
from designer.workspace.section import section_of_pose, section_of_workspace
from designer.workspace.sweep import map_workspace


@dataclass(frozen=True, slots=True, eq=False)
class PoseAnalysis:
    """The configured pose alone.

    Parameters
    ----------
    material : Material
        The family as built.
    sizing : Sizing
        Optimum by Newton, no leading axes.
    massless : MasslessStatics
        Straight weightless cables.
    loop : LoopSizing
        The basic loop with its iterates.
    limit_ratio : float
        Stress at infinite section over allowable stress; at 1 no finite cable is left.
    rest : RestingPlaces or None
        Whether the platform stays there on cables of the optimum; None where there is none.
    """

    material: Material
    sizing: Sizing
    massless: MasslessStatics
    loop: LoopSizing
    limit_ratio: float
    rest: RestingPlaces | None

    @property
    def caution(self) -> str:
        """What a reader must know of cables that hang below the platform; empty if none does."""
        statics = self.sizing.statics
        if not (statics.is_solved and statics.hangs_below):
            return ""
        chord_m = statics.geometry().chord_m
        each = [
            f"Cable {k + 1} hangs below the platform, {statics.length_m[k]:.4g} m long over a "
            f"distance of {chord_m[k]:.4g} m."
            for k in np.flatnonzero(statics.hanging_cables)
        ]
        if not np.isfinite(self.sizing.massless_tension_N):
            each.append("Straight cables cannot hold this pose: what hangs there is a weight.")
        return " ".join(each)


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where the numbers come from.

    Parameters
    ----------
    version : str
        Of this program.
    libraries : tuple of (name, version)
        What computed and drew them.
    system : str
        Operating system and Python.
    created : datetime
        When the analysis was started.
    """

    version: str
    libraries: tuple[tuple[str, str], ...]
    system: str
    created: datetime

    @classmethod
    def now(cls, study: Study | None = None) -> Provenance:
        """Return the provenance of an analysis that starts now, with what the study asks for."""
        names = ["numpy", "scipy", "numba", "xarray", "pyvista", "matplotlib", "plutoprint"]
        if study is not None:
            has_groups = study.selection is not None and bool(study.selection.groups)
            if has_groups or study.robot.is_redundant:  # chosen by mathematical programmes
                names += ["cvxpy", "highspy"]
        return cls(
            version=__version__,
            libraries=tuple((name, version(name)) for name in names if find_spec(name)),
            system=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
            created=datetime.now().astimezone(),
        )


class Scratch:
    """A temporary folder that goes when nothing refers to this any more."""

    def __init__(self) -> None:
        self.folder = Path(mkdtemp(prefix="designer-"))
        weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """Everything that the report shows.

    Parameters
    ----------
    study : Study
        The problem.
    catalogue : Catalogue
        The grades it was solved with.
    provenance : Provenance
        Versions and time.
    pose : PoseAnalysis or None
        If the study has a pose.
    workspace : WorkspaceMap or None
        If the study has a workspace.
    selection : SelectionResult or None
        If the study has a workspace and a selection.
    groups : GroupChoice or None
        If the selection has groups of cables.
    requirements : tuple of Requirement
        All that the study asks for, in every load case; the answer follows from these alone.
    qualities : Qualities or None
        Stiffness and clearances, if the study has a workspace and a cable holds in all of it.
    section_m : float or None
        Diameter whose mass, stiffness and strength stand for the configured family; None where the
        declared effects leave it a family, see `designer.workspace.section` [m].
    verification : tuple of SecondAnswer
        The governing poses, solved again by other methods.
    carries : Carries or None
        What carries the choice of a rope for all cables.
    needs : tuple of CaseNeed
        What each load case needs of the configured family, where the study asks for no rope.
    group_slopes : tuple of GroupSlopes
        What the utilisation of each group of cables answers to.
    servable : Servable or None
        Which part of the region no rope can serve; None where nothing speaks for such a part.
    uncertainty : UncertaintyAnalysis or None
        How likely the chosen rope is enough where inputs are not certain.
    scratch : Scratch or None
        Folder that goes with this value, where no other was given for the samples.
    """

    study: Study
    catalogue: Catalogue
    provenance: Provenance
    pose: PoseAnalysis | None
    workspace: WorkspaceMap | None
    selection: SelectionResult | None
    groups: GroupChoice | None = None
    requirements: tuple[Requirement, ...] = ()
    qualities: Qualities | None = None
    section_m: float | None = None
    verification: tuple[SecondAnswer, ...] = ()
    carries: Carries | None = None
    needs: tuple[CaseNeed, ...] = ()
    group_slopes: tuple[GroupSlopes, ...] = ()
    servable: Servable | None = None
    uncertainty: UncertaintyAnalysis | None = None
    scratch: Scratch | None = field(default=None, repr=False)

    @property
    def sweep_file(self) -> Path | None:
        """NetCDF file with every sample, if the study has a workspace."""
        return None if self.workspace is None else self.workspace.file

    def to_dict(self) -> dict[str, Any]:
        """Return what ``result.json`` holds: plain values under stable names."""
        from designer.analysis.result_json import result_dict

        return result_dict(self)

    def to_json(self) -> str:
        """Return what ``result.json`` holds, as text."""
        from designer.documents.plain import json_text

        return json_text(self.to_dict())

    @property
    def built(self) -> AsBuilt:
        """Robot and cables with the declared effects, as everything here was solved."""
        return as_built_by(self.study, self.section_m)

    @property
    def left_out(self) -> tuple[str, ...]:
        """What plugins and grade files gave that could not be used, one line each."""
        problems = (*self.study.known_effects.problems, *self.catalogue.problems)
        return tuple(dict.fromkeys(problems))

    @property
    def hanging(self) -> HangingCables:
        """Cables that hang too far, with those of the design; else with what each sample needs."""
        if self.qualities is not None:
            return self.qualities.hanging
        return HangingCables() if self.workspace is None else self.workspace.census.hanging

    @property
    def answer(self) -> Answer:
        """Yes if all requirements hold, no if one fails, else open."""
        return answer_of(self.requirements)

    @property
    def is_positive(self) -> bool:
        """Whether the answer is yes."""
        return self.answer is Answer.YES

    @property
    def unmet(self) -> tuple[Requirement, ...]:
        """Requirements that fail, then those of which it is not known."""
        unmet = [requirement for requirement in self.requirements if not requirement.holds]
        return tuple(sorted(unmet, key=lambda requirement: requirement.state is State.OPEN))

    @property
    def most_needed(self) -> CaseNeed | None:
        """The load case that needs the thickest cable of the family, or one that none holds."""
        return most_needed(self.needs)

    @property
    def chosen(self) -> Candidate | None:
        """The product chosen for all cables; None without one."""
        return self.selection.chosen if self.selection is not None else None

    @property
    def has_groups(self) -> bool:
        """Whether products for groups of cables are the answer."""
        return self.groups is not None and self.groups.chosen is not None

    @property
    def has_products(self) -> bool:
        """Whether a product was found, or one for each group where the study has groups."""
        if self.groups is not None:
            return self.groups.chosen is not None
        return self.selection is None or self.chosen is not None


def analyse_pose(study: Study, *, finds_rest: bool = True) -> PoseAnalysis:
    """Size the configured pose in every way.

    ``finds_rest`` is whether other places to rest are looked for, which takes most of the time.

    Raises
    ------
    InputError
        If the study has no pose, or the robot has fewer cables than degrees of freedom.
    """
    require_enough_cables(study)
    if study.pose is None:
        fault = study.source.fault("pose", "is missing", "a pose, such as [250, 200, -50]")
        raise InputError([fault])
    built = as_built_by(study)
    section_m = section_of_pose(built, study.pose, study.material)
    robot, material = built.robot, built.material(study.material, section_m)
    sizing = size_poses(robot, study.pose, material)
    rest = None
    if finds_rest and sizing.statics.is_solved:
        cable = material.cable(float(sizing.diameter_m))
        rest = resting_places(robot, study.pose, cable, sizing.statics.length_m)
    return PoseAnalysis(
        material=material,
        sizing=sizing,
        massless=solve_massless(robot, study.pose),
        loop=size_by_loop(robot, study.pose, material),
        limit_ratio=float(limit_ratio(robot, study.pose, material)),
        rest=rest,
    )


def analyse(
    study: Study,
    catalogue: Catalogue | None = None,
    folder: Path | None = None,
    reporter: Reporter = SILENT,
    *,
    explains: bool = True,
) -> Analysis:
    """Size the pose, sweep the workspace, choose a product.

    Parameters
    ----------
    study : Study
        The problem.
    catalogue : Catalogue, optional
        All grades; if left out, those that are shipped, of plugins, and of the study's own files.
    folder : Path, optional
        Existing folder that receives ``workspace.nc``; a temporary one if left out.
    reporter : Reporter
        Shows progress.
    explains : bool
        False leaves out what changes no answer and takes its time: second answers, what carries
        the result, which part of the region no rope can serve, how likely the rope is enough.

    Raises
    ------
    InputError
        If the study has neither pose nor workspace, the robot has fewer cables than degrees of
        freedom, or a grade is not in the catalogue.
    """
    require_answerable(study)
    if catalogue is None:
        catalogue = load_catalogue(study.catalogues)
    catalogue.require_grades_of(study)
    scratch = Scratch() if folder is None and study.workspace is not None else None
    if scratch is not None:
        folder = scratch.folder
    provenance = Provenance.now(study)
    pose = None if study.pose is None else analyse_pose(study, finds_rest=explains)
    built = as_built_by(study)
    if study.workspace is not None:
        section_m = section_of_workspace(built, study.workspace, study.material)
        built = replace(built, section_m=section_m)
    workspace = chosen = groups = None
    if study.workspace is not None and folder is not None:
        with reporter.task("workspace", study.workspace.sample_count) as advance:
            workspace = map_workspace(
                built.robot,
                study.workspace,
                built.material(study.material),
                file=folder / "workspace.nc",
                attributes=_attributes(study, provenance),
                progress=advance,
            )
    if study.workspace is not None and study.selection is not None:
        chosen, groups = _ropes(study, study.workspace, study.selection, built, catalogue, reporter)
    needs = family_needs(study, built, reporter)
    qualities = None
    if study.workspace is not None and workspace is not None:
        qualities = qualities_of(
            study.workspace, workspace, chosen, groups, built, study.material, needs
        )
    design = None if qualities is None else qualities.cable
    requirements = requirements_of(
        study, built, pose, workspace, chosen, groups, needs, design, reporter
    )
    return Analysis(
        study,
        catalogue,
        provenance,
        pose,
        workspace,
        chosen,
        groups,
        requirements,
        qualities,
        built.section_m,
        second_answers(study, built, pose, workspace, chosen) if explains else (),
        carries_of(study, chosen) if explains and groups is None else None,
        needs,
        group_slopes(built.robot, study.workspace, groups) if explains and groups else (),
        _servable(study, built, workspace, reporter) if explains else None,
        uncertainty_of(study, chosen, built, reporter) if explains else None,
        scratch,
    )


def _ropes(
    study: Study,
    workspace: Workspace,
    selection: Selection,
    built: AsBuilt,
    catalogue: Catalogue,
    reporter: Reporter,
) -> tuple[SelectionResult, GroupChoice | None]:
    """Select one rope for all cables and, where the study has groups, one for each."""
    chosen = select(
        built.robot,
        workspace,
        selection,
        catalogue.grades,
        built=built,
        load_cases=study.load_cases,
        reporter=reporter,
        proof_s=0.0 if selection.groups else workspace.proof_s,
    )
    if not selection.groups:
        return chosen, None
    grades, single = catalogue.grades, chosen.chosen
    return chosen, choose_groups_of(workspace, selection, grades, built, single, reporter)


def _servable(
    study: Study, built: AsBuilt, found: WorkspaceMap | None, reporter: Reporter
) -> Servable | None:
    """Bound the part that no rope can serve, where samples say that there may be one."""
    if found is None or study.workspace is None or study.workspace.proof_s == 0.0:
        return None
    doubtful = (Verdict.OUTSIDE_HULL, Verdict.NOT_FOUND, Verdict.RANK_DEFICIENT)
    if not any(found.census.statuses[verdict.label] for verdict in doubtful):
        return None
    with reporter.task("impossible", 1):
        return servable(built.robot, study.workspace.space, Budget(study.workspace.proof_s))


def _attributes(study: Study, provenance: Provenance) -> dict[str, str]:
    return {
        "title": study.name,
        "source": f"cdpr-designer {provenance.version}",
        "config_sha256": study.source.sha256,
        "history": f"{provenance.created.isoformat(timespec='seconds')} created",
    }
