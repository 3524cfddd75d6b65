"""``openscenario``: trajectories as an OpenSCENARIO 1.0 file, for esmini and CARLA's ScenarioRunner.

Each object is an entity that is put at its first pose and follows its recorded trajectory in time. Cars (drives that
steer, such as ``acker``) are vehicles, other objects that can move are pedestrians, the rest are obstacles. The frame
is irsim's, x forward, y to the left, heading counterclockwise, moved by the options `x`, `y` and `yaw`. Options
`roads`, `pedestrian` and `car` name the road network and the models.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.sax.saxutils import XMLGenerator
from xml.sax.xmlreader import AttributesImpl

import numpy as np

from irsim.bridges.export.episode import Actor, ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.recorded import recorded_scene
from irsim.bridges.solids import box_of
from irsim.common.arrays import Floats
from irsim.common.installed import version
from irsim.common.text import decimal
from irsim.options.base import Options
from irsim.options.units import Degrees, Meters
from irsim.runs.files import RunError
from irsim.simulation.scene import SceneObject

__all__ = ["FORMAT"]

MAX_VERTICES = 2_000_000
"""Number of poses of a file, about 150 bytes each."""
_PERSON, _CAR, _THING = 1.8, 1.5, 1.0
"""Heights of bodies [m], which a scenario has none of."""
_NOT_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_FOREVER = 1e10
"""Limit of the speed and acceleration of vehicles without one."""


class OpenScenarioOptions(Options):
    """Where the trajectories are in the world of the roads, and what the bodies are there."""

    x: Meters = 0.0
    """x of the origin of the scenario."""
    y: Meters = 0.0
    """y of the origin, to the left of x; CARLA's y has the other sign."""
    yaw: Degrees = 0.0
    """Direction of the x axis of the scenario, counterclockwise; CARLA's yaw has the other sign."""
    roads: str = ""
    """OpenDRIVE file, or for ScenarioRunner the town, such as Town03; empty leaves it out."""
    pedestrian: str = "walker.pedestrian.0001"
    """Model of pedestrians; for CARLA a blueprint."""
    car: str = "vehicle.tesla.model3"
    """Name of vehicles; for CARLA a blueprint."""


class _Writer:
    """Writes indented elements, whose attributes are escaped."""

    def __init__(self, file: Any) -> None:
        self._xml, self._depth = XMLGenerator(file, "utf-8", short_empty_elements=True), 0
        self._xml.startDocument()

    @contextmanager
    def element(self, tag: str, /, **attributes: object) -> Iterator[None]:
        """An element with others inside."""
        self._xml.ignorableWhitespace("  " * self._depth)
        self._xml.startElement(tag, _attributes(attributes))
        self._xml.ignorableWhitespace("\n")
        self._depth += 1
        yield
        self._depth -= 1
        self._xml.ignorableWhitespace("  " * self._depth)
        self._xml.endElement(tag)
        self._xml.ignorableWhitespace("\n")

    def leaf(self, tag: str, /, **attributes: object) -> None:
        """An element without others inside."""
        self._xml.ignorableWhitespace("  " * self._depth)
        self._xml.startElement(tag, _attributes(attributes))
        self._xml.endElement(tag)
        self._xml.ignorableWhitespace("\n")


def _attributes(values: dict[str, object]) -> AttributesImpl[str]:
    return AttributesImpl({key: _text(value) for key, value in values.items()})


def _text(value: object) -> str:
    if isinstance(value, float):
        return decimal(value, 6) if abs(value) < 1e9 else f"{value:g}"
    return _NOT_XML.sub("\ufffd", str(value))


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write one run."""
    (episode,) = episodes
    vertices = (episode.last_step + 1) * len(episode.actors)
    if vertices > MAX_VERTICES:
        what = f"a file of OpenSCENARIO holds up to {MAX_VERTICES:,} poses, and this run has {vertices:,}"
        raise RunError("bad-argument", what, "name fewer objects with --objects, or record a shorter run")
    scene = recorded_scene(episode.run, episode.limits)
    options = episode.options or OpenScenarioOptions()
    assert isinstance(options, OpenScenarioOptions)
    bodies = tuple(actor for actor in episode.actors if actor.name in scene.names)  # without the map
    maps = len(episode.actors) - len(bodies)
    episode = replace(episode, actors=bodies)
    times, poses = _trajectories(episode)
    poses = _moved(poses, options)
    present = [np.isfinite(poses[:, column]).all(axis=1) for column in range(len(episode.actors))]
    shown = [column for column, rows in enumerate(present) if rows.any()]
    with open(target, "w", encoding="utf-8", newline="\n") as file:
        writer = _Writer(file)
        with writer.element("OpenSCENARIO"):
            _header(writer, episode, options.roads)
            with writer.element("Entities"):
                for column in shown:
                    _entity(writer, episode.actors[column], scene.agent(episode.actors[column].name), options)
            with writer.element("Storyboard"):
                with writer.element("Init"), writer.element("Actions"):
                    for column in shown:
                        _start(writer, episode.actors[column].name, poses[present[column], column][0])
                moving = [column for column in shown if present[column].sum() > 1 and episode.actors[column].can_move]
                _story(writer, episode, moving, times, poses, present)
                with writer.element("StopTrigger"):
                    _after(writer, "end of the run", float(times[-1]))
    notes = ["the map was left out: OpenSCENARIO has no grids"] if maps else []
    return notes + _notes(episode, shown, present, options)


def _notes(episode: ExportedEpisode, shown: list[int], present: list[Any], options: OpenScenarioOptions) -> list[str]:
    notes = [] if options.roads else ["no roads are named: give the option roads, a file of OpenDRIVE or a town"]
    absent = [actor.name for column, actor in enumerate(episode.actors) if column not in shown]
    late = [episode.actors[column].name for column in shown if not present[column].all()]
    if absent:
        notes.append(f"never in the world, so left out: {', '.join(absent[:5])}")
    if late:
        notes.append(f"not in the world all the time, so standing where they appear before: {', '.join(late[:5])}")
    return notes


def _trajectories(episode: ExportedEpisode) -> tuple[Floats, Floats]:
    """(T,) times [s] and (T, M, 3) poses whose headings do not jump at half a turn."""
    times, poses = [], []
    for block in episode.blocks(scans=False):
        times.append(block.trace.time)
        poses.append(block.trace.pose)
    pose = np.concatenate(poses)
    known = np.nan_to_num(pose[:, :, 2])
    pose[:, :, 2] += np.unwrap(known, axis=0) - known
    return np.concatenate(times), pose


def _moved(poses: Floats, options: OpenScenarioOptions) -> Floats:
    """(..., 3) poses in the world of the roads."""
    yaw = math.radians(options.yaw)
    x, y, heading = np.moveaxis(poses, -1, 0)
    cosine, sine = math.cos(yaw), math.sin(yaw)
    moved = (options.x + cosine * x - sine * y, options.y + sine * x + cosine * y, heading + yaw)
    return np.stack(moved, axis=-1)


def _header(writer: _Writer, episode: ExportedEpisode, roads: str) -> None:
    created = str(episode.run.meta.get("created") or "2000-01-01T00:00:00")[:19]
    about = f"run {episode.run.id} of irsim {version()}, seed {episode.run.meta['seed']}"
    writer.leaf("FileHeader", revMajor=1, revMinor=0, date=created, description=about, author="irsim")
    writer.leaf("CatalogLocations")
    with writer.element("RoadNetwork"):
        if roads:
            writer.leaf("LogicFile", filepath=roads)


def _entity(writer: _Writer, actor: Actor, agent: SceneObject, options: OpenScenarioOptions) -> None:
    """An object with its box."""
    with writer.element("ScenarioObject", name=actor.name):
        if agent.steered:
            with writer.element("Vehicle", name=options.car, vehicleCategory="car"):
                _box(writer, agent, _CAR)
                speed = agent.high[0] if agent.high and np.isfinite(agent.high[0]) else _FOREVER
                change = agent.acceleration[0] if agent.acceleration else _FOREVER
                change = change if np.isfinite(change) else _FOREVER
                writer.leaf("Performance", maxSpeed=float(speed), maxAcceleration=change, maxDeceleration=change)
                base, track = agent.wheelbase or 1.0, 0.8 * box_of(agent).width
                with writer.element("Axles"):
                    for name, x, steering in (("FrontAxle", base, 0.7), ("RearAxle", 0.0, 0.0)):
                        wheels = {"wheelDiameter": 0.6, "trackWidth": track, "positionZ": 0.3}
                        writer.leaf(name, maxSteering=steering, positionX=float(x), **wheels)
                _properties(writer, actor)
        elif actor.can_move:
            facts = {"name": actor.name, "model": options.pedestrian, "pedestrianCategory": "pedestrian"}
            with writer.element("Pedestrian", mass=75.0, **facts):
                _box(writer, agent, _PERSON)
                _properties(writer, actor)
        else:
            mass = agent.mass if np.isfinite(agent.mass) else 1000.0
            with writer.element("MiscObject", mass=float(mass), miscObjectCategory="obstacle", name=actor.name):
                _box(writer, agent, _THING)
                _properties(writer, actor)


def _box(writer: _Writer, agent: SceneObject, height: float) -> None:
    box = box_of(agent)
    with writer.element("BoundingBox"):
        writer.leaf("Center", x=box.ahead, y=box.left, z=height / 2)
        writer.leaf("Dimensions", width=box.width, length=box.length, height=height)


def _properties(writer: _Writer, actor: Actor) -> None:
    with writer.element("Properties"):
        writer.leaf("Property", name="irsim:role", value=actor.role)


def _position(writer: _Writer, pose: Floats) -> None:
    x, y, heading = (float(value) for value in pose)
    with writer.element("Position"):
        writer.leaf("WorldPosition", x=x, y=y, z=0.0, h=heading, p=0.0, r=0.0)


def _start(writer: _Writer, name: str, pose: Floats) -> None:
    with writer.element("Private", entityRef=name), writer.element("PrivateAction"), writer.element("TeleportAction"):
        _position(writer, pose)


def _after(writer: _Writer, name: str, time: float) -> None:
    """A condition that holds after a time [s]."""
    with (
        writer.element("ConditionGroup"),
        writer.element("Condition", name=name, delay=0.0, conditionEdge="none"),
        writer.element("ByValueCondition"),
    ):
        writer.leaf("SimulationTimeCondition", value=time, rule="greaterThan")


def _story(
    writer: _Writer, episode: ExportedEpisode, moving: list[int], times: Floats, poses: Floats, present: list[Any]
) -> None:  # fmt: skip
    """One act, in which each object follows its trajectory; without any that moves, one without actions."""
    with writer.element("Story", name="run"), writer.element("Act", name="run"):
        for column in moving:
            rows = present[column]
            _maneuver(writer, episode.actors[column].name, times[rows], poses[rows, column])
        if not moving:
            with writer.element("ManeuverGroup", name="nothing moves", maximumExecutionCount=1):
                writer.leaf("Actors", selectTriggeringEntities="false")
        with writer.element("StartTrigger"):
            _after(writer, "start of the run", -1.0)


def _maneuver(writer: _Writer, name: str, times: Floats, poses: Floats) -> None:
    with writer.element("ManeuverGroup", name=name, maximumExecutionCount=1):
        with writer.element("Actors", selectTriggeringEntities="false"):
            writer.leaf("EntityRef", entityRef=name)
        with writer.element("Maneuver", name=name), writer.element("Event", name=name, priority="overwrite"):
            with (
                writer.element("Action", name=name),
                writer.element("PrivateAction"),
                writer.element("RoutingAction"),
                writer.element("FollowTrajectoryAction"),
            ):
                with (
                    writer.element("Trajectory", name=name, closed="false"),
                    writer.element("Shape"),
                    writer.element("Polyline"),
                ):
                    for time, pose in zip(times.tolist(), poses, strict=True):
                        with writer.element("Vertex", time=time):
                            _position(writer, pose)
                with writer.element("TimeReference"):
                    writer.leaf("Timing", domainAbsoluteRelative="absolute", scale=1.0, offset=0.0)
                writer.leaf("TrajectoryFollowingMode", followingMode="position")
            with writer.element("StartTrigger"):
                _after(writer, f"start of {name}", -1.0)


FORMAT = Format("openscenario", ".xosc", _write, ranges=False, options=OpenScenarioOptions)
