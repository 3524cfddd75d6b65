"""Details that only snapshots show: goals whose heading counts, arrows over hits, and goals, not names, over fog."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from irsim.graphics.scene.bodies import arrow, place
from irsim.graphics.scene.scene import Fog, Mark, Region, Scene, Stroke
from irsim.graphics.scene.style import Color, Palette
from irsim.objects.views import views
from irsim.simulation.events import BETWEEN_STEPS, passable_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from irsim.simulation.events import Event
    from irsim.simulation.simulation import Simulation

__all__ = ["add_details", "draw_between_steps"]


_GOAL_ARROW_SHARE = 0.05
"""Length of the arrow on a goal, as a share of the longer side of the picture."""
_GOAL_ARROW_WIDTH = 0.4
"""Its width, as a share of its length."""
_ABOVE = 0.1
"""How far above the fog goals are drawn."""
_DEFAULT_COLOR: Color = "#333333"


def add_details(scene: Scene, simulation: Simulation, world: int) -> None:
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


_SIZE_SHARE = 0.018
"""Half the width of a mark as a share of the longer side of the picture."""
_HOLE_SHARE = 0.45
"""Size of the hole of a mark as a share of the mark's."""
_HALO_PT = 0.6
_ZORDER = 9.0
_MAX_MARKS = 500
"""Number of the latest contacts that are marked."""


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
