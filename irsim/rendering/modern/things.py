"""The objects of a picture, with what their glyphs depend on: kind, shades, state, and how many there are."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from irsim.graphics.scene.bodies import Body
from irsim.graphics.scene.glyphs import CROWD, SMALLER
from irsim.graphics.scene.scene import Mark, Scene
from irsim.graphics.scene.theme import Kind, Shades, Theme
from irsim.objects.drawing.kinds import kind_of
from irsim.objects.drawing.signs import distinct_colors
from irsim.objects.views import views
from irsim.simulation.events import Event, first_collisions

if TYPE_CHECKING:
    from irsim.objects.drawing.scene_builder import SceneBuilder
    from irsim.objects.view import ObjectView
    from irsim.rendering.modern.layout import Layout
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["Crowd", "Thing", "read_things"]

MANY_PEOPLE = 50
_CROWDED_PERSON, _CROWDED_SMALL_PERSON = 4.2, 3.8
"""Least radius of a person where there are many, in the normal layout and in others [u]."""
State = Literal["", "arrived", "collided", "stopped"]


@dataclass(slots=True)
class Thing:
    """One object.

    Attributes:
        number: Id of the object.
        record: Its entry of the scenario.
        color: Its colour, from which its shades are.
        is_round: Whether its body is a disc about its position.
        mark: The mark of its body, with its true footprint; None for one that is drawn as an image or not at all.
        drawn_at: x, y [m], heading [rad] at which it is drawn; before it appears, where it will.
        course: Where it is going, which may differ from its heading [rad].
        glyph_radius: Radius that its glyph has in the picture [m].
        shown: Whether it is in the part of the world that the picture shows.
        moves: Whether it can move.
        hit: Its first collision.
        chosen: The plot keys that the scenario gives it.
    """

    view: ObjectView
    record: ObjectRecord
    number: int
    kind: Kind
    color: Any
    shades: Shades
    body: Body
    is_round: bool
    moves: bool
    chosen: set[str]
    overrides: Mapping[str, Any]
    mark: Mark | None = None
    drawn_at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    course: float = 0.0
    glyph_radius: float = 0.0
    shown: bool = False
    state: State = ""
    hit: Event | None = None
    picked: bool = False

    @property
    def half_width(self) -> float:
        """Half the shorter side of its body [m]."""
        return min(self.body.length, self.body.width) / 2

    @property
    def around(self) -> tuple[float, float, float]:
        """Middle and radius of the circle around what is drawn of its body [m]."""
        x, y, heading = self.drawn_at
        if self.is_round or self.glyph_radius > self.body.radius:
            return x, y, self.glyph_radius
        across, up = self.body.middle
        c, s = math.cos(heading), math.sin(heading)
        return x + c * across - s * up, y + s * across + c * up, math.hypot(self.body.length, self.body.width) / 2

    def wants(self, key: str, default: bool = True) -> bool:
        """Whether a plot key, such as ``show_goal``, is on.

        The caller switches off anything, and on what the style draws of this object; else the scenario decides.
        """
        given = self.overrides.get(key)
        if given is not None and (default or not given):
            return bool(given)
        return bool(getattr(self.record.plot, key)) if key in self.chosen else default


@dataclass(frozen=True)
class Crowd:
    """How many robots and people the picture shows."""

    robots: int
    people: int

    @property
    def level(self) -> int:
        """0 for few robots, 1 for some, 2 for many."""
        return (self.robots > CROWD["few"]) + (self.robots > CROWD["many"])

    def least_radius(self, kind: Kind, layout: Layout) -> float:
        """Least radius of a robot or a person [m]."""
        sizes = layout.sizes
        if kind == "robot":
            return layout.metres(sizes.robot * SMALLER[self.level])
        crowded = _CROWDED_PERSON if sizes.kind == "normal" else _CROWDED_SMALL_PERSON
        return layout.metres(crowded if self.people > MANY_PEOPLE else sizes.person)


def read_things(
    scene: Scene,
    simulation: Simulation,
    world: int,
    builder: SceneBuilder,
    layout: Layout,
    theme: Theme,
    *,
    events: Sequence[Event],
    overrides: Mapping[str, Any],
    picked: Collection[str] = (),
    before: Mapping[int, Thing] | None = None,
) -> tuple[list[Thing], Crowd]:
    """Read the objects that are in a scene.

    Args:
        scene: The scene, with the bodies of its objects.
        simulation: The simulation.
        world: Index of the world.
        builder: The builder that has made the scene.
        layout: The layout of the picture.
        theme: Its colours.
        events: Events of the episode so far.
        overrides: Plot keys that the caller sets.
        picked: Names of the objects that stand out.
        before: The things of the last picture with this layout, which serve again: what moves is brought up to date.
    """
    marks = {mark.object: mark for mark in scene.marks if mark.part == "body"}
    images = {picture.object for picture in scene.pictures}
    objects = views(simulation, world)
    first, end = (objects[0].row, objects[-1].row + 1) if objects else (0, 0)
    columns = (
        values[first:end].tolist()
        for values in (simulation.pose, simulation.appeared, simulation.arrived, simulation.stopped)
    )
    rows = [row for row in zip(objects, *columns, strict=True) if row[0].id in marks or row[0].id in images]
    hits = first_collisions(simulation, list(events))
    colors = distinct_colors(objects)
    x0, x1, y0, y1 = layout.world
    things = list[Thing]()
    for view, (x, y, heading), appeared, arrived, stopped in rows:
        number, mark, body = view.id, marks.get(view.id), builder.body(view)
        thing = None if before is None else before.get(number)
        if thing is None or not _is_same(thing, view, colors[number], body, overrides):
            thing = _thing_of(view, colors[number], body, theme, overrides)
        elif thing.kind == "still" and mark is not None and thing.mark is mark:
            thing.picked = view.name in picked
            things.append(thing)
            continue
        if math.isnan(x) or appeared < 0:
            x, y, heading = simulation.state.initial_state(view.row)[:3].tolist()
        thing.mark, thing.hit, thing.picked = mark, hits.get(view.name), view.name in picked
        thing.drawn_at = x, y, heading
        thing.course = builder.heading_of(view, thing.drawn_at)
        thing.glyph_radius = reach = body.radius
        thing.shown = x0 - reach <= x <= x1 + reach and y0 - reach <= y <= y1 + reach
        thing.state = _state(arrived, stopped, thing.hit) if thing.kind == "robot" else ""
        things.append(thing)
    shown = [thing for thing in things if thing.shown]
    crowd = Crowd(sum(t.kind == "robot" for t in shown), sum(t.kind == "person" for t in shown))
    least: dict[Kind, float] = {"robot": crowd.least_radius("robot", layout)}
    least["person"] = crowd.least_radius("person", layout)
    for thing in things:
        if thing.kind in least:
            thing.glyph_radius = max(thing.glyph_radius, least[thing.kind])
    return things, crowd


def _is_same(thing: Thing, view: ObjectView, color: Any, body: Body, overrides: Mapping[str, Any]) -> bool:
    """Whether all that a thing has from its scenario is as it was."""
    same = thing.view is view and thing.record is view.record and thing.body is body
    return same and thing.color == color and thing.overrides == overrides


def _thing_of(view: ObjectView, color: Any, body: Body, theme: Theme, overrides: Mapping[str, Any]) -> Thing:
    """A thing whose place and state have not been read."""
    record, kind = view.record, kind_of(view.record)
    return Thing(
        view=view,
        record=record,
        number=view.id,
        kind=kind,
        color=color,
        shades=theme.shades(kind, color),
        body=body,
        is_round=body.kind == "circle" and body.middle == (0.0, 0.0),
        moves=not record.static and record.kinematics is not None,
        chosen=record.plot.model_fields_set,
        overrides=dict(overrides),
    )


def _state(arrived: bool, stopped: bool, hit: Event | None) -> State:
    if arrived:
        return "arrived"
    if not stopped:
        return ""  # a robot that touched something and drives on has its star
    return "stopped" if hit is None else "collided"
