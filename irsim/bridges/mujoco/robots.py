"""Robots in MuJoCo: wheels, casters, mass and heights by drive, and how controls become targets of their motors."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from xml.etree import ElementTree as ET

import numpy as np

from irsim.bridges.solids import numbers, part_points
from irsim.bridges.state import Motion
from irsim.common.arrays import Floats
from irsim.components.bridges.mujoco import Mujoco
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = [
    "DRIVES",
    "LIDAR_HEIGHT",
    "PLANAR",
    "PUSHED",
    "TURNING",
    "Driver",
    "Rig",
    "add_actuators",
    "add_robot",
    "can_move",
    "default_agents",
    "rig_of",
    "speeds_of",
    "steering_of",
]

DRIVES = ("diff", "omni", "omni_angular", "acker")
"""Drives that have a body in MuJoCo."""
PUSHED = "pushed"
"""In place of a drive: an object that only moves where others push it."""
PLANAR = ("omni", "omni_angular", PUSHED)
"""Drives of bodies that move along the axes of the world, without wheels."""
TURNING = ("omni_angular", PUSHED)
"""Drives of such bodies that also turn."""
LIDAR_HEIGHT = 0.2
"""Height of the plane of all lidars [m]: every footprint is between its clearance, which is below, and its top."""
_DEFAULT_MASS = 10.0
"""Mass of a robot whose scenario gives none [kg]."""
_LOWEST_TOP, _HIGHEST_TOP = 0.3, 1.6
"""Bounds of the height of robots [m]."""
_WHEEL_SHARE = 0.02
"""Share of the mass of a robot that each of its wheels has."""


@dataclass(frozen=True)
class Rig:
    """Dimensions of a robot that the scenario does not give, in proportion to its footprint.

    Attributes:
        drive: One of :data:`DRIVES`, or :data:`PUSHED`.
        mass: Mass with its wheels [kg].
        wheel_mass: Mass of each wheel [kg].
        wheel_radius: [m].
        half_track: Half of the distance between left and right wheels [m].
        front, back: Distance of the front and the rear caster from the axle [m], of ``diff``.
        wheelbase: Distance of the axles [m], of ``acker``.
        center: x, y of the center of mass [m], body frame.
        gyration: Radius of gyration about the vertical axis [m].
        clearance, top: Heights of the lower and the upper end of the footprint [m].
    """

    drive: str
    mass: float
    wheel_mass: float
    wheel_radius: float
    half_track: float
    front: float
    back: float
    wheelbase: float
    center: tuple[float, float]
    gyration: float
    clearance: float
    top: float


def default_agents(scene: SceneDescription) -> frozenset[str]:
    """Names of the robots that MuJoCo can move, and of the obstacles that can be pushed."""
    chosen = [a for a in scene.agents if (a.role == "robot" and a.moves) or not _has_drive(a)]
    return frozenset(agent.name for agent in chosen if can_move(agent))


def can_move(agent: SceneObject) -> bool:
    """Whether MuJoCo can move an object."""
    pushed = agent.solid and not agent.moves and math.isfinite(agent.mass)
    return bool(agent.parts) and (agent.drive in DRIVES if _has_drive(agent) else pushed)


def _has_drive(agent: SceneObject) -> bool:
    return agent.drive not in (None, "static")


def rig_of(agent: SceneObject, mass: float | None = None) -> Rig:
    """The rig of a robot.

    Args:
        agent: The robot, or an obstacle that can be pushed.
        mass: Mass of robots [kg]; None: as in the scenario.
    """
    points = part_points(agent.parts)
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    radius = agent.radius
    side = min(y1, -y0)
    half_track = 0.7 * side if side > 0.2 * radius else 0.5 * radius
    front, back = (0.7 * end if end > 0.2 * radius else 0.5 * radius for end in (x1, -x0))
    wheelbase = agent.wheelbase or 1.0
    wheel_radius = min(0.35, max(0.02, 0.3 * radius))
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    if agent.drive == "acker":
        center = min(max(x, 0.3 * wheelbase), 0.7 * wheelbase), _within(y, 0.5 * half_track)
    elif agent.drive == "diff":
        center = min(max(x, -0.3 * back), 0.3 * front), _within(y, 0.5 * half_track)
    else:
        center = x, y
    if mass is None or not _has_drive(agent):
        mass = agent.mass if math.isfinite(agent.mass) and agent.mass > 0 else _DEFAULT_MASS
    return Rig(
        drive=str(agent.drive) if _has_drive(agent) else PUSHED,
        mass=mass,
        wheel_mass=_WHEEL_SHARE * mass,
        wheel_radius=wheel_radius,
        half_track=half_track,
        front=front,
        back=back,
        wheelbase=wheelbase,
        center=center,
        gyration=max(1e-3, math.hypot(x1 - x0, y1 - y0) / math.sqrt(12)),
        clearance=min(0.1, 0.25 * radius),
        top=min(_HIGHEST_TOP, max(_LOWEST_TOP, radius)),
    )


def _within(value: float, bound: float) -> float:
    return min(max(value, -bound), bound)


_CASTER_GAP = 5e-4
"""Distance between casters and the ground [m], so that wheels carry the robot."""
_GRIP = 0.9
"""Share of the friction with the ground that motors use at most, so that wheels do not spin."""
_GRAVITY = 9.81
_SLIDING = 0.4
"""Coefficient of friction between the ground and what is pushed."""
_STEERING_RATE = 60.0
"""Natural frequency of the steering servos [rad/s]."""
_STEERING_SHARE = 1e-3
"""Inertia of a steered wheel about its vertical axis, as share of the mass of the robot times its wheelbase squared."""
_DARK = "0.15 0.15 0.15 1"


def add_robot(body: ET.Element, rig: Rig, pose: tuple[float, float, float], options: Mujoco) -> None:
    """Add joints, inertia, wheels and casters to the body of a robot, whose origin is on the ground.

    Args:
        body: The body.
        rig: Its dimensions.
        pose: x, y [m], yaw [rad] at the start, world frame.
        options: Physics.
    """
    name, away = body.get("name", ""), max(1.0, 6 * rig.gyration)
    ET.SubElement(body, "camera", name=f"{name}/camera", pos=numbers(-away, 0, rig.top + 0.7 * away), fovy="60",
                  xyaxes="0 -1 0 0.5 0 0.866")  # fmt: skip
    if rig.drive in PLANAR:
        _planar(body, rig, pose)
        return
    ET.SubElement(body, "freejoint", name=f"{name}/free")
    wheels = 2 if rig.drive == "diff" else 4
    _inertia(body, rig, rig.mass - wheels * rig.wheel_mass)
    for side, y in (("left", rig.half_track), ("right", -rig.half_track)):
        _wheel(body, f"{name}/{side}", 0.0, y, rig.wheel_radius, rig, options)
        if rig.drive == "acker":
            steer = ET.SubElement(body, "body", name=f"{name}/steer_{side}")
            steer.set("pos", numbers(rig.wheelbase, y, rig.wheel_radius))
            ET.SubElement(steer, "joint", name=f"{name}/steer_{side}", type="hinge", axis="0 0 1",
                          armature=numbers(_steering_inertia(rig)))  # fmt: skip
            ET.SubElement(steer, "inertial", pos="0 0 0", mass="1e-3", diaginertia="1e-6 1e-6 1e-6")
            _wheel(steer, f"{name}/front_{side}", 0.0, 0.0, 0.0, rig, options)
    if rig.drive == "diff":
        size = 0.3 * rig.wheel_radius
        for x in (rig.front, -rig.back):
            ET.SubElement(body, "geom", {"class": "caster", "pos": numbers(x, 0, size + _CASTER_GAP),
                                         "size": numbers(size)})  # fmt: skip


def add_actuators(actuators: ET.Element, name: str, rig: Rig, options: Mujoco) -> None:
    """Add what drives a robot: velocities of wheels or of planar joints, angles of steered wheels."""
    grip = _GRIP * options.friction * rig.mass * _GRAVITY
    if rig.drive == PUSHED:
        return
    if rig.drive in ("omni", "omni_angular"):
        force = numbers(-grip, grip)
        for axis in ("x", "y"):
            ET.SubElement(actuators, "velocity", name=f"{name}/{axis}", joint=f"{name}/{axis}", forcerange=force,
                          kv=numbers(rig.mass / options.lag))  # fmt: skip
        if rig.drive == "omni_angular":
            torque, inertia = grip * rig.gyration, rig.mass * rig.gyration**2
            ET.SubElement(actuators, "velocity", name=f"{name}/yaw", joint=f"{name}/yaw",
                          kv=numbers(inertia / options.lag), forcerange=numbers(-torque, torque))  # fmt: skip
        return
    torque = grip * rig.wheel_radius / 2
    gain = rig.mass * rig.wheel_radius**2 / (2 * options.lag)
    for side in ("left", "right"):
        ET.SubElement(actuators, "velocity", name=f"{name}/{side}", joint=f"{name}/{side}", kv=numbers(gain),
                      forcerange=numbers(-torque, torque))  # fmt: skip
    if rig.drive == "acker":
        stiffness = _steering_inertia(rig) * _STEERING_RATE**2
        damping = 2 * _steering_inertia(rig) * _STEERING_RATE
        for side in ("left", "right"):
            ET.SubElement(actuators, "position", name=f"{name}/steer_{side}", joint=f"{name}/steer_{side}",
                          kp=numbers(stiffness), kv=numbers(damping))  # fmt: skip


def _steering_inertia(rig: Rig) -> float:
    return _STEERING_SHARE * rig.mass * rig.wheelbase**2


def _planar(body: ET.Element, rig: Rig, pose: tuple[float, float, float]) -> None:
    """Joints along the axes of the world, and one about the vertical axis for a robot that turns.

    Their positions are the coordinates of the robot: axes of joints are given in the frame that the body starts in.
    """
    name, (x, y, yaw) = body.get("name", ""), pose
    cosine, sine = math.cos(yaw), math.sin(yaw)
    drag = _SLIDING * rig.mass * _GRAVITY if rig.drive == PUSHED else 0.0
    for axis, start, direction in (("x", x, (cosine, -sine, 0.0)), ("y", y, (sine, cosine, 0.0))):
        ET.SubElement(body, "joint", name=f"{name}/{axis}", type="slide", axis=numbers(*direction), ref=numbers(start),
                      frictionloss=numbers(drag))  # fmt: skip
    if rig.drive in TURNING:
        ET.SubElement(body, "joint", name=f"{name}/yaw", type="hinge", axis="0 0 1", ref=numbers(yaw),
                      frictionloss=numbers(drag * rig.gyration))  # fmt: skip
    _inertia(body, rig, rig.mass)


def _inertia(body: ET.Element, rig: Rig, mass: float) -> None:
    """Mass and moments of inertia of the body of a robot without its wheels."""
    upright = mass * rig.gyration**2
    tilting = mass * (rig.gyration**2 / 2 + (rig.top - rig.clearance) ** 2 / 12)
    ET.SubElement(body, "inertial", pos=numbers(*rig.center, min(0.05, rig.wheel_radius)), mass=numbers(mass),
                  diaginertia=numbers(max(tilting, upright / 2), max(tilting, upright / 2), upright))  # fmt: skip


def _wheel(body: ET.Element, name: str, x: float, y: float, z: float, rig: Rig, options: Mujoco) -> None:
    """A wheel that turns about the y axis. It touches the ground in one point, as a sphere, and looks like a disk."""
    wheel = ET.SubElement(body, "body", name=name, pos=numbers(x, y, z))
    ET.SubElement(wheel, "joint", name=name, type="hinge", axis="0 1 0")
    inertia = rig.wheel_mass * rig.wheel_radius**2 * 0.5
    ET.SubElement(wheel, "inertial", pos="0 0 0", mass=numbers(rig.wheel_mass),
                  diaginertia=numbers(inertia / 2 + 1e-9, inertia + 1e-9, inertia / 2 + 1e-9))  # fmt: skip
    ET.SubElement(wheel, "geom", {"class": "wheel", "size": numbers(rig.wheel_radius),
                                  "friction": numbers(options.friction, 0.005, 0.0001)})  # fmt: skip
    ET.SubElement(wheel, "geom", {"class": "seen", "type": "cylinder", "euler": "1.5707963267949 0 0", "rgba": _DARK,
                                  "size": numbers(rig.wheel_radius, 0.2 * rig.wheel_radius)})  # fmt: skip


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
