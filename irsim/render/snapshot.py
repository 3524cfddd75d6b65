"""One small, legible picture of a simulation, for people and agents who want a quick look."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image

from irsim.render.builder import SceneBuilder
from irsim.render.figure import SceneFigure, fitting_size
from irsim.render.files import replacing
from irsim.render.pictures import find_picture
from irsim.render.pixels import to_image

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["render_scene"]

_DPI = 100.0
_COLORS = 128


def render_scene(
    simulation: Simulation,
    out: str | Path | None = None,
    *,
    size_px: int = 600,
    world: int = 0,
    labels: bool = True,
    title: str | None = None,
    viewpoint: Any = None,
    overrides: Mapping[str, Any] | None = None,
) -> bytes:
    """Draw one world as a PNG of few colours (some 20 kB).

    Args:
        simulation: What to draw, at its present state.
        out: File to write too.
        size_px: Longer side of the picture, at most.
        world: Which world of a batch.
        labels: Name every object, and draw the goals and paths of robots.
        title: Text above; default: the time.
        viewpoint: Point or object name to centre on; default: what the scenario says.
        overrides: Object plot keys.

    Returns:
        The PNG file.
    """
    options, extent = simulation.scenario.world.plot, simulation.scenario.world
    source = simulation.scenario.source
    folder = str(Path(source).parent) if source else None
    builder = SceneBuilder(simulation, world=world, has_picture=lambda name: find_picture(name, folder) is not None)
    chosen = {"show_text": True, "show_goal": True, "show_goal_text": True, "show_trajectory": True} if labels else {}
    scene = builder.build(
        viewpoint=options.viewpoint if viewpoint is None else viewpoint, overrides={**chosen, **(overrides or {})}
    )
    if labels:
        robots = {record.id for record in simulation.scenario.objects if record.role == "robot"}
        scene.marks = [mark for mark in scene.marks if mark.part != "goal" or mark.object in robots]
        scene.labels = [label for label in scene.labels if label.part != "goal" or label.object in robots]
    size = fitting_size(extent.width, extent.height, size_px, _DPI, axis=not options.no_axis)
    figure = SceneFigure(size, _DPI, axis=not options.no_axis, folder=folder)
    figure.show(scene, f"{scene.time:.2f} s" if title is None else title)
    pixels, _ = figure.pixels(tight=True, pad_inches=0.05)
    data = io.BytesIO()
    reduced = to_image(pixels).quantize(_COLORS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    reduced.save(data, "PNG", optimize=True)
    if out is not None:
        with replacing(Path(out)) as temporary:
            temporary.write_bytes(data.getvalue())
    return data.getvalue()
