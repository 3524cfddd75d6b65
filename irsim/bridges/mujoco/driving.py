"""From the controls of irsim to the actuators of a model, with latency, slip and noise."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from irsim.bridges.mujoco.robots import PUSHED, Rig
from irsim.bridges.state import Motion
from irsim.common.arrays import Floats
from irsim.components.bridges.mujoco import Mujoco

__all__ = ["Driver", "speeds_of", "steering_of"]

_STANDING = 1e-6
"""Speed below which the steering angle does not follow from the yaw rate [m/s]."""
_SOON = 1e-9
"""Commands that are due within this time are executed [s]."""


def speeds_of(rig: Rig, control: Sequence[float], yaw_rate: float) -> list[float]:
    """Targets of the actuators that are speeds: wheels left and right [rad/s], or velocity in the body frame.

    Args:
        rig: The robot.
        control: Its control, in the words of its drive.
        yaw_rate: Yaw rate that follows from it [rad/s].
    """
    if rig.drive == "omni":
        return [control[0], control[1]]
    if rig.drive == "omni_angular":
        return [control[0], control[1], control[2]]
    rate = control[1] if rig.drive == "diff" else yaw_rate
    turn = rate * rig.half_track
    return [(control[0] - turn) / rig.wheel_radius, (control[0] + turn) / rig.wheel_radius]


def steering_of(rig: Rig, angle: float) -> tuple[float, float]:
    """Angles of the left and the right steered wheel [rad] for a steering angle between them (Ackermann)."""
    curve = math.tan(angle) / rig.wheelbase  # signed curvature of the path of the middle of the rear axle

    def wheel(y: float) -> float:
        return math.atan2(rig.wheelbase * curve, 1 - y * curve)

    return wheel(rig.half_track), wheel(-rig.half_track)


@dataclass
class Driver:
    """Commands on their way to the motors.

    Attributes:
        names: Names of the robots.
        rows: (K,) their rows in states.
        rigs: Their dimensions.
        options: Latency, slip and noise.
        random: Where slip and noise are drawn from.
    """

    names: tuple[str, ...]
    rows: tuple[int, ...]
    rigs: tuple[Rig, ...]
    options: Mujoco
    random: np.random.Generator
    _waiting: deque[tuple[float, Floats]] = field(default_factory=deque)
    _present: Floats | None = None
    _angles: dict[int, float] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of targets of all robots."""
        return sum(len(self.targets_at(k)) for k in range(len(self.rigs)))

    def targets_at(self, robot: int) -> tuple[str, ...]:
        """Suffixes of the names of the actuators of a robot, in the order of its targets."""
        return {
            "diff": ("left", "right"),
            "omni": ("x", "y"),
            "omni_angular": ("x", "y", "yaw"),
            PUSHED: (),
            "acker": ("left", "right", "steer_left", "steer_right"),
        }[self.rigs[robot].drive]

    def command(self, motion: Motion) -> None:
        """Send the controls of a step; they arrive after the latency."""
        targets: list[float] = []
        for robot, (row, rig) in enumerate(zip(self.rows, self.rigs, strict=True)):
            control, rate = motion.control[row].tolist(), float(motion.twist[row, 2])
            if rig.drive == PUSHED:
                continue
            speeds = np.array(speeds_of(rig, control, rate))
            drawn = self.random.random(len(speeds)), self.random.standard_normal(len(speeds))
            speeds *= (1 - self.options.slip * drawn[0]) * (1 + self.options.command_noise * drawn[1])
            targets += speeds.tolist()
            if rig.drive == "acker":
                if abs(control[0]) > _STANDING:
                    self._angles[robot] = math.atan(rig.wheelbase * rate / control[0])
                targets += steering_of(rig, self._angles.get(robot, 0.0))
        self._waiting.append((motion.time + self.options.latency, np.array(targets)))

    def targets(self, time: float) -> Floats:
        """Targets at a time [s], from the last command that has arrived; zero before the first one."""
        while self._waiting and self._waiting[0][0] <= time + _SOON:
            self._present = self._waiting.popleft()[1]
        return np.zeros(self.count) if self._present is None else self._present

    def forget(self) -> None:
        """Stop all robots and forget commands that have not arrived yet."""
        self._waiting.clear()
        self._present = None
        self._angles.clear()
