"""The pass that turns a scene into a picture of the style `modern`: each part in its shade, size and layer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.common.arrays import Floats
from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.groups import kept
from irsim.graphics.scene.scene import Bounds, Fog, GridImage, Group, Label, Mark, Scene, Stroke
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern import bodies, frame, ground, heading, names, sensing, signs, ways
from irsim.rendering.modern.beliefs import belief_marks
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import MANY_PEOPLE, Crowd, Thing, read_things
from irsim.simulation.events import Event, passable_names, read_events
from irsim.simulation.outcome import collided_robots

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


def _is_hidden(thing: Thing, scene: Scene) -> bool:
    """Whether fog lies over a body."""
    return scene.fog is not None and thing.mark is not None and not ground.is_seen(scene.fog, thing.mark.geometry)


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
        self._marks: dict[tuple[str, int], tuple[Any, list[Mark]]] = {}
        self._groups: dict[tuple[Any, ...], Group] = {}
        self._things: dict[int, Thing] = {}
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
            events=events, overrides=request.overrides, picked=request.picked, before=self._things,
        )  # fmt: skip
        by_number = self._things = {thing.number: thing for thing in things}
        hides = simulation.scenario.world.plot.fog == "hide"
        if hides:
            things = [thing for thing in things if thing.kind == "robot" or not _is_hidden(thing, scene)]
        marks, labels = list(self._ground), list[Label]()
        grids = self._add_maps(scene, marks)
        if request.zones:
            zones = simulation.scenario.world.zones
            zone_marks, zone_labels = self._same(("zones",), lambda: ground.zone_parts(zones, layout, theme))
            marks += zone_marks
            labels += zone_labels
        fog = None if scene.fog is None else ground.shown_fog(scene.fog, theme, hides=hides)
        if fog is not None:
            marks += self._hatch(fog, layout)
        body_marks, groups = self._bodies(things, scene, layout)
        marks += [*body_marks, *belief_marks(things, simulation, layout)]
        for picture in scene.pictures:
            picture.zorder = bodies.STILL_Z if by_number[picture.object].kind == "still" else USER_ZORDER + 1.3
        marks += self._views(scene, by_number, crowd, layout)
        way_marks, way_groups, beads = self._ways(things, crowd, layout, request)
        marks += way_marks
        groups += way_groups
        marks += [self._kept(mark) for mark in scene.marks if mark.part in _ADDED_PARTS]
        labels += [one for one in scene.labels if one.part in ("field", "plan")]
        own, others = signs.touches(
            events, {thing.view.name for thing in things if thing.kind == "robot"}, passable_names(simulation)
        )
        level = crowd.level
        touched = level, [(one.x, one.y) for one in others], [(one.x, one.y) for one in own]
        if self._stars[0] != touched:
            self._stars = touched, signs.star_marks(own, others, layout, theme, level=level)
        marks += self._stars[1]
        for thing in things:
            if thing.kind == "robot" and thing.shown and (thing.state or thing.picked):
                marks += self._made(
                    ("sign", thing.number),
                    (thing.around, thing.state, thing.picked, level, thing.hit),
                    lambda: signs.state_marks(thing, layout, theme, level=level),  # noqa: B023 - called at once
                )
        labels += self._same(("axes",), lambda: ([], frame.axis_labels(layout, theme)))[1] if request.axes else []
        wishes = names.wishes_of(things, own, crowd, layout, theme) if request.names else []
        leaders, named, dropped = names.place_names(
            wishes, marks, groups, labels, layout, theme, self.sizes, self._boxes
        )
        marks += leaders
        labels += named
        self.notes = _notes(crowd, dropped)
        marks += self._page
        velocities = any(sensing.measures_velocity(beams, by_number[beams.object]) for beams in scene.beams)
        collided = len(collided_robots(simulation, self.world, list(events)))
        parts = [self._heading(scene, things, crowd, collided, layout, request)]
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
            groups=[self._unchanged(group) for group in groups],
        )

    def _unchanged(self, group: Group) -> Group:
        """The group of the last frame if nothing in it has changed."""
        key = group.part, group.zorder, group.looks[0][1].round_caps
        self._groups[key] = group = kept(group, self._groups.get(key))
        return group

    def _forget(self, layout: Layout) -> None:
        walls = self.simulation.scenario.world.boundary == "walls"
        self._layout = layout
        self._ground = frame.ground_marks(layout, self.theme, walls=walls)
        self._page = frame.frame_marks(layout, self.theme, walls=walls)
        self._still.clear()
        self._parts.clear()
        self._boxes.clear()
        self._marks.clear()
        self._groups.clear()
        self._things = {}
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

    def _hatch(self, fog: Fog, layout: Layout) -> list[Mark]:
        known = self._fog[0]
        if known is None or (known != fog.explored).any():
            self._fog = fog.explored.copy(), ground.fog_marks(fog, layout, self.theme)
        return self._fog[1]

    def _bodies(self, things: Sequence[Thing], scene: Scene, layout: Layout) -> tuple[list[Mark], list[Group]]:
        marks, robots, people = list[Mark](), list[Thing](), list[Thing]()
        for thing in things:
            if thing.kind == "robot":
                robots.append(thing)
            elif thing.kind == "person" and thing.is_round:
                people.append(thing)
            elif thing.kind == "still":
                marks += self._still_body(thing, scene)
            else:
                marks += bodies.moving_marks(thing, self.theme)
        groups, more = bodies.robot_groups(robots, layout, self.theme)
        return marks + more, [*bodies.person_groups(people, layout, self.theme), *groups]

    def _still_body(self, thing: Thing, scene: Scene) -> list[Mark]:
        theme = self.theme
        hidden = _is_hidden(thing, scene)
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

    def _ways(
        self, things: Sequence[Thing], crowd: Crowd, layout: Layout, request: Request
    ) -> tuple[list[Mark], list[Group], bool]:
        """Trails, goals and plans, and whether trails have beads."""
        theme, simulation, marks = self.theme, self.simulation, list[Mark]()
        beaded, most = layout.sizes.kind == "normal" and 0 < crowd.robots <= ways.MAX_BEADED, crowd.level
        trails: dict[tuple[bool, int], list[Thing]] = {}
        plans, any_beads = list[tuple[Thing, Floats]](), False
        for thing in things:
            robot = thing.kind == "robot"
            if not thing.shown or thing.kind == "still":
                continue
            level = 0 if thing.picked else most
            if thing.wants("show_trajectory"):
                trails.setdefault((robot, level if robot else 0), []).append(thing)
                if beaded and robot and (count := ways.bead_count(thing, simulation)):
                    any_beads = True
                    marks += self._made(
                        ("bead", thing.number),
                        (count, int(simulation.state.scene[self.world]), simulation.revision),
                        lambda: ways.bead_marks(thing, count, simulation, layout, theme),  # noqa: B023 - called at once
                    )
            if not (level < 2 and thing.wants("show_goal", robot)):
                continue
            goals = ways.remaining_goals(thing, simulation)
            if goals:
                key = thing.shades, level, *(goal.tobytes() for goal in goals)
                marks += self._made(
                    ("goal", thing.number),
                    key,
                    lambda: ways.goal_marks(thing, goals, layout, theme, level=level),  # noqa: B023 - called at once
                )
                if robot and request.plans and level == 0:
                    plans.append((thing, ways.path_ahead(thing, goals, simulation)))
        groups = ways.plan_groups(plans, layout)
        for (_, level), members in trails.items():
            crowded = crowd.people > MANY_PEOPLE
            groups += ways.trail_groups(members, simulation, layout, theme, level=level, crowded=crowded)
        return marks, groups, any_beads

    def _made(self, what: tuple[str, int], key: Any, make: Callable[[], list[Mark]]) -> list[Mark]:
        """Marks of an object that stay the same objects as long as the key does."""
        known = self._marks.get(what)
        if known is None or known[0] != key:
            known = self._marks[what] = key, make()
        return known[1]

    @staticmethod
    def _kept(mark: Mark) -> Mark:
        """A mark that the caller has added: contacts above bodies, the others in the layer of drawings of users."""
        layer = {"field": mark.zorder, "contact": _ADDED_Z}
        return replace(mark, zorder=layer.get(mark.part, USER_ZORDER))

    def _heading(
        self, scene: Scene, things: Sequence[Thing], crowd: Crowd, collided: int, layout: Layout, request: Request
    ) -> tuple[list[Mark], list[Label]]:
        if not request.head:
            return [], []
        self.word = word = heading.outcome_word(self.simulation, self.world, collided)
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


def _notes(crowd: Crowd, dropped: int) -> list[str]:
    notes = []
    if crowd.level == 1:
        notes.append("with more than 12 robots names are short, as r13 for robot_13, and plans are left out")
    if crowd.level == 2:
        notes.append("with more than 50 robots names, goals, plans and scans are left out")
    if dropped:
        notes.append(f"{dropped} names have no room")
    return notes
