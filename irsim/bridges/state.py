"""The data that crosses a bridge in a step: the state of the world, the wanted motion, and the feedback."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.simulation.trace import present_readings, sensors

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Feedback", "Motion", "WorldState", "world_state"]


@dataclass(frozen=True)
class WorldState:
    """All objects after a step, in the order of :attr:`irsim.simulation.scene.SceneDescription.agents`.

    Attributes:
        step: Number of executed steps.
        time: Simulated time [s].
        pose: (N, 3) x, y [m], yaw [rad], world frame; NaN of an object that is not in the world (yet).
        twist: (N, 3) velocity vx, vy [m/s], yaw rate [rad/s], world frame.
        control: (N, 3) executed controls in the words of the drive, zero padded.
        goal: (N, 3) present goal; NaN without one.
        arrived, collided, stopped: (N,) flags.
        ranges: Key of a lidar -> (beams,) ranges [m], infinite for a beam that hit nothing.
        readings: Key of a sensor that reports numbers -> these by name: a row of :attr:`Trace.readings`.
        stamps: Key of a lidar or such a sensor -> when it has measured what it shows [s]; NaN: nothing yet.
        paths: Name of a robot -> (K, 2 or 3) the path that it follows, world frame: the one that it has planned, or, if
            its behavior plans none, from where it is through its goals. Only of robots that have one.
    """

    step: int
    time: float
    pose: Floats
    twist: Floats
    control: Floats
    goal: Floats
    arrived: NDArray[np.bool_]
    collided: NDArray[np.bool_]
    stopped: NDArray[np.bool_]
    ranges: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    paths: Mapping[str, Floats] = field(default_factory=dict)
    readings: Mapping[str, Any] = field(default_factory=dict)
    stamps: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Motion:
    """The middle of a step: what is wanted of the objects, and where irsim would have them at its end.

    Attributes:
        step: Number of steps executed before this one.
        time: Simulated time at the start of the step [s].
        control: (N, 3) controls within the limits, in the words of the drive, zero padded.
        pose: (N, 3) poses at the end of the step as irsim moves them, world frame.
        twist: (N, 3) velocities vx, vy [m/s], yaw rate [rad/s] that lead there, world frame.
    """

    step: int
    time: float
    control: Floats
    pose: Floats
    twist: Floats


@dataclass(frozen=True)
class Feedback:
    """Input from outside; all keys but lidar keys are names of objects.

    Attributes:
        poses: x, y [m], yaw [rad] of objects that the other program moves, world frame.
        twists: Their velocities vx, vy [m/s], yaw rate [rad/s], world frame; default: from the change of the pose.
        commands: Commands to robots that irsim moves: forward, leftward speed [m/s], yaw rate [rad/s], body frame.
        goals: New goals x, y [m], yaw [rad], world frame.
        starts: Poses to which robots are set back (RViz: 2D Pose Estimate), world frame.
        ranges: Key of a lidar -> (beams,) ranges [m] measured by the other program.
        end: Why the episode is to end, or None.
    """

    poses: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    twists: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    commands: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    goals: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    starts: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    ranges: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    end: str | None = None


def world_state(simulation: Simulation, rows: NDArray[np.int64]) -> WorldState:
    """The present state of the first world.

    Args:
        simulation: The simulation.
        rows: (N,) what :func:`agent_rows` returns.
    """
    measured = np.where(simulation.valid.astype(bool), simulation.ranges, np.inf).astype(np.float32)
    records = simulation.scenario.objects
    paths = {records[row].name: _path(simulation, row) for row in rows.tolist() if records[row].role == "robot"}
    readings, beams = present_readings(simulation), sensors(simulation)
    keys = [*(key for key, _ in beams), *readings]
    return WorldState(
        step=int(simulation.count[0]),
        time=simulation.time,
        pose=simulation.pose[rows].copy(),
        twist=simulation.twist[rows].copy(),
        control=simulation.control[rows].copy(),
        goal=simulation.goal[rows].copy(),
        arrived=simulation.arrived[rows].astype(bool),
        collided=simulation.collided[rows].astype(bool),
        stopped=simulation.stopped[rows].astype(bool),
        ranges={key: measured[own] for key, own in beams},
        paths={name: path for name, path in paths.items() if path is not None},
        readings={key: row[0] for key, row in readings.items()},
        stamps=dict(zip(keys, simulation.state.stamp[0].tolist(), strict=True)),
    )


def _path(simulation: Simulation, row: int) -> Floats | None:
    """(K, 2) the planned path of a robot; of one whose behavior plans none, from where it is through its goals."""
    state, behavior = simulation.state, simulation.scenario.objects[row].active_behavior
    route = state.route(row)
    if route is not None:
        return route
    if hasattr(behavior, "planner") or not getattr(behavior, "needs_goal", True):
        return None
    points = np.array([simulation.pose[row, :2].tolist(), *(goal[:2] for goal in state.goals(row))])
    return points if len(points) > 1 and np.isfinite(points).all() else None
