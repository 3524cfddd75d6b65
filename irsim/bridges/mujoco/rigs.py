"""How the robots of a scene stand on the ground in three dimensions: wheels, casters, mass and heights."""

from __future__ import annotations

import math
from dataclasses import dataclass

from irsim.bridges.solids.solids import part_points
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = ["DRIVES", "LIDAR_HEIGHT", "PLANAR", "PUSHED", "TURNING", "Rig", "can_move", "default_agents", "rig_of"]

DRIVES = ("diff", "omni", "omni_angular", "acker")
"""Drives that have a body in MuJoCo."""
PUSHED = "pushed"
"""In place of a drive: an object that only moves where others push it."""
PLANAR = ("omni", "omni_angular", PUSHED)
"""Drives of bodies that move along the axes of the world, without wheels."""
TURNING = ("omni_angular", PUSHED)
"""Those of them that turn."""
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
    return frozenset(agent.name for agent in scene.agents if can_move(agent) and _by_default(agent))


def _by_default(agent: SceneObject) -> bool:
    return (agent.role == "robot" and agent.moves) or not _has_drive(agent)


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
        mass: Mass of robots [kg]; None: that of the scenario.
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
