"""The platform at rest and as far as it moves in each of its modes, which move where a page can."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.analysis.governing import PlatformModes
from designer.arrays import FloatArray
from designer.model.robot import Robot
from designer.report import format as fmt
from designer.report.figures import palette
from designer.report.figures.parts import hull_edges, hull_faces
from designer.statics.inverse import Statics
from designer.statics.modes import Mode

_MOVES = 0.3
"""How far the farthest-moving attachment is drawn to move, over the reach of the platform."""
_STUB = 0.9
"""How much of each cable is drawn, over the same."""
_FROM_ASIDE = np.array([[0.82, -0.57, 0.0], [0.24, 0.35, 0.905]])
_IN_PLANE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Right and upward of the sheet, in the frame whose z axis is the vertical."""
WIDTH, HEIGHT, _MARGIN = 160.0, 120.0, 4.0
PERIOD_S = 2.4
"""Of all modes alike, since the eye cannot follow the quick ones."""
_SINE = ".37 0 .63 1"
"""Control points of a cubic curve that is near half a period of a cosine."""


def mode_shapes(modes: PlatformModes) -> tuple[str, ...]:
    """Return each mode as SVG: at rest, and at its end, which moves to the other end and back."""
    rest, moves = on_sheet(modes)
    return tuple(
        _svg(number, mode, *(_path(rest + sign * move) for sign in (0.0, 1.0, -1.0)))
        for number, (mode, move) in enumerate(zip(modes.modes, moves, strict=True), start=1)
    )


def on_sheet(modes: PlatformModes) -> tuple[FloatArray, FloatArray]:
    """Return lines (n, 2, 2) of the platform and its cables, and how they move (n_modes, n, 2, 2).

    On a sheet of `WIDTH` by `HEIGHT`, y downward. Displacements are those of small motions, drawn
    far larger; that of a point is linear in its lever, u + θ × r, and that of a cable falls off
    linearly toward its exit point.
    """
    statics = modes.statics
    lines, shares = _lines(statics)
    robot = statics.robot
    view = (_IN_PLANE if robot.is_planar else _FROM_ASIDE) @ robot.level
    moves = [_MOVES * _reach_m(robot) * _displacements(mode, lines, shares) for mode in modes.modes]
    every = np.concatenate([lines + sign * move for move in moves for sign in (1.0, -1.0)]) @ view.T
    low, high = every.min(axis=(0, 1)), every.max(axis=(0, 1))
    sheet = np.array([WIDTH, HEIGHT])
    scale = float(((sheet - 2.0 * _MARGIN) / np.maximum(high - low, 1e-12)).min())
    to_sheet = scale * view.T * [1.0, -1.0]
    middle = 0.5 * (low + high) * scale * [1.0, -1.0]
    return lines @ to_sheet - middle + 0.5 * sheet, np.array(moves) @ to_sheet


def _path(lines: FloatArray) -> str:
    ends = lines.reshape(-1, 4).tolist()
    return "".join(f"M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" for x, y, u, v in ends)


def _reach_m(robot: Robot) -> float:
    """Return how far the farthest attachment is from the origin of the platform, 1 for a point."""
    return 1.0 if robot.is_point_mass else float(np.linalg.norm(robot.attachments_m, axis=1).max())


def _lines(statics: Statics) -> tuple[FloatArray, FloatArray]:
    """Return lines (n, 2, 3) about the platform's origin [m], and how far ends move with it."""
    robot, reach_m = statics.robot, _reach_m(statics.robot)
    turn = statics.poses.rotation
    levers = robot.attachments_m @ turn.T
    chords = robot.exit_points_m - statics.poses.position_m - levers
    shares = np.minimum(_STUB * reach_m / np.linalg.norm(chords, axis=1), 1.0)
    cables = np.stack([levers, levers + shares[:, None] * chords], axis=1)
    body = np.array([*_edges(robot, reach_m)]) @ turn.T
    moved = np.ones((len(body) + len(cables), 2))
    moved[len(body) :, 1] -= shares
    return np.concatenate([body, cables]), moved


def _edges(robot: Robot, reach_m: float) -> Iterator[FloatArray]:
    """Yield the edges (2, 3) of the platform, of a point those of a small cross [m]."""
    if robot.is_point_mass:
        for axis in 0.08 * reach_m * np.eye(3):
            yield np.array([-axis, axis])
        return
    points = robot.attachments_m if robot.platform.hull_m is None else robot.platform.hull_m
    faces = hull_faces(points)
    if len(faces) == 0:  # attached on a line
        ends = np.argsort(points @ (points - points.mean(axis=0))[0])[[0, -1]]
        yield points[ends]
        return
    yield from points[hull_edges(points, faces)]


def _displacements(mode: Mode, lines: FloatArray, shares: FloatArray) -> FloatArray:
    """Return how the ends of lines (n, 2, 3) move in a mode, as it is scaled [m]."""
    moved = np.broadcast_to(mode.shape[:3], lines.shape)
    if len(mode.shape) == 6:
        at = lines.copy()
        is_cable = shares[:, 1] < 1.0
        at[is_cable, 1] = lines[is_cable, 0]  # a cable goes where its attachment does
        moved = moved + np.cross(mode.shape[3:], at)
    return np.asarray(moved * shares[..., None])


def _svg(number: int, mode: Mode, rest: str, end: str, other_end: str) -> str:
    title = f"Mode {number} of the platform, {fmt.number(mode.frequency_Hz, 3)} Hz"
    values = f"{end};{other_end};{end}"
    return (
        f'<svg class="mode-shape" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" fill="none" '
        f'stroke-linecap="round"><title>{title}</title>'
        f'<path d="{rest}" stroke="{palette.FAINT}" stroke-width="1"/>'
        f'<path class="still" d="{end}" stroke="{palette.SAG}" stroke-width="1.6"/>'
        f'<path class="moving" display="none" d="{end}" stroke="{palette.SAG}" stroke-width="1.6">'
        f'<animate attributeName="d" values="{values}" dur="{PERIOD_S}s" calcMode="spline" '
        f'keyTimes="0;0.5;1" keySplines="{_SINE};{_SINE}" repeatCount="indefinite"/></path></svg>'
    )
