"""An independent judge of contacts within a step: shapely on sampled poses, refined round the smallest distance.

It knows nothing of how the core searches. Bodies move on chords while their headings turn linearly (`euler`), or on the
arc of a constant twist (`exact`), which is integrated here from the velocity in the body frame.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
import shapely.ops
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SAMPLES = 257
"""Poses of a step that are looked at first."""
ZOOMS = 5
"""How often the surroundings of the smallest distances are looked at again, 16 times finer."""
SLACK = 1e-6
"""Clearance below which both verdicts are right [m]."""


@dataclass(frozen=True)
class Body:
    """A body and its motion in one step.

    Attributes:
        core: Its outline in the body frame without `radius`: a point, a line, or a polygon.
        radius: Of a disc [m]; 0 for other shapes.
        start: x, y [m], heading [rad].
        by: Displacement of the origin under Euler's law [m].
        turn: Change of the heading [rad].
        exact: Whether `by` is the displacement without the turn, and the body drives the arc.
    """

    core: Any
    radius: float
    start: tuple[float, float, float]
    by: tuple[float, float]
    turn: float
    exact: bool = False

    def poses(self, times: Floats) -> Floats:
        """(T, 3) poses at these times."""
        x, y, heading = self.start
        if self.exact and self.turn:
            # the integral of the velocity, which turns with the body
            angle = self.turn * times
            along, aside = np.sin(angle) / self.turn, (1 - np.cos(angle)) / self.turn
            dx, dy = self.by[0] * along - self.by[1] * aside, self.by[0] * aside + self.by[1] * along
        else:
            dx, dy = self.by[0] * times, self.by[1] * times
        return np.stack([x + dx, y + dy, heading + self.turn * times], axis=1)

    def placed(self, times: Floats, core: Any = None) -> NDArray[np.object_]:
        """(T,) geometries at these times."""
        core = self.core if core is None else core
        points = shapely.get_coordinates(core)
        poses = self.poses(times)
        cosine, sine = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
        turned = np.stack(
            [cosine * points[:, 0] - sine * points[:, 1], sine * points[:, 0] + cosine * points[:, 1]], axis=2
        )
        placed = turned + poses[:, None, :2]
        if core.geom_type == "Point":
            return np.asarray(shapely.points(placed[:, 0]))
        return np.asarray((shapely.polygons if core.geom_type == "Polygon" else shapely.linestrings)(placed))

    def smaller(self) -> Any:
        """The outline, smaller by the slack."""
        if self.core.geom_type == "Polygon":
            return shapely.remove_repeated_points(self.core.buffer(-SLACK, join_style="mitre"))
        if self.core.geom_type == "LineString":
            return shapely.ops.substring(self.core, SLACK, self.core.length - SLACK)
        return self.core


def clearance(a: Body, b: Body, times: Floats) -> Floats:
    """(T,) distances at these times [m]; negative only if a disc is involved, 0 if outlines overlap."""
    return np.asarray(shapely.distance(a.placed(times), b.placed(times))) - a.radius - b.radius


def least_clearance(a: Body, b: Body) -> float:
    """The smallest clearance within the step [m], to 1e-7 m."""
    times = np.linspace(0.0, 1.0, SAMPLES)
    distances = clearance(a, b, times)
    least = float(distances.min())
    inner = np.flatnonzero((distances <= np.r_[np.inf, distances[:-1]]) & (distances <= np.r_[distances[1:], np.inf]))
    for k in inner[np.argsort(distances[inner])][:4].tolist():
        at, width = float(times[k]), 1.0 / (SAMPLES - 1)
        for _ in range(ZOOMS):
            near = np.clip(np.linspace(at - width, at + width, 33), 0.0, 1.0)
            values = clearance(a, b, near)
            at, width = float(near[int(values.argmin())]), width / 16
            least = min(least, float(values.min()))
    return least


def verdict(a: Body, b: Body) -> bool | None:
    """Whether two bodies touch within the step; None if less than the slack decides."""
    least = least_clearance(a, b)
    if least > SLACK:
        return False
    if a.radius + b.radius > 0.0:
        return True if least < -SLACK else None
    less = replace(a, core=a.smaller()), replace(b, core=b.smaller())
    return True if least_clearance(*less) <= 0.0 else None


def first_time(a: Body, b: Body) -> float:
    """The first sampled time at which two bodies that touch overlap, bisected; only for overlaps of some duration."""
    times = np.linspace(0.0, 1.0, 4 * SAMPLES)
    k = int(np.argmax(clearance(a, b, times) <= 0.0))
    low, high = times[k - 1], times[k]
    for _ in range(40):
        middle = 0.5 * (low + high)
        if clearance(a, b, np.array([middle]))[0] <= 0.0:
            high = middle
        else:
            low = middle
    return float(high)


def grazing(a: Body, b: Body, aside: tuple[float, float]) -> float | None:
    """How far `b` must be shifted along a direction so that it is just passed [m]; None if that takes more than 3 m."""

    def shifted(by: float) -> Body:
        return replace(b, start=(b.start[0] + by * aside[0], b.start[1] + by * aside[1], b.start[2]))

    low, high = 0.0, 3.0
    if least_clearance(a, b) > 0.0 or least_clearance(a, shifted(high)) <= 0.0:
        return None
    while high - low > 2e-7:
        middle = 0.5 * (low + high)
        if least_clearance(a, shifted(middle)) > 0.0:
            high = middle
        else:
            low = middle
    return high
