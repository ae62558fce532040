"""The workspace as a scene to turn, one HTML page that loads nothing from anywhere.

PyVista puts up the scene; trame's serialisers and its stand-alone viewer (vtk.js) turn it into a
page. They are called without trame's web server, which writing a file does not need.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.field import Field
from designer.arrays import FloatArray
from designer.report.figures import canvas, palette, stage
from designer.report.figures.colours import Steps
from designer.report.figures.maps import WorkspaceMaps
from designer.report.figures.names import names_of
from designer.report.figures.quantity import DIAMETER, Quantity
from designer.report.figures.stage import SCREEN
from designer.report.figures.view import View
from designer.report.figures.workspace_scene import add_workspace, scale_of, size_m, view_of
from designer.report.fonts import with_fonts

if TYPE_CHECKING:
    from pyvista import Plotter


def workspace_scene_html(maps: WorkspaceMaps, quantity: Quantity = DIAMETER) -> str:
    """Return the workspace, cut open, as an HTML page in which it can be turned.

    Parameters
    ----------
    maps : WorkspaceMaps
        What to draw.
    quantity : Quantity
        What the colours mean.
    """
    steps = scale_of(maps, quantity)
    view = view_of(maps)
    plotter = stage.empty_stage()
    add_workspace(plotter, maps.thinned(), quantity, steps, view, SCREEN)
    stage.aim(plotter, view)
    scene = _scene(plotter)
    plotter.close()
    return _page(scene, maps.study.name, _overlay(maps, quantity, steps, view))


def _scene(plotter: Plotter) -> bytes:
    """Return all that is on the stage as the viewer reads it: JSON in a ZIP archive."""
    from trame_vtk.modules.vtk.serializers import (
        SynchronizationContext,
        extract_array_hash,
        initialize_serializers,
        reference_id,
        serialize,
    )

    window = plotter.render_window
    window.Render()
    initialize_serializers()
    context = SynchronizationContext()
    context.set_ignore_last_dependencies(True)
    scene: dict[str, Any] = serialize(None, window, reference_id(window), context, 1)
    camera = plotter.renderer.GetActiveCamera()
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
    here = Path(__file__)
    style = here.with_name("interactive.css").read_text(encoding="utf-8")
    script = here.with_name("interactive.js").read_text(encoding="utf-8")
    head, rest = page.split("<title>", 1)
    rest = rest.split("</title>", 1)[1]
    page = f"{head}<title>{escape(title)}</title>\n<style>{style}</style>{rest}"
    page = page.replace("<body>", f'<body>\n<div class="content"></div>\n{overlay}', 1)
    before, after = page.rsplit("</body>", 1)
    return with_fonts(f"{before}<script>{script}</script>\n</body>{after}")


def _without_web(page: str) -> str:
    """Drop the viewer's icons, which it would fetch, and its picture for dropping files."""
    start = page.find("https://kitware.github.io/vtk-js/icon/")
    if start >= 0:
        end = page.index("`", start)
        page = page[:start] + "data:," + page[end:]
    start = page.find("data:image/jpeg;base64,")
    if start >= 0:
        end = page.index(")", start)
        page = page[:start] + "data:," + page[end:]
    return page


def _overlay(maps: WorkspaceMaps, quantity: Quantity, steps: Steps | None, view: View) -> str:
    """Return labels, colour scale and controls as HTML."""
    focus = maps.focus
    parts = [_label(focus.position_m, focus.text(quantity), "label strong")]
    for name, place in names_of(maps.study.robot.exit_points_m, 0.04 * size_m(maps)):
        parts.append(_label(place, name, "label"))
    parts.append(_scale(quantity, steps) if steps is not None else "")
    parts.append(_notes(list(maps.shell.values()) or [maps.section]))
    parts.append('<button id="shield"><span>click to turn the scene</span></button>')
    parts.append(
        f'<button id="home" data-half-height="{view.half_height_m:.6g}">reset view</button>'
    )
    return "\n".join(parts)


def _label(point_m: FloatArray, text: str, kind: str) -> str:
    at = ",".join(f"{x:.6g}" for x in point_m)
    return f'<div class="{kind}" data-at="{at}">{escape(text)}</div>'


def _scale(quantity: Quantity, steps: Steps) -> str:
    """Return the steps of the scale as a list, the greatest first."""
    from matplotlib.colors import to_hex

    decimals = canvas.decimals(steps.ticks)
    colours = [to_hex(steps.colormap(index)) for index in range(steps.colormap.N)]
    levels = [*steps.levels, *([np.inf] if steps.extend == "max" else [])]
    rows = []
    for low, colour in zip(levels[:-1], colours, strict=True):
        labelled = bool(np.isclose(low, steps.ticks).any())
        number = f"{low:.{decimals}f}" if labelled else ""
        rows.append(f'<li><span>{number}</span><i style="background:{colour}"></i></li>')
    return (
        f'<div class="scale"><p>{escape(quantity.label)}</p><ul>'
        + "".join(reversed(rows))
        + "</ul></div>"
    )


def _notes(fields: Iterable[Field]) -> str:
    """Return what grey and orange mean, where they occur."""
    shown = list(fields)
    reasons = sorted({field.why_infeasible for field in shown} - {""})
    notes = []
    if reasons:
        text = reasons[0] if len(reasons) == 1 else "no cable holds the platform"
        notes.append(f'<i style="background:{palette.WARNING}"></i><span>{text}</span>')
    if any(field.is_left_out.any() for field in shown):
        text = "left out: a cable hangs below the platform"
        notes.append(f'<i style="background:{palette.LEFT_OUT}"></i><span>{text}</span>')
    return f'<p class="notes">{"".join(notes)}</p>' if notes else ""
