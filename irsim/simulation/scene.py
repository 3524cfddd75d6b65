"""Contents of a world that do not change during an episode, as plain data without types of the engine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.outline import BodyPart
from irsim.options.registry import KINEMATICS

__all__ = ["SCENE_VERSION", "Gauge", "Grid", "Lidar", "Look", "SceneDescription", "SceneObject"]

SCENE_VERSION = 1
"""Version of the files of scenes and states."""


@dataclass(frozen=True)
class Lidar:
    """A planar lidar.

    Attributes:
        key: ``<object>/<number>``, the key of its ranges.
        number: Number among the lidars of its carrier.
        mount: x, y [m], yaw [rad] on the carrier, body frame.
        angle_min, angle_max: Directions of the first and the last beam, frame of the sensor [rad].
        beams: Number of beams.
        range_min, range_max: Shortest and longest range [m].
        period: Duration of a full turn, which is reported as the time of a scan [s].
        noise_std: Standard deviation of the ranges [m]; 0 without noise.
        between: Angle between neighboring beams [rad].
        beam_time: Time between neighboring beams [s]; 0 if all are measured at once, at the end of a step.
        rate: Measurements per second [Hz]; 0: one in each step.
        latency: Time from a measurement until its data arrive [s].
    """

    key: str
    number: int
    mount: tuple[float, float, float]
    angle_min: float
    angle_max: float
    beams: int
    range_min: float
    range_max: float
    period: float
    noise_std: float = 0.0
    between: float = 0.0
    beam_time: float = 0.0
    rate: float = 0.0
    latency: float = 0.0

    @property
    def lag(self) -> float:
        """Time from the first beam of a scan to the last one [s], which is measured at the end of a step."""
        return self.beam_time * (self.beams - 1)

    @property
    def angles(self) -> Floats:
        """(beams,) directions of the beams, frame of the sensor [rad]."""
        return np.linspace(self.angle_min, self.angle_max, self.beams)


@dataclass(frozen=True)
class Gauge:
    """A sensor that reports numbers.

    Attributes:
        key: ``<object>/<sensor>``, the key of its readings.
        name: Its name in scenarios, such as ``imu``.
        number: Number among the sensors of this name of its carrier.
        mount: x, y [m], yaw [rad] on the carrier, body frame.
        units: Name and unit of each number of a row.
        settings: Its options, as JSON types.
    """

    key: str
    name: str
    number: int
    mount: tuple[float, float, float]
    units: Mapping[str, str]
    settings: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Look:
    """How an object is drawn.

    Attributes:
        color: Red, green, blue, from 0 to 1.
        alpha: Opacity, from 0 to 1.
        goal: Whether its goal is drawn.
        arrow: Whether an arrow shows where it points.
        kind: ``robot``, ``person``, ``thing`` (it moves, but is neither) or ``still``.
        motion: Whether the mark in its body points where it moves; else it is its heading.
    """

    color: tuple[float, float, float]
    alpha: float = 1.0
    goal: bool = False
    arrow: bool = False
    kind: Literal["robot", "person", "thing", "still"] = "still"
    motion: bool = False


@dataclass(frozen=True)
class SceneObject:
    """A robot or an obstacle.

    Attributes:
        index: Place in the scene, which is its row in states.
        name: Its name.
        role: ``robot`` or ``obstacle``.
        drive: Name of its drive, of irsim or of a plug-in; None without one.
        moves: Whether it can move.
        pose: x, y [m], yaw [rad] at the start, world frame.
        goals: Its goals x, y [m], yaw [rad], world frame.
        parts: Its footprint, body frame; a map has no parts.
        radius: Radius of the circle around its center that encloses the footprint [m].
        low, high: Limits of its controls, in the words of the drive.
        acceleration: Limits of the change of its controls [1/s]; infinite without.
        wheelbase: [m], of a drive that steers wheels; None for other drives.
        mass: [kg]; infinite for an object that nothing pushes.
        color: Red, green, blue, from 0 to 1.
        lidars: Its sensors with beams.
        solid: Whether it collides; false for ``unobstructed`` objects.
        row: Its row in a trace, which counts the map, too.
        static: Whether it never moves.
        threshold: Distance within which it has arrived at a goal [m].
        look: How it is drawn; None for objects of other programs.
        gauges: Its sensors that report numbers.
    """

    index: int
    name: str
    role: Literal["robot", "obstacle"]
    drive: str | None
    moves: bool
    pose: tuple[float, float, float]
    goals: tuple[tuple[float, float, float], ...]
    parts: tuple[BodyPart, ...]
    radius: float
    low: tuple[float, ...]
    high: tuple[float, ...]
    acceleration: tuple[float, ...]
    wheelbase: float | None
    mass: float
    color: tuple[float, float, float]
    lidars: tuple[Lidar, ...] = ()
    solid: bool = True
    row: int = -1
    static: bool = False
    threshold: float = 0.0
    look: Look | None = None
    gauges: tuple[Gauge, ...] = ()

    @property
    def steered(self) -> bool:
        """Whether its drive steers wheels, as cars do."""
        feature = KINEMATICS.get(self.drive or "")
        return feature is not None and bool(getattr(feature.options, "steered", False))


@dataclass(frozen=True)
class Grid:
    """The map of a world.

    Attributes:
        occupied: (nx, ny) cells that are solid; the first index goes along x, the second one along y, upwards.
        cell: Sides of a cell along x and y [m].
        origin: Lower left corner [m], world frame.
        levels: (nx, ny) occupancies from 0 to 100, -1 where unknown; None in scenes of other programs.
    """

    occupied: NDArray[np.bool_]
    cell: tuple[float, float]
    origin: tuple[float, float]
    levels: NDArray[np.int8] | None = None

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """(nx, ny) cells of which the map does not say whether they are solid, and that count as neither."""
        return np.zeros(self.occupied.shape, dtype=bool) if self.levels is None else self.levels < 0

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top [m], world frame."""
        (x, y), (nx, ny), (dx, dy) = self.origin, self.occupied.shape, self.cell
        return x, x + nx * dx, y, y + ny * dy


@dataclass(frozen=True)
class SceneDescription:
    """The scene at the start of an episode.

    Attributes:
        name: Name of the scenario.
        step_time: Period [s].
        low, high: Corners of the world [m].
        agents: All objects but the map, in the order of states.
        grid: The map; None without one.
        walls: Whether walls surround the world.
        seed: Seed of the episode.
        about: Further facts: text of the scenario, versions.
        version: Version of this description.
        maps: The map as an object of traces; it has no parts.
    """

    name: str
    step_time: float
    low: tuple[float, float]
    high: tuple[float, float]
    agents: tuple[SceneObject, ...]
    grid: Grid | None = None
    walls: bool = False
    seed: int = 0
    about: Mapping[str, str] = field(default_factory=dict)
    version: int = SCENE_VERSION
    maps: tuple[SceneObject, ...] = ()

    @property
    def objects(self) -> tuple[SceneObject, ...]:
        """All objects in the order of their rows in a trace, the map included."""
        return tuple(sorted((*self.agents, *self.maps), key=lambda one: one.row))

    def agent(self, name: str) -> SceneObject:
        """The agent of that name.

        Raises:
            KeyError: No object has it.
        """
        for agent in self.agents:
            if agent.name == name:
                return agent
        raise KeyError(name)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the agents, in order."""
        return tuple(agent.name for agent in self.agents)

    @property
    def robots(self) -> tuple[SceneObject, ...]:
        """The agents that are robots."""
        return tuple(agent for agent in self.agents if agent.role == "robot")
