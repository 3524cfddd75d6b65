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


def stopping_rate(left: float, acce: float, dt: float) -> float:
    """The fastest turn for one period after which a turn that slows down by acce * dt per period ends in time."""
    if math.isinf(acce):
        return math.inf
    low, high = 0.0, left / dt
    for _ in range(100):
        rate = (low + high) / 2
        turns = np.arange(rate, 0.0, -acce * dt).sum() * dt
        low, high = (rate, high) if turns <= left else (low, rate)
    return low


def time_to_line(view: View, a: np.ndarray, b: np.ndarray, w: np.ndarray) -> float:
    along = (b - a) / np.linalg.norm(b - a)
    offset = cross(along, view.position - a)
    towards = -math.copysign(1.0, offset) * cross(along, w)
    if towards <= 1e-9:
        return 1e6
    t = max((abs(offset) - view.radius) / towards, 0.0)
    at = (view.position + w * t - a) @ along
    if not -view.radius <= at <= np.linalg.norm(b - a) + view.radius:
        return 1e6
    return 1e-4 if t == 0 else t


def time_to_wall(view: View, a: np.ndarray, b: np.ndarray, w: np.ndarray) -> float:
    """When a disc that moves at w first touches a segment; bisection over the distance, which is convex in time."""
    away = view.position - nearest(a, b, view.position)
    if w @ away >= 0:
        return math.inf
    if np.linalg.norm(away) <= view.radius:
        return 0.0

    def distance(t: float) -> float:
        p = view.position + t * w
        return float(np.linalg.norm(p - nearest(a, b, p)))

    low, high = 0.0, 1e3 / float(np.linalg.norm(w))
    for _ in range(100):  # least distance
        one, two = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, two) if distance(one) < distance(two) else (one, high)
    if distance(low) > view.radius:
        return math.inf
    low, high = 0.0, low
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if distance(middle) <= view.radius else (middle, high)
    return high


def cones(o: Any, view: View) -> list[tuple[np.ndarray, float, float]]:
    """Apex, left and right edge of every velocity obstacle."""
    found = []
    for centre, velocity, radius in view.discs:
        way = centre - view.position
        distance, both = np.linalg.norm(way), view.radius + radius + 0.1
        half, bearing = math.asin(both / max(distance, both)), math.atan2(way[1], way[0])
        left, right = bearing + half, bearing - half
        a, b = (view.velocity + velocity) / 2, velocity
        apex = {"rvo": a, "vo": b, "hrvo": a}[o.mode]
        if o.mode == "hrvo":
            opening = math.pi - 2 * half
            lean = math.sin(left - math.atan2(*(a - b)[::-1])) / math.sin(0.01 if opening == 0 else opening)
            shift = np.linalg.norm(a - b) * lean * np.array([math.cos(right), math.sin(right)])
            apex = a - shift if cross(way, view.velocity - a) <= 0 else b + shift
        found.append((apex, left, right))
    for a, b in view.lines:
        if np.linalg.norm(b - a) < 1e-6:
            continue
        a, b = a - view.position, b - view.position
        if cross(a, b) < 0:
            a, b = b, a
        wide = [math.asin(min(1.0, view.radius / max(np.linalg.norm(p), view.radius))) for p in (a, b)]
        found.append((np.zeros(2), math.atan2(b[1], b[0]) + wide[1], math.atan2(a[1], a[0]) - wide[0]))
    return found


def samples(speed: float, acce: float, limit: float) -> np.ndarray:
    grid = np.arange(max(speed - acce, -limit), min(speed + acce, limit), 0.05)
    return grid if len(grid) else np.array([np.clip(speed, -limit, limit)])


def rvo(o: Any, view: View) -> list[tuple[float, float, float]]:
    """Candidates (cost, x, y) of the class that counts, best first.

    Several may be equally good to rounding: any of them is a right answer, the first one in exact arithmetic.
    """
    view.discs = [d for d in view.discs if np.linalg.norm(d[0] - view.position) < o.neighbor_threshold]
    reach = min(o.neighbor_threshold, view.radius + math.hypot(o.vxmax, o.vymax))
    view.walls = [
        (a, b)
        for a, b in view.walls
        if cross(b - a, view.position - a) <= 0
        and np.linalg.norm(nearest(a, b, view.position) - view.position) <= reach
    ]
    obstacles = cones(o, view)
    free, spoiled, walled = [], [], []
    for x in samples(view.velocity[0], o.acce, o.vxmax):
        for y in samples(view.velocity[1], o.acce, o.vymax):
            w = np.array([x, y])
            far = float(np.linalg.norm(w - view.desired))
            into_wall = [time_to_wall(view, a, b, w) for a, b in view.walls]
            times = [1e6]
            for centre, velocity, radius in view.discs:
                gap2 = np.sum((centre - view.position) ** 2) - (view.radius + radius + 0.1) ** 2
                t = math.sqrt(max(gap2, 0.0)) / (np.linalg.norm(2 * w - view.velocity - velocity) + 1e-7)
                times.append(1e-4 if t == 0 else t)
            times += [time_to_line(view, a, b, w) for a, b in view.lines]
            penalty = o.factor / min(times) if len(times) > 1 else 0.0
            if min(into_wall, default=math.inf) < 1.0:
                worst = min([*times, *(min(max(t, 1e-4), 1e6) for t in into_wall)])
                walled.append((o.factor / worst + far, x, y))
            elif any(
                cross(np.array([math.cos(left), math.sin(left)]), w - apex) <= 0
                and cross(np.array([math.cos(right), math.sin(right)]), w - apex) >= 0
                for apex, left, right in obstacles
            ):
                spoiled.append((penalty + far, x, y))
            else:
                free.append((far, x, y))
    return sorted(free or spoiled or walled, key=lambda c: c[0])
