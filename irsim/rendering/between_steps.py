"""Marks of contacts within a step in a picture: hollow red diamonds, as on the page of a replay."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim.graphics.scene.scene import Mark, Region, Scene, Stroke
from irsim.graphics.scene.style import Palette
from irsim.simulation.events import BETWEEN_STEPS, passable_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from irsim.simulation.events import Event
    from irsim.simulation.simulation import Simulation

__all__ = ["draw_between_steps"]

_SIZE_SHARE = 0.018
"""Half the width of a mark as a share of the longer side of the picture."""
_HOLE_SHARE = 0.45
"""Size of the hole of a mark as a share of that of the mark."""
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
