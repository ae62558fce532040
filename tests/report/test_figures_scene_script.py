"""The script of the scene to turn, with a camera that hands out its own arrays, as vtk.js does.

The camera looks along y at a wall of four poses, x to the right and z up, 100 pixels a metre; the
pose in the middle of the list lies behind the wall.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from designer.report.figures import interactive

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="needs Node.js")

STAGE = """
const camera = {
  state: {position: [0, -9, 0], focalPoint: [0, 0, 0], viewUp: [0, 0, 1]}, scale: 5, time: 1,
  getReferenceByName(name) { return this.state[name]; },
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      value.forEach((x, k) => { this.state[name][k] = x; });  // into its own array
    }
    this.time += 1;
  },
  getMTime() { return this.time; }, setParallelProjection() {},
  setParallelScale(value) { this.scale = value; }, getParallelScale() { return this.scale; },
};
const property = {
  colour: [0.13, 0.13, 0.13],
  getDiffuseColor() { return this.colour; }, setColor(...colour) { this.colour = colour; },
};
const renderer = {
  ground: null, setBackground(...colour) { this.ground = colour; },
  getActors: () => [{getProperty: () => property}], getActiveCamera: () => camera,
  resetCameraClippingRange() {},
};
const parts = {}, heard = {};
const element = (name) => parts[name] ??= {
  name, hidden: false, style: {}, textContent: "", dataset: {halfHeight: "5"}, focus() {},
  addEventListener(kind, done) { heard[`${name} ${kind}`] = done; },
};
const poses = {title: "needed diameter", unit: "mm", reasons: ["no cable"], grids: [
  {columns: 1, points: [[0.1, 3, 0.1, 9]]},
  {columns: 2, points: [[-1, 0, -1, 2.3456], [1, 0, -1, 3], [-1, 0, 1, 4], [1, 0, 1, -1]]},
]};
element("poses").textContent = JSON.stringify(poses);
for (const name of ["near", "mark", "pointed"]) element(name).hidden = true;
let frame = null;
globalThis.window = {
  global: {renderWindow: {getRenderers: () => [renderer], render() {}}},
  innerWidth: 1600, innerHeight: 1000, requestAnimationFrame(next) { frame = next; },
  matchMedia: () => ({matches: DARK, addEventListener() {}}),
  addEventListener(kind, done) { heard[kind] = done; },
};
globalThis.document = {
  querySelectorAll: () => [], getElementById: element, querySelector: element,
  documentElement: {addEventListener() {}},
};
const key = (name, shiftKey = false) => heard.keydown({
  key: name, type: "keydown", shiftKey, stopPropagation() {}, preventDefault() {},
});
const mouse = (kind, clientX, clientY) => heard[`pointer${kind}`]({clientX, clientY, buttons: 0});
const click = (x, y) => { mouse("down", x, y); mouse("up", x, y); };
const view = () => ({...structuredClone(camera.state), scale: camera.scale});
const told = [], tell = (what) => told.push(structuredClone(what));
"""
HOME = {"position": [0, -9, 0], "focalPoint": [0, 0, 0], "viewUp": [0, 0, 1], "scale": 5}
AT_2_35 = "needed diameter 2.35 mm at x -1 m, y 0 m, z -1 m"


def told(tmp_path: Path, does: str, dark: bool = False) -> list[Any]:
    """Return what a script tells that runs after that of the scene."""
    script = Path(interactive.__file__).with_name("interactive.js").read_text(encoding="utf-8")
    page = tmp_path / "page.js"
    stage = STAGE.replace("DARK", str(dark).lower())
    end = "console.log(JSON.stringify(told));"
    page.write_text(f"{stage}{script}{does}{end}", encoding="utf-8")
    run = subprocess.run(["node", str(page)], capture_output=True, text=True, check=True)
    found: list[Any] = json.loads(run.stdout)
    return found


def test_reset_restores_all_of_the_view_each_time(tmp_path: Path) -> None:
    turns = """
for (let turn = 0; turn < 3; turn += 1) {
  camera.state.position[0] += 10; camera.state.focalPoint[1] -= 2; camera.state.viewUp[2] = -1;
  camera.scale = 1;
  heard["home click"]();
  tell(view());
}"""
    assert told(tmp_path, turns) == [HOME] * 3


def test_keys_turn_move_and_zoom_and_reset_takes_it_all_back(tmp_path: Path) -> None:
    does = """
key("ArrowRight"); tell(view());
key("Home"); key("ArrowUp"); tell(view());
key("Home"); key("ArrowRight", true); tell(view());
key("Home"); key("+"); tell(view());
key("n"); tell(parts.picked.textContent); tell(parts.mark.hidden);
key("Home"); tell(view()); tell(parts.picked.textContent); tell(parts.mark.hidden);"""
    turned, lifted, moved, zoomed, picked, hidden, *end = told(tmp_path, does)
    angle = math.pi / 36
    aside = [9 * math.sin(angle), -9 * math.cos(angle), 0]
    assert turned["position"] == pytest.approx(aside, abs=1e-12)
    above = [0, -9 * math.cos(angle), 9 * math.sin(angle)]
    assert lifted["position"] == pytest.approx(above, abs=1e-12)
    assert (moved["focalPoint"], moved["position"]) == ([1, 0, 0], [1, -9, 0])
    assert zoomed["scale"] == pytest.approx(5 / 1.2)
    assert picked == "no cable at x 1 m, y 0 m, z 1 m"  # what nothing holds asks for the most
    assert not hidden
    assert end == [HOME, "", True]


def test_the_mouse_reads_what_is_in_front_and_a_click_keeps_it(tmp_path: Path) -> None:
    does = """
heard["shield click"]();
mouse("move", 740, 540); tell(parts.pointed.textContent); tell(parts.near.style);
mouse("move", 100, 100); tell(parts.pointed.hidden);
click(740, 540); tell(parts.picked.textContent); frame(); tell(parts.mark.style);
mouse("down", 740, 540); mouse("up", 800, 540); tell(parts.picked.textContent);
key("Escape"); tell(parts.picked.textContent);"""
    at = {"left": "700px", "top": "600px"}
    assert told(tmp_path, does) == [AT_2_35, at, True, AT_2_35, at, AT_2_35, ""]


@pytest.mark.parametrize("dark", [False, True])
def test_ink_is_bright_on_dark_ground(tmp_path: Path, dark: bool) -> None:
    ground, ink = told(tmp_path, "tell(renderer.ground); tell(property.colour);", dark)
    assert (max(ground) < 0.2) == dark
    assert (min(ink) > 0.8) == dark
