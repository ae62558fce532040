"""The robot of a study as other programs get it: as built, at rest, on the cables of the design."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from designer import __version__
from designer.analysis.analyse import Analysis
from designer.analysis.lengths import design_cable_of
from designer.arrays import FloatArray, frozen_array
from designer.errors import InputError, one_line
from designer.grades.registry import Catalogue
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.model.winches import Winches
from designer.progress import SILENT, Reporter
from designer.selection.assignment import DesignCable
from designer.statics.inverse import Statics, solve_sagging
from designer.study import Study, as_built_by, declared_settings

_THINNEST = 0.1
"""Edge of such a box over its longest, where attachments lie in a plane or on a line."""
_READ = ("selection.chosen",)
"""Of ``result.json``: nothing is computed that only other parts of it show."""


@dataclass(frozen=True, slots=True)
class Export:
    """What is written for another program."""

    files: Mapping[str, bytes]  #: content of each file by its name, that of the user first
    #: what the study has and the files do not, a line each; it stands in the files as well
    lost: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ExportedRobot:
    """A study as the formats take it; what is solved for it is solved when it is first read."""

    analysis: Analysis  #: of the study; see `of`

    @classmethod
    def of(
        cls,
        study: Study,
        catalogue: Catalogue | None = None,
        reporter: Reporter = SILENT,
        *,
        with_maps: bool = False,
    ) -> ExportedRobot:
        """Return the robot of a study; parameters are those of `designer.analyse`.

        ``with_maps`` also keeps what maps of the workspace are drawn from. No proof is tried: where
        one comes upon a worse pose than the search, a report may choose a thicker rope.

        Raises
        ------
        InputError
            If the study cannot be answered.
        """
        keep = None if with_maps else _READ
        return cls(Analysis.begin(study.unproved, catalogue, reporter=reporter, keep=keep))

    @property
    def study(self) -> Study:
        """The study."""
        return self.analysis.study

    def has_ropes(self) -> bool:
        """Tell whether the design comes to ropes of the catalogue.

        Raises
        ------
        InputError
            If the study does not ask for them.
        """
        if self.study.selection is None:
            problem = "is missing: without a rope there is nothing to cut"
            expected = "a selection of grades, and the workspace that it is for"
            raise InputError([self.study.source.fault("selection", problem, expected)])
        return self.analysis.assignment.is_found

    @cached_property
    def robot(self) -> Robot:
        """The robot as the declared effects have it, at rest."""
        return as_built_by(self.study).robot.at_rest

    @cached_property
    def design(self) -> DesignCable | None:
        """Its cables, as `designer lengths` has them; None where no rope serves the study."""
        return design_cable_of(self.analysis)

    @cached_property
    def reference(self) -> Statics:
        """The equilibrium at the configured pose or, without one, at the worst place (no axes).

        Raises
        ------
        InputError
            If the cables of the design do not hold it.
        """
        statics = self._at(self.reference_pose)
        if not statics.is_solved:
            assert self.design is not None
            reason = Verdict(int(statics.verdict)).label
            problem = f"the robot at rest is not held there by {self.design.name} ({reason})"
            expected = "a pose in which the cables of the design are in equilibrium"
            raise InputError([self.study.source.fault("pose", problem, expected)])
        return statics

    @cached_property
    def worst(self) -> Statics | None:
        """The equilibrium where the cables are used most; None without a workspace.

        Also None where the platform is not held there at rest, but in a load case alone.
        """
        if self.study.workspace is None:
            return None
        statics = self._at(self.worst_pose)
        return statics if statics.is_solved else None

    @property
    def lost_of_cables(self) -> list[str]:
        """What a format that takes cables as springs does not know of those of the design."""
        design, lost = self.design, []
        assert design is not None
        if self.study.selection is not None and not design.ropes:
            lost.append(f"a rope, as none serves; cables are {design.name}")
        if any(rope.cable.stiffening for rope in design.ropes):
            lost.append("EA that depends on the tension; it is that of the largest tension met")
        if self.robot.attached:
            lost.append("what is attached along cables, but for its mass where cables have theirs")
        return lost

    @property
    def lost_worst(self) -> list[str]:
        """A line where the worst pose lacks though there is a workspace."""
        is_lost = self.study.workspace is not None and self.worst is None
        return ["the worst pose, in which the platform is not held at rest"] if is_lost else []

    @property
    def reference_pose(self) -> Poses:
        """The configured pose or, without one, the worst."""
        return self.worst_pose if self.study.pose is None else self.study.pose

    @property
    def worst_pose(self) -> Poses:
        """Where the cables are used most of all the workspace, whatever the load case."""
        analysis = self.analysis
        if analysis.ropes is not None:
            return Poses.at(analysis.ropes.place)
        assert analysis.workspace is not None
        assert analysis.workspace.sagging is not None
        return analysis.workspace.sagging.pose

    def _at(self, pose: Poses) -> Statics:
        assert self.design is not None
        return solve_sagging(self.robot, pose, self.design.cable)

    def heading(self, lost: Sequence[str], *, names_cables: bool = True) -> list[str]:
        """Return the lines that begin a file: where it is from, its cables, and what is lost."""
        study, sha = self.study, self.study.source.sha256
        lines = [
            f"{one_line(study.name)}, exported by cdpr-designer {__version__}",
            f"from {study.source.path.name}" + (f", SHA-256 {sha}" if sha else ""),
            "SI units: m, kg, s, N, rad",
        ]
        if names_cables and self.design is not None:
            lines.append(f"Cables: {self.design.name}")
        return lines + [f"Not in this file: {line}" for line in lost]


def lost_by_all(study: Study, taken: Sequence[str] = ()) -> list[str]:
    """Return what no file for a simulation takes of a study, a line each.

    ``taken`` are fields of `Winches` that this one does take.
    """
    lost, space = [], study.workspace
    if study.load_cases:
        names = ", ".join(case.name for case in study.load_cases)
        lost.append(f"load cases ({names}); the platform is at rest under the loads of robot")
    if space is not None:
        limits = {"clearance": space.clearance_m, "floor": space.floor_m}
        named = [name for name, value in limits.items() if value is not None]
        if named:
            lost.append(f"what the workspace asks for: {', '.join(named)}")
        if space.region.is_discrete:
            lost.append("the listed poses or the path of the workspace, with its times")
    if study.selection is not None:
        lost.append("how the rope was chosen, with its limits, its factors of safety and a proof")
    winches, plain = study.robot.winches, Winches()
    changed = [
        field.name
        for field in fields(winches)
        if field.name not in taken
        and not np.array_equal(getattr(winches, field.name), getattr(plain, field.name))
    ]
    if changed:
        lost.append(f"what the study has of its winches: {', '.join(changed)}")
    if study.measurements is not None:
        lost.append("measured data")
    if study.uncertainty is not None:
        lost.append("what is uncertain")
    settings = declared_settings(study)
    unseen = [setting.effect.key for setting in settings if not setting.effect.reaches_design]
    if unseen:
        lost.append(f"effects that do not reach a design: {', '.join(unseen)}")
    return lost


def numbers(*values: float) -> str:
    """Return numbers with all their digits; 0.0 makes a plain zero of −0."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def xml_document(heading: Iterable[str], lines: Iterable[str]) -> bytes:
    """Return an XML file with a comment at its head."""
    comment = [re.sub("-(?=-)", "- ", line) for line in heading]  # two would end a comment
    head = ['<?xml version="1.0" encoding="utf-8"?>', "<!--", *comment, "-->"]
    return ("\n".join([*head, *lines]) + "\n").encode()


def inertia_of(body: Platform) -> FloatArray:
    """Return the moments of inertia about the centre of mass (3, 3), body frame [kg·m²].

    Where the study gives none, those of a solid box as large as the attachments lie apart.
    """
    if body.inertia_kg_m2 is not None:
        return body.inertia_kg_m2
    assert body.attachments_m is not None
    edges_m = np.ptp(body.attachments_m, axis=0)
    square = np.maximum(edges_m, _THINNEST * edges_m.max()) ** 2
    return np.asarray(body.mass_kg / 12.0 * np.diag(square.sum() - square))


def levelled(robot: Robot, poses: Poses) -> tuple[Robot, Poses, str]:
    """Return robot and poses in a frame in which things fall along −z, and what was turned.

    For programs that know no other gravity. A planar robot then lies in the x-z plane. The text is
    empty where nothing is turned.
    """
    rotation = robot.level
    if np.allclose(rotation, np.eye(3), rtol=0.0, atol=1e-15):
        return robot, poses, ""
    body, winches = robot.platform, robot.winches
    wrench_N = (body.wrench_N.reshape(2, 3) @ rotation.T).ravel()
    if winches.positions_m is not None:
        winches = replace(winches, positions_m=frozen_array(winches.positions_m @ rotation.T))
    level = replace(
        robot,
        exit_points_m=frozen_array(robot.exit_points_m @ rotation.T),
        platform=replace(body, wrench_N=frozen_array(wrench_N)),
        tilt_rad=frozen_array(np.zeros(2)),
        gravity_direction=frozen_array([0.0, 0.0, -1.0]),
        winches=winches,
    )
    rows = "; ".join(" ".join(f"{x:.9g}" for x in row) for row in rotation.tolist())
    note = f"the frame of the study: coordinates here are [{rows}] times those"
    return level, Poses(poses.position_m @ rotation.T, rotation @ poses.rotation), note
