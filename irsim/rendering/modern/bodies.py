"""Bodies with their glyphs: a dart is a robot, head and shoulders are a person, pale with an edge is what stands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
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
from irsim.graphics.scene.groups import Outlines, circles, placed_areas
from irsim.graphics.scene.scene import SOLID, Circle, Geometry, Group, Line, Look, Mark, Region, Stroke
from irsim.graphics.scene.theme import Shades, Theme, mix
from irsim.rendering.modern.frame import stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Thing

__all__ = ["STILL_Z", "dart", "moving_marks", "person_groups", "robot_groups", "still_marks"]

STILL_Z = 1.2
_WALL_Z, _PERSON_Z, _HALO_Z, _ROBOT_Z = 1.5, 4.0, 4.28, 4.3
_POINTS = 32
_ANGLES = np.linspace(0, 2 * math.pi, _POINTS, endpoint=False)
_CIRCLE = np.cos(_ANGLES), np.sin(_ANGLES)
"""x and y of points around the outline of shoulders, which is an ellipse."""
_WHEEL = (0.22, 0.09)
"""Length and width of a wheel, as shares of the length of the body."""
MIN_WHEELED = 24.0
"""Least length of a body with wheels [u]."""


def still_marks(thing: Thing, theme: Theme) -> list[Mark]:
    """A static body: pale, carried by its edge."""
    body = thing.mark
    if body is None or thing.view.shape == "walls":  # the edge of the world stands for these
        return []
    plot = thing.record.plot
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


def person_groups(people: Sequence[Thing], layout: Layout, theme: Theme) -> list[Group]:
    """Heads and shoulders as seen from above; the head is in front."""
    sizes: dict[str, list[Thing]] = {"large": [], "small": []}
    for thing in people:
        if thing.mark is not None:
            sizes["small" if thing.glyph_radius * layout.scale < SMALL_PERSON_U else "large"].append(thing)
    return [group for size, members in sizes.items() if members for group in _people(members, size, theme)]


def _people(people: Sequence[Thing], size: str, theme: Theme) -> list[Group]:
    """Glyphs of the same size class."""
    glyph, numbers = PEOPLE[size], [thing.number for thing in people]
    radii = np.array([thing.glyph_radius for thing in people])
    poses = np.array([(*thing.drawn_at[:2], thing.course) for thing in people])
    places, course = np.ascontiguousarray(poses[:, :2]), poses[:, 2:]
    looks = [_person_looks(thing.shades, theme, size, thing.mark.alpha if thing.mark else 1.0) for thing in people]
    discs, rims, bodies, heads = (list(one) for one in zip(*looks, strict=True))
    shoulders = np.empty((len(people), _POINTS, 2))
    shoulders[:, :, 0] = (-glyph.behind * radii)[:, None] + (glyph.along * radii)[:, None] * _CIRCLE[0]
    shoulders[:, :, 1] = (glyph.across * radii)[:, None] * _CIRCLE[1]
    ahead = np.concatenate([np.cos(course), np.sin(course)], axis=1) * (glyph.ahead * radii)[:, None]
    groups = []
    if size == "large":
        groups += circles("halo", _PERSON_Z, numbers, places, radii, discs)
        groups += circles("halo", _PERSON_Z, numbers, places, radii, rims)
    groups += placed_areas("body", _PERSON_Z, numbers, shoulders, poses, bodies)
    return [*groups, *circles("head", _PERSON_Z, numbers, places + ahead, glyph.head * radii, heads)]


@lru_cache(maxsize=512)
def _person_looks(shades: Shades, theme: Theme, size: str, alpha: float) -> tuple[Look, Look, Look, Look]:
    """Looks of the footprint, its rim, the shoulders and the head."""
    fill, glyph = shades.fill, PEOPLE[size]
    edge, rim = (stroke(theme.paper, width) for width in glyph.rims)
    return (
        (fill, Stroke(None), FOOTPRINT["fill"] * alpha),
        (None, stroke(fill, EDGES["person"]), FOOTPRINT["rim"] * alpha),
        (mix(fill, theme.person_head, glyph.own), edge, alpha),
        (theme.person_head, rim, alpha),
    )


def robot_groups(robots: Sequence[Thing], layout: Layout, theme: Theme) -> tuple[list[Group], list[Mark]]:
    """Robots with their true footprint, or a disc that is large enough to be seen, and a dart in it."""
    outlines, halos, bodies, marks = Outlines(), list[Look](), list[Look](), list[Mark]()
    darts, poses, looks, numbers = list[Floats](), list[Pose](), list[Look](), list[int]()
    for thing in robots:
        if thing.mark is None:
            continue
        own, shape, number, r = thing.record.plot, thing.mark.geometry, thing.number, thing.glyph_radius
        disc = thing.is_round or r > thing.body.radius or isinstance(shape, Line)
        width = float(own.obj_linewidth) if "obj_linewidth" in thing.chosen else EDGES["robot"]
        halo, body, inner = _robot_looks(
            thing.shades, theme, thing.state == "arrived", disc, (width, own.obj_linestyle), thing.mark.alpha
        )
        x, y, _ = thing.drawn_at
        solid = own.obj_linestyle in SOLID
        area = isinstance(shape, Region) and len(shape.rings) == 1
        if solid and (disc or area):
            halos.append(halo)
            bodies.append(body)
        if solid and disc:
            outlines.add_circle(number, x, y, r)
        elif solid and isinstance(shape, Region) and area:
            outlines.add_area(number, shape.rings[0])
        else:
            shape = Circle(x, y, r) if disc else shape
            marks.append(Mark(number, "halo", shape, *halo, _HALO_Z))
            marks.append(Mark(number, "body", shape, *body, _ROBOT_Z))
        marks += [] if disc else _wheels(thing, layout, theme, thing.mark.alpha)
        if thing.wants("show_arrow"):
            long = None if disc else thing.body.length / 2
            darts.append(_dart(r if disc else thing.half_width, long, (0.0, 0.0) if disc else thing.body.middle))
            poses.append((x, y, thing.course))
            looks.append(inner)
            numbers.append(number)
    signs = placed_areas("dart", _ROBOT_Z + 0.01, numbers, darts, poses, looks)
    return [*outlines.groups([("halo", _HALO_Z, halos), ("body", _ROBOT_Z, bodies)]), *signs], marks


@lru_cache(maxsize=512)
def _robot_looks(
    shades: Shades, theme: Theme, arrived: bool, disc: bool, edge: tuple[float, str], alpha: float
) -> tuple[Look, Look, Look]:
    """Looks of the halo, the body and the dart."""
    fill = mix(shades.fill, theme.paper, ARRIVED_SHARE) if arrived else shades.fill
    halo = 2 * (EDGES["round_halo"] if disc else EDGES["other_halo"]) + EDGES["robot"]
    return (
        (None, stroke(theme.paper, halo), alpha),
        (fill, stroke(shades.edge, *edge), alpha),
        (shades.edge if arrived else shades.dart, Stroke(None), alpha),
    )


def dart(r: float, half_length: float | None = None, middle: tuple[float, float] = (0.0, 0.0)) -> Region:
    """A kite along body x whose tip is in front.

    Args:
        r: Half the width of the body [m].
        half_length: Half the length of a long body [m].
        middle: Middle of the body [m].
    """
    return Region([_dart(r, half_length, middle)])


@lru_cache(maxsize=512)
def _dart(r: float, half_length: float | None, middle: tuple[float, float]) -> Floats:
    corners = [(x * r, y * r) for x, y in DART] if half_length is None else long_dart(r, half_length)
    points: Floats = np.array(corners) + middle
    return points


def _wheels(thing: Thing, layout: Layout, theme: Theme, alpha: float) -> list[Mark]:
    """The wheels of a car, of which the front ones are turned by its steering angle; a tricycle has one in front."""
    record, body = thing.record, thing.body
    drive: Any = record.kinematics
    if not getattr(drive, "steered", False) or body.length * layout.scale < MIN_WHEELED or not record.wheelbase:
        return []
    state = thing.view.state[:, 0]
    steering = float(state[3]) if len(state) > 3 else 0.0
    long, wide = (share * body.length / 2 for share in _WHEEL)
    wheel = Region([np.array([(-long, -wide), (long, -wide), (long, wide), (-long, wide)])])
    marks = list[Mark]()
    for x, angle in ((0.0, 0.0), (float(record.wheelbase), steering)):
        for side in (0,) if x and drive.pivots else (-1, 1):
            turned = place(wheel, (x, body.middle[1] + side * (body.width / 2 - wide), angle))
            shape: Geometry = place(turned, thing.drawn_at)
            marks.append(Mark(thing.number, "arrow", shape, theme.ink, Stroke(None), alpha, _ROBOT_Z))
    return marks
