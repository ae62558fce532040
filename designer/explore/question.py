"""What is asked for: a study as it stands, a place and a rope; and what comes back."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.effects.design import AsBuilt
from designer.errors import DesignerError, described
from designer.grades.grade import Grade
from designer.grades.registry import Catalogue, cached_catalogue
from designer.model.cable import Cable, Cables, Material
from designer.model.load_case import STATIC, LoadCase
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.plugins import Plugins
from designer.progress import Advance
from designer.selection.candidate import Candidate, candidates_of
from designer.selection.cases import converge_stiffness
from designer.selection.reeving import Allowance
from designer.selection.select import at_samples
from designer.statics.inverse import solve_sagging
from designer.study import Selection, Study, as_built_by, require_enough_cables
from designer.workspace.effort import COARSE
from designer.workspace.section import section_of_pose

Quick = Literal["pose", "coarse", "fine", "ropes", "residuals", "worst", "requirements"]
Long = Literal["select", "diagnose", "export", "optimise", "sweep"]
Kind = Quick | Long
Status = Literal["progress", "done", "failed", "cancelled"]
_REPORT_EVERY_S = 0.1
"""As often as an eye follows; a message costs a thread or a process some time."""


@dataclass(frozen=True, slots=True)
class Rope:
    """A product by its names: one size of one grade."""

    grade_id: str
    size_id: str

    @property
    def label(self) -> str:
        return f"{self.size_id} of {self.grade_id}"


@dataclass(frozen=True, slots=True)
class RopePerCable:
    """A rope for each cable, in the order of the anchors."""

    ropes: tuple[Rope, ...]

    @property
    def label(self) -> str:
        return ", ".join(dict.fromkeys(rope.label for rope in self.ropes))


def cables_words(rope: Rope | RopePerCable | None) -> str:
    return "Thinnest cable of the family" if rope is None else rope.label


@dataclass(frozen=True, eq=False)
class Question:
    """A state of the window, as far as answers depend on it; what follows from it is kept."""

    study: Study = field(repr=False)  #: The problem
    place: FloatArray  #: (6,) where the platform is, and its rotation vector [m, rad]
    #: The rope, or the ropes of groups, that are looked at; None for the thinnest cable of the
    #: configured family
    rope: Rope | RopePerCable | None
    text: str = field(repr=False)  #: The config, and where it lies or its relative paths start from
    path: Path
    plugins: Plugins = field(repr=False)  #: Whose grades are in the catalogue

    @property
    def pose(self) -> Poses:
        """Where the platform is; the study's own pose, to the last digit, where it is there."""
        study_pose = self.study.pose
        if study_pose is not None and np.array_equal(study_pose.place, self.place):
            return study_pose
        is_point = self.study.robot.is_point_mass
        return Poses.at(self.place[:3]) if is_point else Poses.at(self.place)

    @property
    def outside(self) -> str:
        """In what this pose is none of the workspace, in a sentence; or empty."""
        fault = replace(self.study, pose=self.pose).pose_outside
        return f"This pose {fault}." if fault else ""

    @property
    def workspace(self) -> Workspace | None:
        return self.study.workspace

    @property
    def selection(self) -> Selection:
        """How a product is chosen; as usual where the study does not say."""
        return self.study.selection or Selection()

    @cached_property
    def built(self) -> AsBuilt:
        require_enough_cables(self.study)
        has_region = self.workspace is not None
        return as_built_by(
            replace(self.study, selection=self.selection) if has_region else self.study
        )

    @property
    def robot(self) -> Robot:
        return self.built.robot

    @cached_property
    def material(self) -> Material:
        """The configured family as built; where effects leave none, as at this pose."""
        section_m = section_of_pose(self.built, self.pose, self.study.material)
        return self.built.material(self.study.material, section_m)

    @cached_property
    def catalogue(self) -> Catalogue:
        return catalogue_of(self.study, self.plugins)

    @cached_property
    def cable(self) -> Cable | Cables | None:
        """What is looked at, with its figures as the solver takes them; None for the thinnest.

        Raises InputError if the catalogue has no such grade; DesignerError if a grade has no such
        size, the sheave leaves nothing of its strength, or there are more or fewer ropes than
        cables.
        """
        if self.rope is None:
            return None
        if isinstance(self.rope, Rope):
            return self._with_converged_stiffness(self.rope)
        cables = {rope: self._with_converged_stiffness(rope) for rope in self.rope.ropes}
        if len(self.rope.ropes) != self.robot.n_cables:
            raise DesignerError("the ropes of the groups are of a robot with other cables")
        return Cables(tuple(cables[rope] for rope in self.rope.ropes))

    def _grade_of(self, rope: Rope) -> Grade:
        grade = self.catalogue.grade(rope.grade_id)
        sizes = tuple(size for size in grade.sizes if size.id == rope.size_id)
        if not sizes:
            raise DesignerError(f"the grade {grade.id} has no size {rope.size_id}")
        return replace(grade, sizes=sizes)

    def cable_in(self, case: LoadCase, rope: Rope) -> Cable:
        """Return a rope with what it may be used to in a load case."""
        grade = self._grade_of(rope)
        (size,) = grade.sizes
        allowance = Allowance.of(self.selection.under(case), self.robot.winches)
        if not allowance.efficiency(grade, size.diameter_m) > 0.0:
            raise DesignerError(
                f"{rope.label}: the sheave is thinner than the rope, or than a fibre rope may be "
                "bent over"
            )
        return self.built.of_products.cable(allowance.cable(grade, size))

    def _with_converged_stiffness(self, rope: Rope) -> Cable:
        """Return a rope as stiff as at the largest tension that it meets, at few samples."""
        cable = self.cable_in(STATIC, rope)
        if cable.stiffening is None:
            return cable
        if self.workspace is None:
            return converge_stiffness(
                cable,
                lambda stiffened: float(
                    solve_sagging(self.robot, self.pose, stiffened).largest_tension_N
                ),
            )
        naming = replace(self.selection, grades=(rope.grade_id,), materials=())
        (candidate,) = self._at_samples(self.workspace, naming, [self._grade_of(rope)])
        return candidate.cable

    def _at_samples(
        self, workspace: Workspace, selection: Selection, grades: Sequence[Grade]
    ) -> list[Candidate]:
        """Return the sizes of these grades with what they meet at few samples."""
        sampled = workspace.with_fewer_samples(COARSE.slow)
        return at_samples(sampled, selection, grades, self.built, self.study.load_cases)

    @cached_property
    def candidates(self) -> list[Candidate]:
        """All ropes that the study allows, each as stiff as at the largest tension that it meets.

        At few samples, as in `cable`.
        """
        candidates = candidates_of(self.selection, self.catalogue.grades, self.built)
        varying = {c.grade.id: c.grade for c in candidates if c.cable.stiffening is not None}
        if self.workspace is None or not varying:
            return candidates
        sampled = self._at_samples(self.workspace, self.selection, list(varying.values()))
        return [c for c in candidates if c.grade.id not in varying] + sampled


def catalogue_of(study: Study, plugins: Plugins) -> Catalogue:
    """Return the catalogue of a study, read anew only where its files have changed.

    Raises InputError if a file that the study names is faulty, or there is no grade that it names.
    """
    catalogue = cached_catalogue(study.catalogues, plugins)
    catalogue.require_grades_of(study)
    return catalogue


def initial_place(study: Study | None) -> FloatArray:
    """Return where the platform is at first: in the study's pose, else in the middle."""
    if study is None:
        return frozen_array(np.zeros(6))
    if study.pose is not None:
        return frozen_array(study.pose.place)
    middle = study.robot.exit_points_m.mean(axis=0)
    if study.workspace is not None:
        region = study.workspace.region
        middle = region.nearest(region.bounds_m.mean(axis=0)[None])[0]
        return frozen_array(study.workspace.space.first(middle))
    return frozen_array(np.concatenate([middle, np.zeros(3)]))


# What is asked of a worker


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A question of a kind; numbers grow."""

    number: int
    kind: Kind
    question: Question
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    """What becomes of a request: progress, and exactly one end."""

    request: Request  #: What was asked
    #: ``progress``; or the end: ``done``, ``failed``, or ``cancelled``, taken back or replaced by a
    #: newer one
    status: Status
    #: Of a request that is done; None where the study has not what is asked for, such as a
    #: workspace
    answer: Any = None
    text: str = ""  #: What went wrong, for the user as it stands; of progress what is being done
    #: Of progress: how many steps are done, and of how many; a total of 0 is not known
    steps: int = 0
    total: int = 0

    @property
    def number(self) -> int:
        return self.request.number

    @property
    def kind(self) -> Kind:
        return self.request.kind

    @property
    def question(self) -> Question:
        return self.request.question

    @property
    def is_end(self) -> bool:
        return self.status != "progress"


class ThrottledReporter:
    """A reporter, and a spinner, that tell how far something is, a few times a second at most.

    ``tell`` is called with what is being done, how many steps are done, and of how many; 0 of 0
    where that is not known.
    """

    def __init__(self, tell: Callable[[str, int, int], None]) -> None:
        self._tell, self._last_s = tell, -math.inf

    def __call__(self, text: str) -> None:
        self._report(text, 0, 0)

    @contextmanager
    def task(self, name: str, total: int) -> Iterator[Advance]:
        finished, self._last_s = 0, -math.inf

        def advance(steps: int) -> None:
            nonlocal finished
            finished += steps
            self._report(name, finished, total)

        self._report(name, 0, total)
        yield advance

    def _report(self, name: str, steps: int, total: int) -> None:
        now_s = time.monotonic()
        if now_s - self._last_s >= _REPORT_EVERY_S:
            self._last_s = now_s
            self._tell(name, steps, total)


def failure_text(error: BaseException) -> str:
    """Return an error as a user is told of it: our own as they stand, others by their kind."""
    if isinstance(error, DesignerError):
        return str(error)
    return f"unexpected {described(error)}"
