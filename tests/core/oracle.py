"""Results that the core should compute, written out with NumPy and without any cleverness."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import shapely

import irsim._core as core


def wrap(a: float) -> float:
    return float(np.mod(a + np.pi, 2 * np.pi) - np.pi)


def rotation(theta: float) -> np.ndarray:
    return np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])


def move(drive: str, pose: np.ndarray, psi: float, u: np.ndarray, dt: float, wheelbase: float = 1.2):
    """Pose, steering angle and twist after one period of forward Euler."""
    x, y, theta = pose
    if drive in ("omni", "omni_angular"):
        v = rotation(theta) @ u[:2]
        rate = u[2] if drive == "omni_angular" else 0.0
    else:
        v = u[0] * np.array([math.cos(theta), math.sin(theta)])
        rate = u[1] if drive == "diff" else u[0] * math.tan(psi) / wheelbase
    if drive == "steer":
        psi = u[1]
    elif drive == "angular":
        psi = float(np.clip(psi + u[1] * dt, -0.9, 0.9))
    heading = theta if drive == "omni" else wrap(theta + rate * dt)
    return np.array([x + v[0] * dt, y + v[1] * dt, heading]), psi, np.array([*v, rate])


def limited(command: np.ndarray, before: np.ndarray, low: np.ndarray, high: np.ndarray, acce: np.ndarray, dt: float):
    return np.clip(command, np.maximum(low, before - acce * dt), np.minimum(high, before + acce * dt))


def dash(drive: str, pose, goal, top, acce, threshold: float, tolerance: float, dt: float) -> np.ndarray:
    """The published law of each drive, before limits."""

    def ramp(error: float, axis: int) -> float:
        a = acce[axis]
        if np.isinf(a) or a <= 0:
            return abs(top[axis])
        return min(abs(top[axis]), -a * dt + math.sqrt((a * dt) ** 2 + 2 * a * (abs(error) - tolerance)))

    distance = math.hypot(goal[0] - pose[0], goal[1] - pose[1])
    bearing = math.atan2(goal[1] - pose[1], goal[0] - pose[0])
    phi = wrap(bearing - pose[2])
    if drive == "diff":
        if distance < threshold:
            return np.zeros(3)
        turn = 0.0 if abs(phi) < tolerance else math.copysign(ramp(phi, 1), phi)
        return np.array([top[0] * math.cos(phi), turn, 0.0])
    if drive == "omni":
        if distance <= threshold:
            return np.zeros(3)
        return np.array([top[0] * math.cos(phi), top[1] * math.sin(phi), 0.0])
    if drive == "omni_angular":
        u, target = np.zeros(3), bearing
        if distance > threshold:
            u[:2] = top[0] * math.cos(phi), top[1] * math.sin(phi)
        else:
            target = goal[2] if len(goal) > 2 else pose[2]
        error = wrap(target - pose[2])
        if abs(error) > tolerance:
            u[2] = math.copysign(ramp(error, 2), error)
        return u
    if distance < threshold:
        return np.zeros(3)
    return np.array([top[0], np.clip(0.0 if abs(phi) < tolerance else phi, -top[1], top[1]), 0.0])


def draws(seed: int, scene: int, noise: int, stream: int, index: int, count: int) -> np.ndarray:
    """The first `count` uniform draws of an object."""
    words = [core.random_bits(seed, scene, noise, stream, index, block) for block in range((count + 3) // 4)]
    return (np.array(words, dtype=np.uint64).ravel()[:count] >> np.uint64(11)) * 2.0**-53


def normals(block: Sequence[int]) -> np.ndarray:
    """Box-Muller over one block."""
    u = (np.array(block, dtype=np.uint64) >> np.uint64(11)) * 2.0**-53
    out = []
    for a, b in ((u[0], u[1]), (u[2], u[3])):
        length = math.sqrt(-2 * math.log(1 - a))
        out += [length * math.cos(2 * math.pi * b), length * math.sin(2 * math.pi * b)]
    return np.array(out)


def ray_segment(origin: np.ndarray, beam: np.ndarray, a: np.ndarray, b: np.ndarray, slack: float) -> float:
    """Distance along a beam to a segment; infinite without a hit, and with a negative slack if it only runs along."""
    p, q, e = a - origin, b - origin, b - a
    if max(abs(beam[0] * corner[1] - beam[1] * corner[0]) for corner in (p, q)) < 1e-9:
        ahead = [t for t in (p @ beam, q @ beam) if t > 1e-9 and slack >= 0]
        return min(ahead, default=math.inf)
    den, area = beam[0] * e[1] - beam[1] * e[0], p[0] * e[1] - p[1] * e[0]
    if den == 0.0:
        return math.inf
    t, w = area / den, (p[0] * beam[1] - p[1] * beam[0]) / den
    return t if -slack <= w <= 1 + slack and t > 1e-9 else math.inf


def ray_circle(origin: np.ndarray, beam: np.ndarray, centre: np.ndarray, radius: float, slack: float) -> float:
    d = centre - origin
    ahead, aside = d @ beam, abs(d[0] * beam[1] - d[1] * beam[0])
    if aside > radius + slack:
        return math.inf
    half = math.sqrt(max(0.0, radius**2 - aside**2))
    return min((t for t in (ahead - half, ahead + half) if t > 1e-9), default=math.inf)


def distances(state: core.State, row: int, origin: np.ndarray, beam: np.ndarray, slack: float) -> float:
    """Distance along a beam to a single-part object."""
    kind = state.parts(row)[0]
    if kind == "circle":
        x, y, radius = state.circle(row, 0, True)
        return ray_circle(origin, beam, np.array([x, y]), radius, slack)
    return min(ray_segment(origin, beam, a, b, slack) for a, b in itertools.pairwise(outline(state, row)))


def outline(state: core.State, row: int) -> np.ndarray:
    """Corners of a polygon or line; a polygon ends with its first corner again."""
    v = state.vertices(row, 0, True)
    return np.vstack([v, v[:1]]) if state.parts(row)[0] == "polygon" else v


def runs_along(state: core.State, row: int, origin: np.ndarray, beam: np.ndarray, distance: float) -> bool:
    """Whether a beam runs along an edge of a single-part object, at that distance too."""
    if row < 0 or state.parts(row)[0] == "circle":
        return False
    ring, across = outline(state, row), np.array([-beam[1], beam[0]])
    along = (ring - origin) @ beam
    on_line = np.abs((ring - origin) @ across) < 1e-9
    return any(
        on_line[k] and on_line[k + 1] and min(along[k : k + 2]) - 1e-9 <= distance <= max(along[k : k + 2]) + 1e-9
        for k in range(len(ring) - 1)
    )


def assert_scan(
    state: core.State,
    beams: slice,
    rows: Sequence[int],
    pose: Sequence[float],
    reach: float,
    aim: np.ndarray | None = None,
    error: np.ndarray | None = None,
) -> None:
    """Casting every beam against every edge from a sensor pose gives the ranges and hits of the state.

    Where a beam just grazes something, both answers are right; of things equally far away, either may be the hit; of
    an edge that a beam runs along, any point before all else.
    ``aim``: true beam angles; ``error``: added to the range of a hit.
    """
    angles = state.beam_angles[beams] if aim is None else aim
    origin, heading = np.array(pose[:2]), pose[2]
    for i, angle in enumerate(angles):
        c, s, ch, sh = math.cos(angle), math.sin(angle), math.cos(heading), math.sin(heading)
        beam = np.array([c * ch - s * sh, c * sh + s * ch])
        seen, hit = float(state.ranges[beams][i]), int(state.hits[beams][i])
        right, answers, own = False, [], []
        for slack in (-1e-9, 1e-12, 1e-9):
            each = {row: distances(state, row, origin, beam, slack) for row in rows}
            near = min((t for t in each.values() if t <= reach), default=math.inf)
            range_ = min(near, reach)
            if error is not None and near < math.inf:
                range_ = min(max(near + error[i], 0.0), reach)
            hits = {row for row, t in each.items() if abs(t - min(near, reach)) < 1e-9}
            if near > reach - 1e-9:
                hits.add(-1)
            answers.append((range_, hits))
            own.append(each.get(hit, math.inf))
            right |= hit in hits and math.isclose(seen, range_, rel_tol=1e-12, abs_tol=1e-12)
        if not right and error is None and seen <= answers[0][0] + 1e-9:  # before what it surely hits
            grazed = any(math.isclose(seen, distance, rel_tol=1e-12) for distance in own)
            right = grazed or runs_along(state, hit, origin, beam, seen)
        assert right, (i, seen, hit, answers)


def shape_of(state: core.State, row: int) -> shapely.Geometry:
    """The union of the parts of an object where it stands; circles have 1000 corners."""
    parts: list[shapely.Geometry] = []
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, True)
            parts.append(shapely.Point(x, y).buffer(radius, quad_segs=250))
        elif kind == "polygon":
            parts.append(shapely.Polygon(state.vertices(row, part, True)))
        else:
            parts.append(shapely.LineString(state.vertices(row, part, True)))
    return shapely.union_all(parts)
