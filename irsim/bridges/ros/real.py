"""Real robots: where they are in the scene, how old their odometry is, and what they are commanded."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from irsim.bridges.base import BridgeLostError
from irsim.bridges.ros.guard import ZERO, Velocity
from irsim.bridges.ros.incoming import Odometry
from irsim.bridges.ros.outgoing import body_velocity
from irsim.bridges.state import Motion
from irsim.common.angles import wrap
from irsim.components.bridges._ros import RosOptions
from irsim.simulation.scene import SceneObject

__all__ = ["Pose", "RealRobots", "composed", "inverted"]

Pose = tuple[float, float, float]
"""x, y [m], yaw [rad]."""


def composed(first: Sequence[float], second: Sequence[float]) -> Pose:
    """The pose ``second``, given in the frame ``first``, in the frame of ``first``'s parent."""
    cosine, sine = math.cos(first[2]), math.sin(first[2])
    x, y = first[0] + cosine * second[0] - sine * second[1], first[1] + sine * second[0] + cosine * second[1]
    return x, y, float(wrap(first[2] + second[2]))


def inverted(pose: Sequence[float]) -> Pose:
    """The frame's parent in the frame itself."""
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    return -cosine * pose[0] - sine * pose[1], sine * pose[0] - cosine * pose[1], -pose[2]


@dataclass
class _Robot:
    agent: SceneObject
    origin: Pose | None
    odometry: Odometry | None = None
    when: float = -math.inf
    scans: dict[str, float] = field(default_factory=dict)
    stops: int = 0


@dataclass
class RealRobots:
    """The robots that a bridge drives.

    Attributes:
        options: Options of the bridge.
        step_time: Period of the scene [s].
    """

    options: RosOptions
    step_time: float
    _robots: dict[str, _Robot] = field(default_factory=dict)

    def add(self, agents: Iterable[SceneObject]) -> None:
        """Add robots."""
        origin = (0.0, 0.0, 0.0) if self.options.odom_origin == "world" else None
        for agent in agents:
            self._robots[agent.name] = _Robot(agent, origin)

    @property
    def missing(self) -> list[str]:
        """Names of the robots whose odometry has not come yet."""
        return [name for name, robot in self._robots.items() if robot.odometry is None]

    def take(self, name: str, odometry: Odometry, when: float) -> None:
        """Keep the newest odometry of a robot, which arrived at a time [s]."""
        robot = self._robots[name]
        if robot.origin is None:
            robot.origin = composed(robot.agent.pose, inverted(odometry.pose))
        robot.odometry, robot.when = odometry, when

    def take_scan(self, name: str, lidar: str, when: float) -> None:
        """Note that a lidar of a robot has measured; from now on it must go on to do so."""
        self._robots[name].scans[lidar] = when

    def relocate(self, name: str, pose: Pose) -> None:
        """Move the frame of the odometry so that the robot is at a pose of the scene."""
        robot = self._robots[name]
        if robot.odometry is not None:
            robot.origin = composed(pose, inverted(robot.odometry.pose))

    def poses(self) -> dict[str, Pose]:
        """Where the robots are in the scene."""
        return {
            name: composed(robot.origin, robot.odometry.pose)
            for name, robot in self._robots.items()
            if robot.origin is not None and robot.odometry is not None
        }

    def twists(self, now: float) -> dict[str, Pose]:
        """Their velocities [m/s, m/s, rad/s] in the world frame; zero for robots that are stopped."""
        result = {}
        for name, pose in self.poses().items():
            robot = self._robots[name]
            assert robot.odometry is not None
            forward, left, rate = ZERO if self._is_old(robot, now) else robot.odometry.velocity
            cosine, sine = math.cos(pose[2]), math.sin(pose[2])
            result[name] = (cosine * forward - sine * left, sine * forward + cosine * left, rate)
        return result

    def commands(self, motion: Motion, now: float) -> dict[str, Velocity]:
        """Commands to the robots in a step: their wanted ones, or zero while their odometry or scans are old.

        Raises:
            BridgeLostError: No odometry has come for so long that the robot counts as lost.
        """
        result = {}
        for name, robot in self._robots.items():
            age = now - robot.when
            if age > self.options.lost_timeout:
                what = f"no odometry of '{name}' for {age:.1f} s"
                raise BridgeLostError(what, "see whether the robot runs, then run the scenario again")
            if self._is_old(robot, now):
                robot.stops += 1
                result[name] = ZERO
                continue
            row = robot.agent.index
            start = float(motion.pose[row, 2] - motion.twist[row, 2] * self.step_time)
            result[name] = body_velocity(motion.twist[row], start)
        return result

    def notes(self) -> list[str]:
        """How often robots had to stop because their odometry was old."""
        return [
            f"'{name}' got zero commands in {robot.stops} steps because its odometry or a scan was older than "
            f"{self.options.odom_timeout:g} s"
            for name, robot in self._robots.items()
            if robot.stops
        ]

    def _is_old(self, robot: _Robot, now: float) -> bool:
        return now - min([robot.when, *robot.scans.values()]) > self.options.odom_timeout
