"""Every option of a study, once: how it changes the text of a small study.

A base is the text of a study without options. An option says on which bases it has a meaning, and
changes the text. Options that change a load case change the same one.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Text = dict[str, Any]

_CABLE = {
    "density": 5290.0,
    "youngs_modulus": 6.27e10,
    "allowable_stress": 1.98e8,
    "drag_coefficient": 1.2,
}
_DRAG = {"area": 0.6, "coefficient": 1.1}
_MODULUS = {"reference_area": "nominal", "basis": "printed", "source": "a test", "uncertainty": 0.1}
_ROPE = {
    "manufacturer": "maker",
    "product": "rope",
    "finish": "bright",
    "trust": "A",
    "source": {"publisher": "made for a test", "document": "table of pairs"},
}
WIRE: Text = {
    "id": "pairs-wire",
    **_ROPE,
    "construction": "7x19",
    "core": "WSC",
    "material": "steel",
    "modulus": {"value": 6.27e10, **_MODULUS},
    "sheave_ratio": {"suggested": 40, "minimum": 20, "source": "a test"},
    "currency": "EUR",
    "sizes": [
        {
            "id": f"{d} mm",
            "diameter": d / 1e3,
            "minimum_breaking_load": 780.0 * d**2,
            "linear_mass": 4.15e-3 * d**2,
            "price_per_m": 0.3 * d,
        }
        for d in (3, 5, 8)
    ],
}
FIBRE: Text = {
    "id": "pairs-fibre",
    **_ROPE,
    "construction": "12 strands",
    "core": "HMPE",
    "material": "HMPE",
    "stiffness": {
        "ea_over_breaking_load": 40.0,
        "basis": "printed",
        "source": "a test",
        "uncertainty": 0.2,
    },
    "sheave_ratio": {"suggested": 20, "minimum": 10, "source": "a test"},
    "currency": "EUR",
    "sizes": [
        {
            "id": f"{d} mm",
            "diameter": d / 1e3,
            "minimum_breaking_load": 900.0 * d**2,
            "linear_mass": 6.2e-4 * d**2,
            "price_per_m": 0.6 * d,
        }
        for d in (4, 6, 9)
    ],
}
GRADES: Mapping[str, Text] = {grade["id"]: grade for grade in (WIRE, FIBRE)}


def _base(name: str, anchors: list, platform: Text, points: list, **robot: Any) -> Text:
    return {
        "name": name,
        "robot": {"anchors": anchors, "platform": platform | {"drag": _DRAG}, **robot},
        "cable": dict(_CABLE),
        "workspace": {"region": {"points": points}, "samples": 16, "proof": 0},
        "selection": {"grades": ["pairs-wire"], "safety_factor": 5},
    }


OF_A_ROPE = "effects of a rope are not applied to those of the catalogue, whose data sheets count"

BASES: Mapping[str, Text] = {
    "crane": _base(
        "crane",
        [[0.0, 0.0, 10.0], [12.0, 0.0, 10.0], [6.0, 10.0, 11.0]],
        {"mass": 240.0},
        [[5.0, 3.0, 4.0], [7.0, 5.0, 5.0], [6.0, 4.0, 2.0]],
    ),
    "four": _base(
        "crane of four cables",
        [[0.0, 0.0, 9.0], [12.0, 0.0, 9.5], [11.0, 10.0, 9.0], [1.0, 9.0, 10.0]],
        {"mass": 200.0},
        [[5.0, 3.0, 4.0], [7.0, 5.0, 5.0]],
    ),
    "six": _base(
        "platform of six cables",
        [
            [7.0, 0.2, 8.0], [7.0, -0.2, 8.0], [-3.4, 6.2, 8.0],
            [-3.6, 5.9, 8.0], [-3.6, -5.9, 8.0], [-3.4, -6.2, 8.0],
        ],
        {
            "mass": 400.0,
            "attachments": [
                [0.6, 1.05, 0.5], [0.6, -1.05, 0.5], [0.6, 1.0, 0.5],
                [-1.2, 0.0, 0.5], [-1.2, 0.05, 0.5], [0.6, -1.0, 0.5],
            ],
        },
        [[0.3, 0.1, 1.5], [-0.2, 0.3, 2.5]],
    ),
    "body": _base(
        "platform of eight cables",
        [
            [-7.1, 5.4, 5.4], [7.5, 5.0, 5.4], [7.1, -5.5, 5.3], [-7.4, -5.1, 5.4],
            [-7.4, 5.1, 5.3], [7.2, 5.3, 5.4], [7.4, -5.2, 5.3], [-7.1, -5.4, 5.3],
        ],
        {
            "mass": 300.0,
            "centre_of_mass": [-0.03, -0.01, 0.26],
            "attachments": [
                [0.5, 0.36, 1.0], [0.5, -0.34, 1.0], [-0.5, -0.35, 1.0], [-0.5, 0.35, 1.0],
                [-0.5, -0.27, 0.0], [-0.5, 0.49, 0.0], [0.5, 0.275, 0.0], [0.5, -0.49, 0.0],
            ],
        },
        [[0.5, 0.3, 1.2], [-1.5, 0.8, 1.6]],
    ),
    "plane": _base(
        "facade",
        [[-9.0, 0.0, 15.0], [9.0, 0.0, 15.0], [9.0, 0.0, 0.0], [-9.0, 0.0, 0.0]],
        {
            "mass": 120.0,
            "centre_of_mass": [0.0, 0.0, -0.2],
            "attachments": [[-0.5, 0.0, -0.3], [0.5, 0.0, -0.3], [0.5, 0.0, 0.3], [-0.5, 0.0, 0.3]],
        },
        [[2.0, 0.0, 6.0], [-3.0, 0.0, 8.0]],
        planar=True,
    ),
}  # fmt: skip
PATHS: Mapping[str, tuple[list[float], list[float]]] = {
    f"path-{name}.csv": (base["workspace"]["region"]["points"][0],
                         base["workspace"]["region"]["points"][-1])
    for name, base in BASES.items()
}  # fmt: skip
"""Files of paths: the two ends of a straight line, from rest to rest in `PATH_S`."""
PATH_S = 6.0


Row = tuple[list[float], list[float], str]


def _rows(base: Text, turns: list[list[float]], owners: tuple[str, str]) -> list[Row]:
    """Return poses of a base, each with the load case that it is for, '' for all."""
    first, *_, last = base["workspace"]["region"]["points"]
    between = [0.7 * a + 0.3 * b for a, b in zip(first, last, strict=True)]
    return [
        (first, turns[0], owners[0]),
        (last, turns[1], ""),
        (between, turns[2], owners[1]),
    ]


_TURNS = [[0.0, 0.05, 0.0], [0.0, -0.03, 0.0], [0.0, 0.01, 0.0]]
POSES: Mapping[str, list[Row]] = {
    f"{kind}-{name}.csv": _rows(base, _TURNS, ("", owner))
    for name, base in BASES.items()
    for kind, owner in (("poses", ""), ("poses-of-case", "working"))
}
"""Files of poses, with orientations for what can turn."""


PRICES = "prices.csv"
"""A price list, in which the thickest rope is the cheapest."""


def file_text(name: str) -> str:
    """Return what a file beside a study holds."""
    if name == PRICES:
        sizes = [(WIRE, (3, 5, 8)), (FIBRE, (4, 6, 9))]
        rows = [[g["id"], d, 12 - d, "USD", 2026] for g, each in sizes for d in each]
        return _csv(["grade", "diameter_mm", "price_per_m", "currency", "date"], rows)
    if name in PATHS:
        rows = [[t, *place] for t, place in zip((0.0, PATH_S), PATHS[name], strict=True)]
        return _csv(["time_s", *_AXES], rows)
    base = BASES[name.removesuffix(".csv").rpartition("-")[2]]
    turns = ["rx_rad", "ry_rad", "rz_rad"] * ("attachments" in base["robot"]["platform"])
    owner = ["load_case"] * name.startswith("poses-of-case")
    rows = [[*at, *turn[: len(turns)], *[of][: len(owner)]] for at, turn, of in POSES[name]]
    return _csv([*_AXES, *turns, *owner], rows)


_AXES = ["x_m", "y_m", "z_m"]


def _csv(names: list[str], rows: list[list[Any]]) -> str:
    return "\n".join([",".join(names), *(",".join(map(str, row)) for row in rows), ""])


def files_of(study: Text) -> list[str]:
    """Return the names of the files beside a study."""
    workspace = study.get("workspace", {})
    facing = workspace.get("orientation")
    named = (
        workspace.get("path"),
        workspace.get("poses"),
        facing.get("table") if isinstance(facing, dict) else None,
        study.get("selection", {}).get("prices"),
    )
    files = (PRICES, *PATHS, *POSES)
    return [name for name in named if name in files]


POINT = ("crane", "four")
SPACE = ("crane", "four", "six", "body")
REDUNDANT = ("four", "body", "plane")
BODY = ("body", "six", "plane")
ALL = ("crane", "four", "body", "six", "plane")


@dataclass(frozen=True)
class Option:
    """One option: its name in the table, the bases it fits, first the cheapest, what it changes."""

    id: str
    words: str
    bases: tuple[str, ...]
    change: Callable[[Text], None]
    is_command: bool = False
    not_covered: Callable[[Text], str] = lambda _: ""


def case(study: Text) -> Text:
    """Return the load case that all options change."""
    cases = study.setdefault("load_cases", [])
    if not cases:
        cases.append({"name": "working"})
    return cases[0]


def _set(path: str, value: Any) -> Callable[[Text], None]:
    """Put a value at a path of the study, or of its load case where it begins with ``case``."""

    def change(study: Text) -> None:
        *folders, last = path.split(".")
        section = study
        for name in folders:
            section = case(study) if name == "case" else section.setdefault(name, {})
        section[last] = copy.deepcopy(value)

    return change


def _own_region(study: Text) -> None:
    points = copy.deepcopy(study["workspace"]["region"].get("points"))
    if points is None:
        low, high = zip(*study["workspace"]["region"]["box"], strict=True)
        points = [list(low), list(high)]
    for point in points:
        point[2] += 0.7
    case(study)["region"] = {"points": points[:2]}


def _box(study: Text) -> None:
    x, y, z = study["workspace"]["region"]["points"][0]
    box = [[x - 0.6, x + 0.6], [y - 0.5, y + 0.5], [z - 0.4, z + 0.4]]
    if study["robot"].get("planar"):
        study["workspace"]["region"] = {"rectangle": [[x - 0.6, y], [x + 0.6, y]], "z": box[2]}
    else:
        study["workspace"]["region"] = {"box": box}


def _gravity(study: Text) -> None:
    study["robot"]["gravity"] = [0.04, 0.0 if study["robot"].get("planar") else -0.03, -1.0]


def _tilt(study: Text) -> None:
    flat = {"ry_rad": 0.03}
    study.setdefault("effects", {})["base_tilt"] = (
        flat if study["robot"].get("planar") else flat | {"rx_rad": -0.02}
    )


def _along(study: Text) -> list[float]:
    return [1.0, 0.0, 0.0] if study["robot"].get("planar") else [0.6, 0.8, 0.0]


def _anchor(study: Text) -> None:
    study.setdefault("effects", {})["anchor_offset"] = {"cable": 1, "x_m": 0.1, "z_m": -0.08}


def _groups(study: Text) -> None:
    n = len(study["robot"]["anchors"])
    study["selection"]["groups"] = {"first": [1, 2], "others": list(range(3, n + 1))}
    study["selection"]["objectives"] = ["mass"]


def _frequency(study: Text) -> None:
    _set("selection.limits.platform_frequency", 0.05)(study)
    if "attachments" in study["robot"]["platform"]:
        study["robot"]["platform"]["inertia"] = [60.0, 70.0, 90.0]


def _duty_class(study: Text) -> None:
    del study["selection"]["safety_factor"]
    study["selection"]["duty_class"] = "M5"


def _turns(study: Text) -> None:
    study["workspace"]["orientations"] = [[0.0, 0.0, 0.0], [0.0, 0.05, 0.0]]


def _wrench(force: list[float]) -> Callable[[Text], Text]:
    return lambda study: {"force": [force[0], 0.0 if study["robot"].get("planar") else force[1],
                                    force[2]]}  # fmt: skip


_FORCES = {"force": [[-60.0, 80.0], [0.0, 0.0], [-300.0, 100.0]]}


def _wrench_list(study: Text) -> list[Text]:
    return [_wrench(force)(study) for force in ([70, -40, -50], [-60, 50, -200], [0, 0, 120])]


def _at(path: str, value_of: Callable[[Text], Any]) -> Callable[[Text], None]:
    return lambda study: _set(path, value_of(study))(study)


def _spooling(study: Text) -> None:
    _set("robot.winches.drum_diameter", 0.2)(study)
    aside = {"sheave_distance": 9.0, "fleet_angle_max": 0.03}
    _set("robot.winches.drum", {"length": 0.3} | aside)(study)


def _winches_each(study: Text) -> None:
    n_cables = len(study["robot"]["anchors"])
    largest = [[900.0, None, 700.0][k % 3] for k in range(n_cables)]
    _set("robot.winches.tension_max", largest)(study)


def _lines(study: Text) -> None:
    lines = [
        {"linear_mass": 0.35, "diameter": 0.012},
        None,
        {"linear_mass": 0.2, "diameter": 0.008},
    ]
    n_cables = len(study["robot"]["anchors"])
    study["robot"]["attached"] = [lines[k % 3] for k in range(n_cables)]


def _beside(kind: str, study: Text) -> str:
    name = next(name for name, base in BASES.items() if base["name"] == study["name"])
    return f"{kind}-{name}.csv"


def _path(study: Text) -> None:
    study["workspace"]["path"] = _beside("path", study)
    study["workspace"].pop("proof", None)
    if "points" in study["workspace"].get("region", {}):
        del study["workspace"]["region"]


def _poses(kind: str) -> Callable[[Text], None]:
    def change(study: Text) -> None:
        study["workspace"]["poses"] = _beside(kind, study)
        if "points" in study["workspace"].get("region", {}):
            del study["workspace"]["region"]
        if kind == "poses-of-case":
            case(study)

    return change


def _life(study: Text) -> None:
    _path(study)
    study["selection"].setdefault("sheave_diameter", 0.2)
    constants = {"b0": 1.278, "b1": 0.029, "b2": 6.241, "b3": -1.613}
    study["selection"]["rope_life"] = {
        **constants, "wire_strength": 1.77e9, "source": "a test", "runs_per_day": 3.0,
        "days_min": 5.0,
    }  # fmt: skip


def _motor(study: Text) -> None:
    motor = {"drum_diameter": 0.25, "layers": 2, "gear_ratio": 12.0, "efficiency": 0.9}
    study["robot"].setdefault("winches", {}).update(**motor, motor={"torque": 60.0})


def _positions(study: Text) -> None:
    anchors = study["robot"]["anchors"]
    study["robot"].setdefault("winches", {})["positions"] = [
        [x + 0.4, y, z - 2.5 - 0.1 * k] for k, (x, y, z) in enumerate(anchors)
    ]


def _nothing(study: Text) -> None:
    """Commands change no study."""


OPTIONS: tuple[Option, ...] = (
    Option(
        "wrench",
        "force on the platform",
        ALL,
        _at("robot.platform.wrench", _wrench([90, 60, -300])),
    ),
    Option("case_mass", "mass of a load case", ALL, _set("case.mass", 310.0)),
    Option(
        "case_wrench", "force of a load case", ALL, _at("case.wrench", _wrench([-50, 80, -100]))
    ),
    Option("wrench_box", "box of forces", ALL, _set("case.wrench_set", _FORCES)),
    Option("wrench_list", "list of forces", ALL, _at("case.wrench_set", _wrench_list)),
    Option("dynamic_factor", "dynamic factor", ALL, _set("case.dynamic_factor", 1.3)),
    Option("acceleration", "acceleration", ALL, _set("case.acceleration", 0.6)),
    Option(
        "wind_along",
        "wind along one direction",
        ALL,
        _at("case.wind", lambda s: {"speed": 18.0, "direction": _along(s)}),
    ),
    Option("wind", "wind from the worst direction", ALL, _set("case.wind", {"speed": 15.0})),
    Option("ice", "ice on the cables", ALL, _set("case.ice", {"thickness": 0.004})),
    Option("temperature", "change of temperature", ALL, _set("case.temperature_change", -35.0)),
    Option(
        "cable_lost", "loss of one cable", ("four", "body", "plane"), _set("case.cable_lost", 2)
    ),
    Option(
        "each_lost",
        "loss of each cable",
        ("four", "body", "plane"),
        _set("case.cable_lost", "each"),
    ),
    Option("case_factor", "safety factor of a load case", ALL, _set("case.safety_factor", 3.0)),
    Option(
        "case_fitting", "end fittings of a load case", ALL, _set("case.termination_efficiency", 0.8)
    ),
    Option("case_region", "region of a load case", ALL, _own_region),
    Option("pulleys", "pulleys", ALL, _set("effects.pulley_radius", {"radius_m": 0.12})),
    Option("anchor_offset", "moved exit point", ALL, _anchor),
    Option("base_tilt", "tilted base", ALL, _tilt),
    Option(
        "elastic_modulus",
        "another modulus",
        ALL,
        _set("effects.elastic_modulus", {"scale": 0.7}),
        not_covered=lambda _: OF_A_ROPE,
    ),
    Option(
        "linear_mass",
        "another mass per length",
        ALL,
        _set("effects.linear_mass", {"scale": 1.4}),
        not_covered=lambda _: OF_A_ROPE,
    ),
    Option(
        "platform_mass",
        "another mass of the platform",
        ALL,
        _set("effects.platform_mass", {"offset_kg": 25.0}),
    ),
    Option(
        "centre_of_mass",
        "moved centre of mass",
        BODY,
        _set("effects.centre_of_mass_offset", {"x_m": 0.06, "z_m": 0.05}),
    ),
    Option(
        "reading_effect",
        "effect on readings",
        ALL,
        _set("effects.drum_scale", {"scale": 1.001}),
        not_covered=lambda _: "an effect on readings changes no design",
    ),
    Option("planar", "robot in a plane", ("plane",), _nothing),
    Option("gravity", "direction of gravity", ALL, _gravity),
    Option("orientation", "one orientation", BODY, _set("workspace.orientation", [0.0, 0.06, 0.0])),
    Option("orientations", "several orientations", BODY, _turns),
    Option(
        "orientation_range",
        "range of orientations",
        BODY,
        _set("workspace.orientation_range", {"ry": [-0.03, 0.05]}),
    ),
    Option(
        "toward",
        "orientation toward a point",
        BODY,
        _set("workspace.orientation", {"toward": [1.0, -2.0, 40.0], "axis": [0.0, 0.05, 1.0]}),
    ),
    Option(
        "table",
        "table of orientations",
        BODY,
        lambda s: _set("workspace.orientation", {"table": _beside("poses", s)})(s),
    ),
    Option(
        "orientation_free",
        "best orientation of a range",
        BODY,
        _set("workspace.orientation_free", {"ry": [-0.04, 0.06]}),
    ),
    Option("box", "region with a volume", ALL, _box),
    Option("fibre", "fibre rope", ALL, _set("selection.grades", ["pairs-fibre"])),
    Option("tension_min", "least tension", REDUNDANT, _set("robot.tension_min", 40.0)),
    Option("sag", "largest sag", REDUNDANT, _set("workspace.sag", 0.02)),
    Option(
        "clearance",
        "clearance",
        ("body", "six", "four", "plane", "crane"),
        _set("workspace.clearance", 0.02),
    ),
    Option("floor", "floor", ALL, _set("workspace.floor", 0.1)),
    Option(
        "exclude",
        "poses with hanging cables left out",
        ALL,
        _set("workspace.hangs_below", "exclude"),
    ),
    Option("stiffness", "least stiffness", ALL, _set("selection.limits.stiffness", 1000.0)),
    Option(
        "excitation", "band of excitation", ALL, _set("selection.limits.excitation", [0.2, 0.9])
    ),
    Option("drum", "capacity of the drums", ALL, _set("selection.limits.drum_capacity", 12.0)),
    Option("platform_frequency", "frequency of the platform", ALL, _frequency),
    Option("duty_class", "duty class", ALL, _duty_class),
    Option("winch_tension", "largest tension", ALL, _set("robot.winches.tension_max", 900.0)),
    Option("winch_tension_each", "largest tension of each winch", ALL, _winches_each),
    Option(
        "sheave_losses",
        "losses on two sheaves",
        ALL,
        lambda s: s["robot"].setdefault("winches", {}).update(sheave_efficiency=0.96, sheaves=2),
    ),
    Option("motor", "torque of the motors", ALL, _motor),
    Option("winch_positions", "places of the winches", ALL, _positions),
    Option("spooling", "layers on the drums", ALL, _spooling),
    Option(
        "attached",
        "line along the cables",
        ALL,
        _set("robot.attached", {"linear_mass": 0.35, "diameter": 0.012}),
    ),
    Option("attached_each", "line along some cables", ALL, _lines),
    Option("sheave", "sheave", ALL, _set("selection.sheave_diameter", 0.2)),
    Option("fitting", "end fittings", ALL, _set("selection.termination_efficiency", 0.9)),
    Option("groups", "groups of cables", ALL, _groups),
    Option("cost", "least cost", ALL, _set("selection.objectives", ["cost"])),
    Option("prices", "price list", ALL, _set("selection.prices", PRICES)),
    Option(
        "pose",
        "configured pose",
        ALL,
        lambda s: s.update(pose=list(s["workspace"]["region"].get("points", [[5.0, 3.0, 4.0]])[0])),
    ),
    Option(
        "uncertainty",
        "uncertainty",
        ALL,
        _set(
            "uncertainty",
            {"payload": {"uniform": 0.1}, "modulus": {"uniform": 0.01}, "samples": 128},
        ),
    ),
    Option("poses", "list of poses", ALL, _poses("poses")),
    Option("poses_of_case", "list of poses, some for a load case", ALL, _poses("poses-of-case")),
    Option("path", "path with inertia", ALL, _path),
    Option(
        "rope_life",
        "life of the rope along a path",
        ALL,
        _life,
        not_covered=lambda text: (
            "the constants of a rope's life are of steel wire ropes"
            if text["selection"]["grades"] == ["pairs-fibre"]
            else ""
        ),
    ),
    Option(
        "lengths",
        "`designer lengths`",
        ALL,
        _nothing,
        is_command=True,
        not_covered=lambda text: (
            "lengths are those under the study's own load, not in its load cases"
            if text.get("load_cases")
            else ""
        ),
    ),
    Option("compare", "`designer compare`", ALL, _nothing, is_command=True),
    Option("sweep", "`designer sweep`", ALL, _nothing, is_command=True),
    Option(
        "diagnose",
        "`designer diagnose --check`",
        ALL,
        _nothing,
        is_command=True,
        not_covered=lambda text: (
            "a machine is measured under its own load, not in its load cases"
            if text.get("load_cases")
            else "a machine is measured with one rope on all cables"
            if "groups" in text["selection"]
            else ""
        ),
    ),
    Option("optimise", "`designer optimise`", ALL, _nothing, is_command=True),
)
BY_ID: Mapping[str, Option] = {option.id: option for option in OPTIONS}


def base_of(*options: Option) -> str | None:
    """Return the first base that all options fit; None where no robot has all of them."""
    common = [name for name in options[0].bases if all(name in o.bases for o in options)]
    return common[0] if common else None


def study_of(base: str, *options: Option) -> Text:
    """Return the text of a study with options, in the order of the table."""
    study = copy.deepcopy(dict(BASES[base]))
    for option in sorted(options, key=OPTIONS.index):
        option.change(study)
    return study
