"""The figures of the explanation, drawn from the package."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial.transform import Rotation

import designer
from designer.arrays import frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.robot import Platform, Poses, Robot
from designer.physics.catenary import end_tensions_N, forces_from_length, position_m
from designer.sizing.newton import limit_ratio, size_poses


def draw_all(folder):
    """Draw each figure that is not there yet."""
    plt.switch_backend("Agg")
    folder.mkdir(exist_ok=True)
    for draw in (catenary, sizing, internal, cone, tilt, euler):
        path = Path(folder, f"{draw.__name__}.svg")
        if not path.exists():
            figure, axes = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
            draw(axes)
            figure.savefig(path, metadata={"Date": None})
            plt.close(figure)


def catenary(axes):
    """One cable of the paper's robot between two points, paid out further and further."""
    section_m2 = np.pi / 4 * 0.032**2
    weight = 7800.0 * section_m2 * STANDARD_GRAVITY_M_PER_S2
    stiffness = 200e9 * section_m2
    for paid_out_m in (320.4, 321, 324, 332):
        force_x, force_z = forces_from_length(paid_out_m, 316.2, 50.0, stiffness, weight)
        s = np.linspace(0.0, paid_out_m, 200)
        x, z = position_m(s, paid_out_m, force_x, force_z, stiffness, weight)
        top, _ = end_tensions_N(paid_out_m, force_x, force_z, weight)
        axes.plot(x, z, label=f"{paid_out_m:g} m paid out: {top / 1e3:.0f} kN")
    axes.plot([0, 316.2], [0, -50], "k.")
    axes.set(xlabel="horizontal distance [m]", ylabel="height [m]")
    axes.legend(frameon=False)


def sizing(axes):
    """The needed diameter from the middle of the paper's robot toward its edge."""
    study = designer.read_study(designer.example_file("fast"), with_plugins=False)
    robot, middle = study.robot, study.robot.exit_points_m.mean(axis=0)
    share = np.linspace(0.0, 0.97, 120)
    at = middle + share[:, None] * ([250.0, 0.0, 0.0] - middle) + [0.0, 0.0, -50.0]
    found = size_poses(robot, Poses.at(at), study.material)
    ratio = limit_ratio(robot, Poses.at(at), study.material)
    distance_m = np.linalg.norm(at[:, :2] - middle[:2], axis=1)
    axes.plot(distance_m, 1e3 * found.massless_diameter_m, label="weightless cables")
    axes.plot(distance_m, 1e3 * found.diameter_m, label="cables with their weight")
    end_m = distance_m[ratio < 1.0].max()
    axes.axvline(end_m, color="k", linestyle=":", label="no finite cable beyond")
    axes.set(xlabel="distance from the middle [m]", ylabel="needed diameter [mm]", ylim=(0, 120))
    axes.legend(frameon=False)


def internal(axes):
    """All tensions of four cables that hold a point: one choice is left."""
    anchors = np.array([[0, 0, 30], [80, 0, 30], [80, 50, 30], [0, 50, 30]])
    robot = Robot(frozen_array(anchors), Platform(900.0))
    pulls = anchors - [30.0, 20.0, 12.0]
    matrix = (pulls / np.linalg.norm(pulls, axis=1, keepdims=True)).T
    weight_N = robot.platform.mass_kg * STANDARD_GRAVITY_M_PER_S2
    one = np.linalg.lstsq(matrix, [0.0, 0.0, weight_N], rcond=None)[0]
    free = np.linalg.svd(matrix)[2][-1]
    choice = np.linspace(-9e3, 9e3, 400)
    tension_kN = (one[:, None] + free[:, None] * choice) / 1e3
    for number, row in enumerate(tension_kN, start=1):
        axes.plot(choice / 1e3, row, label=f"cable {number}")
    largest = np.where((tension_kN >= 0).all(axis=0), tension_kN.max(axis=0), np.inf)
    best = choice[np.argmin(largest)] / 1e3
    axes.axvline(best, color="k", linestyle=":", label="smallest largest tension")
    axes.axhline(0, color="k", linewidth=0.8)
    axes.set(xlabel="internal force [kN]", ylabel="tension [kN]", ylim=(-1, 17))
    axes.legend(frameon=False, ncols=3, loc="upper center")


def cone(axes):
    """What two cables to the right of a platform can do, whatever they weigh, and its weight."""
    for x, colour in ((1.0, "C0"), (3.4, "C1")):
        axes.plot([0, x], [0, 2], "--", color=colour, linewidth=1)
        axes.annotate("", (x / 2, 1), (0, 0), arrowprops={"arrowstyle": "->", "color": colour})
        axes.plot(x, 2, "o", color=colour)
    axes.annotate("", (0, -1.2), (0, 0), arrowprops={"arrowstyle": "->", "color": "C2"})
    axes.annotate("", (0, 1.5), (0, 0), arrowprops={"arrowstyle": "->", "linewidth": 2})
    axes.fill([0, 1.0, 3.4], [0, 2, 2], color="C0", alpha=0.15)
    axes.fill([0, 3.4, 3.4, 0], [0, 2, -1.4, -1.4], color="C2", alpha=0.15)
    axes.plot([-0.56, 0.92], [-1.4, 2.3], "k:", linewidth=1)  # through the origin
    axes.text(1.2, 1.6, "straight cables do this", color="C0")
    axes.text(0.5, -0.6, "sagging ones also this", color="C2")
    axes.text(-0.1, 1.3, "what the weight asks for: outside", ha="right")
    axes.set(aspect="equal", xlim=(-3.2, 3.6), ylim=(-1.5, 2.4))
    axes.set_axis_off()


def tilt(axes):
    """A base frame that leans by positive angles, as the model turns it; gravity stays upright."""
    masts = frozen_array([[-1.0, -1.0, 1.2], [1.0, -1.0, 1.2], [0.0, 1.0, 1.2]])
    views = (("ry", (0.0, 0.25), 0, "y away from you"), ("rx", (0.25, 0.0), 1, "x toward you"))
    for x, (name, angles, across, depth) in zip((0.0, 4.4), views, strict=True):
        robot = Robot(masts, Platform(1.0), tilt_rad=frozen_array(angles))
        # Its columns are axes of the base; of the room, the picture has one axis and the height.
        horizontal, up = robot.level[[across, 2]][:, [across, 2]].T
        place = np.array([x, 0.0])
        ground = np.array([place - 1.3 * horizontal, place + 1.3 * horizontal])
        axes.plot(*ground.T, color="0.4", linewidth=3)
        for side in (-1.1, 1.1):
            foot = place + side * horizontal
            axes.plot(*np.array([foot, foot + 1.4 * up]).T, color="0.4", linewidth=1.5)
        _arrow(axes, place, 1.6 * horizontal, f"C{across}", "xy"[across])
        _arrow(axes, place, 1.2 * up, "C2", "z")
        axes.plot([x, x], [0.0, 1.5], "k:", linewidth=1)
        lean = np.linspace(0.0, np.arctan2(*up), 20)
        _turn(axes, place + 0.9 * np.array([np.sin(lean), np.cos(lean)]).T)
        axes.text(x, 1.75, f"{name} > 0, {depth}", ha="center")
        axes.annotate("", (x, -1.0), (x, -0.1), arrowprops={"arrowstyle": "->", "lw": 2})
        axes.text(x + 0.1, -0.8, "gravity")
    axes.set(aspect="equal", xlim=(-1.9, 6.3), ylim=(-1.1, 2.1))
    axes.set_axis_off()


def euler(axes):
    """The turns of euler_intrinsic_zyx by positive angles, about axes as those before left them."""
    screen = np.array([[-0.5, 0.95, 0.0], [-0.35, -0.1, 1.0]])  # x toward you, y right, z up
    turned = Rotation.identity()
    stages = (("z", 40.0, "y"), ("y", 30.0, "x"), ("x", 50.0, "y"))
    for number, (name, angle_deg, moved) in enumerate(stages):
        place = np.array([2.6 * number, 0.0])
        before = turned
        turned = before * Rotation.from_euler(name.upper(), angle_deg, degrees=True)
        for axis, unit in zip("xyz", np.eye(3), strict=True):
            if axis != name:
                _arrow(axes, place, screen @ before.apply(unit), "0.75", "")
            colour = f"C{'xyz'.index(axis)}"
            _arrow(axes, place, screen @ turned.apply(unit), colour, axis)
        part = Rotation.from_euler(
            name.upper(), np.linspace(0.0, angle_deg, 20)[:, None], degrees=True
        )
        arc = (before * part).apply(0.75 * np.eye(3)["xyz".index(moved)]) @ screen.T + place
        _turn(axes, arc)
        which = "z" if number == 0 else f"the new {name}"
        axes.text(place[0], -1.15, f"{number + 1}: about {which}", ha="center")
    axes.set(aspect="equal", xlim=(-1.1, 6.6), ylim=(-1.3, 1.3))
    axes.set_axis_off()


def _turn(axes, arc):
    axes.plot(*arc[:-1].T, "k", linewidth=1)
    axes.annotate("", arc[-1], arc[-3], arrowprops={"arrowstyle": "->"})


def _arrow(axes, start, along, colour, label):
    start, along = np.asarray(start), np.asarray(along)
    style = {"arrowstyle": "->", "color": colour, "lw": 1.6}
    axes.annotate("", start + along, start, arrowprops=style)
    axes.text(*(start + 1.12 * along), label, color=colour, ha="center", va="center")
