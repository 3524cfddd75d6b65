"""What `sfm` and `rvo` should decide, written out with NumPy and without any cleverness."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tests.core.oracle import wrap


@dataclass
class View:
    """What one object sees, world frame: radii of others as they are, its own padded by 0.1 m."""

    position: np.ndarray
    velocity: np.ndarray
    desired: np.ndarray
    radius: float
    discs: list[tuple[np.ndarray, np.ndarray, float]] = field(default_factory=list)  # centre, velocity, radius
    lines: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    walls: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)  # inside on the left


def cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def nearest(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    length2 = (b - a) @ (b - a)
    return a if length2 == 0 else a + np.clip((p - a) @ (b - a) / length2, 0, 1) * (b - a)


def social_force(o: Any, view: View, centre: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    way = centre - view.position
    distance = np.linalg.norm(way)
    if distance < 1e-6:
        return np.zeros(2)
    towards = way / distance
    t = o.lambda_importance * (view.velocity - velocity) + towards
    length = np.linalg.norm(t)
    along = t / length
    reach = o.gamma * length
    angle = math.atan2(cross(along, towards), along @ towards)
    if abs(angle) < 1e-12:
        angle = 0.0
    gap = max(distance - 2 * o.safety_radius, 0.0)
    f_v = -math.exp(-gap / reach - (o.n_velocity * reach * angle) ** 2)
    f_a = -np.sign(angle) * math.exp(-gap / reach - (o.n_angular * reach * angle) ** 2)
    return f_v * along + f_a * np.array([-along[1], along[0]])


def wall_force(o: Any, view: View, point: np.ndarray) -> np.ndarray:
    away = view.position - point
    distance = np.linalg.norm(away)
    if distance > 5 * o.sigma_obstacle + view.radius:
        return np.zeros(2)
    if distance < 1e-9:
        return np.array([1.0, 0.0])
    return math.exp(-max(distance - view.radius, 0.0) / o.sigma_obstacle) * away / distance


def obstacle_force(o: Any, view: View) -> np.ndarray:
    """Every segment of a line; of the outlines each distinct nearest point of a side that faces the object."""
    force = sum((wall_force(o, view, nearest(a, b, view.position)) for a, b in view.lines), np.zeros(2))
    points: list[np.ndarray] = []
    for a, b in view.walls:
        if cross(b - a, view.position - a) > 0:
            continue
        point = nearest(a, b, view.position)
        if not any(np.allclose(point, other, atol=1e-12) for other in points):
            points.append(point)
    return force + sum((wall_force(o, view, point) for point in points), np.zeros(2))


def group_force(o: Any, view: View, companions: Sequence[tuple[np.ndarray, float]]) -> np.ndarray:
    """`companions`: origin and padded radius of the other members of the social group."""
    if not companions:
        return np.zeros(2)
    others = np.array([position for position, _ in companions])
    middle = (others.sum(0) + view.position) / (len(others) + 1)
    way = middle - view.position
    coherence = way * (math.tanh(np.linalg.norm(way) - len(others) / 2) + 1) / 2
    repulsion = np.zeros(2)
    for position, radius in companions:
        limit = view.radius + radius if o.group_repulsion_threshold is None else o.group_repulsion_threshold
        if np.linalg.norm(view.position - position) < limit:
            repulsion += view.position - position
    gaze = np.zeros(2)
    to_others = others.mean(0) - view.position
    if np.linalg.norm(view.velocity) > 0 and np.linalg.norm(to_others) > 0:
        angle = abs(math.atan2(cross(view.velocity, to_others), view.velocity @ to_others))
        gaze = -max(angle - math.radians(o.gaze_vision_angle), 0.0) * view.velocity
    return (
        o.force_factor_coherence * coherence + o.force_factor_group_repulsion * repulsion + o.force_factor_gaze * gaze
    )


def sfm(o: Any, view: View, dt: float, companions: Sequence[tuple[np.ndarray, float]] = ()) -> np.ndarray:
    """Wanted velocity, world frame."""
    speed = np.linalg.norm(view.desired)
    desired = view.desired / speed * o.vmax if speed > 0 else np.zeros(2)
    social = np.zeros(2)
    for centre, velocity, _ in view.discs:
        if np.linalg.norm(centre - view.position) < o.neighbor_threshold:
            social += social_force(o, view, centre, velocity)
    force = (
        o.force_factor_desired * (desired - view.velocity) / o.relaxation_time
        + o.force_factor_social * social
        + o.force_factor_obstacle * obstacle_force(o, view)
        + group_force(o, view, companions)
    )
    velocity = view.velocity + dt * force
    fast = np.linalg.norm(velocity)
    return velocity * (o.vmax / fast) if fast > o.vmax else velocity


def forward(velocity: np.ndarray, theta: float, *, tolerance: float, guarantee_time: float, max_rate: float) -> tuple:
    """Forward speed, heading error and yaw rate for a wanted velocity (reference: 5.4)."""
    speed = float(np.hypot(*velocity))
    if speed <= 0.02:
        return 0.0, 0.0, 0.0
    error = -wrap(theta - math.atan2(velocity[1], velocity[0]))
    kept = 0.0 if abs(error) < tolerance else error
    return max(0.0, speed * math.cos(error)), kept, float(np.clip(kept / guarantee_time, -max_rate, max_rate))
