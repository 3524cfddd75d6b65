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
from irsim.objects.views import views
from irsim.options.colors import ACKER_COLOR, CYCLE, ROBOT_COLOR
from irsim.simulation.events import Event, first_collisions

if TYPE_CHECKING:
    from irsim.objects.drawing.scene_builder import SceneBuilder
    from irsim.objects.view import ObjectView
    from irsim.rendering.modern.layout import Layout
    from irsim.simulation.simulation import Simulation

__all__ = ["Crowd", "Thing", "read_things"]

MANY_PEOPLE = 50
_DISTINCT = 6
"""Number of colours that all people can tell apart."""
_CROWDED_PERSON, _CROWDED_SMALL_PERSON = 4.2, 3.8
"""Least radius of a person where there are many, in the normal layout and in others [u]."""
State = Literal["", "arrived", "collided", "stopped"]


@dataclass(slots=True)
class Thing:
    """One object.

    Attributes:
        number: Id of the object.
        is_round: Whether its body is a disc about its position.
        mark: The mark of its body, with its true footprint; None for one that is drawn as an image or not at all.
        drawn_at: x, y [m], heading [rad] at which it is drawn; before it appears, where it will.
        course: Where it is going, which may differ from its heading [rad].
        glyph_radius: Radius that its glyph has in the picture [m].
        shown: Whether it is in the part of the world that the picture shows.
        moves: Whether it can move.
        hit: Its first collision.
    """

    view: ObjectView
    number: int
    kind: Kind
    shades: Shades
    body: Body
    is_round: bool
    mark: Mark | None
    drawn_at: tuple[float, float, float]
    course: float
    glyph_radius: float
    shown: bool
    moves: bool
    state: State
    hit: Event | None
    picked: bool
    overrides: Mapping[str, Any]

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
        plot = self.view.record.plot
        return bool(getattr(plot, key)) if key in plot.model_fields_set else default


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
        before: The things of the last picture with this layout; unchanged ones that stand serve again.
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
    colors = _colors([row[0] for row in rows])
    shades: dict[tuple[Kind, Any], Shades] = {}
    x0, x1, y0, y1 = layout.world
    things = list[Thing]()
    for view, (x, y, heading), appeared, arrived, stopped in rows:
        number, record, mark = view.id, view.record, marks.get(view.id)
        known = None if before is None or mark is None else before.get(number)
        if known is not None and known.kind == "still" and known.mark is mark and known.overrides == overrides:
            known.picked = view.name in picked
            things.append(known)
            continue
        if math.isnan(x) or appeared < 0:
            x, y, heading = simulation.state.initial_state(view.row)[:3].tolist()
        kind, hit, body = kind_of(record), hits.get(view.name), builder.body(view)
        look = kind, colors[number]
        if look not in shades:
            shades[look] = theme.shades(*look)
        reach = body.radius
        things.append(
            Thing(
                view=view,
                number=number,
                kind=kind,
                shades=shades[look],
                body=body,
                is_round=body.kind == "circle" and body.middle == (0.0, 0.0),
                mark=mark,
                drawn_at=(x, y, heading),
                course=builder.heading_of(view, (x, y, heading)),
                glyph_radius=reach,
                shown=x0 - reach <= x <= x1 + reach and y0 - reach <= y <= y1 + reach,
                moves=not record.static and record.kinematics is not None,
                state=_state(arrived, stopped, hit) if kind == "robot" else "",
                hit=hit,
                picked=view.name in picked,
                overrides=overrides,
            )
        )
    shown = [thing for thing in things if thing.shown]
    crowd = Crowd(sum(t.kind == "robot" for t in shown), sum(t.kind == "person" for t in shown))
    least: dict[Kind, float] = {"robot": crowd.least_radius("robot", layout)}
    least["person"] = crowd.least_radius("person", layout)
    for thing in things:
        if thing.kind in least:
            thing.glyph_radius = max(thing.glyph_radius, least[thing.kind])
    return things, crowd


def _state(arrived: bool, stopped: bool, hit: Event | None) -> State:
    if arrived:
        return "arrived"
    if not stopped:
        return ""  # a robot that touched something and drives on has its star
    return "stopped" if hit is None else "collided"


def _colors(shown: Sequence[ObjectView]) -> dict[int, Any]:
    """The colour of each object; two to six robots whose colours were not chosen get one each."""
    colors = {view.id: view.color if view.color != "none" else "k" for view in shown}
    same = [view for view in shown if view.role == "robot" and view.color in (ROBOT_COLOR, ACKER_COLOR)]
    others = {str(view.color) for view in shown if view.role == "robot"} - {ROBOT_COLOR, ACKER_COLOR}
    free = [color for color in CYCLE[:_DISTINCT] if color not in others]
    if 1 < len(same) <= len(free):
        colors.update(zip((view.id for view in same), free, strict=False))
    return colors
