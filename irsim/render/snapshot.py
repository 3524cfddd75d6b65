"""One small, legible picture of a simulation, for people and agents who want a quick look."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image

from irsim.render.bodies import bounds, picture_outline
from irsim.render.builder import SceneBuilder
from irsim.render.figure import SceneFigure, fitting_size
from irsim.render.files import replacing
from irsim.render.pictures import Pictures
from irsim.render.pixels import to_image
from irsim.render.scene import Scene

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["render_scene"]

_DPI = 100.0
_COLORS = 128
_MOST_LABELS = 60
_LABEL_GAP = 0.01
"""Between a label and what it names, as a share of the world's height."""


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
        size_px: Longer side of the picture.
        world: Which world of a batch.
        labels: Name objects (robots first, where there are many), and draw the goals and paths of robots.
        title: Text above; default: the time.
        viewpoint: Point or object name to centre on; default: what the scenario says.
        overrides: Object plot keys.

    Returns:
        The PNG file.
    """
    options, extent = simulation.scenario.world.plot, simulation.scenario.world
    source = simulation.scenario.source
    pictures = Pictures(Path(source).parent if source else None)
    builder = SceneBuilder(simulation, world=world, has_picture=pictures.has)
    chosen = {"show_text": True, "show_goal": True, "show_goal_text": True, "show_trajectory": True} if labels else {}
    scene = builder.build(
        viewpoint=options.viewpoint if viewpoint is None else viewpoint, overrides={**chosen, **(overrides or {})}
    )
    if labels:
        robots = {record.id for record in simulation.scenario.objects if record.role == "robot"}
        _tidy_labels(scene, robots)
        _thin_labels(scene, robots)
    size = fitting_size(extent.width, extent.height, size_px, _DPI)
    figure = SceneFigure(size, _DPI, pictures=pictures, halo=True)
    figure.show(scene, f"{scene.time:.2f} s" if title is None else title)
    pixels, _ = figure.pixels(tight=False)
    data = io.BytesIO()
    reduced = to_image(pixels).quantize(_COLORS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    reduced.save(data, "PNG", optimize=True)
    if out is not None:
        with replacing(Path(out)) as temporary:
            temporary.write_bytes(data.getvalue())
    return data.getvalue()


def _thin_labels(scene: Scene, robots: set[int]) -> None:
    """Leave out the labels of obstacles, then of goals, then all, when there are too many to be read."""
    of_robots = [label for label in scene.labels if label.object in robots]
    names = [label for label in of_robots if label.part == "name"]
    choices = (scene.labels, of_robots, names)
    scene.labels = next((labels for labels in choices if len(labels) <= _MOST_LABELS), [])


def _tidy_labels(scene: Scene, robots: set[int]) -> None:
    """Labels on top of what they name; goals of robots only."""
    scene.marks = [mark for mark in scene.marks if mark.part != "goal" or mark.object in robots]
    scene.labels = [label for label in scene.labels if label.part != "goal" or label.object in robots]
    gap = _LABEL_GAP * (scene.extent[3] - scene.extent[2])
    pictures = {picture.object: picture for picture in scene.pictures}
    for label in scene.labels:
        shapes = [mark.geometry for mark in scene.of(label.object, "goal" if label.part == "goal" else "body")]
        if not shapes and label.object in pictures:
            shapes = [picture_outline(pictures[label.object])]
        if shapes:
            left, _, _, top = bounds(shapes[0])
            label.x, label.y = left, top + gap
