"""How quickly the window's answers follow a change of the payload, against a whole report.

Run:  xvfb-run -a -s '-screen 0 1280x800x24' python tests/benchmarks/explore.py [--report]

For three and for eight cables: editing the study, then, in the worker, the pose, the coarse map
that is shown while a slider moves, and the fine one when it rests; then, in a window of 1280 x 800
on the display that there is, colouring the coarse map and drawing a frame of the scene, edges not
smoothed, as while something moves; each the median of some turns. With them, how late a thread
beside the worker gets its turn at worst, as a window would. With --report the same study is also
analysed, and its report written; the ratio is that time over that of an edit, the pose, the coarse
map, colouring and drawing. Without a display nothing is drawn, and it says so.
"""

from __future__ import annotations

import argparse
import os
import statistics
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import Any

from designer.analysis.analyse import analyse
from designer.explore.answers import MapAnswer
from designer.explore.question import Message, Rope
from designer.explore.session import Session
from designer.explore.worker import Worker
from designer.plugins import find_plugins
from designer.report.render import write_report
from designer.resources import example_file

_TURNS = 15
_BEAT_S = 0.002
_SHOWN = frozenset({"utilisation"})
_ROPE = Rope("unirope-7x19-galvanised", "7/32 in")


class Heartbeat:
    """A thread that wants its turn every 2 ms, and how late it got it at worst [s]."""

    def __init__(self) -> None:
        self.late_s = 0.0
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._beat, daemon=True)
        self._thread.start()

    def _beat(self) -> None:
        while not self._ends.is_set():
            before = time.perf_counter()
            time.sleep(_BEAT_S)
            self.late_s = max(self.late_s, time.perf_counter() - before - _BEAT_S)

    def end(self) -> float:
        """Stop, and return how late it was at worst [s]."""
        self._ends.set()
        self._thread.join()
        return self.late_s


class Asker:
    """Asks a worker and waits."""

    def __init__(self) -> None:
        self._got: SimpleQueue[Message] = SimpleQueue()
        self.worker = Worker(self._got.put)

    def __call__(self, kind: Any, session: Session, **options: Any) -> Any:
        question = session.question()
        assert question is not None
        number = self.worker.ask(kind, question, **options)
        while True:
            end = self._got.get()
            if end.number == number and end.is_end:
                assert end.status == "done", getattr(end, "text", "cancelled")
                return end.answer


def _median_s(action: Callable[[], object]) -> float:
    times = []
    for _ in range(_TURNS):
        before = time.perf_counter()
        action()
        times.append(time.perf_counter() - before)
    return statistics.median(times)


def _measure(name: str, ask: Asker, with_report: bool) -> None:
    session = Session.open(example_file(name), find_plugins(with_plugins=False))
    session.choose(_ROPE)
    mass = next(one for one in session.fields() if one.path == "robot.platform.mass")
    assert mass.value_SI is not None
    loads = iter(range(1, 10_000))

    def edit() -> None:
        assert mass.value_SI is not None
        text = f"{mass.value_SI * (1.0 + 1e-4 * next(loads)):.9g} kg"
        assert session.edit(mass.path, text, continuous=True) == ()

    fine = ask("fine", session)  # loads the kernels
    maps = [ask("coarse", session)]
    points = sum(grid[..., 0].size for grid in fine.grids.values())
    steps = {
        "edit": _median_s(edit),
        "pose": _median_s(lambda: (edit(), ask("pose", session))),
        "coarse map": _median_s(
            lambda: (edit(), maps.append(ask("coarse", session, quantities=_SHOWN)))
        ),
    }
    heart = Heartbeat()
    steps["fine map"] = _median_s(lambda: (edit(), ask("fine", session)))
    late_s = heart.end()
    for step in ("pose", "coarse map", "fine map"):
        steps[step] -= steps["edit"]
    cables = session.study.robot.n_cables if session.study else 0
    each = ", ".join(f"{step} {1e3 * took:.0f} ms" for step, took in steps.items())
    print(f"{name}, {cables} cables, fine map of {points} points: {each}")
    print(f"  a thread beside it was late by {1e3 * late_s:.0f} ms at most")
    solve_s = steps["edit"] + steps["pose"] + steps["coarse map"]
    colour_s, draw_s = _shown_s(name, maps) if os.environ.get("DISPLAY") else (0.0, 0.0)
    drawn = (
        f"colour {1e3 * colour_s:.1f} ms, draw {1e3 * draw_s:.0f} ms" if draw_s else "no display"
    )
    print(f"  one change of payload: solve {1e3 * solve_s:.0f} ms, {drawn}")
    if with_report:
        whole_s = _whole_s(session)
        ratio = whole_s / (solve_s + colour_s + draw_s)
        print(f"  analysis and report {whole_s:.1f} s, {ratio:.0f} times a change of payload")


def _shown_s(name: str, maps: Sequence[MapAnswer]) -> tuple[float, float]:
    """Return how long a window takes to colour a map, and to draw a frame of the scene."""
    from PySide6.QtTest import QTest

    from designer.explore.desktop.app import application
    from designer.explore.desktop.files import Settings
    from designer.explore.desktop.window import Window

    application()
    with TemporaryDirectory() as folder:
        window = Window(Settings(Path(folder) / "settings.ini"), with_plugins=False)
        window.resize(1280, 800)
        window.show()
        window.files.open(example_file(name))
        while not window.live.is_at_rest:
            QTest.qWait(20)
        window.live.forget()
        scene = window.work.scene
        scene.ren_win.SetMultiSamples(0)
        colours, frames = [], []
        for answer in maps:
            before = time.perf_counter()
            window.work.show_map(answer)
            colours.append(time.perf_counter() - before)
            scene.repaint()
            frames.append(scene.frame_s)
        window.live.session = None
        window.close()
    return statistics.median(colours), statistics.median(frames)


def _whole_s(session: Session) -> float:
    assert session.study is not None
    with TemporaryDirectory() as folder:
        before = time.perf_counter()
        write_report(analyse(session.study), Path(folder))
        return time.perf_counter() - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--report", action="store_true")
    with_report = parser.parse_args().report
    ask = Asker()
    for name in ("yard", "ipanema", "cogiro"):
        _measure(name, ask, with_report)
    ask.worker.close()


if __name__ == "__main__":
    main()
