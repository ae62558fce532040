"""The window stays quick and small: nothing grows while a slider moves, nothing waits for work."""

from __future__ import annotations

import gc
import resource
import time
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QElapsedTimer, QObject, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QSlider
from window_driver import Driver

from designer.resources import example_file

LATE_MS = 50.0


def memory_MB() -> float:
    """Resident memory of this process."""
    with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123
        return int(file.read().split()[1]) * resource.getpagesize() / 2**20


@pytest.mark.slow
def test_two_hundred_moves_of_a_slider_leave_nothing_behind(yard: Driver) -> None:
    slider = yard.find(QSlider, "slider robot.platform.mass")
    slider.setFocus()

    def moves(count: int) -> None:
        for number in range(count):
            key = Qt.Key.Key_Right if number % 2 else Qt.Key.Key_Left
            QTest.keyClick(slider, key)
            QTest.qWait(15)
        yard.rest()

    moves(40)
    gc.collect()
    actors = sorted(yard.scene.renderer.actors)
    props, before_MB = yard.scene.renderer.GetViewProps().GetNumberOfItems(), memory_MB()
    moves(200)
    gc.collect()
    assert sorted(yard.scene.renderer.actors) == actors
    assert yard.scene.renderer.GetViewProps().GetNumberOfItems() == props
    assert memory_MB() - before_MB < 40.0


class Heartbeat(QObject):
    """How late a timer of the window's thread comes [ms]."""

    def __init__(self, every_ms: int = 5) -> None:
        super().__init__()
        self.late_ms: list[float] = []
        self._clock = QElapsedTimer()
        self._every_ms = every_ms
        self._timer = QTimer(self, interval=every_ms, timerType=Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._beat)

    def _beat(self) -> None:
        self.late_ms.append(self._clock.nsecsElapsed() / 1e6 - self._every_ms)
        self._clock.restart()

    def start(self) -> None:
        """Begin to beat."""
        self._clock.start()
        self._timer.start()

    def stop(self) -> float:
        """Return how late the latest beat was."""
        self._timer.stop()
        return max(self.late_ms, default=0.0)


@pytest.mark.slow
def test_the_window_never_waits_for_a_map(empty: Driver, tmp_path: Path) -> None:
    """Eight cables, 20 000 poses; how late an idle window is here is measured in the same run."""
    text = example_file("cogiro").read_text(encoding="utf-8")
    file = tmp_path / "cogiro.yaml"
    file.write_text(text.replace("samples: 5000", "samples: 20000"), encoding="utf-8")
    empty.open(file)
    assert empty.session.study.workspace.samples == 20_000
    scene, live = empty.scene, empty.window.live
    scene.setUpdatesEnabled(False)  # solving is looked at, not colouring and drawing
    live.answered.disconnect()
    late = []
    for _ in range(3):  # other programs can make a beat late, and nothing makes it early
        late.append(_lateness(live))
        if late[-1] < LATE_MS:
            break
    scene.setUpdatesEnabled(True)
    assert min(late) < LATE_MS, late


def _lateness(live: Any) -> float:
    """Return by how much the latest beat is later while a map is solved than while all rests."""
    idle = Heartbeat()
    idle.start()
    end = time.monotonic() + 3.0
    while time.monotonic() < end:
        QTest.qWait(20)
    idle_ms = idle.stop()
    busy = Heartbeat()
    live.ask_map()
    live._ask("worst", live.question)
    busy.start()
    while live.busy:
        QTest.qWait(5)
    busy_ms = busy.stop()
    assert len(busy.late_ms) > 10
    return busy_ms - idle_ms
