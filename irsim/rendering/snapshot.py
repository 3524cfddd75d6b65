"""The snapshot: one small, legible picture of a simulation, for a quick look."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.files import replacing
from irsim.graphics.encoding.gif import reduce_colors
from irsim.graphics.encoding.pixels import to_image
from irsim.graphics.figure.figure import SceneFigure, fitting_size
from irsim.graphics.figure.layers import opaque_colors
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.bodies import arrow, place
from irsim.graphics.scene.scene import Fog, Line, Mark, Region, Scene, Stroke, region_extent
from irsim.graphics.scene.style import Color, Palette
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.objects.views import views
from irsim.rendering.compared import mark_changes
from irsim.rendering.modern.still import draw_still
from irsim.rendering.readability import make_legible
from irsim.simulation.events import BETWEEN_STEPS, Event, passable_names

if TYPE_CHECKING:
    from PIL import Image

    from irsim.simulation.simulation import Simulation

__all__ = ["Extra", "draw_between_steps", "legible_scene", "png_of", "render_scene"]

Extra = Callable[[Scene], None]
"""Callback that adds marks or labels to a scene."""
_DPI = 100.0
MIN_HEIGHT_SHARE = 0.2
"""Smallest height of what is shown, as a share of its width."""
MIN_WIDTH_SHARE = 0.25
"""Smallest width of what is shown, as a share of its height; names are wide."""
_EDGE_COLOR = "#868e96"
_NO_OBJECT = -1000
"""Object id of marks that belong to no object."""
MAX_COLORS = 255
"""Number of colours of a snapshot, which keeps its file small."""
_GOAL_ARROW_SHARE = 0.05
"""Length of the arrow on a goal, as a share of the longer side of the picture."""
_GOAL_ARROW_WIDTH = 0.4
"""Its width, as a share of its length."""
_ABOVE = 0.1
"""How far above the fog goals are drawn."""
_DEFAULT_COLOR: Color = "#333333"
_SIZE_SHARE = 0.018
"""Half the width of a mark as a share of the longer side of the picture."""
_HOLE_SHARE = 0.45
"""Size of the hole of a mark as a share of the mark's."""
_HALO_PT = 0.6
_ZORDER = 9.0
_MAX_MARKS = 500
"""Number of the latest contacts that are marked."""


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
    before: Simulation | None = None,
    changed: Collection[str] = (),
    printed: bool = False,
    zones: bool = True,
    notes: list[str] | None = None,
) -> bytes:
    """Draw the present state of one world as a PNG with few colours (about 20 kB).

    Args:
        simulation: The simulation.
        out: File to write as well; default: none.
        size_px: Longer side of the picture [px].
        world: Index of the world in a batch.
        labels: Draw names, paths and goals; if there are many names, only the names of robots.
        title: Text above the picture; default: the title that the scenario sets, and the time.
        viewpoint: Point or object name to centre on; default: the one of the scenario.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the whole world.
        overrides: Object plot keys.
        extra: Callback that adds marks or labels to the scene.
        before: Simulation of another scenario to compare with.
        changed: Names of the objects that differ from it, which are marked.
        printed: Whether the picture has the layout for print, in the style `modern`.
        zones: Whether zones are drawn, in the style `modern`.
        notes: Takes what the picture leaves out, as sentences.

    Returns:
        The content of the PNG file.
    """
    if simulation.scenario.world.plot.style == "modern":

        def add(scene: Scene) -> None:
            if extra is not None:
                extra(scene)
            if before is not None:
                mark_changes(scene, simulation, before, changed)

        pixels, colors, left_out = draw_still(
            simulation, world, size_px=size_px, title=title, labels=labels, printed=printed, axes=True,
            viewpoint=viewpoint, region=region, overrides=overrides or {}, extra=add, zones=zones,
        )  # fmt: skip
        if notes is not None:
            notes += left_out
        data = png_of(to_image(pixels), colors)
        return _written(data, out)
    scene, pictures = legible_scene(
        simulation, world, labels=labels, viewpoint=viewpoint, region=region, overrides=overrides, extra=extra
    )
    if before is not None:
        mark_changes(scene, simulation, before, changed)
    x0, x1, y0, y1 = scene.extent
    size = fitting_size(x1 - x0, y1 - y0, size_px, _DPI)
    figure = SceneFigure(size, _DPI, pictures=pictures, halo=True)
    figure.show(scene, default_title(simulation, scene) if title is None else title)
    pixels, _ = figure.pixels(tight=False)
    return _written(png_of(to_image(pixels), opaque_colors(scene)), out)


def _written(data: bytes, out: str | Path | None) -> bytes:
    if out is not None:
        with replacing(Path(out)) as temporary:
            temporary.write_bytes(data)
    return data


def default_title(simulation: Simulation, scene: Scene) -> str:
    """Return the title that the scenario sets, if it sets one, and the time."""
    options = simulation.scenario.world.plot
    time = f"{scene.time:.2f} s"
    return f"{options.title}, {time}" if options.title and options.show_title else time


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
    """Return the scene of a snapshot, and the images in it; see :func:`render_scene` for the arguments."""
    options, source = simulation.scenario.world.plot, simulation.scenario.source
    pictures = Pictures(Path(source).parent if source else None)
    at_start = int(simulation.count[world]) == 0
    builder = SceneBuilder(simulation, world=world, has_picture=pictures.has, ghosts=at_start)
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
    _add_details(scene, simulation, world)
    if extra is not None:
        extra(scene)
    _leave_room_for_names(scene)
    return scene, pictures


def _leave_room_for_names(scene: Scene) -> None:
    """Show a margin beside a very flat or narrow area, with a line at its edge, so that names do not cover another."""
    x0, x1, y0, y1 = scene.extent
    width, height = x1 - x0, y1 - y0
    right, up = max(0.0, MIN_WIDTH_SHARE * height - width) / 2, max(0.0, MIN_HEIGHT_SHARE * width - height) / 2
    if right > 0 or up > 0:
        edge = Line(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]))
        scene.marks.append(Mark(_NO_OBJECT, "field", edge, None, Stroke(_EDGE_COLOR, 0.8), 1.0, 0.0))
        scene.look_at((x0 - right, x1 + right, y0 - up, y1 + up))


def png_of(image: Image.Image, kept: Sequence[tuple[int, int, int]]) -> bytes:
    """Convert an image to a PNG file with few colours, which include ``kept``."""
    data = io.BytesIO()
    reduce_colors(image, kept, MAX_COLORS).save(data, "PNG", optimize=True)
    return data.getvalue()


def _add_details(scene: Scene, simulation: Simulation, world: int) -> None:
    """Change a legible scene in place.

    - A goal that requires a heading has an arrow in that direction.
    - Arrows of objects are above the marks of hits.
    - Goals of robots are above the fog, and names of obstacles under it are left out.

    Args:
        scene: The scene; its extent is the area that the picture shows.
        simulation: The simulation that the scene shows.
        world: Index of the world.
    """
    top = max((beams.dots.zorder for beams in scene.beams if beams.dots is not None), default=0.0)
    for mark in scene.marks:
        if mark.part == "arrow":
            mark.zorder = max(mark.zorder, top + 1.0)
    fog, robots = scene.fog, {view.id for view in views(simulation, world) if view.role == "robot"}
    for mark in scene.marks:
        if fog is not None and mark.part == "goal" and mark.object in robots:
            mark.zorder = max(mark.zorder, fog.zorder + _ABOVE)
    scene.marks += _goal_arrows(scene, simulation, world)
    if fog is not None:
        scene.labels = [label for label in scene.labels if label.object in robots or not _is_hidden(fog, label.anchor)]


def _goal_arrows(scene: Scene, simulation: Simulation, world: int) -> list[Mark]:
    """An arrow on each drawn goal whose heading counts."""
    x0, x1, y0, y1 = scene.extent
    length = _GOAL_ARROW_SHARE * max(x1 - x0, y1 - y0)
    goals = {mark.object: mark for mark in scene.marks if mark.part == "goal"}
    arrows = []
    for view in views(simulation, world):
        x, y, heading = (float(value) for value in simulation.goal[view.row][:3])
        drawn = goals.get(view.id)
        if drawn is None or math.isnan(x) or not view.record.heading_counts([x, y, heading]):
            continue
        pointer = place(arrow(length, _GOAL_ARROW_WIDTH * length), (x, y, heading))
        color = drawn.fill if drawn.fill is not None else _DEFAULT_COLOR
        arrows.append(Mark(view.id, "arrow", pointer, color, Stroke(_DEFAULT_COLOR, 0.6), 1.0, drawn.zorder + 0.1))
    return arrows


def _is_hidden(fog: Fog, point: tuple[float, float]) -> bool:
    """Whether a point lies under the fog."""
    x0, x1, y0, y1 = fog.extent
    columns, rows = fog.explored.shape
    column, row = int((point[0] - x0) / (x1 - x0) * columns), int((point[1] - y0) / (y1 - y0) * rows)
    inside = 0 <= column < columns and 0 <= row < rows
    return bool(inside and not np.asarray(fog.explored)[column, row])


def draw_between_steps(scene: Scene, simulation: Simulation, events: Sequence[Event]) -> None:
    """Mark where objects touched, or passed through, each other between two steps, up to the present moment.

    Args:
        scene: Scene to add to.
        simulation: The simulation that it shows.
        events: Events of the episode so far.
    """
    passable = passable_names(simulation)
    x0, x1, y0, y1 = scene.extent
    half = _SIZE_SHARE * max(x1 - x0, y1 - y0)
    corners = half * np.array([[0.0, -1.2], [1.0, 0.0], [0.0, 1.2], [-1.0, 0.0]])
    hole = _HOLE_SHARE * corners[::-1]
    shown = [event for event in events if event.kind in BETWEEN_STEPS and not {event.object, event.partner} <= passable]
    for event in shown[-_MAX_MARKS:]:
        place = np.array([event.x, event.y])
        shape = Region([place + corners, place + hole])
        scene.marks.append(Mark(-1, "contact", shape, Palette().contact, Stroke("white", _HALO_PT), 1.0, _ZORDER))
