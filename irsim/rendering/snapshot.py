"""One small, legible picture of a simulation, for people and agents who want a quick look."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.files import replacing
from irsim.graphics.encoding.gif import reduce_colors
from irsim.graphics.encoding.pixels import to_image
from irsim.graphics.figure.figure import SceneFigure, fitting_size
from irsim.graphics.figure.layers import opaque_colors
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.scene import Scene, region_extent
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.rendering.readability import make_legible

if TYPE_CHECKING:
    from PIL import Image

    from irsim.simulation.simulation import Simulation

__all__ = ["Extra", "legible_scene", "png_of", "render_scene"]

Extra = Callable[[Scene], None]
"""Adds something to a scene."""
_DPI = 100.0
_COLORS = 255


def render_scene(
    simulation: Simulation,
    out: str | Path | None = None,
    *,
    size_px: int = 600,
    world: int = 0,
    labels: bool = True,
    title: str | None = None,
    viewpoint: Any = None,
    region: Sequence[float] | None = None,
    overrides: Mapping[str, Any] | None = None,
    extra: Extra | None = None,
) -> bytes:
    """Draw one world as a PNG of few colours (some 20 kB).

    Args:
        simulation: What to draw, at its present state.
        out: File to write too.
        size_px: Longer side of the picture.
        world: Which world of a batch.
        labels: Name objects (robots first, where there are many), and draw paths and goals.
        title: Text above; default: the time.
        viewpoint: Point or object name to centre on; default: what the scenario says.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        overrides: Object plot keys.
        extra: Adds something to the scene.

    Returns:
        The PNG file.
    """
    scene, pictures = legible_scene(
        simulation, world, labels=labels, viewpoint=viewpoint, region=region, overrides=overrides, extra=extra
    )
    x0, x1, y0, y1 = scene.extent
    size = fitting_size(x1 - x0, y1 - y0, size_px, _DPI)
    figure = SceneFigure(size, _DPI, pictures=pictures, halo=True)
    figure.show(scene, f"{scene.time:.2f} s" if title is None else title)
    pixels, _ = figure.pixels(tight=False)
    data = png_of(to_image(pixels), opaque_colors(scene))
    if out is not None:
        with replacing(Path(out)) as temporary:
            temporary.write_bytes(data)
    return data


def legible_scene(
    simulation: Simulation,
    world: int = 0,
    *,
    labels: bool = True,
    viewpoint: Any = None,
    region: Sequence[float] | None = None,
    overrides: Mapping[str, Any] | None = None,
    extra: Extra | None = None,
) -> tuple[Scene, Pictures]:
    """What such a picture shows, and the images in it; see :func:`render_scene`."""
    options, source = simulation.scenario.world.plot, simulation.scenario.source
    pictures = Pictures(Path(source).parent if source else None)
    builder = SceneBuilder(simulation, world=world, has_picture=pictures.has)
    chosen = {"show_text": True, "show_goal": True, "show_goal_text": True, "show_trajectory": True} if labels else {}
    scene = builder.build(
        viewpoint=options.viewpoint if viewpoint is None else viewpoint, overrides={**chosen, **(overrides or {})}
    )
    if region is not None:
        scene.look_at(region_extent(region))
    elif scene.center is not None:
        x0, x1, y0, y1 = scene.extent
        (x, y), right, up = scene.center, (x1 - x0) / 2, (y1 - y0) / 2
        scene.look_at((x - right, x + right, y - up, y + up))
    make_legible(scene, simulation, world)
    if extra is not None:
        extra(scene)
    return scene, pictures


def png_of(image: Image.Image, kept: Sequence[tuple[int, int, int]]) -> bytes:
    """A PNG file of few colours, among them those that are to be kept."""
    data = io.BytesIO()
    reduce_colors(image, kept, _COLORS).save(data, "PNG", optimize=True)
    return data.getvalue()
