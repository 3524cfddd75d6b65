"""Tracks of pedestrians as the text of a scenario that replays them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.tracks import Track
from irsim.common.arrays import Floats
from irsim.common.text import decimal
from irsim.scenario.limits import DEFAULT_LIMITS

__all__ = [
    "ROBOT_RADIUS",
    "Layout",
    "bounds",
    "check_size",
    "checked",
    "crossing_time",
    "default_robot",
    "number",
    "people_lines",
    "robot_lines",
    "scenario_text",
    "world_lines",
]

_ROBOT_SPEED = 1.2
"""Top speed of the robot [m/s]."""
_PATIENCE = 2.5
"""Factor on the time that the robot would need alone."""
ROBOT_RADIUS = 0.3
"""[m]."""
_FIRST, _ROOM = 2.0, 0.5
"""For how long from the start no pedestrian comes closer to where the robot starts than this [s, m]."""
_EVENTS_PER_ROW = 6
"""Events of YAML of one row: a time, two numbers and the brackets around them."""
_FIX = "choose a window of time or space: --start, --end, --crop"


@dataclass(frozen=True)
class Layout:
    """The parts of a scenario besides its pedestrians.

    Attributes:
        source: Name of the file, for the comment at the top.
        step_time: [s].
        radius: Of a pedestrian [m].
        margin: Width of the free border around all that is recorded [m].
        interpolation: ``linear`` or ``cubic``.
        start, goal: Of the robot [m]; None to cross the middle from left to right.
        behavior: Of the robot.
        robot: Whether there is one.
    """

    source: str
    step_time: float = 0.1
    radius: float = 0.25
    margin: float = 1.0
    interpolation: str = "linear"
    start: tuple[float, float] | None = None
    goal: tuple[float, float] | None = None
    behavior: str = "orca"
    robot: bool = True


def default_robot(low: Floats, high: Floats, margin: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Start and goal at the left and right edge of an area."""
    middle = float(low[1] + high[1]) / 2
    inset = min(margin / 2, float(high[0] - low[0]) / 4)
    return (float(low[0]) + inset, middle), (float(high[0]) - inset, middle)


def _start(tracks: Sequence[Track], layout: Layout, low: Floats, high: Floats, x: float) -> tuple[float, float]:
    """The place at that x that is nearest to the middle and keeps clear of those who are there first.

    Where no place does, it is the one with most room.
    """
    near = []
    for track in tracks:
        times = np.arange(0.0, _FIRST + 0.05, 0.1)
        times = times[(times >= track.times[0]) & (times <= track.times[-1])]
        near.append(np.column_stack([np.interp(times, track.times, track.places[:, axis]) for axis in (0, 1)]))
    people = np.concatenate(near)
    middle, reach = float(low[1] + high[1]) / 2, float(high[1] - low[1]) / 2 - ROBOT_RADIUS
    heights = middle + reach * np.array(sorted(np.linspace(-1, 1, 81), key=abs))
    if not len(people) or reach <= 0:
        return x, middle
    room = np.array([np.hypot(people[:, 0] - x, people[:, 1] - y).min() for y in heights])
    clear = np.flatnonzero(room >= layout.radius + ROBOT_RADIUS + _ROOM)
    return x, float(heights[clear[0] if len(clear) else int(room.argmax())])


def scenario_text(tracks: Sequence[Track], layout: Layout) -> str:
    """The scenario as YAML.

    Args:
        tracks: The pedestrians, at least one.
        layout: The rest of the scenario.

    Raises:
        BridgeError: The scenario would be larger than scenarios may be.
    """
    check_size(tracks)
    low, high = bounds(tracks, layout)
    start, goal = default_robot(low, high, layout.margin)
    start, goal = layout.start or _start(tracks, layout, low, high, start[0]), layout.goal or goal
    duration = max(float(track.times[-1]) for track in tracks)
    patience = crossing_time(start, goal) if layout.robot else 0.0
    heading = float(np.arctan2(goal[1] - start[1], goal[0] - start[0]))
    ways = [
        f"state: [{number(start[0])}, {number(start[1])}, {number(heading)}]",
        f"goal: [{number(goal[0])}, {number(goal[1])}]",
    ]
    lines = [
        f"# {len(tracks)} recorded pedestrians of {json.dumps(layout.source)}, replayed at their times. The recording",
        f"# ends after {duration:g} s. Written by `irsim bridge import-pedestrians`.",
        "",
        *world_lines(low, high, layout),
        f"  time_limit: {number(max(duration, layout.step_time, patience))}  # s",
        "",
        *([*robot_lines(ways, layout.behavior), ""] if layout.robot else []),
        *people_lines(tracks, layout),
        "",
    ]
    return checked("\n".join(lines))


def check_size(tracks: Sequence[Track]) -> None:
    """Refuse more pedestrians than a file may hold.

    Raises:
        BridgeError: There are too many pedestrians, or too many rows.
    """
    rows = sum(len(track.times) for track in tracks)
    if rows * _EVENTS_PER_ROW > DEFAULT_LIMITS.events or len(tracks) > DEFAULT_LIMITS.objects:
        what = f"{len(tracks)} pedestrians with {rows} rows are more than a file may hold"
        raise BridgeError("bridge-file", what, _FIX)


def checked(text: str) -> str:
    """A text, unless it is longer than a scenario may be.

    Raises:
        BridgeError: It is.
    """
    if len(text) > DEFAULT_LIMITS.bytes:
        raise BridgeError("bridge-file", f"the file would have {len(text) / 1e6:.0f} MB, more than it may have", _FIX)
    return text


def bounds(tracks: Sequence[Track], layout: Layout) -> tuple[Floats, Floats]:
    """(2,) lower left and upper right corner of the world [m]."""
    ends = [point for point in (layout.start, layout.goal) if point is not None]
    corners = np.concatenate([*(track.places for track in tracks), np.array(ends).reshape(-1, 2)])
    low = np.floor((corners.min(axis=0) - layout.margin) * 100) / 100
    high = np.ceil((corners.max(axis=0) + layout.margin) * 100) / 100
    return low, high


def crossing_time(start: Sequence[float], goal: Sequence[float]) -> int:
    """Time that the robot needs from one place to another, with room for giving way, in whole seconds."""
    return math.ceil(_PATIENCE * math.dist(start, goal) / _ROBOT_SPEED)


def world_lines(low: Floats, high: Floats, layout: Layout) -> list[str]:
    """The key ``world`` without its time limit."""
    return [
        "world:",
        f"  width: {number(high[0] - low[0])}  # m",
        f"  height: {number(high[1] - low[1])}  # m",
        f"  offset: [{number(low[0])}, {number(low[1])}]  # m",
        f"  step_time: {layout.step_time!r}  # s",
    ]


def robot_lines(ways: Sequence[str], behavior: str) -> list[str]:
    """The key ``robot``.

    Args:
        ways: Keys of its start and goal.
        behavior: Its behavior.
    """
    return [
        "robot:",
        "  - name: robot",
        "    kinematics: {name: diff}",
        f"    shape: {{name: circle, radius: {ROBOT_RADIUS}}}",
        *(f"    {line}" for line in ways),
        "    goal_threshold: 0.3",
        f"    vel_max: [{_ROBOT_SPEED}, 2.0]  # m/s, rad/s",
        "    vel_min: [-0.3, -2.0]",
        f"    behavior: {{name: {json.dumps(behavior)}}}",
        "    color: '#0072B2'",
    ]


def people_lines(tracks: Sequence[Track], layout: Layout) -> list[str]:
    """The key ``obstacle``: the pedestrians."""
    return [
        "obstacle:",
        f"  - number: {len(tracks)}",
        "    tags: [pedestrian]",
        f"    name: [{', '.join(track.name for track in tracks)}]",
        "    kinematics: {name: omni_angular}",
        f"    shape: {{name: circle, radius: {layout.radius!r}}}  # m",
        "    color: '#56B4E9'",
        "    behavior:  # times [s] and places [m]",
        *(_behavior(track, layout) for track in tracks),
    ]


def _behavior(track: Track, layout: Layout) -> str:
    times = ", ".join(_exact(time) for time in track.times.round(12).tolist())
    poses = ", ".join(f"[{_exact(x)}, {_exact(y)}]" for x, y in track.places.tolist())
    curve = "" if layout.interpolation == "linear" else f", interpolation: {layout.interpolation}"
    return f"      - {{name: replay{curve}, times: [{times}], poses: [{poses}]}}"


def _exact(value: float) -> str:
    """The number, as it reads back exactly; with a dot before an exponent, as YAML 1.1 wants it."""
    if value == int(value) and abs(value) < 1e15:
        return str(int(value))
    text = repr(value)
    return text if "e" not in text or "." in text else text.replace("e", ".0e")


def number(value: float) -> str:
    """The number with at most four digits behind the point."""
    return decimal(value, 4)
