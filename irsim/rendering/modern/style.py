"""The pass that turns a scene into a picture of the style `modern`: each part in its shade, size and layer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.glyphs import CROWD
from irsim.graphics.scene.scene import Bounds, Circle, GridImage, Label, Mark, Scene, Stroke
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern import bodies, frame, ground, heading, names, sensing, signs, ways
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import MANY_PEOPLE, Crowd, Thing, read_things
from irsim.simulation.events import Event, passable_names, read_events

if TYPE_CHECKING:
    from irsim.objects.drawing.scene_builder import SceneBuilder
    from irsim.simulation.simulation import Simulation

__all__ = ["BUILD_KEYS", "USER_ZORDER", "ModernStyle", "Request", "name_of"]

BUILD_KEYS = {
    **dict.fromkeys(("show_goal", "show_text", "show_goal_text", "show_arrow", "show_trajectory"), False),
    "show_trail": None,
}
"""Plot keys with which a scene is built for this style, which draws these parts itself."""
Parts = tuple[list[Mark], list[Label]]
_ADDED_Z = 5.4
_GHOST = (0, (1.0, 2.0))
USER_ZORDER = 3.0
"""Layer of drawings of users."""
_ADDED_PARTS = ("field", "plan", "contact")
"""Parts of a scene that callers add and that stay as they are."""


@dataclass(frozen=True)
class Request:
    """The wishes for a picture, besides bodies.

    Attributes:
        overrides: Plot keys that hold instead of the scenario's.
        picked: Names of objects that stand out.
        axes: Whether coordinates are at the edge of the world.
        zones: Whether zones are shown.
        title: In place of the name of the scenario.
        head: Whether there is a line above the world.
        said: The state that the line of the moment before has said; it is not said again.
        names: Whether robots have names where the scenario does not say so.
        plans: Whether ways to goals are shown.
        events: Events of the episode; None: the simulation's.
    """

    overrides: Mapping[str, Any] = field(default_factory=dict)
    picked: Collection[str] = ()
    axes: bool = False
    zones: bool = True
    title: str | None = None
    head: bool = True
    said: str = ""
    names: bool = True
    plans: bool = True
    events: Sequence[Event] | None = None


class ModernStyle:
    """Draws scenes of one world. Things that do not change from one frame to the next keep their marks.

    Args:
        simulation: The simulation.
        world: Index of the world.
        theme: The colours.

    Attributes:
        notes: Things that the last picture left out, as sentences.
        word: The state of the episode, as the last picture said it.
    """

    def __init__(self, simulation: Simulation, world: int, theme: Theme) -> None:
        self.simulation, self.world, self.theme = simulation, world, theme
        self.sizes = TextSizes()
        self.notes: list[str] = []
        self.word = ""
        self._layout: Layout | None = None
        self._ground: list[Mark] = []
        self._page: list[Mark] = []
        self._still: dict[int, tuple[Mark | None, bool, list[Mark]]] = {}
        self._maps: dict[int, tuple[GridImage, GridImage, list[Mark]]] = {}
        self._fog: tuple[Any, list[Mark]] = (None, [])
        self._parts: dict[tuple[Any, ...], Parts] = {}
        self._head: tuple[Any, Parts] | None = None
        self._boxes: dict[Mark, Bounds] = {}
        self._goals: dict[int, tuple[Any, list[Mark]]] = {}
        self._stars: tuple[Any, list[Mark]] = (None, [])
        self._name = name_of(simulation)

    def draw(self, scene: Scene, builder: SceneBuilder, layout: Layout, request: Request) -> Scene:
        """Return the picture of a scene.

        Args:
            scene: The scene, built with :data:`BUILD_KEYS`, and additions of the caller.
            builder: The builder that has made it.
            layout: The layout of the picture.
            request: The wishes for it.
        """
        simulation, theme = self.simulation, self.theme
        if layout != self._layout:
            self._forget(layout)
        events = read_events(simulation, self.world) if request.events is None else request.events
        things, crowd = read_things(
            scene, simulation, self.world, builder, layout, theme,
            events=events, overrides=request.overrides, picked=request.picked,
        )  # fmt: skip
        by_number = {thing.number: thing for thing in things}
        marks, labels = list(self._ground), list[Label]()
        grids = self._add_maps(scene, marks)
        if request.zones:
            zones = simulation.scenario.world.zones
            zone_marks, zone_labels = self._same(("zones",), lambda: ground.zone_parts(zones, layout, theme))
            marks += zone_marks
            labels += zone_labels
        fog = None if scene.fog is None else ground.shown_fog(scene.fog, theme)
        if scene.fog is not None:
            marks += self._hatch(scene, layout)
        for thing in things:
            marks += self._body(thing, scene, layout)
        for picture in scene.pictures:
            picture.zorder = bodies.STILL_Z if by_number[picture.object].kind == "still" else USER_ZORDER + 1.3
        marks += self._views(scene, by_number, crowd, layout)
        beads = self._ways(things, crowd, layout, request, marks)
        marks += [self._kept(mark) for mark in scene.marks if mark.part in _ADDED_PARTS]
        labels += [one for one in scene.labels if one.part in ("field", "plan")]
        own, others = signs.touches(
            events, {thing.view.name for thing in things if thing.kind == "robot"}, passable_names(simulation)
        )
        touched = crowd.level, [(one.x, one.y) for one in others], [(one.x, one.y) for one in own]
        if self._stars[0] != touched:
            self._stars = touched, signs.star_marks(own, others, layout, theme, level=crowd.level)
        marks += self._stars[1]
        for thing in things:
            if thing.kind == "robot" and thing.shown:
                marks += signs.state_marks(thing, layout, theme, level=crowd.level)
        labels += self._same(("axes",), lambda: ([], frame.axis_labels(layout, theme)))[1] if request.axes else []
        wishes = _wishes(things, own, crowd, layout, theme) if request.names else []
        leaders, named, dropped = names.place_names(wishes, marks, labels, layout, theme, self.sizes, self._boxes)
        marks += leaders
        labels += named
        self.notes = _notes(crowd, dropped)
        marks += self._page
        velocities = any(sensing.measures_velocity(beams, by_number[beams.object]) for beams in scene.beams)
        parts = [self._heading(scene, things, crowd, sum(e.kind == "collision" for e in own), layout, request)]
        if layout.sizes.kind != "strip":
            parts.append(self._same(("foot",), lambda: frame.foot(layout, theme)))
            parts.append(
                self._same(
                    ("legend", beads, velocities),
                    lambda: heading.legend_parts(layout, theme, self.sizes, beads=beads, velocities=velocities),
                )
            )
        for more_marks, more_labels in parts:
            marks += more_marks
            labels += more_labels
        return Scene(
            time=scene.time,
            status=scene.status,
            extent=layout.extent,
            center=None,
            marks=marks,
            beams=[],
            labels=labels,
            pictures=scene.pictures,
            fog=fog,
            grids=grids,
        )

    def _forget(self, layout: Layout) -> None:
        walls = self.simulation.scenario.world.boundary == "walls"
        self._layout = layout
        self._ground = frame.ground_marks(layout, self.theme, walls=walls)
        self._page = frame.frame_marks(layout, self.theme, walls=walls)
        self._still.clear()
        self._parts.clear()
        self._boxes.clear()
        self._goals.clear()
        self._stars = (None, [])
        self._head = None
        self._maps.clear()
        self._fog = (None, [])

    def _same(self, key: tuple[Any, ...], make: Callable[[], Parts]) -> Parts:
        """Marks and labels that stay the same objects as long as the layout does."""
        if key not in self._parts:
            self._parts[key] = make()
        return self._parts[key]

    def _add_maps(self, scene: Scene, marks: list[Mark]) -> list[GridImage]:
        grids = []
        for grid in scene.grids:
            known = self._maps.get(grid.object)
            if known is None or known[0] is not grid:
                contour = ground.contour_marks(grid, self.theme)
                known = self._maps[grid.object] = grid, ground.shown_grid(grid, self.theme), contour
            grids.append(known[1])
            marks += known[2]
        return grids

    def _hatch(self, scene: Scene, layout: Layout) -> list[Mark]:
        assert scene.fog is not None
        known = self._fog[0]
        if known is None or (known != scene.fog.explored).any():
            self._fog = scene.fog.explored.copy(), ground.fog_marks(scene.fog, layout, self.theme)
        return self._fog[1]

    def _body(self, thing: Thing, scene: Scene, layout: Layout) -> list[Mark]:
        theme = self.theme
        if thing.kind == "robot":
            return bodies.robot_marks(thing, layout, theme)
        if thing.kind == "person" and thing.is_round:
            return bodies.person_marks(thing, layout, theme)
        if thing.kind in ("person", "thing"):
            return bodies.moving_marks(thing, theme)
        hidden = scene.fog is not None and thing.mark is not None and not ground.is_seen(scene.fog, thing.mark.geometry)
        known = self._still.get(thing.number)
        if known is None or known[0] is not thing.mark or known[1] != hidden:
            made = bodies.still_marks(thing, theme)
            if hidden:
                ghost = Stroke(theme.still_edge, 0.9, style=_GHOST)
                made = [replace(mark, fill=None, stroke=ghost) for mark in made]
            known = self._still[thing.number] = thing.mark, hidden, made
        return known[2]

    def _views(self, scene: Scene, by_number: Mapping[int, Thing], crowd: Crowd, layout: Layout) -> list[Mark]:
        """Fields of view and scans."""
        marks = list[Mark]()
        for shape in scene.marks:
            if shape.part == "fov":
                marks += sensing.fov_marks(shape, by_number[shape.object], self.theme)
        scans = len(scene.beams)
        for beams in scene.beams:
            thing = by_number[beams.object]
            area = crowd.level == 0 or thing.picked
            if crowd.level < 2 or thing.picked:
                marks += sensing.scan_marks(beams, thing, layout, self.theme, scans=scans, area=area)
        return marks

    def _ways(self, things: Sequence[Thing], crowd: Crowd, layout: Layout, request: Request, marks: list[Mark]) -> bool:
        """Add trails, goals and plans; return whether trails have beads."""
        theme, simulation = self.theme, self.simulation
        beaded = layout.sizes.kind == "normal" and 0 < crowd.robots <= ways.MAX_BEADED
        crowded, any_beads = crowd.people > MANY_PEOPLE, False
        for thing in things:
            robot = thing.kind == "robot"
            if not thing.shown or thing.kind == "still":
                continue
            if thing.wants("show_trajectory"):
                level = 0 if thing.picked else crowd.level
                drawn = ways.trail_marks(
                    thing, simulation, layout, theme, level=level, beads=beaded and robot, crowded=crowded
                )
                any_beads |= any(mark.part == "bead" for mark in drawn)
                marks += drawn
            if not (thing.wants("show_goal", robot) and (crowd.level < 2 or thing.picked)):
                continue
            goals = ways.remaining_goals(thing, simulation)
            if goals:
                level = 0 if thing.picked else crowd.level
                key = thing.shades, level, *(goal.tobytes() for goal in goals)
                known = self._goals.get(thing.number)
                if known is None or known[0] != key:
                    made = ways.goal_marks(thing, goals, layout, theme, level=level)
                    known = self._goals[thing.number] = key, made
                marks += known[1]
                if robot and request.plans and level == 0:
                    marks += ways.plan_marks(thing, ways.path_ahead(thing, goals, simulation), layout)
        return any_beads

    @staticmethod
    def _kept(mark: Mark) -> Mark:
        """A mark that the caller has added: contacts above bodies, the others in the layer of drawings of users."""
        layer = {"field": mark.zorder, "contact": _ADDED_Z}
        return replace(mark, zorder=layer.get(mark.part, USER_ZORDER))

    def _heading(
        self, scene: Scene, things: Sequence[Thing], crowd: Crowd, collisions: int, layout: Layout, request: Request
    ) -> tuple[list[Mark], list[Label]]:
        if not request.head:
            return [], []
        self.word = word = heading.outcome_word(self.simulation, self.world, collisions)
        if layout.sizes.kind == "strip":
            name, shown, facts = "", "" if word == request.said else word, list[str]()
        else:
            name, shown = self._name if request.title is None else request.title, word
            facts = heading.facts_of(things, crowd, word, short=layout.sizes.kind == "print")
        time = heading.time_text(scene.time)
        key = name, shown, facts, len(time)
        if self._head is None or self._head[0] != key:
            parts = heading.heading_parts(name, scene.time, shown, facts, layout, self.theme, self.sizes)
            self._head = key, parts
        marks, labels = self._head[1]
        return marks, [replace(one, text=time) if one.part == "time" else one for one in labels]


def name_of(simulation: Simulation) -> str:
    """The title that a scenario sets, or its name; a file `scenario.yaml` is called like its folder."""
    scenario = simulation.scenario
    plot = scenario.world.plot
    if plot.title and plot.show_title:
        return str(plot.title)
    if scenario.name == "scenario" and scenario.source:
        return Path(scenario.source).absolute().parent.name
    return scenario.name


def _wishes(
    things: Sequence[Thing], own: Sequence[Event], crowd: Crowd, layout: Layout, theme: Theme
) -> list[names.Wish]:
    """Names and times of contacts, the most important first."""
    star = layout.metres(layout.sizes.star)
    named = [thing for thing in things if _has_name(thing, crowd)]
    first = [thing.picked or thing.state == "collided" for thing in named]
    wishes = [_name_wish(thing) for thing in compress(named, first)]
    if crowd.level < 2 and len(own) <= CROWD["timed"]:
        for number, event in enumerate(own):
            place, text = (float(event.x), float(event.y)), f"{event.time:.1f} s"
            wishes.append(names.Wish(frame.FRAME - number, "moment", text, theme.danger, place, (star, star), False))
    return wishes + [_name_wish(thing) for thing, early in zip(named, first, strict=True) if not early]


def _has_name(thing: Thing, crowd: Crowd) -> bool:
    if not thing.shown or not thing.wants("show_text", thing.kind == "robot"):
        return False
    if thing.kind != "robot":
        return "show_text" in thing.view.record.plot.model_fields_set and thing.view.shape != "walls"
    chosen = thing.picked or (thing.state == "collided" and crowd.level < 2)
    return crowd.level == 0 or chosen


def _name_wish(thing: Thing) -> names.Wish:
    view, drawing = thing.view, thing.view.drawing
    unnamed = view.name == f"{view.role}_{view.id}"
    text = (view.name if unnamed else drawing.label) if drawing.text is None else str(drawing.text)
    shape = Circle(*thing.drawn_at[:2], thing.body.radius) if thing.mark is None else thing.mark.geometry
    left, bottom, right, top = bounds(shape)
    reach = max((right - left) / 2, thing.glyph_radius), max((top - bottom) / 2, thing.glyph_radius)
    if not thing.is_round and thing.glyph_radius <= thing.body.radius:
        reach = (right - left) / 2, (top - bottom) / 2
    return names.Wish(thing.number, "name", text, thing.shades.name, ((left + right) / 2, (bottom + top) / 2), reach)


def _notes(crowd: Crowd, dropped: int) -> list[str]:
    notes = []
    if crowd.level == 1:
        notes.append("with more than 12 robots only the ones that collided have names, and plans are left out")
    if crowd.level == 2:
        notes.append("with more than 50 robots names, goals, plans and scans are left out")
    if dropped:
        notes.append(f"{dropped} names have no room")
    return notes
