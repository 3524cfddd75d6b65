"""Where objects have been and where they are going: trails that fade, beads of time, goals, waypoints, plans."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from irsim import _core as core
from irsim.common.arrays import Floats
from irsim.graphics.scene.bodies import place
from irsim.graphics.scene.glyphs import GOAL
from irsim.graphics.scene.groups import ranges_between
from irsim.graphics.scene.scene import NO_CIRCLE, Circle, Group, Look, Mark, Region, Spots, Stroke
from irsim.graphics.scene.theme import Theme, mix
from irsim.objects.drawing.object_marks import trajectory_points
from irsim.rendering.modern.bodies import dart
from irsim.rendering.modern.frame import stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Thing

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = [
    "bead_count",
    "bead_marks",
    "goal_marks",
    "path_ahead",
    "plan_groups",
    "remaining_goals",
    "trail_groups",
]

_PERSON_TRAIL_Z, _PLAN_Z, _TRAIL_Z, _BEAD_Z, GOAL_Z = 2.2, 2.3, 2.4, 2.45, 2.6
_AGES = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.5, 8.0, 10.0, 13.0, 17.0, 23.0, math.inf)
"""A trail has one tint between two of these ages [s]."""
_PERSON_AGES = (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
_TRAIL_FADE_S, _PERSON_FADE_S = 6.0, 1.2
_TRAIL_S = (math.inf, 10.0, 3.0)
"""How far back trails reach: with few robots, with some, with many [s]."""
_CROWDED_WIDTH = 0.8
"""Factor of the width of trails of more than a few robots."""
_PERSON_S = (3.0, 1.2)
"""How far back trails of people reach: of few, of many [s]."""
_BEAD_S = 5.0
MAX_BEADED = 6
"""Number of robots up to which their trails have beads."""
_BEAD, _BEAD_EDGE = 4.6, 1.1
_STEP = 1.5
"""Least distance between points of a trail [u]."""
_DASHES = (0, (3.6, 2.6))
_PLAN_ALPHA = 0.85
_WAYPOINT, _WAYPOINT_EDGE = 5.0, 1.3
_SAME_M, _SAME_SHARE = 1e-8, 1e-5
"""Coordinates of goals that differ by no more than this, or than this share, are the same."""


def trail_groups(
    things: Sequence[Thing], simulation: Simulation, layout: Layout, theme: Theme, *, level: int, crowded: bool
) -> list[Group]:
    """The ways that objects have come: opaque tints, which neither bead at joints nor blacken where they cross.

    Args:
        things: The objects; either all of them are robots, or no one is.
        simulation: The simulation.
        layout: The layout.
        theme: The colours.
        level: Of robots: 0 few, 1 some, 2 many.
        crowded: Whether there are many people.
    """
    if not things:
        return []
    period, robot = float(simulation.scenario.world.step_time), things[0].kind == "robot"
    longest = _TRAIL_S[level] if robot else _PERSON_S[crowded]
    widths, zorder = (layout.sizes.trail, _TRAIL_Z) if robot else ((2.0, 1.2), _PERSON_TRAIL_Z)
    offsets = [thing.body.middle[1] if thing.body.kind == "compound" else 0.0 for thing in things]
    ages = [-1 if math.isinf(age) else round(age / period) for age in (_AGES if robot else _PERSON_AGES)[::-1]]
    points, ranges = core.trails(
        simulation.state,
        [thing.view.row for thing in things],
        offsets,
        ages,
        -1 if math.isinf(longest) else round(longest / period),
        layout.metres(_STEP) if robot else 0.0,
    )
    edges = [thing.shades.edge for thing in things]
    tints = {edge: _tints(edge, theme.paper, robot, widths, robot and level > 0) for edge in dict.fromkeys(edges)}
    pieces = ranges.reshape(-1, 2)
    drawn = pieces[:, 1] > pieces[:, 0]
    every_look, every_number = list[Look](), list[int]()
    for thing, edge in zip(things, edges, strict=True):
        every_look += tints[edge]
        every_number += [thing.number] * len(tints[edge])
    chosen = drawn.tolist()
    looks = list(itertools.compress(every_look, chosen))
    numbers = list(itertools.compress(every_number, chosen))
    if not looks:
        return []
    radii = np.full(len(looks), NO_CIRCLE)
    return [Group("trajectory", zorder, False, numbers, points, pieces[drawn], radii, looks)]


@lru_cache(maxsize=512)
def _tints(color: str, paper: str, robot: bool, widths: tuple[float, float], crowded: bool) -> list[Look]:
    """Looks of the parts of a trail, the oldest first."""
    ages, fade = (_AGES, _TRAIL_FADE_S) if robot else (_PERSON_AGES, _PERSON_FADE_S)
    newest, oldest = widths
    tints = list[Look]()
    for young in ages[-2::-1]:
        rest = math.exp(-young / fade)
        share = 0.32 + 0.60 * rest if robot else 0.02 + 0.38 * rest
        width = (oldest + (newest - oldest) * rest) * (_CROWDED_WIDTH if crowded else 1.0)
        tints.append((None, stroke(mix(color, paper, share), width), 1.0))
    return tints


def bead_count(thing: Thing, simulation: Simulation) -> int:
    """Number of moments that are marked on the trail of an object."""
    every = round(_BEAD_S / float(simulation.scenario.world.step_time))
    return max(0, (simulation.state.recorded(thing.view.row) - 1) // every) if every else 0


def bead_marks(thing: Thing, count: int, simulation: Simulation, layout: Layout, theme: Theme) -> list[Mark]:
    """Moments on the trail of an object, one every 5 s."""
    every = round(_BEAD_S / float(simulation.scenario.world.step_time))
    states = simulation.state.trajectory(thing.view.row)[every - 1 :: every][:count]
    places = Spots(trajectory_points(thing.body, states), layout.metres(_BEAD / 2))
    return [Mark(thing.number, "bead", places, theme.paper, stroke(thing.shades.edge, _BEAD_EDGE), 1.0, _BEAD_Z)]


def remaining_goals(thing: Thing, simulation: Simulation) -> list[Floats]:
    """x, y, heading (which may be NaN) of the present goal and those after it, of an object that can drive there."""
    if not thing.moves or thing.state == "arrived" or simulation.appeared[thing.view.row] < 0:
        return []
    present = simulation.goal[thing.view.row][:3]
    if math.isnan(present[0]) or simulation.scenario.is_parked(thing.record):
        return []
    goals = simulation.state.goals(thing.view.row)
    if len(goals) == 1:
        return [np.array(present, dtype=np.float64)]
    x, y = present[:2].tolist()
    index = next((i for i, goal in enumerate(goals) if _is_close(goal[0], x) and _is_close(goal[1], y)), len(goals))
    later = [np.array([*goal[:3], math.nan][:3], dtype=np.float64) for goal in goals[index + 1 :]]
    return [np.array(present, dtype=np.float64), *later]


def _is_close(one: float, other: float) -> bool:
    return abs(one - other) <= _SAME_M + _SAME_SHARE * abs(other)


def path_ahead(thing: Thing, goals: list[Floats], simulation: Simulation) -> Floats:
    """Corners (K, 2) of the way to the goals: the route that the behavior has planned, else straight lines."""
    here, ends = thing.drawn_at[:2], np.array([goal[:2] for goal in goals])
    route = simulation.state.route(thing.view.row)
    if route is not None and len(route):
        x, y = (route[-1, :2] - ends[0]).tolist()
        if math.hypot(x, y) <= thing.record.goal_threshold:
            return np.concatenate([[here], _left_of(route[:, :2], here), ends[1:]])
    return np.concatenate([[here], ends])


def _left_of(route: Floats, here: tuple[float, float]) -> Floats:
    """The corners of a route that are still ahead of a place near it."""
    corners, (x, y) = route.tolist(), here
    nearest, least = 0, math.inf
    for number, ((x0, y0), (x1, y1)) in enumerate(itertools.pairwise(corners)):
        along, up = x1 - x0, y1 - y0
        share = ((x - x0) * along + (y - y0) * up) / max(along * along + up * up, 1e-12)
        share = min(1.0, max(0.0, share))
        away = math.hypot(x0 + share * along - x, y0 + share * up - y)
        if away < least:
            nearest, least = number, away
    return route if len(corners) < 2 else route[nearest + 1 :]


def plan_groups(paths: Sequence[tuple[Thing, Floats]], layout: Layout) -> list[Group]:
    """The ways ahead, dashed."""
    if not paths:
        return []
    looks: list[Look] = [
        (None, stroke(thing.shades.edge, layout.sizes.plan, _DASHES), _PLAN_ALPHA) for thing, _ in paths
    ]
    ranges = ranges_between(np.cumsum([0, *(len(path) for _, path in paths)]))
    points = np.concatenate([path for _, path in paths])
    numbers = [thing.number for thing, _ in paths]
    return [Group("plan", _PLAN_Z, False, numbers, points, ranges, np.full(len(paths), NO_CIRCLE), looks)]


def goal_marks(thing: Thing, goals: list[Floats], layout: Layout, theme: Theme, *, level: int) -> list[Mark]:
    """The last goal as a ring with a dot, or with a dart where the heading counts; waypoints before it as diamonds."""
    number = thing.number
    color = thing.shades.edge
    x, y, heading = (float(value) for value in goals[-1])
    if level:
        spot = Circle(x, y, layout.metres(GOAL["open"] / 2))
        return [Mark(number, "goal", spot, theme.paper, stroke(color, layout.sizes.goal[1]), 1.0, GOAL_Z)]
    radius = max(thing.half_width, layout.metres(layout.sizes.goal[0]))
    disc = Circle(x, y, radius)
    marks = [
        Mark(number, "goal", disc, color, Stroke(None), GOAL["fill"], GOAL_Z),
        Mark(number, "goal", disc, None, stroke(color, layout.sizes.goal[1]), 1.0, GOAL_Z),
    ]
    if not math.isnan(heading) and thing.record.heading_counts([x, y, heading]):
        sign = place(dart(GOAL["dart"] * radius), (x, y, heading))
        marks.append(Mark(number, "goal", sign, color, Stroke(None), 1.0, GOAL_Z))
    else:
        marks.append(Mark(number, "goal", Circle(x, y, GOAL["dot"] * radius), color, Stroke(None), 1.0, GOAL_Z))
    half = layout.metres(_WAYPOINT / 2)
    diamond = np.array([(0.0, -half), (half, 0.0), (0.0, half), (-half, 0.0)])
    edge = stroke(color, _WAYPOINT_EDGE)
    for stop in goals[:-1]:
        marks.append(Mark(number, "goal", Region([stop[:2] + diamond]), theme.paper, edge, 1.0, GOAL_Z))
    return marks
