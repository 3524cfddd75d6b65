"""Layouts, families and seeds of the bench of avoidance, fixed before anything was measured.

A *case* is a layout: where robots start, which way they look, where they want to go, and which walls are there. Its
start 0 is exact, with all its symmetries; starts 1, 2, … move every robot by up to 0.2 m in x and in y, drawn from a
generator of its own, so that every behavior, drive, step and spelling of a wall gets the same starts. Random scenes
are drawn anew for each start instead. The scenarios use keys of IR-SIM 2.12 only, and this module needs only the
standard library: the worker imports it into the other simulator's interpreter, too.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

__all__ = [
    "BEHAVIORS", "CASES", "DRIVES", "PEER_BEHAVIORS", "RADIUS_M", "THRESHOLD_M", "Case", "Group", "Layout", "Robot",
    "Wall", "groups", "layout", "scenario",
]  # fmt: skip

BEHAVIORS = ("rvo", "sfm", "orca", "avocado", "footprint_orca")
PEER_BEHAVIORS = BEHAVIORS[:3]
"""Behaviors that ir-sim 2.12 has as well."""
DRIVES = ("diff", "omni")
STEPS_S = (0.1, 0.2, 0.05)
"""Lengths of a step; the first is the one with all starts."""
RADIUS_M = 0.2
THRESHOLD_M = 0.2
"""Radius of every robot, and distance from its goal at which it has arrived."""
JITTER_M = 0.2
"""Largest shift of a start in x and in y, and so of every robot alone."""
SIZE_M = 20.0
"""Width and height of the world; (10, 10) is its middle."""
CELL_M = 0.05
"""Size of a cell of the maps; all walls have corners on this grid."""

Point = tuple[float, float]


@dataclass(frozen=True)
class Robot:
    """A robot: start, heading [rad], goal, top speed [m/s]."""

    start: Point
    heading: float
    goal: Point
    speed: float = 1.0


@dataclass(frozen=True)
class Wall:
    """A solid outline: corners about its place, counterclockwise, and the rectangles that it consists of.

    Attributes:
        place: Where its origin is [m].
        corners: Outline about the origin [m].
        parts: (x, y, length, width) of rectangles about the origin that cover it [m].
    """

    place: Point
    corners: tuple[Point, ...]
    parts: tuple[tuple[float, float, float, float], ...]

    def outline(self) -> list[Point]:
        """Corners in the world."""
        return [(self.place[0] + x, self.place[1] + y) for x, y in self.corners]


@dataclass(frozen=True)
class Layout:
    """Robots and walls of a case at one start."""

    robots: tuple[Robot, ...]
    walls: tuple[Wall, ...] = ()


@dataclass(frozen=True)
class Case:
    """A layout and how often it is run.

    Attributes:
        family: Family that it belongs to.
        name: Name within the family.
        build: Makes the exact layout; random scenes get the number of the start.
        limit_s: Time limit [s].
        jittered: Number of jittered starts at the first length of a step; 3 and 5 at the shorter and the longer step.
        spellings: How its walls are written; all starts of the first, some of the others.
        loop: Whether robots go back and forth until the time limit, and have to get across at least once.
        drawn: Whether each start is a scene of its own.
        ring: Radius of the circle on which the robots start; its exact start is written as a `circle` distribution.
    """

    family: str
    name: str
    build: Callable[[int], Layout]
    limit_s: float
    jittered: int = 50
    spellings: tuple[str, ...] = ("",)
    loop: bool = False
    drawn: bool = False
    ring: float = 0.0

    def starts(self, dt: float, spelling: str) -> range:
        """Numbers of the starts that are run at a length of a step: 0 is exact."""
        count = {0.1: self.jittered, 0.2: 5, 0.05: 3}[dt]
        if spelling != self.spellings[0]:
            count = 10 if dt == STEPS_S[0] else 0
        return range(min(count, self.jittered) + 1)


def _across(center: Point, reach: float, angle: float, speed: float = 1.0, beyond: float | None = None) -> Robot:
    """A robot that starts ``reach`` before a point and wants to get as far behind it, in the direction of an angle."""
    c, s = math.cos(angle), math.sin(angle)
    after = reach if beyond is None else beyond
    start, goal = (center[0] - reach * c, center[1] - reach * s), (center[0] + after * c, center[1] + after * s)
    return Robot(start, math.atan2(s, c), goal, speed)


def _circle(count: int, radius: float) -> Layout:
    """Robots on a circle that change places with those opposite: the poses of the `circle` distribution."""
    robots = []
    for k in range(count):
        a = math.tau * k / count
        x, y = radius * math.cos(a), radius * math.sin(a)
        robots.append(Robot((10 + x, 10 + y), math.atan2(-math.sin(a), -math.cos(a)), (10 - x, 10 - y)))
    return Layout(tuple(robots))


def _head_on(degrees: float) -> Layout:
    angle = math.radians(degrees)
    return Layout((_across((10, 10), 6, angle), _across((10, 10), 6, angle + math.pi)))


def _crossing(degrees: float) -> Layout:
    return Layout((_across((10, 10), 5, 0), _across((10, 10), 5, math.radians(degrees))))


def _streams() -> Layout:
    """Three robots in a file cross three others."""
    right = [_across((10 - 1.2 * k, 10), 5, 0) for k in range(3)]
    up = [_across((10, 10 - 1.2 * k), 5, math.pi / 2) for k in range(3)]
    return Layout((*right, *up))


def _overtaking(aside: float) -> Layout:
    """A robot catches up with one of 0.4 m/s whose goal is nearer, on the same line or a little beside it."""
    return Layout((Robot((3.0, 10.0), 0.0, (16.0, 10.0)), Robot((6.0, 10.0 + aside), 0.0, (11.0, 10.0 + aside), 0.4)))


def _rectangle(x: float, y: float, length: float, width: float) -> Wall:
    a, b = length / 2, width / 2
    return Wall((x, y), ((-a, -b), (a, -b), (a, b), (-a, b)), ((0.0, 0.0, length, width),))


def _door(gap: float, robots: tuple[Robot, ...]) -> Layout:
    """A wall of 0.2 m from side to side of the world with a gap at y = 10."""
    length = 8.0
    return Layout(robots, tuple(_rectangle(10, 10 + side * (gap + length) / 2, 0.2, length) for side in (1, -1)))


def _corridor(width: float, robots: tuple[Robot, ...], *more: Wall) -> Layout:
    """Two walls of 14 m."""
    walls = tuple(_rectangle(10, 10 + side * (width / 2 + 0.1), 14, 0.2) for side in (1, -1))
    return Layout(robots, (*walls, *more))


def _one(aside: float = 0.0, reach: float = 4.0) -> Robot:
    return Robot((10 - reach, 10 + aside), 0.0, (10 + reach, 10.0))


def _box(size: float) -> Layout:
    return Layout((_one(),), (_rectangle(10, 10.1, size, size),))


def _ell(size: float, opens: str) -> Layout:
    """Two arms that meet in a corner; the robot meets the flat side (``away``) or the pocket (``toward``)."""
    h, t = size / 2, 0.2 if size < 1 else 0.4
    corners = ((-h, -h), (h, -h), (h, -h + t), (-h + t, -h + t), (-h + t, h), (-h, h))
    parts = ((0.0, -h + t / 2, size, t), (-h + t / 2, t / 2, t, size - t))
    if opens == "toward":
        corners = tuple((-x, y) for x, y in reversed(corners))
        parts = tuple((-x, y, length, width) for x, y, length, width in parts)
    return Layout((_one(),), (Wall((10, 10.1), corners, parts),))


def _random(count: int, side: float, number: int) -> Layout:
    """Starts and goals in a square, starts 1 m and goals 0.8 m apart, each way at least half as long as the square."""
    draw = random.Random(f"random {count} {number}")
    low, starts, goals = 10 - side / 2, list[Point](), list[Point]()
    while len(starts) < count:
        start = (low + side * draw.random(), low + side * draw.random())
        goal = (low + side * draw.random(), low + side * draw.random())
        if math.dist(start, goal) < side / 2 or any(math.dist(start, other) < 1.0 for other in starts):
            continue
        if all(math.dist(goal, other) >= 0.8 for other in goals):
            starts.append(start)
            goals.append(goal)
    ways = [
        (start, math.atan2(goal[1] - start[1], goal[0] - start[0]), goal)
        for start, goal in zip(starts, goals, strict=True)
    ]
    return Layout(tuple(Robot(*way) for way in ways))


SIZES = (2, 3, 4, 5, 6, 8, 10, 16)
LINES, BOXES, ELLS = (
    ("polygon", "line"),
    ("polygon", "rectangle", "line", "map"),
    ("polygon", "compound", "line", "map"),
)


def _cases() -> Iterator[Case]:
    for degrees in (0, 30, 45, 90, 135):
        yield Case("head-on", f"{degrees}", lambda _, d=degrees: _head_on(d), 30)
    for degrees in (45, 90, 135):
        yield Case("crossing", f"{degrees}", lambda _, d=degrees: _crossing(d), 30)
    yield Case("crossing", "3x3", lambda _: _streams(), 30)
    for size in (0.5, 1.0, 2.0, 3.0):
        yield Case("box", f"{size}", lambda _, s=size: _box(s), 30, spellings=BOXES)
    for count in SIZES:
        yield Case("circle", f"{count}", lambda _, n=count: _circle(n, 6), 30, ring=6)
    for aside in (0.0, 0.15, 0.3):
        yield Case("overtaking", f"{aside}", lambda _, a=aside: _overtaking(a), 40)
    yield Case("doorway", "0.8 alone", lambda _: _door(0.8, (_one(0.3),)), 30, spellings=LINES)
    yield Case("doorway", "1.2 aside", lambda _: _door(1.2, (_one(2.0),)), 30, spellings=LINES)
    two = (_across((10, 10), 4, 0), _across((10, 10), 4, math.pi))
    yield Case("doorway", "2.0 two", lambda _: _door(2.0, two), 30, spellings=LINES)
    yield Case("corridor", "1.5 alone", lambda _: _corridor(1.5, (_one(0.0, 6),)), 30, spellings=LINES)
    yield Case("corridor", "2.0 two", lambda _: _corridor(2.0, two), 30, spellings=LINES)
    box = _rectangle(10, 10.1, 1, 1)
    yield Case("corridor", "3.0 box", lambda _: _corridor(3.0, (_one(0.0, 5),), box), 30, spellings=LINES)
    for size, opens in ((0.5, "away"), (1.0, "away"), (2.0, "away"), (3.0, "away"), (2.0, "toward")):
        yield Case("ell", f"{size} {opens}", lambda _, s=size, o=opens: _ell(s, o), 30, spellings=ELLS)
    yield Case("random", "10", lambda k: _random(10, 9, k), 30, drawn=True)
    for count in SIZES:
        yield Case("loop", f"{count}", lambda _, n=count: _circle(n, 4), 20, jittered=20, loop=True, ring=4)
    yield Case("random", "30", lambda k: _random(30, 15, k), 40, jittered=20, drawn=True)


CASES = tuple(_cases())


@dataclass(frozen=True)
class Group:
    """Starts that stand in one line of a reference: one behavior, drive and step, one case in one spelling."""

    behavior: str
    drive: str
    dt: float
    case: Case
    spelling: str

    @property
    def key(self) -> tuple[str, ...]:
        """Its first columns in a reference."""
        return (self.behavior, self.drive, f"{self.dt}", self.case.family, self.case.name, self.spelling)

    @property
    def starts(self) -> range:
        """Numbers of its starts."""
        return self.case.starts(self.dt, self.spelling)


def groups(behaviors: tuple[str, ...] = BEHAVIORS) -> list[Group]:
    """All groups of starts, in the order in which they are run."""
    return [
        Group(behavior, drive, dt, case, spelling)
        for case in CASES
        for dt in STEPS_S
        for spelling in case.spellings
        for behavior in behaviors
        for drive in DRIVES
    ]


def layout(case: Case, start: int) -> Layout:
    """The layout of one start."""
    exact = case.build(start)
    if start == 0 or case.drawn:
        return exact
    draw = random.Random(f"{case.family} {case.name} {start}")
    moved = []
    for robot in exact.robots:
        x, y = (value + draw.uniform(-JITTER_M, JITTER_M) for value in robot.start)
        moved.append(Robot((x, y), robot.heading, robot.goal, robot.speed))
    return Layout(tuple(moved), exact.walls)


def scenario(group: Group, start: int, picture: str = "") -> dict[str, Any]:
    """The scenario of one start, as both simulators read it.

    Args:
        group: Behavior, drive, step, case and spelling.
        start: Number of the start.
        picture: File with the map, for walls that are written as one.
    """
    case, scene = group.case, layout(group.case, start)
    world: dict[str, Any] = {"width": SIZE_M, "height": SIZE_M, "step_time": group.dt}
    count = len(scene.robots)
    top = 1.0  # rad/s of diff, and m/s sideways of omni
    robot: dict[str, Any] = {
        "number": count,
        "kinematics": {"name": group.drive},
        "shape": {"name": "circle", "radius": RADIUS_M},
        "vel_max": [[r.speed, top if group.drive == "diff" else r.speed] for r in scene.robots],
        "vel_min": [[-r.speed, -top if group.drive == "diff" else -r.speed] for r in scene.robots],
        "goal_threshold": THRESHOLD_M,
    }
    if case.ring and start == 0:
        robot["distribution"] = {"name": "circle", "radius": case.ring, "center": [10, 10]}
    else:
        robot["distribution"] = {"name": "manual"}
        robot["state"] = [[*r.start, r.heading] for r in scene.robots]
        robot["goal"] = [list(r.goal) for r in scene.robots]
    chosen = {"name": group.behavior, **({"loop": True} if case.loop else {})}
    robot["group_behavior" if group.behavior == "orca" else "behavior"] = chosen
    if group.spelling == "map":
        world["obstacle_map"] = picture
        return {"world": world, "robot": [robot]}
    obstacles = [{"shape": _spelled(wall, group.spelling), "state": [*wall.place, 0.0]} for wall in scene.walls]
    return {"world": world, "robot": [robot], **({"obstacle": obstacles} if obstacles else {})}


def _spelled(wall: Wall, spelling: str) -> dict[str, Any]:
    """The shape of a wall."""
    corners = [list(corner) for corner in wall.corners]
    rectangles = [
        {"name": "rectangle", "length": length, "width": width, "pose": [x, y, 0.0]}
        for x, y, length, width in wall.parts
    ]
    if spelling == "polygon":
        return {"name": "polygon", "vertices": corners}
    if spelling == "line":
        return {"name": "linestring", "vertices": [*corners, corners[0]]}
    if spelling == "rectangle":
        return {name: value for name, value in rectangles[0].items() if name != "pose"}
    return {"name": "compound", "parts": rectangles}
