"""Bodies with their glyphs: a dart is a robot, head and shoulders are a person, pale with an edge is what stands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from irsim.graphics.scene.bodies import Pose, place
from irsim.graphics.scene.glyphs import (
    ARRIVED_SHARE,
    DART,
    EDGES,
    FOOTPRINT,
    PEOPLE,
    SMALL_PERSON_U,
    long_dart,
)
from irsim.graphics.scene.scene import Circle, Geometry, Line, Mark, Region, Stroke
from irsim.graphics.scene.theme import Theme, mix
from irsim.rendering.modern.frame import stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Thing

__all__ = ["STILL_Z", "dart", "moving_marks", "person_marks", "robot_marks", "still_marks"]

STILL_Z = 1.2
_WALL_Z, _PERSON_Z, _ROBOT_Z = 1.5, 4.0, 4.3
_POINTS = 32
_WHEEL = (0.22, 0.09)
"""Length and width of a wheel, as shares of the length of the body."""
MIN_WHEELED = 24.0
"""Least length of a body with wheels [u]."""


def still_marks(thing: Thing, theme: Theme) -> list[Mark]:
    """A static body: pale, carried by its edge."""
    body = thing.mark
    if body is None or thing.view.shape == "walls":  # the edge of the world stands for these
        return []
    plot = thing.view.record.plot
    if isinstance(body.geometry, Line):
        line = stroke(theme.wall, EDGES["line"], plot.obj_linestyle)
        return [Mark(thing.number, "body", body.geometry, None, line, body.alpha, _WALL_Z)]
    edge = stroke(thing.shades.edge, EDGES["still"], plot.obj_linestyle)
    return [Mark(thing.number, "body", body.geometry, thing.shades.fill, edge, body.alpha, STILL_Z)]


def moving_marks(thing: Thing, theme: Theme) -> list[Mark]:
    """A moving obstacle other than a person: a disc or an outline, without a sign."""
    body = thing.mark
    if body is None:
        return []
    if isinstance(body.geometry, Line):
        line = stroke(thing.shades.fill, EDGES["line"])
        return [Mark(thing.number, "body", body.geometry, None, line, body.alpha, _PERSON_Z)]
    rim = stroke(theme.paper, EDGES["person"])
    return [Mark(thing.number, "body", body.geometry, thing.shades.fill, rim, body.alpha, _PERSON_Z)]


def person_marks(thing: Thing, layout: Layout, theme: Theme) -> list[Mark]:
    """Head and shoulders as seen from above; the head is in front."""
    body, r = thing.mark, thing.glyph_radius
    if body is None:
        return []
    number, fill, alpha = thing.number, thing.shades.fill, body.alpha
    pose: Pose = (*thing.drawn_at[:2], thing.course)
    small = r * layout.scale < SMALL_PERSON_U
    glyph = PEOPLE["small" if small else "large"]
    marks = list[Mark]()
    if not small:
        disc = Circle(*thing.drawn_at[:2], r)
        marks.append(Mark(number, "halo", disc, fill, Stroke(None), FOOTPRINT["fill"] * alpha, _PERSON_Z))
        rim = stroke(fill, EDGES["person"])
        marks.append(Mark(number, "halo", disc, None, rim, FOOTPRINT["rim"] * alpha, _PERSON_Z))
    fill = mix(fill, theme.person_head, glyph.own)
    shoulders = place(_ellipse(-glyph.behind * r, glyph.along * r, glyph.across * r), pose)
    middle = place(Circle(glyph.ahead * r, 0.0, glyph.head * r), pose)
    edge, rim = (stroke(theme.paper, width) for width in glyph.rims)
    marks.append(Mark(number, "body", shoulders, fill, edge, alpha, _PERSON_Z))
    marks.append(Mark(number, "head", middle, theme.person_head, rim, alpha, _PERSON_Z))
    return marks


def robot_marks(thing: Thing, layout: Layout, theme: Theme) -> list[Mark]:
    """A robot with its true footprint, or a disc that is large enough to be seen, and a dart in it."""
    body, number, shades = thing.mark, thing.number, thing.shades
    arrived = thing.state == "arrived"
    fill = mix(shades.fill, theme.paper, ARRIVED_SHARE) if arrived else shades.fill
    inner = shades.edge if arrived else shades.dart
    turned: Pose = (*thing.drawn_at[:2], thing.course)
    if body is None:
        return []
    own, shape = thing.view.record.plot, body.geometry
    disc = thing.is_round or thing.glyph_radius > thing.body.radius or isinstance(shape, Line)
    if disc:
        shape = Circle(*thing.drawn_at[:2], thing.glyph_radius)
    halo = 2 * (EDGES["round_halo"] if disc else EDGES["other_halo"]) + EDGES["robot"]
    width = float(own.obj_linewidth) if "obj_linewidth" in own.model_fields_set else EDGES["robot"]
    marks = [
        Mark(number, "halo", shape, None, stroke(theme.paper, halo), body.alpha, _ROBOT_Z - 0.02),
        Mark(number, "body", shape, fill, stroke(shades.edge, width, own.obj_linestyle), body.alpha, _ROBOT_Z),
    ]
    marks += [] if disc else _wheels(thing, layout, theme, body.alpha)
    if thing.wants("show_arrow"):
        sign = dart(thing.glyph_radius) if disc else dart(thing.half_width, thing.body.length / 2, thing.body.middle)
        marks.append(Mark(number, "dart", place(sign, turned), inner, Stroke(None), body.alpha, _ROBOT_Z + 0.01))
    return marks


def dart(r: float, half_length: float | None = None, middle: tuple[float, float] = (0.0, 0.0)) -> Region:
    """A kite along body x whose tip is in front.

    Args:
        r: Half the width of the body [m].
        half_length: Half the length of a long body [m].
        middle: Middle of the body [m].
    """
    corners = [(x * r, y * r) for x, y in DART] if half_length is None else long_dart(r, half_length)
    return Region([np.array(corners) + middle])


def _wheels(thing: Thing, layout: Layout, theme: Theme, alpha: float) -> list[Mark]:
    """The wheels of a car, of which the front ones are turned by its steering angle."""
    record, body = thing.view.record, thing.body
    drive = getattr(record.kinematics, "name", "")
    if drive != "acker" or body.length * layout.scale < MIN_WHEELED or not record.wheelbase:
        return []
    state = thing.view.state[:, 0]
    steering = float(state[3]) if len(state) > 3 else 0.0
    long, wide = (share * body.length / 2 for share in _WHEEL)
    wheel = Region([np.array([(-long, -wide), (long, -wide), (long, wide), (-long, wide)])])
    marks = list[Mark]()
    for x, angle in ((0.0, 0.0), (float(record.wheelbase), steering)):
        for side in (-1, 1):
            turned = place(wheel, (x, body.middle[1] + side * (body.width / 2 - wide), angle))
            shape: Geometry = place(turned, thing.drawn_at)
            marks.append(Mark(thing.number, "arrow", shape, theme.ink, Stroke(None), alpha, _ROBOT_Z))
    return marks


@lru_cache(maxsize=256)
def _ellipse(x: float, along: float, across: float) -> Region:
    angles = np.linspace(0, 2 * math.pi, _POINTS, endpoint=False)
    return Region([np.stack([x + along * np.cos(angles), across * np.sin(angles)], axis=1)])


def kinds(things: Sequence[Thing], kind: str) -> list[Thing]:
    """The objects of one kind."""
    return [thing for thing in things if thing.kind == kind]
