"""The workspace as a scene to turn, one HTML page that loads nothing from anywhere.

PyVista puts up the scene; trame's serialisers and its stand-alone viewer (vtk.js) turn it into a
page. They are called without trame's web server, which writing a file does not need.
"""

from __future__ import annotations

import io
import json
import zipfile
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from designer.analysis.maps import WorkspaceMaps
from designer.report.figures import canvas, overlay, palette
from designer.report.figures.colours import DIAMETER, MapQuantity, Steps
from designer.report.figures.scenes import add_workspace, bounds_m, scale_of, size_m, view_of
from designer.report.figures.stage import SCREEN, SceneCanvas
from designer.report.figures.view import View
from designer.report.fonts import with_fonts

_KEYS = (
    "The workspace. Arrow keys turn it, with Shift they move it; plus and minus zoom; N and P go "
    "to the next and the previous pose by what it asks for; Escape forgets it, Home resets all."
)

_HINT = "drag or arrow keys: turn · wheel or + −: zoom · click or N P: pick a pose · Home: reset"


def workspace_scene_html(maps: WorkspaceMaps, quantity: MapQuantity = DIAMETER) -> str:
    """Return the workspace, cut open, as an HTML page in which it can be turned."""
    steps = scale_of(maps, quantity)
    thinned = maps.thinned()
    stage = SceneCanvas(view_of(maps), SCREEN)
    add_workspace(stage, thinned, quantity, steps)
    stage.border(maps.impossible_m)
    stage.lines(overlay.floor_lines(stage.view, bounds_m(maps)), palette.FAINT, 1.0)
    stage.view.aim(stage.scene)
    scene = _scene(stage)
    stage.clear()
    parts = _overlay(maps, quantity, steps, stage.view) + _poses(thinned, quantity)
    return _page(scene, maps.study.name, parts)


def _scene(stage: SceneCanvas) -> bytes:
    """Return all that is on the stage as the viewer reads it: JSON in a ZIP archive."""
    from trame_vtk.modules.vtk.serializers import (
        SynchronizationContext,
        extract_array_hash,
        initialize_serializers,
        reference_id,
        serialize,
    )

    window = stage.window
    initialize_serializers()
    context = SynchronizationContext()
    context.set_ignore_last_dependencies(True)
    scene: dict[str, Any] = serialize(None, window, reference_id(window), context, 1)
    camera = stage.scene.GetActiveCamera()
    scene["extra"] = {
        "vtkRefId": reference_id(window),
        "centerOfRotation": camera.GetFocalPoint(),
        "camera": reference_id(camera),
    }
    arrays = {
        entry["hash"]: {**entry, "content": context.get_cached_data_array(entry["hash"], False)}
        for entry in extract_array_hash(scene)
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("index.json", json.dumps({"hashes": arrays, "scene": scene}))
    return packed.getvalue()


def _page(scene: bytes, title: str, overlay: str) -> str:
    """Return the viewer with the scene in it, freed of what it would load from the web."""
    from trame_vtk.tools.vtksz2html import write_html

    stream = io.StringIO()
    write_html(scene, stream)
    page = _without_web(stream.getvalue())
    folder_file = Path(__file__)
    style = folder_file.with_name("interactive.css").read_text(encoding="utf-8")
    script = folder_file.with_name("interactive.js").read_text(encoding="utf-8")
    head, rest = page.split("<title>", 1)
    rest = rest.split("</title>", 1)[1]
    page = f"{head}<title>{escape(title)}</title>\n<style>{style}</style>{rest}"
    content = f'<div class="content" tabindex="0" role="application" aria-label="{_KEYS}"></div>'
    page = page.replace("<body>", f"<body>\n{content}\n{overlay}", 1)
    before, after = page.rsplit("</body>", 1)
    return with_fonts(f"{before}<script>{script}</script>\n</body>{after}")


def _without_web(page: str) -> str:
    """Drop the viewer's icons, which it would fetch, and its picture for dropping files."""
    for begins, ends in (
        ("https://kitware.github.io/vtk-js/icon/", "`"),
        ("data:image/jpeg;base64,", ")"),
    ):
        before, address, after = page.partition(begins)
        if address:
            page = f"{before}data:,{after[after.index(ends) :]}"
    return page


def _overlay(maps: WorkspaceMaps, quantity: MapQuantity, steps: Steps | None, view: View) -> str:
    """Return labels, colour scale and controls as HTML."""
    labels = [(maps.focus.position_m, quantity.text_of(maps.focus), "label strong")]
    for name, place in canvas.names_of(maps.study.robot.exit_points_m, 0.04 * size_m(maps)):
        labels.append((place, name, "label"))
    labels += [(place, text, "tick") for place, text in overlay.box_ticks(view, bounds_m(maps))]
    parts = []
    for point_m, text, kind in labels:
        at = ",".join(f"{x:.6g}" for x in point_m)
        parts.append(f'<div class="{kind}" data-at="{at}">{escape(text)}</div>')
    parts.append(_scale(quantity, steps) if steps is not None else "")
    notes = (
        f'<i style="background:{colour}"></i><span>{text}</span>'
        for colour, text in overlay.meanings(maps.shown) + overlay.proved(maps.impossible_m)
    )
    note = "".join(notes)
    parts.append(f'<p class="notes">{note}</p>' if note else "")
    parts.append('<div id="near" hidden></div><div id="mark" hidden></div>')
    parts.append('<p id="pointed" hidden></p>')
    parts.append('<p id="picked" role="status"></p>')
    parts.append('<button id="shield"><span>click to turn the scene</span></button>')
    half_height = f"{view.half_height_m:.6g}"
    parts.append(f'<button id="home" data-half-height="{half_height}">reset</button>')
    parts.append(f'<p class="keys">{_HINT}</p>')
    return "\n".join(parts)


def _poses(maps: WorkspaceMaps, quantity: MapQuantity) -> str:
    """Return the poses that are seen, as data: grids of positions and values.

    A value below zero is the number of the reason why there is none, from -1 down.
    """
    reasons = [text for _, text in overlay.meanings(maps.shown)]
    grids = []
    for field in maps.shown:
        value = quantity.of(field)
        whys = [np.isfinite(value), field.is_infeasible, field.is_left_out]
        values = np.select(whys, [value, -1.0, -len(reasons)], -1.0 - len(reasons))
        points = np.column_stack([field.position_m.reshape(-1, 3), values.ravel()])
        columns = values.shape[1] if values.ndim > 1 else 1  # of one column are points, not faces
        rounded = [[float(f"{x:.5g}") for x in point] for point in points]
        grids.append({"columns": columns, "points": rounded})
    shown_quantity = {"title": quantity.title, "unit": quantity.unit, "reasons": reasons}
    text = json.dumps({**shown_quantity, "grids": grids}, separators=(",", ":")).replace(
        "<", "\\u003c"
    )
    return f'\n<script type="application/json" id="poses">{text}</script>'


def _scale(quantity: MapQuantity, steps: Steps) -> str:
    """Return the steps of the scale as a list, the greatest first."""
    from matplotlib.colors import to_hex

    decimals = canvas.decimals(steps.ticks)
    rows = []
    for index, low in enumerate(steps.edges[:-1]):
        number = f"{low:.{decimals}f}" if np.isclose(low, steps.ticks).any() else ""
        colour = to_hex(steps.colormap(index))
        rows.append(f'<li><span>{number}</span><i style="background:{colour}"></i></li>')
    listed = "".join(reversed(rows))
    return f'<div class="scale"><p>{escape(quantity.label)}</p><ul>{listed}</ul></div>'
