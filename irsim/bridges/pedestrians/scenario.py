"""Tracks of pedestrians as the text of a scenario that replays them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.tracks import Track
from irsim.common.arrays import Floats
from irsim.scenario.limits import DEFAULT_LIMITS

__all__ = ["Layout", "scenario_text"]

Place: TypeAlias = tuple[float, float]
_ROBOT_SPEED = 1.2
"""Top speed of the robot [m/s]."""
_PATIENCE = 2.5
"""Factor on the time that the robot would need alone."""
_ROBOT_RADIUS = 0.3
_FIRST, _ROOM = 2.0, 0.5
"""For how long from the start nobody comes closer to where the robot starts than this [s, m]."""
_EVENTS_PER_ROW = 6
"""Events of YAML of one row: a time, two numbers and the brackets around them."""


@dataclass(frozen=True)
class Layout:
    """What a scenario has besides pedestrians.

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
    middle, reach = float(low[1] + high[1]) / 2, float(high[1] - low[1]) / 2 - _ROBOT_RADIUS
    heights = middle + reach * np.array(sorted(np.linspace(-1, 1, 81), key=abs))
    if not len(people) or reach <= 0:
        return x, middle
    room = np.array([np.hypot(people[:, 0] - x, people[:, 1] - y).min() for y in heights])
    clear = np.flatnonzero(room >= layout.radius + _ROBOT_RADIUS + _ROOM)
    return x, float(heights[clear[0] if len(clear) else int(room.argmax())])


def scenario_text(tracks: Sequence[Track], layout: Layout) -> str:
    """The scenario as YAML.

    Args:
        tracks: The pedestrians, at least one.
        layout: What else there is.

    Raises:
        BridgeError: The scenario would be larger than scenarios may be.
    """
    rows = sum(len(track.times) for track in tracks)
    if rows * _EVENTS_PER_ROW > DEFAULT_LIMITS.events or len(tracks) > DEFAULT_LIMITS.objects:
        what = f"{len(tracks)} pedestrians with {rows} rows are more than a scenario may hold"
        raise BridgeError("bridge-file", what, "choose a window of time or space: --from, --to, --crop")
    everything = np.concatenate([track.places for track in tracks])
    given = [point for point in (layout.start, layout.goal) if point is not None]
    corners = np.concatenate([everything, np.array(given).reshape(-1, 2)])
    low = np.floor((corners.min(axis=0) - layout.margin) * 100) / 100
    high = np.ceil((corners.max(axis=0) + layout.margin) * 100) / 100
    duration = max(float(track.times[-1]) for track in tracks)
    size = high - low
    ends = _ends(tracks, layout, low, high)
    limit = max(duration, layout.step_time, _time_of_robot(ends) if layout.robot else 0.0)
    lines = [
        f"# {len(tracks)} recorded pedestrians of {json.dumps(layout.source)}, replayed at their times. The recording",
        f"# ends after {duration:g} s. Written by `irsim bridge import-pedestrians`.",
        "",
        "world:",
        f"  width: {_number(size[0])}  # m",
        f"  height: {_number(size[1])}  # m",
        f"  offset: [{_number(low[0])}, {_number(low[1])}]  # m",
        f"  step_time: {layout.step_time!r}  # s",
        f"  time_limit: {_number(limit)}  # s",
        "",
    ]
    if layout.robot:
        lines += _robot(layout, *ends)
    lines += [
        "obstacle:",
        f"  - number: {len(tracks)}",
        "    tags: [pedestrian]",
        f"    name: [{', '.join(track.name for track in tracks)}]",
        "    kinematics: {name: omni_angular}",
        f"    shape: {{name: circle, radius: {layout.radius!r}}}  # m",
        "    color: '#56B4E9'",
        "    behavior:  # times [s] and places [m]",
        *(_behavior(track, layout) for track in tracks),
        "",
    ]
    text = "\n".join(lines)
    if len(text) > DEFAULT_LIMITS.bytes:
        what = f"the scenario would have {len(text) / 1e6:.0f} MB, more than scenarios may have"
        raise BridgeError("bridge-file", what, "choose a window of time or space: --from, --to, --crop")
    return text


def _ends(tracks: Sequence[Track], layout: Layout, low: Floats, high: Floats) -> tuple[Place, Place]:
    """Start and goal of the robot, by default at the left and right edge."""
    inset = min(layout.margin / 2, float(high[0] - low[0]) / 4)
    start = layout.start or _start(tracks, layout, low, high, float(low[0]) + inset)
    return start, layout.goal or (float(high[0]) - inset, float(low[1] + high[1]) / 2)


def _time_of_robot(ends: tuple[Place, Place]) -> float:
    """Time that the robot needs with room for giving way, in whole seconds."""
    return math.ceil(_PATIENCE * math.dist(*ends) / _ROBOT_SPEED)


def _robot(layout: Layout, start: Place, goal: Place) -> list[str]:
    heading = float(np.arctan2(goal[1] - start[1], goal[0] - start[0]))
    return [
        "robot:",
        "  - name: robot",
        "    kinematics: {name: diff}",
        "    shape: {name: circle, radius: 0.3}",
        f"    state: [{_number(start[0])}, {_number(start[1])}, {_number(heading)}]",
        f"    goal: [{_number(goal[0])}, {_number(goal[1])}]",
        "    goal_threshold: 0.3",
        f"    vel_max: [{_ROBOT_SPEED}, 2.0]  # m/s, rad/s",
        "    vel_min: [-0.3, -2.0]",
        f"    behavior: {{name: {json.dumps(layout.behavior)}}}",
        "    color: '#0072B2'",
        "",
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


def _number(value: float) -> str:
    return _exact(round(float(value), 4))
