"""Moves of the platform: by the mouse, the keys, an entry, or to a pose that has a name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray

if TYPE_CHECKING:
    from designer.explore.desktop.window import Window

_TURN_RAD = float(np.radians(1.0))


class Moving:
    """What the window does with the place of the platform."""

    def __init__(self, window: Window) -> None:
        self._window = window

    def to(self, place: FloatArray, moving: bool = False) -> None:
        """Take the platform to a position (3,) or a place (6,), or on the way there."""
        session = self._window.session
        if session is None or session.study is None:
            return
        session.move(place, continuous=moving)
        if not moving:
            session.settle()
        self._window.changed(moving=moving)

    def step(self, direction: FloatArray, times: float) -> None:
        """Move it by steps along a direction (3,)."""
        session = self._window.session
        if session is None:
            return
        place = session.state.place.copy()
        place[:3] += times * self.step_m * direction
        self._nudge(place)

    def turn(self, axis: FloatArray, times: float) -> None:
        """Turn it by steps about an axis (3,) of the frame; in a plane about its normal."""
        from scipy.spatial.transform import Rotation

        session = self._window.session
        study = None if session is None else session.study
        if session is None or study is None:
            return
        if study.robot.is_planar:
            normal = np.asarray(study.robot.upright[1])
            axis = normal * float(axis.sum())
        place = session.state.place.copy()
        turned = Rotation.from_rotvec(times * _TURN_RAD * axis) * Rotation.from_rotvec(place[3:])
        place[3:] = turned.as_rotvec()
        self._nudge(place)

    def _nudge(self, place: FloatArray) -> None:
        """A step of the keys; several of them are one step to undo."""
        assert self._window.session is not None
        self._window.session.move(place, continuous=True)
        self._window.changed(moving=True)

    @property
    def step_m(self) -> float:
        """How far a key moves the platform: a round length, about a hundredth of what is shown."""
        size = float(np.ptp(self._window.work.scene.stage.bounds_m, axis=0).max())
        power = 10.0 ** np.floor(np.log10(size / 100.0))
        return float(power * max(k for k in (1.0, 2.0, 5.0) if k * power <= size / 100.0))

    def to_worst(self) -> None:
        """Take the platform to the worst pose."""
        worst = self._window.answers.get("worst")
        if worst is not None and worst.place is not None:
            self.to(worst.place)

    def to_pose(self) -> None:
        """Take the platform to the pose of the study."""
        session = self._window.session
        if session is not None and session.study is not None and session.study.pose is not None:
            self.to(session.study.pose.place)

    def keep(self) -> None:
        """Write the place of the platform into the study."""
        session = self._window.session
        if session is not None:
            for fault in session.keep_pose():
                self._window.tell(str(fault))
            self._window.editing.show()
            self._window.changed()
