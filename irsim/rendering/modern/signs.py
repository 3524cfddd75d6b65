"""Signs at objects: stars where they touched, badges and rings that tell what has become of a robot."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from irsim.graphics.scene.glyphs import BADGE_LINE, BADGES, RIM_U, RINGS, STAR, STARS
from irsim.graphics.scene.scene import Circle, Line, Mark, Region
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern.frame import FRAME, stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Thing
from irsim.simulation.events import Event

__all__ = ["star_marks", "state_marks", "touches"]

_STAR_Z, _BADGE_Z, _RING_Z = 5.5, 6.0, 4.33
_MAX_STARS = 500
"""Number of the latest contacts that are drawn."""
_DIAGONAL = math.sqrt(0.5)
_NEAR_STAR = 2.0
"""Distance to a star, in radii of the robot, below which the robot does not have a badge, too."""


def touches(events: Sequence[Event], robots: set[str], passable: set[str]) -> tuple[list[Event], list[Event]]:
    """Contacts with a robot, and contacts between others; without bodies that may be passed through."""
    kinds = ("collision", "contact_between_steps", "passed_through")
    own, others = list[Event](), list[Event]()
    for event in events:
        if event.kind in kinds and event.object not in passable and event.partner not in passable:
            (own if event.object in robots or event.partner in robots else others).append(event)
    return own, others


def star_marks(
    own: Sequence[Event], others: Sequence[Event], layout: Layout, theme: Theme, *, level: int
) -> list[Mark]:
    """Stars where robots touched something, and small pale ones where others touched each other."""
    marks = list[Mark]()
    large = STARS["crowded"] if level > 1 else layout.sizes.star
    for events, color, size in ((others, theme.muted, min(STARS["others"], large)), (own, theme.danger, large)):
        for event in events[-_MAX_STARS:]:
            star = Region([np.array(STAR) * layout.metres(size) + (event.x, event.y)])
            marks.append(Mark(FRAME, "contact", star, color, stroke(theme.paper, RIM_U), 1.0, _STAR_Z))
    return marks


def state_marks(thing: Thing, layout: Layout, theme: Theme, *, level: int) -> list[Mark]:
    """A ring and a badge on the rim of a robot; what they mean differs by shape, not by colour alone."""
    number, marks = thing.number, list[Mark]()
    x, y, rim = thing.around
    if thing.picked:
        ring = Circle(x, y, rim + layout.metres(RINGS["picked"]["gap"]))
        marks.append(Mark(number, "ring", ring, None, stroke(theme.near, RINGS["picked"]["width"]), 1.0, _RING_Z))
    colors = {"arrived": theme.good, "collided": theme.danger, "stopped": theme.warn}
    if not thing.state:
        return marks
    color = colors[thing.state]
    if level > 1:
        ring = Circle(x, y, rim)
        return [*marks, Mark(number, "ring", ring, None, stroke(color, RINGS["crowded"]["width"]), 1.0, _RING_Z)]
    if thing.state == "collided":
        ring = Circle(x, y, rim + layout.metres(RINGS["collided"]["gap"]))
        marks.append(Mark(number, "ring", ring, None, stroke(color, RINGS["collided"]["width"]), 1.0, _RING_Z))
        assert thing.hit is not None
        if math.hypot(thing.hit.x - x, thing.hit.y - y) < _NEAR_STAR * rim:
            return marks  # one red sign is enough
    r = layout.metres(layout.sizes.badge)
    cx, cy = x + _DIAGONAL * rim, y + _DIAGONAL * rim
    marks.append(Mark(number, "badge", Circle(cx, cy, r), color, stroke(theme.paper, RIM_U), 1.0, _BADGE_Z))
    line = stroke(theme.on, BADGE_LINE * layout.sizes.badge)
    for points in BADGES[thing.state]:
        shape = Line(np.array(points) * r + (cx, cy))
        marks.append(Mark(number, "sign", shape, None, line, 1.0, _BADGE_Z))
    return marks
