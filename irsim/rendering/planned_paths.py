"""The ways robots would take to their goals: what a snapshot's overlay ``plan`` draws."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from irsim.graphics.scene.palette import Color
from irsim.graphics.scene.scene import Floats, Label, Line, Mark, Scene, Stroke
from irsim.metrics.geodesic import Geodesics, inscribed_radius
from irsim.objects.views import views
from irsim.rendering.clearance_map import FreeSpace

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.simulation.simulation import Simulation

__all__ = ["Planned", "draw_plans", "plans"]

_MOST = 40
"""Ways that are looked for."""
_SMALLEST = 0.01
_SLACK = 2e-3
_LOOKED_AT = 50
"""Points of a way that are nearly the tightest."""
_WIDTH, _ALPHA, _ZORDER = 1.4, 0.9, 2.5
_DASHES = (0, (5, 2.5))
_NO_WAY, _NO_WAY_DASHES = "#e03131", (0, (1, 2))
_GREY = "#333333"
_SIZE, _TEXT_ZORDER = 8.0, 10.0


@dataclass(frozen=True, eq=False)
class Planned:
    """The way of one robot over its goals.

    Attributes:
        robot: Its id.
        name: Its name.
        points: (K, 2) corners from where it is [m]; as far as there is a way.
        own: Its own behavior has planned the way to its present goal.
        own_points: How many corners that has.
        lost: The goal that it can't get to, None if it gets to all of them.
        margin: Least distance between its inner disc and what stands still, at points of the way [m].
        tightest: Where that is.
    """

    robot: int
    name: str
    points: Floats
    own: bool
    own_points: int
    lost: tuple[float, float] | None
    margin: float
    tightest: tuple[float, float]

    @property
    def length(self) -> float:
        """Of the way [m]."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())


def plans(simulation: Simulation, world: int = 0, routes: Mapping[int, Floats | None] | None = None) -> list[Planned]:
    """The way of each robot with a goal that has not arrived, from where it is; of so many robots at most.

    Args:
        simulation: Where they are.
        world: Which of its worlds.
        routes: What a robot's own behavior has planned, by its id; None for one that found no way.
    """
    left, geodesics = _MOST, Geodesics(simulation, world)
    known: dict[float, FreeSpace] = {}
    found: list[Planned] = []
    for view in views(simulation, world):
        if view.role != "robot" or view.goal is None or view.arrive or left <= 0:
            continue
        inner = max(inscribed_radius(simulation, view.row), _SMALLEST)
        if inner not in known:
            known[inner] = _space(simulation, world, inner)
        made = _plan(simulation, view, geodesics, known[inner], inner, routes or {})
        found.append(made)
        left -= len(_goals(view))
    return found


def _plan(
    simulation: Simulation,
    view: ObjectView,
    geodesics: Geodesics,
    space: FreeSpace,
    inner: float,
    routes: Mapping[int, Floats | None],
) -> Planned:
    outer = max(float(simulation.radius[view.row]), inner)
    points, lost, own = [view.state[:2, 0][None]], None, 0
    for number, goal in enumerate(_goals(view)):
        start = points[-1][-1]
        if number == 0 and view.id in routes:
            way, own = routes[view.id], 1
        else:
            way = _shortest(geodesics, space, start, goal, (outer, inner))
            if way is None:
                way = space.way(start, goal, inner, view.record.goal_threshold)
        if way is None:
            lost = float(goal[0]), float(goal[1])
            break
        own = len(way) if own == 1 and number == 0 else own
        points.append(np.asarray(way)[:, :2])
    line = np.concatenate(points if len(points) == 1 else points[1:])
    dense = _dense(line, space.half)
    rooms = space.at(dense)
    near = dense[np.flatnonzero(rooms <= rooms.min() + 2 * space.half)]
    places = [(float(x), float(y)) for x, y in near[:: max(1, len(near) // _LOOKED_AT)]]
    margin, place = min((space.exactly_at(place) - inner, place) for place in places)
    return Planned(view.id, view.name, line, view.id in routes, own, lost, max(0.0, margin), place)


def _shortest(
    geodesics: Geodesics, space: FreeSpace, start: Floats, goal: Floats, radii: tuple[float, float]
) -> Floats | None:
    """The shortest way of a disc of the first radius that there is one for; None where there is no room at the goal."""
    room = space.exactly_at((float(goal[0]), float(goal[1])))
    for radius in dict.fromkeys(radii):
        way = geodesics.way(start, goal, radius, coarse=True) if room > radius - _SLACK else None
        if way is not None:
            return np.concatenate([[start], way[1:-1], [goal]])  # its ends are the middles of cells
    return None


def draw_plans(scene: Scene, ways: Sequence[Planned]) -> None:
    """Add them to a scene: whole lines for what a robot has planned itself, dashes for ways that there are.

    Where there is no way, dots lead straight to the goal, which says so.

    Args:
        scene: What to add to.
        ways: What to add.
    """
    for way in ways:
        color = _color_of(scene, way.robot)
        own = way.own_points
        if own > 1:
            stroke = Stroke(color, _WIDTH)
            scene.marks.append(Mark(way.robot, "plan", Line(way.points[:own]), None, stroke, _ALPHA, _ZORDER))
        rest = way.points[max(own - 1, 0) :]
        if len(rest) > 1:
            stroke = Stroke(color, _WIDTH, style=_DASHES)
            scene.marks.append(Mark(way.robot, "plan", Line(rest), None, stroke, _ALPHA, _ZORDER))
        if way.lost is not None:
            line = np.array([way.points[-1], way.lost])
            stroke = Stroke(_NO_WAY, _WIDTH, style=_NO_WAY_DASHES)
            scene.marks.append(Mark(way.robot, "plan", Line(line), None, stroke, 1.0, _ZORDER))
            x, y = way.lost
            label = Label(way.robot, "plan", x, y, (x, y), "no way", _NO_WAY, _SIZE, 1.0, _TEXT_ZORDER)
            scene.labels.append(label)


def _color_of(scene: Scene, robot: int) -> Color:
    """What it is drawn in."""
    colors = [mark.fill for mark in scene.of(robot, "body")]
    colors += [picture.tint for picture in scene.pictures if picture.object == robot]
    return next((color for color in colors if color is not None), _GREY)


def _goals(view: ObjectView) -> list[Floats]:
    """(2,) the present goal and those after it."""
    goals = [np.asarray(goal)[:2, 0] for goal in view.goals]
    assert view.goal is not None
    here = np.asarray(view.goal)[:2, 0]
    at = next((i for i, goal in enumerate(goals) if np.array_equal(goal, here)), None)
    return [here] if at is None else goals[at:]


def _space(simulation: Simulation, world: int, radius: float) -> FreeSpace:
    """Room over the world and where robots and their goals are."""
    x0, y0, x1, y1 = simulation.scenario.world.bounds
    robots = [view for view in views(simulation, world) if view.role == "robot"]
    places = [view.state[:2, 0] for view in robots] + [
        goal for view in robots if view.goal is not None for goal in _goals(view)
    ]
    points = np.array([(x0, y0), (x1, y1), *places])
    (left, low), (right, top) = points.min(axis=0), points.max(axis=0)
    return FreeSpace(simulation, world, (float(left), float(low), float(right), float(top)), radius)


def _dense(line: Floats, step: float) -> Floats:
    """Points along a line, not farther apart than this [m]."""
    pieces = [line[:1]]
    for a, b in itertools.pairwise(line):
        count = max(1, int(np.hypot(*(b - a)) / step))
        pieces.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(pieces)
