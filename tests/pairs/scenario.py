"""What a study's text says, as a problem for the reference: read here once more, from plain YAML.

Every number of the text has to be in SI. The laws are those of the documents: half the density of
air, 1.25 kg/m³, times the square of the wind's speed; ice around the cables; effects as in the
table of effects.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pairs.options import PATH_S, PATHS, POSES
from pairs.reference import Pose, Problem
from scipy.interpolate import RBFInterpolator
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
PRESSURE = 0.5 * 1.25
STEEL_EXPANSION = 12e-6
SAG_MAX = 0.2
ZP = {"M5": 4.5}
"""ISO 4308-1, running ropes."""
Data = Mapping[str, Any]


def up_of(study: Data) -> np.ndarray:
    """Return the vertical in the frame of the study: tilted against gravity by the base's tilt."""
    down = np.array(study["robot"].get("gravity", [0.0, 0.0, -1.0]), dtype=float)
    up = -down / np.linalg.norm(down)
    tilt = study.get("effects", {}).get("base_tilt", {})
    turned = Rotation.from_rotvec([tilt.get("rx_rad", 0.0), tilt.get("ry_rad", 0.0), 0.0])
    # The base is turned against the vertical: seen from it, the vertical is turned back.
    level, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [up])
    return level.inv().apply(turned.inv().apply([0.0, 0.0, 1.0]))


def plane_of(study: Data, up: np.ndarray) -> np.ndarray:
    """Return the level direction along the plane of a planar robot."""
    points = np.array(study["robot"]["anchors"], dtype=float)
    spread = points - points.mean(axis=0)
    level = spread - np.outer(spread @ up, up)
    axis = np.linalg.svd(level)[2][0]
    return axis * np.sign(axis[np.abs(axis).argmax()])


def freedoms_of(study: Data, up: np.ndarray) -> np.ndarray:
    is_body = "attachments" in study["robot"]["platform"]
    if not study["robot"].get("planar", False):
        return np.eye(6) if is_body else np.eye(6)[:3]
    along, zero = plane_of(study, up), np.zeros(3)
    rows = [np.concatenate([along, zero]), np.concatenate([up, zero])]
    if is_body:
        rows.append(np.concatenate([zero, np.cross(up, along)]))
    return np.array(rows)


def level_directions(study: Data, up: np.ndarray, count: int, rng: np.random.Generator):
    """Return horizontal directions of wind (count, 3); in a plane the two along it."""
    if study["robot"].get("planar", False):
        along = plane_of(study, up)
        return np.array([along, -along])
    free = rng.normal(size=(count, 3))
    level = free - np.outer(free @ up, up)
    return level / np.linalg.norm(level, axis=1, keepdims=True)


def kept_by_sheaves(study: Data) -> float:
    """Return the tension at the exit point over that which a winch pulls to haul the rope in."""
    winches, kept = study["robot"].get("winches", {}), 1.0
    for _ in range(winches.get("sheaves", 1)):
        kept *= winches.get("sheave_efficiency", 1.0)
    return kept


def allowable_of(study: Data, case: Data, grade: Data, size: Data) -> float:
    """Return breaking load times efficiency over safety factor [N]."""
    selection = study["selection"]
    factor = case.get("safety_factor") or selection.get("safety_factor", 5.0)
    factor = case.get("safety_factor") or ZP.get(selection.get("duty_class"), factor)
    kept = case.get("termination_efficiency") or selection.get("termination_efficiency", 1.0)
    sheave = selection.get("sheave_diameter")
    bent = 1.0
    is_fibre = grade.get("material") not in (None, "steel", "stainless steel")
    if sheave is not None and not (is_fibre and "sheave_ratio" in grade):
        bent = 1.0 - 0.5 / np.sqrt(sheave / size["diameter"])
    # Behind the sheaves the rope is bent and has no fitting.
    kept = min(kept, bent * kept_by_sheaves(study))
    return size["minimum_breaking_load"] * kept / factor


def stiffness_of(study: Data, case: Data, grade: Data, size: Data) -> float:
    """Return EA of the data sheet [N]."""
    if "modulus" in grade:
        return grade["modulus"]["value"] * 0.25 * np.pi * size["diameter"] ** 2
    return grade["stiffness"]["ea_over_breaking_load"] * size["minimum_breaking_load"]


def problem_of(
    study: Data,
    ropes: Sequence[tuple[Data, Data]],
    case: Data | None = None,
    wind: np.ndarray | None = None,
    inertia: np.ndarray | None = None,
) -> Problem:
    """Return the robot of a study with ropes, (grade, size) of each cable, under a load case."""
    case, effects = case or {}, study.get("effects", {})
    robot, cable = study["robot"], study["cable"]
    platform, up = robot["platform"], up_of(study)
    exits = np.array(robot["anchors"], dtype=float)
    moved = effects.get("anchor_offset", [])
    for one in moved if isinstance(moved, list) else [moved]:
        exits[one["cable"] - 1] += [one.get(name, 0.0) for name in ("x_m", "y_m", "z_m")]
    arms = np.array(platform.get("attachments", np.zeros_like(exits)), dtype=float)
    offset = effects.get("centre_of_mass_offset", {})
    centre = np.array(platform.get("centre_of_mass", [0.0, 0.0, 0.0]), dtype=float)
    centre = centre + [offset.get(name, 0.0) for name in ("x_m", "y_m", "z_m")]
    mass = case.get("mass") or platform["mass"]
    mass += effects.get("platform_mass", {}).get("offset_kg", 0.0)
    factor = case.get("dynamic_factor", 1.0)
    wrench = case.get("wrench") or platform.get("wrench", {})
    force = factor * np.array(wrench.get("force", [0.0, 0.0, 0.0]), dtype=float)
    moment = factor * np.array(wrench.get("moment", [0.0, 0.0, 0.0]), dtype=float)
    centre_force = -factor * mass * GRAVITY * up
    if inertia is not None:
        centre_force = centre_force + mass * case["acceleration"] * inertia
    pressure = 0.0
    if wind is not None:
        pressure = PRESSURE * case["wind"]["speed"] ** 2
        drag = platform["drag"]
        centre_force = centre_force + pressure * drag["area"] * drag["coefficient"] * wind
    ice = case.get("ice") or {"thickness": 0.0}
    t, iced = ice["thickness"], ice.get("density", 900.0)
    loads, masses = [], []
    for (_, size), line in zip(ropes, lines_of(robot), strict=True):
        cylinders = [(size["linear_mass"], size["diameter"])]
        cylinders += [(line["linear_mass"], line["diameter"])] if line else []
        masses.append(sum(m + np.pi * t * (d + t) * iced for m, d in cylinders))
        load = -GRAVITY * masses[-1] * up
        if wind is not None:
            width = sum(d + 2.0 * t for _, d in cylinders)
            load = load + pressure * cable["drag_coefficient"] * width * wind
        loads.append(load)
    sag = study["workspace"].get("sag", SAG_MAX)
    return Problem(
        exits_m=exits,
        arms_m=arms,
        load_N_per_m=np.array(loads),
        stiffness_N=np.array([stiffness_of(study, case, *one) for one in ropes]),
        allowable_N=np.array([allowable_of(study, case, *one) for one in ropes]),
        mass_kg_per_m=np.array(masses),
        force_N=force,
        moment_Nm=moment,
        centre_m=centre,
        centre_force_N=centre_force,
        freedoms=freedoms_of(study, up),
        up=up,
        radius_m=effects.get("pulley_radius", {}).get("radius_m", 0.0),
        least_N=robot.get("tension_min", 0.0),
        sag_max=None if sag == "none" else sag,
    )


def lines_of(robot: Data) -> list[Data | None]:
    """Return what is clipped along each cable: a second cylinder, or None."""
    given = robot.get("attached")
    return given if isinstance(given, list) else [given] * len(robot["anchors"])


def growth_of(study: Data, case: Data, grade: Data) -> float:
    """Return the strain of the cables by a change of temperature."""
    own = study["cable"].get("thermal_expansion")
    if own is None:
        own = grade.get("thermal_expansion", {}).get("value", STEEL_EXPANSION)
    return own * (case.get("temperature_change") or 0.0)


def random_places(study: Data, case: Data, count: int, rng: np.random.Generator) -> list[Pose]:
    """Return random poses of a case's region, corners too; of a list all of them."""
    if "path" in study["workspace"]:
        shares = rng.integers(401, size=count) / 400
        turn = turns_of(study, 1, rng)[0]
        return [Pose(line_at(study, share)[0], turn) for share in shares]
    if "poses" in study["workspace"] and not case.get("region"):
        rows = POSES[study["workspace"]["poses"]]
        listed = [row for row in rows if row[2] in ("", case.get("name"))]
        return [listed_pose(study, *row[:2]) for row in listed]
    region = case.get("region") or study["workspace"]["region"]
    if "points" in region:
        positions = np.array(region["points"], dtype=float)
    else:
        shares = rng.uniform(size=(count, 3))
        corners = np.array(np.meshgrid(*[[0.0, 1.0]] * 3)).reshape(3, -1).T
        shares[: len(corners)] = corners[:count]
        if "box" in region:
            low, high = np.array(region["box"], dtype=float).T
            positions = low + shares * (high - low)
        else:
            (first, last), heights = np.array(region["rectangle"], dtype=float), region["z"]
            plan = first + shares[:, :1] * (last - first)
            height = heights[0] + shares[:, 2] * (heights[1] - heights[0])
            positions = np.column_stack([plan, height])
    if turn_at(study, positions[0]) is not None:
        return [Pose(position, turn_at(study, position)) for position in positions]
    turns = turns_of(study, max(count, 1), rng)
    if "points" in region and len(turns) < count:
        return [Pose(position, turn) for position in positions for turn in turns]
    at = rng.integers(len(positions), size=count) if "points" in region else np.arange(count)
    return [Pose(positions[k], turns[rng.integers(len(turns))]) for k in at]


def listed_pose(study: Data, position: list[float], turn: list[float]) -> Pose:
    """Return a pose of a list, of a point mass without its orientation."""
    turns = "attachments" in study["robot"]["platform"]
    return Pose(np.array(position), np.array(turn) if turns else np.zeros(3))


def turn_at(study: Data, position: np.ndarray) -> np.ndarray | None:
    """Return how a platform is turned whose orientation follows its position; None for others."""
    facing = study["workspace"].get("orientation")
    if "turn_of" in study:
        return study["turn_of"](position)
    if not isinstance(facing, dict):
        return None
    if "table" not in facing:
        return turn_toward(position, facing)
    rows = POSES[facing["table"]]
    places, turns = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    between = RBFInterpolator(places, turns, kernel="linear", degree=0)(position[None])[0]
    return np.clip(between, turns.min(axis=0), turns.max(axis=0))


def line_at(study: Data, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Return position and acceleration at a share of the time of the path, at rest at ends."""
    first, last = np.array(PATHS[study["workspace"]["path"]])
    along = last - first
    gain = along * (6.0 - 12.0 * share) / PATH_S**2
    return first + along * (3.0 - 2.0 * share) * share**2, gain


def in_motion(problem: Problem, study: Data, case: Data, position: np.ndarray) -> Problem:
    """Return a problem with what the inertia of the platform asks for at a position of the path."""
    if "path" not in study["workspace"]:
        return problem
    first, last = np.array(PATHS[study["workspace"]["path"]])
    done = (position - first) @ (last - first) / ((last - first) @ (last - first))
    roots = np.roots([-2.0, 3.0, 0.0, -np.clip(done, 0.0, 1.0)]).real
    share = roots[np.abs(roots - 0.5).argmin()]
    mass = case.get("mass") or study["robot"]["platform"]["mass"]
    mass += study.get("effects", {}).get("platform_mass", {}).get("offset_kg", 0.0)
    force = -mass * line_at(study, share)[1]
    turn = turns_of(study, 1, np.random.default_rng(0))[0]
    arm = Rotation.from_rotvec(turn).apply(problem.centre_m)
    return replace(
        problem,
        force_N=problem.force_N + force,
        moment_Nm=problem.moment_Nm + np.cross(arm, force),
    )


def turn_toward(position: np.ndarray, facing: Data) -> np.ndarray:
    """Return the shortest turn that brings an axis to face a point, by the half-way quaternion."""
    axis = np.array(facing["axis"]) / np.linalg.norm(facing["axis"])
    along = np.array(facing["toward"]) - position
    along = along / np.linalg.norm(along)
    quaternion = np.append(np.cross(axis, along), 1.0 + axis @ along)
    return Rotation.from_quat(quaternion).as_rotvec()


def turns_of(study: Data, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Return the orientations of a study, of a range so many at random."""
    workspace = study["workspace"]
    if "orientation" in workspace:
        return [np.array(workspace["orientation"], dtype=float)]
    if "orientations" in workspace:
        return [np.array(one, dtype=float) for one in workspace["orientations"]]
    if "orientation_range" not in workspace:
        return [np.zeros(3)]
    names = ("rx", "ry", "rz")
    ends = np.array([workspace["orientation_range"].get(n, [0.0, 0.0]) for n in names])
    return list(ends[:, 0] + rng.uniform(size=(count, 3)) * np.ptp(ends, axis=1))
