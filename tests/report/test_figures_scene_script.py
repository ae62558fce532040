"""The script of the scene to turn, with a camera that hands out its own arrays, as vtk.js does."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from designer.report.figures import interactive

STAGE = """
const camera = {
  state: {position: [3, 4, 5], focalPoint: [1, 0, 0], viewUp: [0, 0, 1]},
  getReferenceByName(name) { return this.state[name]; },
  get(...names) { return Object.fromEntries(names.map((name) => [name, this.state[name]])); },
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      value.forEach((x, k) => { this.state[name][k] = x; });  // into its own array
    }
  },
  getMTime: () => 1, setParallelProjection() {},
  setParallelScale(value) { this.scale = value; },
};
const renderer = {
  getActors: () => [1], getActiveCamera: () => camera, resetCameraClippingRange() {},
  worldToNormalizedDisplay: () => [0, 0, 0],
};
const clicks = {};
const element = (name) => ({
  dataset: {halfHeight: "7"}, addEventListener(kind, done) { clicks[name] = done; },
});
globalThis.window = {
  global: {renderWindow: {getRenderers: () => [renderer], render() {}}},
  innerWidth: 1600, innerHeight: 1000, addEventListener() {}, requestAnimationFrame() {},
};
globalThis.document = {
  querySelectorAll: () => [], getElementById: element,
  documentElement: {addEventListener() {}},
};
"""
TURNS = """
const seen = [];
for (let turn = 0; turn < 3; turn += 1) {
  camera.state.position[0] += 10; camera.state.focalPoint[1] -= 2; camera.state.viewUp[2] = -1;
  camera.scale = 1;
  clicks.home();
  seen.push({...structuredClone(camera.state), scale: camera.scale});
}
console.log(JSON.stringify(seen));
"""


@pytest.mark.skipif(shutil.which("node") is None, reason="needs Node.js to run the script")
def test_reset_view_restores_all_of_the_view_each_time(tmp_path: Path) -> None:
    script = Path(interactive.__file__).with_name("interactive.js").read_text(encoding="utf-8")
    page = tmp_path / "page.js"
    page.write_text(STAGE + script + TURNS, encoding="utf-8")
    run = subprocess.run(["node", str(page)], capture_output=True, text=True, check=True)
    home = {"position": [3, 4, 5], "focalPoint": [1, 0, 0], "viewUp": [0, 0, 1], "scale": 7}
    assert json.loads(run.stdout) == [home] * 3
