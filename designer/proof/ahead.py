"""Machine code of the proof and of refusals, made in a second process while a first run searches.

Compiling holds Python's lock, so a thread would gain nothing.
"""

from __future__ import annotations

import atexit
import subprocess
import sys

from designer.arrays import frozen_array
from designer.kernel.batch import refuse_batch
from designer.kernel.calling import situation_of
from designer.model.cable import Cable
from designer.model.region import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import Orientations, Space
from designer.proof.encloser import Encloser, covers_of


def compile_apart() -> subprocess.Popen[bytes]:
    """Start and return a process that compiles; it ends with this one at the latest."""
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", __name__],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    atexit.register(process.kill)
    return process


def compile_here() -> None:
    """Compile what bounds a box and what refuses a pose, or load it: one code for all robots."""
    exits = frozen_array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [2.0, 4.0, 0.0]])
    box = Prism.box((2.0, 2.1), (1.0, 1.1), (-2.0, -1.9))
    (cover,) = covers_of(Space(box, Orientations()))
    robot = Robot(exits, Platform(1.0))
    Encloser(robot, Cable(0.01, 0.4, 6e6, 1e4), cover).compile()
    refuse_batch(situation_of(robot, Poses.at([2.0, 1.0, 1.0]).flat, robot.exit_points_m), 0.0)


if __name__ == "__main__":
    compile_here()
