"""Checks that need several fields at once: those of the robot, and here those of all else."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
from scipy.spatial import QhullError

from designer.arrays import FloatArray
from designer.documents.document import Data, Document, Key
from designer.documents.opened import open_input, reason
from designer.documents.picture import LARGEST_PICTURE_BYTES, why_not_shown
from designer.documents.section import reader_of
from designer.effects.effect import ALL_ATTACHMENTS, OF_CABLE, Effect
from designer.errors import Fault
from designer.io.config.columns import ColumnSection
from designer.io.config.effects import read_effects
from designer.io.config.machine import attached_each
from designer.io.config.robot_checks import AT_MOST, LARGEST, ROBOT_CHECKS, Parts, rank, valid
from designer.measured.assign import COVARIATE, IGNORE, TIME_NAME, cable_of, is_rotation
from designer.model.measurements import POSES
from designer.model.region import Prism, Rectangle
from designer.spelling import did_you_mean
from designer.units import describe

_REGION = "workspace.region"
_CASES = "load_cases"
_GROUPS = "selection.groups"
_COLUMNS = "measurements.columns"
_UNCERTAINTY = "uncertainty"
_LOGO = "document.logo"
_UNKNOWN = "measurements.unknown"
_SESSIONS = "measurements.sessions"


def all_faults(document: Document, effects: Mapping[str, Effect]) -> list[Fault]:
    """Return every fault that concerns more than one field of the document, or the effects."""
    parts = Parts(document, document.root.data(), effects)
    checks = (
        *ROBOT_CHECKS,
        prism_has_area,
        rectangle_has_area,
        regions_fit_the_plane,
        places_are_near,
        catalogues_exist,
        each_cable_in_one_group,
        fields_go_together,
        path_stands_alone,
        load_cases_fit,
        inertia_is_known,
        effects_are_known,
        columns_fit_the_robot,
        unknowns_are_known,
        logo_is_a_picture,
        unknown_poses_can_be_told,
        data_have_a_file,
        sessions_have_their_own,
    )
    return [fault for check in checks for fault in check(parts)]


def prism_has_area(parts: Parts) -> Iterator[Fault]:
    """Something is left of the prism's base inside the inset."""
    path, base = f"{_REGION}.prism", parts.read(f"{_REGION}.prism")
    corners = parts.array("robot.anchors" if base == "anchors" else path)
    if corners is None:
        return
    if rank(corners[:, :2]) < 2:
        if base != "anchors":  # the anchors have their own check
            yield parts.fault(path, "all corners lie on one line", "corners that span an area")
        return
    inset_m = parts.read(f"{_REGION}.inset") or 0.0
    try:
        Prism.over(corners, inset_m, (0.0, 1.0))
    except (ValueError, QhullError):
        problem = f"nothing of the region is left inside an inset of {inset_m:g} m"
        yield parts.fault(f"{_REGION}.inset", problem, "a smaller inset")


def rectangle_has_area(parts: Parts) -> Iterator[Fault]:
    """Something is left of the rectangle's width inside the inset."""
    path, base = f"{_REGION}.rectangle", parts.read(f"{_REGION}.rectangle")
    ends = parts.array("robot.anchors") if base == "anchors" else base
    if ends is None:
        return
    if np.ptp(np.array(ends)[:, :2], axis=0).max() == 0.0:
        yield parts.fault(path, "begins and ends at one point", "two corners that are apart")
        return
    try:
        Rectangle.over(ends, parts.read(f"{_REGION}.inset") or 0.0, (0.0, 1.0))
    except ValueError as error:
        yield parts.fault(path, str(error), "a line that leaves something between its ends")


def places_are_near(parts: Parts) -> Iterator[Fault]:
    """The platform is asked to be where the cables can reach."""
    anchors = parts.array("robot.anchors")
    if anchors is None:
        return
    low, high = anchors.min(axis=0) - LARGEST.most, anchors.max(axis=0) + LARGEST.most
    for path, points in _places(parts, anchors.mean(axis=0)):
        axes = points.shape[1]
        off = np.maximum(low[:axes] - points, points - high[:axes])
        if float(off.max()) > 0.0:
            problem = f"lies {off.max() + LARGEST.most:.4g} m from the exit points"
            yield parts.fault(path, problem, AT_MOST)


def _places(parts: Parts, middle: FloatArray) -> Iterator[tuple[str, FloatArray]]:
    """Yield where positions stand, and the positions (n, 3), or (n, 2) without a height [m]."""
    pose, box, z_m = parts.read("pose"), *(parts.array(f"{_REGION}.{n}") for n in ("box", "z"))
    if pose is not None:
        yield "pose", np.array([pose.position])
    if box is not None:
        yield f"{_REGION}.box", box.T
    for name in ("points", "prism", "rectangle"):
        points = parts.array(f"{_REGION}.{name}")
        if points is not None:
            yield f"{_REGION}.{name}", points
    if z_m is not None:
        yield f"{_REGION}.z", np.array([[*middle[:2], height_m] for height_m in z_m])


def catalogues_exist(parts: Parts) -> Iterator[Fault]:
    """Each extra catalogue is a file or folder beside the config."""
    folder = Path(parts.document.name).parent
    for index, name in _texts(parts.raw("catalogues")):
        with suppress(OSError):  # such as a name longer than the file system takes
            if (folder / name).exists():
                continue
        expected = "a grade file or a folder, relative to this file"
        yield parts.fault("catalogues", f"there is no {describe(name)}", expected, index)


def each_cable_in_one_group(parts: Parts) -> Iterator[Fault]:
    """No cable is in two groups, none is left over, and none is named that is not there."""
    groups, anchors = parts.read(_GROUPS), parts.read("robot.anchors")
    if not groups or not anchors:
        return
    n_cables = len(anchors)
    first_use: dict[int, str] = {}
    once = "every cable in exactly one group"
    for name, cables in groups.items():
        for index, cable in enumerate(cables):
            if cable > n_cables:
                problem = f"there is no cable {cable}, the robot has {n_cables}"
                expected = f"a cable from 1 to {n_cables}"
                yield parts.fault(_GROUPS, problem, expected, name, index)
            elif cable in first_use:
                problem = f"cable {cable} is in group '{first_use[cable]}' already"
                yield parts.fault(_GROUPS, problem, once, name, index)
            first_use.setdefault(cable, name)
    missing = [str(cable) for cable in range(1, n_cables + 1) if cable not in first_use]
    if len(missing) == 1:
        yield parts.fault(_GROUPS, f"cable {missing[0]} is in no group", once)
    elif missing:
        listed = f"{', '.join(missing[:-1])} and {missing[-1]}"
        yield parts.fault(_GROUPS, f"cables {listed} are in no group", once)


_NO_WORKSPACE = "a workspace that the rope is to serve, or no selection"
_NO_LIMIT = "has no meaning without selection.groups"
_NO_CASES = "a workspace: a load case is for all its poses"
_NO_ROPE = "a selection: it is the chosen rope that may not be enough"
_NO_WINCHES = "a workspace: winches are held against what they meet in all its poses"
_NO_MOTOR = "robot.winches.motor: {torque: …}, or leave it out"
_NO_USE = "robot.winches.motor: {torque: …} or robot.winches.drum: {length: …}, or leave it out"
_NO_DRUM = "robot.winches.drum_diameter, which tells the torque of a tension"
_PATH = "workspace.path"
_NO_PATH = "workspace.path, along which speed and power are evaluated"
_DRUM, _ETA = "robot.winches.drum", "robot.winches.sheave_efficiency"
_LIFE, _SHEAVE = "selection.rope_life", "selection.sheave_diameter"
_NO_DIAMETER = "robot.winches.drum_diameter beside it"
_NO_SHEAVE = f"{_DRUM}.sheave_distance, which tells the angle"
_NO_ANGLE = f"{_DRUM}.fleet_angle_max, or leave it out"
_NEEDS = (
    *(
        (f"robot.winches.{name}", _PATH, "there is no path, so that nothing moves", _NO_PATH)
        for name in ("speed_max", "motor.speed", "motor.power")
    ),
    ("selection", "workspace", "has no meaning without a workspace", _NO_WORKSPACE),
    (_LIFE, _PATH, "there is no path along which ropes bend", "workspace.path, or leave it out"),
    (_LIFE, _SHEAVE, "the sheaves' diameter is not given", f"{_SHEAVE} beside it"),
    (f"{_LIFE}.days_min", f"{_LIFE}.runs_per_day", "a day has no runs", f"{_LIFE}.runs_per_day"),
    ("selection.max_distinct_products", _GROUPS, _NO_LIMIT, "groups, or neither"),
    (_CASES, "workspace", "there is no workspace", _NO_CASES),
    (_UNCERTAINTY, "selection", "there is no selection", _NO_ROPE),
    *(
        (f"robot.winches.{name}", "robot.winches.motor", "there is no motor to drive it", _NO_MOTOR)
        for name in ("gear_ratio", "efficiency")
    ),
    ("robot.winches.sheaves", _ETA, "nothing is lost on them", f"{_ETA}, or leave it out"),
    (
        "robot.winches.drum",
        "robot.winches.drum_diameter",
        "its diameter is not given",
        _NO_DIAMETER,
    ),
    (f"{_DRUM}.fleet_angle_max", f"{_DRUM}.sheave_distance", "there is no sheave", _NO_SHEAVE),
    (f"{_DRUM}.sheave_distance", f"{_DRUM}.fleet_angle_max", "no angle is asked for", _NO_ANGLE),
    ("robot.winches.motor", "robot.winches.drum_diameter", "there is no drum", _NO_DRUM),
    ("robot.winches", "workspace", "there is no workspace", _NO_WINCHES),
)
"""Fields that another one has to be beside: what is wrong without it, and what is expected."""
_EXCLUDES = (
    (
        _CASES,
        "groups of cables are chosen for the static load alone: wind loads ropes of different "
        "thickness in different directions, and all cables are solved with one",
        "load_cases or groups, not both",
    ),
    (
        _UNCERTAINTY,
        "uncertainty is computed for one rope on all cables",
        "uncertainty or groups, not both",
    ),
)
"""Fields beside which groups of cables may not be."""


def fields_go_together(parts: Parts) -> Iterator[Fault]:
    """What each field needs is there, and what excludes another is there alone."""
    given = {path for path, *_ in (*_NEEDS, *_EXCLUDES) if parts.raw(path) not in (None, [])}
    for path, needed, problem, expected in _NEEDS:
        if path in given and parts.raw(needed) is None:
            yield parts.fault(path, problem, expected)
    if parts.raw("robot.winches.motor") is None and parts.raw(_DRUM) is None:
        for name in ("drum_diameter", "layers"):
            if parts.raw(f"robot.winches.{name}") is not None:
                problem = "there is no motor to drive it, and no length of the drum"
                yield parts.fault(f"robot.winches.{name}", problem, _NO_USE)
    for path, problem, expected in _EXCLUDES:
        if path in given and parts.raw(_GROUPS) is not None:
            yield parts.fault(_GROUPS, problem, expected)
    if parts.raw(_GROUPS) is not None and len(attached_each(parts.read("robot.attached"))) > 1:
        problem = "groups of cables are chosen where the same is attached to all of them"
        yield parts.fault(_GROUPS, problem, "one robot.attached for all cables, or no groups")


def path_stands_alone(parts: Parts) -> Iterator[Fault]:
    """A path is beside nothing that is not computed in motion."""
    path = parts.raw(_PATH)
    if path is None:
        return
    expected = "workspace.path, or this beside workspace.poses"
    for field, problem in _NOT_IN_MOTION:
        if parts.raw(field) not in (None, []):
            yield parts.fault(field, f"{problem} along a path", expected)
    if parts.raw("workspace.proof") is not None:
        problem = "the instants of a path are tried one by one, and nothing is proved between them"
        yield parts.fault("workspace.proof", problem, "no such field beside workspace.path")
    for index, case in _load_cases(parts):
        for name, problem in _CASES_NOT_IN_MOTION.items():
            if case.get(name) is not None:
                yield parts.fault(_CASES, problem, "a load case without it", index, name)


_NOT_IN_MOTION = (
    (_GROUPS, "groups of cables are not chosen"),
    (_UNCERTAINTY, "uncertainty is not computed"),
)
_CASES_NOT_IN_MOTION = {
    "acceleration": "the path gives the platform's accelerations itself",
    "cable_lost": "where a moving platform goes without a cable is not computed",
    "temperature_change": "where a moving platform goes on braked winches is not computed",
    "region": "the platform follows workspace.path in every load case",
}


def regions_fit_the_plane(parts: Parts) -> Iterator[Fault]:
    """A planar robot has flat regions."""
    if not parts.is_planar:
        return
    problem, expected = "is a solid region, but the robot is planar", "rectangle or points"
    for kind in ("prism", "box"):
        if parts.raw(f"{_REGION}.{kind}") is not None:
            yield parts.fault(f"{_REGION}.{kind}", problem, expected)
            break
    for index, case in _load_cases(parts):
        region = case.get("region")
        if isinstance(region, dict) and ("prism" in region or "box" in region):
            yield parts.fault(_CASES, problem, expected, index, "region")


def _load_cases(parts: Parts) -> Iterator[tuple[int, dict[str, Data]]]:
    """Yield the load cases that are mappings, each with its place."""
    cases = parts.raw(_CASES)
    for index, case in enumerate(cases if isinstance(cases, list) else ()):
        if isinstance(case, dict):
            yield index, case


def load_cases_fit(parts: Parts) -> Iterator[Fault]:
    """Load cases have names of their own, cables that exist, and what their wind acts on."""
    first_use: dict[str, int] = {}
    for index, case in _load_cases(parts):
        yield from _case_fits(parts, index, case, first_use)


def _case_fits(
    parts: Parts, index: int, case: Mapping[str, object], first_use: dict[str, int]
) -> Iterator[Fault]:
    name, lost = case.get("name"), case.get("cable_lost")
    if isinstance(name, str) and first_use.setdefault(name, index) != index:
        problem = f"load_cases[{first_use[name]}] has the name '{name}' already"
        yield parts.fault(_CASES, problem, "a name of its own", index, "name")
    if isinstance(lost, int) and not isinstance(lost, bool) and lost > parts.n_cables:
        problem = f"there is no cable {lost}, the robot has {parts.n_cables}"
        yield parts.fault(_CASES, problem, f"1 to {parts.n_cables} or each", index, "cable_lost")
    if lost is not None and parts.n_cables - 1 < (2 if parts.is_planar else 1):
        yield parts.fault(
            _CASES, "too few cables are left", "a robot with more", index, "cable_lost"
        )
    for factor_name in ("safety_factor", "termination_efficiency"):
        if case.get(factor_name) is not None and parts.raw("selection") is None:
            problem = "there is no selection whose figure it could replace"
            yield parts.fault(
                _CASES, problem, "a selection, or a case without it", index, factor_name
            )
    if case.get("wind") is None:
        return
    if parts.raw("robot.platform.drag") is None:
        problem = "the platform has no area in the wind"
        expected = "robot.platform.drag: {area: …, coefficient: …}"
        yield parts.fault(_CASES, problem, expected, index, "wind")
    if len(attached_each(parts.read("robot.attached"))) > 1:
        problem = "wind loads cables to which different things are attached in different directions"
        expected = "the same attached to all cables, or no wind; all are solved with one direction"
        yield parts.fault(_CASES, problem, expected, index, "wind")
    if parts.raw("cable.drag_coefficient") is None:
        problem = "the drag of the cables is not given"
        expected = "cable.drag_coefficient, such as 1.2; 0 for none"
        yield parts.fault(_CASES, problem, expected, index, "wind")


_FREQUENCY = "selection.limits.platform_frequency"


def inertia_is_known(parts: Parts) -> Iterator[Fault]:
    """The inertia of a body is known in every load case where its frequencies have a limit."""
    cases = [*_load_cases(parts)]
    if parts.is_point_mass:
        for index, case in cases:
            if case.get("inertia") is not None:
                problem, expected = "has no meaning for a point mass", "no inertia"
                yield parts.fault(_CASES, problem, expected, index, "inertia")
        return
    if parts.raw(_FREQUENCY) is None:
        return
    if parts.raw("robot.platform.inertia") is None:
        expected = "robot.platform.inertia: [xx, yy, zz]"
        yield parts.fault(_FREQUENCY, "the inertia of the platform is not given", expected)
        return
    for index, case in cases:
        if case.get("mass") is not None and case.get("inertia") is None:
            problem = f"the inertia of the platform with this mass is not given, for {_FREQUENCY}"
            yield parts.fault(_CASES, problem, "inertia beside it", index, "mass")


def effects_are_known(parts: Parts) -> Iterator[Fault]:
    """Each effect has an id, parameters and a cable that there are, and leaves a platform."""
    declared, mass_kg = parts.declared, parts.read("robot.platform.mass")
    for flaw in declared.flaws:
        yield parts.document.fault(*flaw)
    for place, effect in declared.effects:
        if effect.id != "platform_mass" or mass_kg is None:
            continue
        if mass_kg + effect.parameters.get("offset_kg", 0.0) <= 0:
            expected = f"more than -{mass_kg:g} kg, minus the platform's own mass"
            yield parts.document.fault((*place, "offset_kg"), "leaves no mass", expected)


def columns_fit_the_robot(parts: Parts) -> Iterator[Fault]:
    """Each column goes to a place of its own that the robot has, and a point mass to no turn."""
    first_use: dict[str, str] = {}
    columns, has_files = parts.raw(_COLUMNS), isinstance(parts.raw("measurements.file"), list)
    for name, column in columns.items() if isinstance(columns, dict) else ():
        section = valid(reader_of(ColumnSection), column)
        if section is None or section.to in (IGNORE, COVARIATE):
            continue
        target: str = section.to
        if (cable_of(target) or 0) > parts.n_cables:
            problem = f"{target}: the robot has {parts.n_cables} cables"
            yield parts.fault(_COLUMNS, problem, f"a cable from 1 to {parts.n_cables}", name)
        elif is_rotation(target) and parts.is_point_mass:
            expected = f"robot.platform.attachments, or '{IGNORE}'"
            problem = f"{target} has no meaning for a point mass"
            yield parts.fault(_COLUMNS, problem, expected, name)
        if target in first_use and not (target == TIME_NAME and has_files):
            problem = f"{target} is already the column '{first_use[target]}'"
            yield parts.fault(_COLUMNS, problem, f"another name of ours, or '{IGNORE}'", name)
        first_use.setdefault(target, name)


def unknowns_are_known(parts: Parts) -> Iterator[Fault]:
    """What is fitted from the start is an effect, or all exit points together; each once."""
    yield from _unknown_names(parts, parts.raw(_UNKNOWN), _UNKNOWN)


def _unknown_names(parts: Parts, names: Data, path: str, *below: Key) -> Iterator[Fault]:
    """Yield what is wrong with a list of unknowns at a path, or below it."""
    seen: set[str] = set()
    together = [effect.also_called for effect in parts.effects.values() if effect.also_called]
    anchors = parts.raw("robot.anchors")
    cables = range(1, (len(anchors) if isinstance(anchors, list) else 0) + 1)
    by_cable = [effect.id for effect in parts.effects.values() if effect.takes_cable]
    of_cables = [f"{name}{OF_CABLE}{k}" for name in by_cable for k in cables]
    unknowns = (*parts.effects, *together, POSES, *of_cables)
    for index, name in _texts(names):
        if name not in unknowns:
            listed = f"{', '.join((*together, POSES))}, or an effect: {', '.join(parts.effects)}"
            expected = listed + did_you_mean(name, unknowns)
            yield parts.fault(path, f"{describe(name)} is not known", expected, *below, index)
        if name in seen:
            yield parts.fault(path, f"'{name}' is given twice", "once", *below, index)
        seen.add(name)


def data_have_a_file(parts: Parts) -> Iterator[Fault]:
    """Measurements name a file, or sessions with a file each."""
    data = parts.raw("measurements")
    if not isinstance(data, dict):
        return
    has_file, has_sessions = (data.get(name) is not None for name in ("file", "sessions"))
    if not has_file and not has_sessions:
        expected = "the name of a CSV file, or a list of files; or sessions with a file each"
        yield parts.fault("measurements.file", "is missing", expected)
    if has_file and has_sessions:
        yield parts.fault("measurements.file", "there are sessions as well", "one of the two")


def sessions_have_their_own(parts: Parts) -> Iterator[Fault]:
    """What is unknown or known of a session is known to be so, and not of the machine as well."""
    sessions = parts.raw(_SESSIONS)
    if not isinstance(sessions, list):
        return
    of_machine = {name for _, name in _texts(parts.raw(_UNKNOWN))}
    if POSES in of_machine:
        yield parts.fault(_SESSIONS, f"'{POSES}' are unknown", "measured poses in every session")
    declared = {effect.id for _, effect in parts.declared.effects}
    for number, session in enumerate(sessions):
        if not isinstance(session, dict):
            continue
        unknown, place = session.get("unknown"), ("measurements", "sessions", number, "effects")
        yield from _unknown_names(parts, unknown, _SESSIONS, number, "unknown")
        for index, name in _texts(unknown):
            why = "cannot be" if name == POSES else "is unknown of the machine, so cannot be"
            if name in of_machine or name == POSES:
                problem = f"'{name}' {why} of a session"
                yield parts.fault(_SESSIONS, problem, "another", number, "unknown", index)
        own = read_effects(session.get("effects"), parts.n_cables, parts.effects, place)
        for flaw in own.flaws:
            yield parts.document.fault(*flaw)
        for where, effect in own.effects:
            if effect.id in declared:
                problem = f"'{effect.id}' is declared of the machine, so of all sessions"
                yield parts.document.fault(where, problem, "one of the two")


def unknown_poses_can_be_told(parts: Parts) -> Iterator[Fault]:
    """Where poses are unknown, attachments and the vertical are not."""
    unknown = {name: index for index, name in _texts(parts.raw(_UNKNOWN))}
    if POSES not in unknown:
        for name in ("position", "rotation"):
            if parts.raw(f"measurements.noise.{name}") is not None:
                problem = "has no use where poses are taken as they were measured"
                expected = f"'{POSES}' in {_UNKNOWN}, by which coordinates are data with a noise"
                yield parts.fault(f"measurements.noise.{name}", problem, expected)
        return
    lost = {ALL_ATTACHMENTS, "attachment_offset", "base_tilt"}
    for name in unknown.keys() & lost:
        problem = f"'{name}' and '{POSES}' are both unknown, and nothing tells one from the other"
        yield parts.fault(_UNKNOWN, problem, "one of them", unknown[name])
    if parts.raw("workspace.region") is None:
        expected = "where the platform may be, since its poses are unknown"
        yield parts.fault("workspace.region", "is missing", expected)


def _texts(data: Data) -> Iterator[tuple[int, str]]:
    """Yield the texts of a list, each with its place."""
    for index, text in enumerate(data if isinstance(data, list) else ()):
        if isinstance(text, str):
            yield index, text


def logo_is_a_picture(parts: Parts) -> Iterator[Fault]:
    """The logo is a file that a page can show."""
    name = parts.read(_LOGO)
    if name is None:
        return
    path = Path(parts.document.name).parent / name
    try:
        with open_input(path) as file:
            problem = why_not_shown(file.read(LARGEST_PICTURE_BYTES + 1))
    except FileNotFoundError:
        yield parts.fault(_LOGO, f"there is no file {path}", "a picture, relative to this file")
    except (OSError, ValueError) as error:
        expected = "a picture, relative to this file"
        yield parts.fault(_LOGO, f"{path} cannot be read: {reason(error)}", expected)
    else:
        if problem is not None:
            yield parts.fault(_LOGO, f"{path.name} {problem[0]}", problem[1])
