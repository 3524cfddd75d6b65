"""Decisions that `sfm` and `rvo` should make, written out with NumPy and without any cleverness."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely

from tests.core.oracle import rotation, wrap

Walls = list[tuple[np.ndarray, np.ndarray]]


@dataclass
class Ring:
    """The walls of one static object, the solid side on their left, and the corners of its hull, world frame."""

    walls: Walls
    points: np.ndarray

    def distance(self, p: np.ndarray) -> float:
        """Distance from the hull; 0 inside."""
        return float(shapely.MultiPoint(self.points).convex_hull.distance(shapely.Point(p)))

    def facing(self, view: View, reach: float) -> Walls:
        """The walls within reach whose free side faces the object."""
        p = view.position
        return [
            (a, b) for a, b in self.walls if cross(b - a, p - a) <= 0 and np.linalg.norm(nearest(a, b, p) - p) <= reach
        ]


@dataclass
class View:
    """The view of one object, world frame: other radii as they are, its own padded by 0.1 m."""

    position: np.ndarray
    velocity: np.ndarray
    desired: np.ndarray
    radius: float
    discs: list[tuple[np.ndarray, np.ndarray, float]] = field(default_factory=list)  # centre, velocity, radius
    goal: float = math.inf  # distance to the goal
    ahead: np.ndarray = field(default_factory=lambda: np.zeros(2))  # direction of the goal
    lines: Walls = field(default_factory=list)  # moving ones
    rings: list[Ring] = field(default_factory=list)


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
    """Every segment of a moving line, and every wall that faces the object; a corner of two such walls counts once."""
    p = view.position
    force = sum((wall_force(o, view, nearest(a, b, p)) for a, b in view.lines), np.zeros(2))
    for ring in view.rings:
        for (a, b), (c, d) in zip(ring.walls, [*ring.walls[1:], ring.walls[0]], strict=True):
            if cross(b - a, p - a) > 0:
                continue
            shared = (p - b) @ (b - a) >= 0 and (p - c) @ (d - c) <= 0 and cross(d - c, p - c) <= 0
            if not shared:
                force = force + wall_force(o, view, nearest(a, b, p))
    return force


def on_free_way(o: Any, view: View, desired: np.ndarray, force: np.ndarray) -> np.ndarray:
    """The force of walls without what holds back an object whose way is free for 3 m: at most half the pull is left."""
    speed = np.linalg.norm(desired)
    if not speed > 0:
        return force
    ahead = desired / speed
    excess = -force @ ahead - 0.5 * o.vmax * o.force_factor_desired / o.relaxation_time
    body = replace(view, radius=view.radius - 0.1)
    walls = [wall for ring in view.rings for wall in ring.facing(body, 3.0 + body.radius)]
    free = excess > 0 and all(time_to_wall(body, a, b, ahead) >= 3.0 for a, b in walls)
    return force + excess * ahead if free else force


def past_walls(view: View, wanted: np.ndarray, reach: float = 3.0) -> np.ndarray:
    """The wanted velocity turned to the tangent of what is in the way within `reach` and before the goal.

    The side is where the way over the corner to the goal is shorter.
    """
    look = min(reach, view.goal)
    ahead = math.atan2(wanted[1], wanted[0])
    goal = view.goal * view.ahead

    def tangents(ring: Ring) -> tuple[float, float, float]:
        """A direction into the hull, and how far its tangents are to the right and to the left of it."""
        reach = min(view.radius + 0.02, ring.distance(view.position) * (1 - 1e-6))
        x, y = np.mean(ring.points, axis=0) - view.position
        middle = math.atan2(y, x)
        corners = [
            (wrap(math.atan2(y, x) - middle), math.asin(min(1.0, reach / math.hypot(x, y))))
            for x, y in ring.points - view.position
        ]
        return middle, min(a - half for a, half in corners), max(a + half for a, half in corners)

    def blocking(angle: float, share: float) -> Ring | None:
        w = np.array([math.cos(angle), math.sin(angle)])
        for ring in view.rings:
            if ring.distance(view.position) == 0:
                continue
            middle, right, left = tangents(ring)
            walls = ring.facing(view, look + view.radius)
            inside = right + 1e-9 < wrap(angle - middle) < left - 1e-9
            if inside and any(time_to_wall(view, a, b, w) < look * share for a, b in walls):
                return ring
        return None

    def edge(ring: Ring, angle: float, side: float) -> tuple[float, np.ndarray]:
        """The direction of the tangent on one side, and the corner of the hull that it touches."""
        middle, right, left = tangents(ring)
        end = left if side > 0 else right
        reach = min(view.radius + 0.02, ring.distance(view.position) * (1 - 1e-6))
        offsets = ring.points - view.position
        misses = [
            abs(wrap(math.atan2(y, x) - middle) + side * math.asin(min(1.0, reach / math.hypot(x, y))) - end)
            for x, y in offsets
        ]
        return angle + end - wrap(angle - middle), offsets[int(np.argmin(misses))]

    def turned(side: float, share: float) -> tuple[float, float]:
        """Length of the way and its direction."""
        angle, length = ahead, view.goal
        for _ in range(8):
            ring = blocking(angle, share)
            if ring is None:
                return length, angle
            angle, corner = edge(ring, angle, side)
            if math.cos(angle - ahead) < 0.01:
                break
            length = float(np.linalg.norm(corner) + np.linalg.norm(goal - corner))
        return math.inf, ahead

    for share in (1.0, 0.5, 0.25, 0.125):
        if blocking(ahead, share) is None:
            return wanted
        left, right = turned(1.0, share), turned(-1.0, share)
        if min(left, right)[0] < math.inf:
            return rotation((left if left[0] < right[0] - 1e-9 else right)[1] - ahead) @ wanted
    return wanted


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
    desired = past_walls(view, view.desired) / speed * o.vmax if speed > 0 else np.zeros(2)
    social = np.zeros(2)
    for centre, velocity, _ in view.discs:
        if np.linalg.norm(centre - view.position) < o.neighbor_threshold:
            social += social_force(o, view, centre, velocity)
    force = (
        o.force_factor_desired * (desired - view.velocity) / o.relaxation_time
        + o.force_factor_social * social
        + o.force_factor_obstacle * obstacle_force(o, replace(view, rings=[]))
        + on_free_way(o, view, desired, o.force_factor_obstacle * obstacle_force(o, replace(view, lines=[])))
        + group_force(o, view, companions)
    )
    velocity = view.velocity + dt * force
    fast = np.linalg.norm(velocity)
    return velocity * (o.vmax / fast) if fast > o.vmax else velocity


def forward(
    velocity: np.ndarray,
    theta: float,
    *,
    tolerance: float,
    guarantee_time: float,
    max_rate: float,
    min_speed: float = 0.02,
) -> tuple:
    """Forward speed, heading error and yaw rate for a wanted velocity (reference: 5.4)."""
    speed = float(np.hypot(*velocity))
    if speed <= min_speed:
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
    result = []
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
        result.append((apex, left, right))
    for a, b in view.lines:
        if np.linalg.norm(b - a) < 1e-6:
            continue
        a, b = a - view.position, b - view.position
        if cross(a, b) < 0:
            a, b = b, a
        wide = [math.asin(min(1.0, view.radius / max(np.linalg.norm(p), view.radius))) for p in (a, b)]
        result.append((np.zeros(2), math.atan2(b[1], b[0]) + wide[1], math.atan2(a[1], a[0]) - wide[0]))
    return result


def samples(speed: float, acce: float, limit: float) -> np.ndarray:
    grid = np.arange(max(speed - acce, -limit), min(speed + acce, limit), 0.05)
    return grid if len(grid) else np.array([np.clip(speed, -limit, limit)])


def rvo_walls(o: Any, view: View) -> tuple[Walls, Walls, float]:
    """Walls that block what reaches them within a second, those to be passed among them, and how far one looks."""
    reach = min(o.neighbor_threshold, view.radius + math.hypot(o.vxmax, o.vymax))
    look = min(view.goal, o.neighbor_threshold) if view.desired.any() else 0.0
    walls, passed = [], []
    for ring in view.rings:
        if look > 0 and ring.distance(view.position) > 0:
            passed += ring.facing(view, max(reach, look + view.radius))
        else:
            walls += ring.facing(view, reach)
    return walls + passed, passed, look


def rvo(o: Any, view: View) -> list[tuple[float, float, float]]:
    """Candidates (cost, x, y) of the class that counts, best first.

    Several may be equally good to rounding: any of them is a right answer, the first one in exact arithmetic.
    """
    view.discs = [d for d in view.discs if np.linalg.norm(d[0] - view.position) < o.neighbor_threshold]
    if view.desired.any():
        view.desired = past_walls(view, view.desired, o.neighbor_threshold)
    walls, passed, look = rvo_walls(o, view)
    obstacles = cones(o, view)
    free, spoiled, walled, gaps = [], [], [], {}
    for x in samples(view.velocity[0], o.acce, o.vxmax):
        for y in samples(view.velocity[1], o.acce, o.vymax):
            w = np.array([x, y])
            far = float(np.linalg.norm(w - view.desired))
            into_wall = [time_to_wall(view, a, b, w) for a, b in walls]
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
                gaps[x, y] = min(into_wall[len(walls) - len(passed) :], default=math.inf) * float(np.linalg.norm(w))
    free.sort(key=lambda c: c[0])
    for share in (1.0, 0.5, 0.25, 0.125) if passed else ():
        past = [c for c in free if gaps[c[1:]] >= look * share]
        if past and np.array(past[0][1:]) @ view.desired > 0.01 * view.desired @ view.desired:
            return past
    return sorted(free or spoiled or walled, key=lambda c: c[0])
