"""A recorded run as ROS 2 messages, which formats write to their files."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.export.episode import Block, Episode, Lidar
from irsim.bridges.ros.markers import body_markers
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import nanoseconds, ros_names
from irsim.common.arrays import Floats
from irsim.objects.describe import describe_scene
from irsim.runs.resimulation import initial_scene
from irsim.simulation.events import BETWEEN_STEPS, Event
from irsim.simulation.scene import SceneDescription
from irsim.simulation.trace import Trace

__all__ = ["Bag", "occupancy_grid", "write_run"]

_MAX_ASPECT_ERROR = 1e-6
"""Share by which the sides of a cell may differ for it to count as square."""
_WORLD = "world"
_INFO, _WARN = 20, 30
"""Severities of ``rcl_interfaces/Log``."""
Topic: TypeAlias = tuple[Any, str]
Flags: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True)
class _Layout:
    """Topics and frames of a run; actors and lidars in their order, None for obstacles.

    Attributes:
        frames: Frame of each actor.
        laser_frames: Frame of each lidar.
        clock, tf, log, obstacles, odometry, goals, scans: The topics.
    """

    frames: list[str]
    laser_frames: list[str]
    clock: Topic
    tf: Topic
    log: Topic
    obstacles: Topic | None
    odometry: list[Topic | None]
    goals: list[Topic | None]
    scans: list[Topic]


class Bag(Protocol):
    """A file of messages."""

    def topic(self, name: str, kind: str, *, latched: bool = False, **about: str) -> Topic:
        """Add a topic of messages of a type, and say what :meth:`add` takes."""

    def add(self, topic: Topic, stamp: int, message: Any) -> None:
        """Add a message at a simulated time [ns]."""

    def describe(self, facts: dict[str, str], files: dict[str, bytes]) -> None:
        """Add facts and files."""


def write_run(episode: Episode, bag: Bag, messages: Messages) -> list[str]:
    """Write the messages of a run in the order of their stamps; returns notes on what was left out."""
    notes = []
    facts = episode.facts
    text = facts.pop("scenario_text")
    plain = {key: value if isinstance(value, str) else json.dumps(value) for key, value in facts.items()}
    bag.describe(plain, {"scenario.yaml": text.encode()})
    layout = _layout(bag, episode)
    if not _add_scene(bag, messages, episode, layout):
        notes.append("the map was left out: its cells are not square")
    _add_mounts(bag, messages, episode, layout)
    events = deque(episode.run.events)
    goal: Floats | None = None
    for block in episode.blocks():
        changed = _goal_changes(block.trace.goal, goal)
        goal = block.trace.goal[-1:].copy()
        _add_block(bag, messages, layout, episode.lidars, block, changed, events)
    if episode.lidars and episode.last_scan < episode.last_step:
        notes.append(f"scans end at step {episode.last_scan} of {episode.last_step}, as they do in the record")
    return notes


def _layout(bag: Bag, episode: Episode) -> _Layout:
    """Add the topics."""
    actors = episode.actors
    names = ros_names(actor.name for actor in actors)
    obstacles = [actor.name for actor in actors if actor.role == "obstacle"]

    def robots(topic: str, kind: str) -> list[Topic | None]:
        pairs = zip(names, actors, strict=True)
        return [bag.topic(f"/{name}/{topic}", kind) if actor.role == "robot" else None for name, actor in pairs]

    shown = bag.topic("/obstacles", "geometry_msgs/msg/PoseArray", names=json.dumps(obstacles)) if obstacles else None
    owners = [names[lidar.actor] for lidar in episode.lidars]
    ends = [f"_{lidar.number}" if lidar.number else "" for lidar in episode.lidars]
    mounted = list(zip(owners, ends, strict=True))
    return _Layout(
        frames=[f"{name}/base_link" for name in names],
        laser_frames=[f"{owner}/laser{end}" for owner, end in mounted],
        clock=bag.topic("/clock", "rosgraph_msgs/msg/Clock"),
        tf=bag.topic("/tf", "tf2_msgs/msg/TFMessage"),
        log=bag.topic("/rosout", "rcl_interfaces/msg/Log"),
        obstacles=shown,
        odometry=robots("odom", "nav_msgs/msg/Odometry"),
        goals=robots("goal", "geometry_msgs/msg/PoseStamped"),
        scans=[bag.topic(f"/{owner}/scan{end}", "sensor_msgs/msg/LaserScan") for owner, end in mounted],
    )


def _add_scene(bag: Bag, messages: Messages, episode: Episode, layout: _Layout) -> bool:
    """Add bodies and map; whether the map, if there is one, could be added."""
    follows = {actor.name: frame for actor, frame in zip(episode.actors, layout.frames, strict=True)}
    with initial_scene(episode.run, episode.limits) as env:
        scene = describe_scene(env.simulation)
    markers = body_markers(messages, scene, follows, _WORLD, united=True)
    grid = occupancy_grid(messages, scene, _WORLD)
    bag.add(bag.topic("/markers", "visualization_msgs/msg/MarkerArray", latched=True), 0, markers)
    if grid is not None:
        bag.add(bag.topic("/map", "nav_msgs/msg/OccupancyGrid", latched=True), 0, grid)
    return grid is not None or scene.grid is None


def _add_mounts(bag: Bag, messages: Messages, episode: Episode, layout: _Layout) -> None:
    """Add where the lidars are on their robots."""
    mounts = [
        messages.transform(0, layout.frames[lidar.actor], frame, [float(value) for value in lidar.options["offset"]])
        for lidar, frame in zip(episode.lidars, layout.laser_frames, strict=True)
    ]
    if mounts:
        topic = bag.topic("/tf_static", "tf2_msgs/msg/TFMessage", latched=True)
        bag.add(topic, 0, messages("tf2_msgs", "TFMessage")(mounts))


def _add_block(
    bag: Bag,
    messages: Messages,
    layout: _Layout,
    lidars: Sequence[Lidar],
    block: Block,
    changed: Flags,
    events: deque[Event],
) -> None:
    """Add what happened in some steps, one step after the other; ``changed`` (T, M) says which goals are new."""
    trace = block.trace
    clock, transforms = messages("rosgraph_msgs", "Clock"), messages("tf2_msgs", "TFMessage")
    array = messages("geometry_msgs", "PoseArray")
    robots = [(number, topic) for number, topic in enumerate(layout.odometry) if topic is not None]
    others = [number for number, topic in enumerate(layout.odometry) if topic is None]
    states = zip(
        trace.step.tolist(), trace.time.tolist(), trace.pose.tolist(), block.body_velocity.tolist(), strict=True
    )
    for row, (step, time, poses, velocities) in enumerate(states):
        stamp = nanoseconds(time)
        bag.add(layout.clock, stamp, clock(messages.time(stamp)))
        moved = zip(layout.frames, poses, strict=True)
        bag.add(layout.tf, stamp, transforms([messages.transform(stamp, _WORLD, *placed) for placed in moved]))
        for number, topic in robots:
            frame = layout.frames[number]
            bag.add(topic, stamp, messages.odometry(stamp, _WORLD, frame, poses[number], velocities[number]))
        if layout.obstacles is not None:
            placed = [messages.pose(*poses[number]) for number in others]
            bag.add(layout.obstacles, stamp, array(messages.header(stamp, _WORLD), placed))
        for number in np.flatnonzero(changed[row]).tolist():
            _add_goal(bag, messages, layout.goals[number], stamp, trace.goal[row, number].tolist())
        _add_scans(bag, messages, layout, lidars, trace, row, stamp)
        while events and events[0].step <= step:
            bag.add(layout.log, stamp, _log(messages, stamp, events.popleft()))


def _add_scans(
    bag: Bag, messages: Messages, layout: _Layout, lidars: Sequence[Lidar], trace: Trace, row: int, stamp: int
) -> None:
    """Add the scans of one step, as far as scans were recorded."""
    for lidar, topic, frame in zip(lidars, layout.scans, layout.laser_frames, strict=True):
        ranges = trace.ranges[lidar.key]
        if row < len(ranges):
            duration = float(lidar.options["scan_time"])
            bag.add(topic, stamp, messages.scan(stamp, frame, lidar.angles, lidar.limits, duration, ranges[row]))


def _goal_changes(goal: Floats, previous: Floats | None) -> Flags:
    """(T, M) whether a goal is another one than in the row before; True in the first row of a run."""
    before = np.concatenate([np.full_like(goal[:1], np.inf) if previous is None else previous, goal[:-1]])
    same = (goal == before) | (np.isnan(goal) & np.isnan(before))
    return np.asarray(~same.all(axis=2))


def _add_goal(bag: Bag, messages: Messages, topic: Topic | None, stamp: int, goal: list[float]) -> None:
    """Add a goal, if the object is a robot and has one."""
    x, y, heading = goal
    if topic is not None and x == x:
        pose = messages.pose(x, y, heading if heading == heading else 0.0)
        bag.add(topic, stamp, messages("geometry_msgs", "PoseStamped")(messages.header(stamp, _WORLD), pose))


def _log(messages: Messages, stamp: int, event: Event) -> Any:
    """An event as a log message."""
    partner = "" if event.partner is None else f" with {event.partner}"
    zone = "" if event.zone is None else f" of {event.zone}"
    way = "" if event.direction is None else f" {event.direction.replace('_', ' ')}"
    text = f"{event.kind}{partner}{zone}{way} at x {event.x:.3f} y {event.y:.3f}"
    level = _WARN if event.kind in ("collision", "no_path", *BETWEEN_STEPS) else _INFO
    return messages("rcl_interfaces", "Log")(messages.time(stamp), level, event.object, text, "", "", 0)


def occupancy_grid(messages: Messages, scene: SceneDescription, world: str) -> Any | None:
    """The map as a ``nav_msgs/OccupancyGrid``; None without a map, or if its cells are not square."""
    if scene.grid is None or scene.grid.levels is None:
        return None
    side, other = scene.grid.cell
    if abs(other / side - 1) > _MAX_ASPECT_ERROR:
        return None
    return messages.grid(0, world, side, scene.grid.origin, scene.grid.levels.astype(np.int8))
