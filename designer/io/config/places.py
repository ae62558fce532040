"""Which poses a study asks for: its region or its list, and how the platform is turned there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.documents.document import Document, Keys
from designer.errors import InputError
from designer.io.config.schema import (
    ORIENTATION_KINDS,
    PathSection,
    StudySection,
    WorkspaceSection,
)
from designer.io.poses import TIME, PoseTable, path_faults, read_poses
from designer.model.cable import Material
from designer.model.motion import Motion, limited, timed
from designer.model.point_list import PointList
from designer.model.region import Region
from designer.model.robot import Robot
from designer.model.space import Orientations
from designer.model.turning import EachPose, Toward, TurnTable
from designer.model.workspace import Workspace
from designer.workspace.best_orientations import BestOrientations

Listed = tuple[Region, Orientations]


@dataclass(frozen=True, slots=True)
class Places:
    """The workspace of a study, and what of a list of poses is for one load case alone.

    ``tables`` are the names and digests of the files that it was read with, ``motion`` is how the
    platform moves from pose to pose.
    """

    workspace: Workspace | None
    of_cases: Mapping[str, Listed] = field(default_factory=dict)
    tables: tuple[tuple[str, str], ...] = ()
    motion: Motion | None = None

    @property
    def are_turned_one_by_one(self) -> bool:
        """Whether only listed poses have an orientation."""
        law = None if self.workspace is None else self.workspace.orientations.law
        return isinstance(law, EachPose)


def places_of(
    section: StudySection, document: Document, robot: Robot, material: Material
) -> Places:
    """Return which poses a study asks for.

    Raises
    ------
    InputError
        If a table that it names cannot be read, or does not fit the rest.
    """
    workspace = section.workspace
    if workspace is None:
        return Places(None)
    build = _Places(document, robot, material)
    if workspace.path is not None:
        places = build.along_path(section, workspace.path)
    elif workspace.region is None:
        places = build.listed(workspace, [case.name for case in section.load_cases])
    else:
        region = workspace.region.over(robot.exit_points_m)
        places = Places(workspace.workspace(region, build.orientations(workspace, region)))
    return replace(places, tables=tuple(build.tables))


@dataclass(frozen=True, slots=True)
class _Places:
    document: Document
    robot: Robot
    material: Material
    tables: list[tuple[str, str]] = field(default_factory=list)

    def _error(self, keys: Keys, problem: str, expected: str = "") -> InputError:
        return InputError([self.document.fault(keys, problem, expected)])

    def _table(self, keys: Keys, name: str) -> PoseTable:
        path = Path(self.document.name).parent / name
        table = read_poses(path, self.robot, partial(self._error, keys))
        self.tables.append((name, table.sha256))
        return table

    def orientations(self, section: WorkspaceSection, region: Region) -> Orientations:
        """Return how the platform is turned over a region."""
        single, free = section.orientation, section.orientation_free
        if free is not None:
            ends = frozen_array(free.bounds_rad)
            law = BestOrientations(self.robot, self.material, region, ends, section.hangs_below)
            return Orientations(law=law)
        if single is not None and single.toward is not None:
            return Orientations(law=Toward(frozen_array(single.toward), frozen_array(single.axis)))
        if single is not None and single.table is not None:
            return Orientations(law=self._turn_table(single.table))
        return section.fixed_orientations()

    def _turn_table(self, name: str) -> TurnTable:
        keys = ("workspace", "orientation", "table")
        places = self._table(keys, name).places
        if places.shape[1] < 6:
            expected = "the columns rx_rad, ry_rad and rz_rad"
            raise self._error(keys, f"{name} has no orientations", expected)
        if len(places) > MOST_ROWS:
            raise self._error(keys, f"{name} has {len(places)} rows", f"at most {MOST_ROWS}")
        if len(np.unique(places[:, :3], axis=0)) < len(places):
            problem = f"{name} has a position in two rows"
            raise self._error(keys, problem, "one orientation for each position")
        position_m, turn_rad = (frozen_array(part) for part in np.hsplit(places, 2))
        return TurnTable(position_m, turn_rad, name)

    def listed(self, section: WorkspaceSection, cases: list[str]) -> Places:
        """Return a list of poses, and what of it is for one load case alone."""
        keys = ("workspace", "poses")
        assert section.poses is not None
        table = self._table(keys, section.poses)
        if table.places.shape[1] == 6:
            for kind in ORIENTATION_KINDS:
                if getattr(section, kind) is not None:
                    problem = f"{section.poses} has orientations of its own"
                    raise self._error(("workspace", kind), problem, "one of the two")
        owner = np.array(table.load_cases or [""] * len(table.places))
        strangers = sorted({*owner.tolist()} - {"", *cases})
        if strangers:
            problem = f"{section.poses} has poses for '{strangers[0]}', which is no load case"
            raise self._error(keys, problem, f"one of {', '.join(cases) or 'none: there are none'}")
        every = self._poses(section, table.places)
        of_cases = {}
        for name in cases if (owner != "").any() else ():
            is_own = (owner == name) | (owner == "")
            if not is_own.any():
                raise self._error(keys, f"{section.poses} has no pose for load case '{name}'")
            of_cases[name] = self._poses(section, table.places[is_own])
        return Places(section.workspace(*every), of_cases)

    def along_path(self, section: StudySection, path: PathSection) -> Places:
        """Return the instants of a path, and how the platform moves through them."""
        workspace = section.workspace
        assert workspace is not None
        table = self._table((*_PATH, "file"), path.file)
        places = self._turned(workspace, table, path.file)
        faults = list(path_faults(table, has_limits=path.speed_max is not None))
        if faults:
            raise InputError(faults)
        motion = self._motion(path, table, places)
        if motion.turns:
            self._require_inertia(section, path.file)
        region, orientations = self._poses(workspace, motion.places)
        return Places(workspace.workspace(region, orientations), motion=motion)

    def _motion(self, path: PathSection, table: PoseTable, places: FloatArray) -> Motion:
        """Return the motion through the places (n_rows, 6) of a table, by times or by limits."""
        name, up = path.file, self.robot.level[2]
        limits = {name: getattr(path, name) for name in ("speed_max", "acceleration_max")}
        if TIME in table.names:
            for limit in (limit for limit, value in limits.items() if value is not None):
                problem = f"{name} has times of its own, in its column {TIME}"
                raise self._error((*_PATH, limit), problem, "one of the two")
            time_s = table.values[:, table.names.index(TIME)]
            return timed(time_s, places, up, path.ends or "at_rest", name)
        for limit in (limit for limit, value in limits.items() if value is None):
            problem = f"{limit} is missing, and {name} has no column {TIME}"
            raise self._error(_PATH, problem, f"{limit}: …, or times in the file")
        if path.ends is not None:
            problem = f"{name} has no column {TIME}: it is passed from rest to rest"
            raise self._error((*_PATH, "ends"), problem, "times in the file, or no ends")
        reach_m = float(np.linalg.norm(self.robot.attachments_m, axis=1).max())
        return limited(places, up, reach_m, name, *limits.values())

    def _require_inertia(self, section: StudySection, name: str) -> None:
        """Refuse a path that turns a platform whose inertia is not known in every load case."""
        problem, expected = f"{name} turns the platform", "moments of inertia [xx, yy, zz]"
        if self.robot.platform.inertia_kg_m2 is None:
            where = ("robot", "platform")
            raise self._error(where, f"inertia is missing, and {problem}", f"inertia: {expected}")
        for index, case in enumerate(section.load_cases):
            if case.mass is not None and case.inertia is None:
                keys = ("load_cases", index, "mass")
                problem = f"has no inertia beside it, and {problem}"
                raise self._error(keys, problem, f"inertia: {expected}")

    def _turned(self, section: WorkspaceSection, table: PoseTable, name: str) -> FloatArray:
        """Return the places of a path (n_rows, 6), turned as it says or in one way all along."""
        has_turns = table.places.shape[1] == 6
        single = section.orientation
        is_fixed = single is None or (single.toward is None and single.table is None)
        for kind in ORIENTATION_KINDS:
            if getattr(section, kind) is None or (
                kind == "orientation" and is_fixed and not has_turns
            ):
                continue
            problem = (
                f"{name} has orientations of its own"
                if has_turns
                else f"the platform moves along {name}"
            )
            expected = "one of the two" if has_turns else "rx_rad, ry_rad and rz_rad in the file"
            raise self._error(("workspace", kind), problem, expected)
        if has_turns:
            return table.places
        turn = section.fixed_orientations().turns_rad[:1]
        return np.hstack([table.places, np.repeat(turn, len(table.places), axis=0)])

    def _poses(self, section: WorkspaceSection, places: FloatArray) -> Listed:
        positions, turns = places[:, :3], places[:, 3:]
        region = PointList(frozen_array(np.unique(positions, axis=0)))
        if not turns.size:
            return region, self.orientations(section, region)
        is_level = not turns.any()
        return region, Orientations(law=None if is_level else EachPose.of(positions, turns))


_PATH = ("workspace", "path")
MOST_ROWS = 1000
"""Of a table of orientations: each costs time at every pose."""
