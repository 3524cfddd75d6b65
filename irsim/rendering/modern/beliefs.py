"""Where robots that decide from an estimate believe to be: dashed outlines, joined to where they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim import _core as core
from irsim.graphics.scene.bodies import place
from irsim.graphics.scene.scene import Circle, Line, Mark
from irsim.rendering.modern.frame import stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Thing

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["belief_marks"]

_JOINT_Z, _BELIEF_Z = 4.2, 4.35
"""The line is below the bodies of robots, the outline above them."""
_DASHES = (0, (4, 3))
_OUTLINE, _JOINT = 1.4, 1.0
_APART = 2.0
"""Distance from which on a line joins both places [u]."""


def belief_marks(things: Sequence[Thing], simulation: Simulation, layout: Layout) -> list[Mark]:
    """An outline at the believed pose of each robot that goes by an estimate, as large as its body is drawn."""
    robots = [thing for thing in things if thing.record.estimates and thing.shown and thing.mark is not None]
    if not robots:
        return []
    rows = np.array([thing.view.row for thing in robots], dtype=np.int64)
    poses, _, _ = core.believed_rows(simulation.world, simulation.state, rows)
    marks = list[Mark]()
    for thing, (x, y, heading) in zip(robots, poses.tolist(), strict=True):
        if not math.isfinite(x):
            continue
        here = thing.drawn_at[:2]
        disc = thing.is_round or thing.glyph_radius > thing.body.radius
        shape = Circle(x, y, thing.glyph_radius) if disc else place(thing.body.geometry, (x, y, heading))
        color = thing.shades.edge
        if math.dist(here, (x, y)) > layout.metres(_APART):
            joint = Line(np.array([here, (x, y)]))
            marks.append(Mark(thing.number, "belief", joint, None, stroke(color, _JOINT), 1.0, _JOINT_Z))
        outline = stroke(color, _OUTLINE, _DASHES)
        marks.append(Mark(thing.number, "belief", shape, None, outline, 1.0, _BELIEF_Z))
    return marks
