"""The pipeline: from a study to everything that the report shows."""

from __future__ import annotations

import re
import shutil
import weakref
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from designer import checked
from designer.analysis.findings import Findings, find
from designer.analysis.governing import (
    GoverningPose,
    GoverningRopes,
    PlatformModes,
    governing_pose,
    governing_ropes,
    modes_of,
)
from designer.analysis.path import PathAnalysis, path_of, path_requirements
from designer.analysis.pose import PoseAnalysis, analyse_pose
from designer.analysis.provenance import Provenance
from designer.analysis.reactions import Reaction, reactions_of
from designer.analysis.requirements import Terms, requirements_of, terms_of
from designer.analysis.sensitivity import (
    Sensitivities,
    SensitivityReport,
    group_sensitivities,
    sensitivity_report,
)
from designer.analysis.uncertainty import UncertaintyAnalysis, uncertainty_of
from designer.analysis.verification import SecondAnswer, second_answers
from designer.documents.plain import is_requested
from designer.effects.design import AsBuilt
from designer.grades.registry import Catalogue, load_catalogue
from designer.model.cable import Cable
from designer.model.load_case import STATIC, Loaded
from designer.model.robot import Poses
from designer.model.verdict import Answer, Requirement, State, Verdict, answer_of
from designer.progress import SILENT, Reporter
from designer.proof.prove import Budget
from designer.proof.servable import Servable, servable
from designer.selection.assignment import Assignment, Qualities, for_all, qualities_of
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult
from designer.selection.criteria import CaseLoads
from designer.selection.family import CaseNeed, family_needs, governing_need
from designer.selection.groups import GroupChoice, choose_groups_of
from designer.selection.result import SelectionResult
from designer.selection.select import select
from designer.sizing.newton import Sizing, size_poses
from designer.statics.free_motion import FreeMotion, free_motion
from designer.statics.inverse import Statics, solve_sagging
from designer.study import Study, as_built_by, require_answerable
from designer.workspace.effort import MOTION
from designer.workspace.section import section_of_workspace
from designer.workspace.sweep import HangingCables, WorkspaceMap, map_workspace

if TYPE_CHECKING:
    from designer.report.plot import Plots


_METAL_KG_PER_M3 = 2500.0
"""Over the nominal circle: of wire ropes 3800 at least, of fibre ropes 1640 at most."""
_NEEDS_CHOSEN_ONLY = re.compile(
    r"(name|positive|answer|pose|workspace|load_cases"
    r"|selection\.chosen(?!\.(continuous_diameter_m|outcome)$))(\.|$)"
).match
"""Whether a path of ``result.json`` needs the chosen rope alone."""
_STAGES = (
    *("pose", "workspace", "selection", "groups", "needs", "qualities", "requirements", "terms"),
    *(
        "path",
        "reactions",
        "verification",
        "sensitivity",
        "group_slopes",
        "servable",
        "uncertainty",
    ),
    *("worst_sizing", "outside", "governing", "findings", "modes"),
)
"""In the order in which their progress is shown."""


class TemporaryFolder:
    """A temporary folder that goes when nothing refers to this any more, or after a killed run."""

    def __init__(self) -> None:
        from filelock import FileLock, Timeout

        self.folder = Path(mkdtemp(prefix="designer-"))
        lock = FileLock(self.folder / "lock", thread_local=False)
        weakref.finalize(self, _remove_locked, lock)
        with suppress(NotImplementedError):  # a file system without locks
            lock.acquire()
        for path in self.folder.parent.glob("designer-*/lock"):  # nobody holds a killed run's
            with suppress(OSError, Timeout, NotImplementedError):
                if path.parent.lstat().st_uid == self.folder.stat().st_uid:
                    left_over = FileLock(path, timeout=0)
                    left_over.acquire()
                    _remove_locked(left_over)


def _remove_locked(lock: Any) -> None:
    lock.release()  # Windows removes no file that is open
    shutil.rmtree(Path(lock.lock_file).parent, ignore_errors=True)


@dataclass(frozen=True, eq=False, repr=False)
class Analysis(checked.Shown):
    """All that is computed of a study, each stage when it is first read.

    Whoever reads the answer alone has nothing computed that does not change it; `analyse` returns
    one in which every stage is.

    Parameters
    ----------
    study : Study
        The problem.
    catalogue : Catalogue
        The grades that ropes are chosen from.
    provenance : Provenance
        Versions and time.
    folder : Path, optional
        Existing folder that receives ``workspace.nc``; if left out, a temporary one, which goes
        with this value.
    reporter : Reporter
        Shows the progress of stages.
    keep : sequence of str, optional
        Paths of ``result.json`` that will be read; all if left out.
    """

    study: Study
    catalogue: Catalogue
    provenance: Provenance
    folder: Path | None = None
    reporter: Reporter = field(default=SILENT, repr=False)
    keep: Sequence[str] | None = None

    @classmethod
    def begin(
        cls,
        study: Study,
        catalogue: Catalogue | None = None,
        folder: Path | None = None,
        reporter: Reporter = SILENT,
        keep: Sequence[str] | None = None,
    ) -> Analysis:
        """Return the analysis of a study that can be answered; nothing is computed yet.

        Parameters are those of `analyse`, and ``keep`` of the class.

        Raises
        ------
        InputError
            If the study has neither pose nor workspace, the robot has fewer cables than degrees
            of freedom, or a grade is not in the catalogue.
        """
        require_answerable(study)
        if catalogue is None:
            catalogue = load_catalogue(study.catalogues)
        catalogue.require_grades_of(study)
        return cls(study, catalogue, Provenance.now(study), folder, reporter, keep)

    def is_read(self, part: str) -> bool:
        """Tell whether a part of ``result.json`` is read, such as ``workspace.servable``."""
        return is_requested(part, self.keep)

    @cached_property
    def pose(self) -> PoseAnalysis | None:
        """The configured pose alone; None where the study has none."""
        return None if self.study.pose is None else analyse_pose(self.study)

    @cached_property
    def free_motion(self) -> FreeMotion | None:
        """A motion that no cable resists in any pose of the study; known before any is solved."""
        study, workspace = self.study, self.study.workspace
        if workspace is not None:
            landmarks = workspace.space.landmarks()
            poses = Poses.at(np.concatenate([landmarks, workspace.thinned(MOTION)]))
        elif study.pose is not None:
            poses = study.pose.flat
        else:
            return None
        return free_motion(study.robot, poses)

    @cached_property
    def section_m(self) -> float | None:
        """Diameter whose mass, stiffness and strength stand for the configured family [m].

        None where the declared effects leave it a family, see `designer.workspace.section`.
        """
        workspace, material = self.study.workspace, self.study.material
        if workspace is None:
            return None
        return section_of_workspace(as_built_by(self.study), workspace, material)

    @cached_property
    def built(self) -> AsBuilt:
        """Robot and cables with the declared effects, as everything here is solved."""
        return as_built_by(self.study, self.section_m)

    @cached_property
    def workspace(self) -> WorkspaceMap | None:
        """What the configured family needs in the workspace; None where the study has none."""
        study, built = self.study, self.built
        if study.workspace is None:
            return None
        folder = self.folder or (self._scratch.folder if self.keep is None else None)
        with self.reporter.task("workspace", study.workspace.sample_count) as advance:
            return map_workspace(
                built.robot,
                study.workspace,
                built.material(study.material),
                file=folder and folder / "workspace.nc",
                attributes={
                    "title": study.name,
                    "source": f"cdpr-designer {self.provenance.version}",
                    "config_sha256": study.source.sha256,
                    "history": f"{self.provenance.created.isoformat(timespec='seconds')} created",
                },
                progress=advance,
                with_massless=self.is_read("workspace.massless") or self.is_read("findings"),
            )

    @cached_property
    def _scratch(self) -> TemporaryFolder:
        return TemporaryFolder()

    @cached_property
    def selection(self) -> SelectionResult | None:
        """One rope for all cables; None without a workspace or a selection."""
        workspace, selection = self.study.workspace, self.study.selection
        if workspace is None or selection is None:
            return None
        return select(
            self.built.robot,
            workspace,
            selection,
            self.catalogue.grades,
            built=self.built,
            load_cases=self.study.load_cases,
            reporter=self.reporter,
            proof_s=0.0 if selection.groups else workspace.proof_s,
            explains=self.keep is None or not all(map(_NEEDS_CHOSEN_ONLY, self.keep)),
        )

    @cached_property
    def groups(self) -> GroupChoice | None:
        """How a rope for each group was sought; None where the selection has no groups."""
        workspace, selection = self.study.workspace, self.study.selection
        if workspace is None or selection is None or not selection.groups:
            return None
        grades, single = self.catalogue.grades, self.chosen
        return choose_groups_of(workspace, selection, grades, self.built, single, self.reporter)

    @property
    def assignment(self) -> Assignment:
        """Which rope goes onto which cable; without ropes where none were found or asked for."""
        return for_all(self.chosen) if self.groups is None else self.groups.chosen

    @cached_property
    def needs(self) -> tuple[CaseNeed, ...]:
        """What each load case needs of the configured family, where the study asks for no rope."""
        return family_needs(self.study, self.built, self.reporter)

    @cached_property
    def qualities(self) -> Qualities | None:
        """Stiffness and clearances; None unless a cable holds in all of a workspace."""
        survey, material = self.workspace, self.study.material
        if survey is None:
            return None
        ropes = self.assignment, self.built, material, self.needs
        return qualities_of(survey.workspace, survey, *ropes)

    @cached_property
    def loads(self) -> tuple[CaseLoads, ...]:
        """The load cases with the cables of the design, each in all directions; () without."""
        if self.qualities is None:
            return ()
        workspace, robot = self.qualities.workspace, self.qualities.robot
        cable = cast(Cable, self.qualities.cable.cable)  # or `Cables`, of the same figures
        if not self.study.load_cases:
            return (CaseLoads(workspace, (Loaded(STATIC, (robot, cable), robot, cable),)),)
        return tuple(
            CaseLoads(workspace.of_case(case), tuple(case.on(robot, cable)))
            for case in self.study.load_cases
        )

    @cached_property
    def requirements(self) -> tuple[Requirement, ...]:
        """All that the study asks for, in every load case; the answer follows from these alone."""
        return (*requirements_of(self), *path_requirements(self))

    @cached_property
    def cases(self) -> tuple[CaseResult, ...]:
        """What the chosen rope, or the configured family where none is asked for, meets."""
        if self.chosen is not None:
            return self.chosen.cases
        return tuple(need.governing for need in self.needs)

    @cached_property
    def governing(self) -> GoverningPose | None:
        """The pose at which the chosen rope for all cables is used most; None without one."""
        chosen, selection = self.chosen, self.study.selection
        if chosen is None or selection is None:
            return None
        return governing_pose(chosen, selection.safety_factor)

    @cached_property
    def ropes(self) -> GoverningRopes | None:
        """The ropes of the answer as loaded where they are used most; None without any."""
        return governing_ropes(self)

    @cached_property
    def modes(self) -> PlatformModes | None:
        """How the platform oscillates there; None where nothing holds it or inertia lacks."""
        return modes_of(self)

    @cached_property
    def worst_sizing(self) -> Sizing | None:
        """The cable that the worst pose of the workspace needs; None where none is finite."""
        survey = self.workspace
        if survey is None or survey.sagging is None:
            return None
        material = self.built.material(self.study.material)
        return size_poses(self.built.robot, survey.sagging.pose, material, proves_thinnest=True)

    @cached_property
    def outside(self) -> Statics | None:
        """The design in the configured pose, where that is not one of the workspace."""
        pose, qualities = self.study.pose, self.qualities
        if not self.study.pose_outside or pose is None or qualities is None:
            return None
        return solve_sagging(self.built.robot, pose, qualities.cable.cable)

    @cached_property
    def findings(self) -> Findings:
        """What a reviewer asks next."""
        return find(self)

    @cached_property
    def verification(self) -> tuple[SecondAnswer, ...]:
        """The governing poses, solved again by other methods."""
        return second_answers(self)

    @cached_property
    def sensitivity(self) -> SensitivityReport | None:
        """What the choice of a rope for all cables rests on; None without one."""
        return sensitivity_report(self.study, self.selection, self.assignment.rope)

    @cached_property
    def group_slopes(self) -> tuple[Sensitivities, ...]:
        """What the utilisation of each group of cables answers to."""
        return group_sensitivities(self.built.robot, self.study.workspace, self.assignment)

    @cached_property
    def servable(self) -> Servable | None:
        """Which part of the region no rope can serve; None where nothing speaks for such a part."""
        survey = self.workspace
        if survey is None or survey.workspace.proof_s == 0.0:
            return None
        workspace, counts = survey.workspace, survey.census.statuses
        if not any(counts[v.label] for v in Verdict if v.questions_all_ropes):
            return None
        with self.reporter.task("impossible", 1):
            return servable(self.built.robot, workspace.space, Budget(workspace.proof_s))

    @cached_property
    def uncertainty(self) -> UncertaintyAnalysis | None:
        """How likely the chosen rope is enough where inputs are not certain."""
        return uncertainty_of(self.study, self.selection, self.built, self.reporter)

    @cached_property
    def path(self) -> PathAnalysis | None:
        """What the winches do along the path of the study; None without one, or without cables."""
        return path_of(self)

    @cached_property
    def reactions(self) -> tuple[Reaction, ...]:
        """What the cables of the design do to their supports; nothing where none holds."""
        if not self.loads:
            return ()
        with self.reporter.task("reactions", len(self.loads)) as advance:
            return reactions_of(self.loads, advance)

    @property
    def plot(self) -> Plots:
        """The figures of the report, as Matplotlib axes and PyVista scenes."""
        # What draws stands above this room, and is loaded when it is first asked for.
        plots: Plots = import_module("designer.report.plot").Plots(self)
        return plots

    def summary(self) -> dict[str, str]:
        """Return the answer, as far as it is computed already."""
        if "requirements" not in vars(self):
            return {"study": self.study.name, "answer": "not computed yet"}
        count = len(self.requirements)
        answer = f"{self.answer.value}, {count - len(self.unmet)} of {count} requirements hold"
        shown = {"study": self.study.name, "answer": answer}
        if self.chosen is not None:
            shown["rope"] = self.chosen.name
            shown["utilisation"] = f"{self.chosen.verification.utilisation:.1%}"
        return shown

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

    @cached_property
    def terms(self) -> Terms:
        """What the answer covers, what was not asked, and what a yes is subject to."""
        return terms_of(self)

    @property
    def own_material(self) -> str | None:
        """Material of the configured family; of one by its figures steel or not known."""
        if self.study.family is not None:
            return self.catalogue.grade(self.study.family.grade).material
        return "steel" if self.study.material.density_kg_per_m3 > _METAL_KG_PER_M3 else None

    @property
    def unmet(self) -> tuple[Requirement, ...]:
        """Requirements that fail, then those of which it is not known."""
        unmet = [requirement for requirement in self.requirements if not requirement.holds]
        return tuple(sorted(unmet, key=lambda requirement: requirement.state is State.OPEN))

    @property
    def governing_need(self) -> CaseNeed | None:
        """The load case that needs the thickest cable of the family, or one that none holds."""
        return governing_need(self.needs)

    @property
    def chosen(self) -> Candidate | None:
        """The product chosen for all cables; None without one."""
        return self.selection.chosen if self.selection is not None else None


def analyse(
    study: Study,
    catalogue: Catalogue | None = None,
    folder: Path | None = None,
    reporter: Reporter = SILENT,
) -> Analysis:
    """Size the pose, sweep the workspace, choose a product; every stage is computed here.

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

    Raises
    ------
    InputError
        If the study has neither pose nor workspace, the robot has fewer cables than degrees of
        freedom, or a grade is not in the catalogue.
    """
    return finished(Analysis.begin(study, catalogue, folder, reporter))


def finished(analysis: Analysis) -> Analysis:
    """Return an analysis of which every stage is computed: that of a report."""
    with analysis.reporter.task("stages", len(_STAGES)) as advance:
        for stage in _STAGES:
            getattr(analysis, stage)
            advance(1)
    if analysis.pose is not None:
        _ = analysis.pose.rest
    if analysis.ropes is not None:
        _ = analysis.ropes.worst, analysis.ropes.straight
    if (surveyed := analysis.qualities) is not None:
        _ = surveyed.stiffness, surveyed.interference, surveyed.hanging
    for case in analysis.cases:
        _ = case.most_used
    return analysis
