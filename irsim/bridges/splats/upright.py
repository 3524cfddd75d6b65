"""Which direction is up in a scene of splats that is tilted: the one that its floor, tables and ceiling face.

Trained scenes stand as their first camera was held. Splats lie flat on surfaces, so that their thin axes vote for
directions within 45° of the axis that is said to point up, from where walls cannot win; round splats have no thin axis,
and the direction along which their heights form the sharpest layers is taken instead. A plane through the floor makes
the result exact. Nothing is random.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from irsim.bridges.splats.splats import Splats, rotation_matrices
from irsim.common.arrays import Floats

__all__ = ["Upward", "upward_of"]

_REACH_DEG = 45.0
"""Largest angle between the axis that is said to point up and the one that does; walls are farther away."""
_BIN = 0.03
"""Side of a bin of directions, as a tangent: 1.7° in the middle."""
_WINDOWS_DEG = (20.0, 20.0, 15.0, 15.0, 10.0, 10.0, 10.0)
"""Angles within which directions are averaged, one step after the other."""
_LEAST_SPLATS = 100
"""Splats that a floor has at least."""
_CLEARER = 1.2
"""How much more of the scene must be level along the new direction than along the old one."""
_SAMPLE = 8_000
"""Splats among which the layers of round ones are looked for."""
_STEPS_DEG = (4.0, 1.0, 0.25)
"""Steps between directions that are tried for round splats."""
_LAYER_M = 0.05
"""Thickness of a layer."""
_BANDS_M = (0.4, 0.2, 0.1, 0.06, 0.06)
"""Distances from the floor within which a plane is laid through splats, one after the other."""
_PLANE_DEG = 8.0
"""Largest angle by which the plane changes the direction."""
_SPREAD_M = 0.3
"""Standard deviation of places that a plane needs along each of its axes."""


@dataclass(frozen=True)
class Upward:
    """The direction that points up, and how far it is from the axis that should.

    Attributes:
        direction: (3,) unit vector, frame of the scene.
        tilt: Angle between it and the axis that is said to point up [deg].
    """

    direction: Floats
    tilt: float


def upward_of(splats: Splats, up: Floats, *, unit: float = 1.0, opacity: float = 0.05) -> Upward | None:
    """The direction that points up in a scene; None if no other floor is clearer than the given one.

    Args:
        splats: The scene.
        up: (3,) unit vector that is said to point up, in the frame of the scene.
        unit: Length of a unit of the scene [m].
        opacity: Splats with less opacity are left out.
    """
    seen = splats.take(np.flatnonzero(splats.opacity >= opacity))
    if len(seen) < _LEAST_SPLATS:
        return None
    squares = seen.scale.astype(np.float64) ** 2
    flat = squares.min(axis=1) < 0.1 * squares.sum(axis=1)
    center = seen.center.astype(np.float64) * unit
    weight = seen.opacity.astype(np.float64) * np.minimum(squares.sum(axis=1) * unit**2, 1.0)
    if flat.mean() >= 0.1:
        axes = rotation_matrices(seen.rotation[flat])
        thin = np.take_along_axis(axes, squares[flat].argmin(axis=1)[:, None, None], axis=2)[..., 0]
        direction = _voted(thin.astype(np.float64), weight[flat], up)
        if direction is None:
            return None
        level = np.flatnonzero(flat)[np.abs(thin @ direction) > math.cos(math.radians(30.0))]
        direction = _on_plane(center[level], weight[level], direction)
    else:
        direction = _layered(center[:: -(-len(center) // _SAMPLE)], up)
        if direction is None:
            return None
        direction = _on_plane(center, np.ones(len(center)), direction)
    tilt = math.degrees(math.acos(min(1.0, float(direction @ up))))
    return Upward(direction, tilt) if tilt <= _REACH_DEG else None


def _around(up: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors (3,) that are perpendicular to another one and to each other."""
    first = np.cross(up, np.eye(3)[int(np.abs(up).argmin())])
    first /= np.linalg.norm(first)
    return first, np.cross(up, first)


def _voted(thin: Floats, weight: Floats, up: Floats) -> Floats | None:
    """The direction along which most area is level, by thin axes (N, 3) of splats."""
    along = thin @ up
    thin = thin * np.where(along < 0, -1.0, 1.0)[:, None]
    near = np.abs(along) > math.cos(math.radians(_REACH_DEG))
    thin, weight, along = thin[near], weight[near], np.abs(along[near])
    if len(thin) < _LEAST_SPLATS:
        return None
    half = math.ceil(math.tan(math.radians(_REACH_DEG)) / _BIN)
    count = 2 * half + 1
    i, j = (np.rint(thin @ axis / along / _BIN).astype(np.int64) + half for axis in _around(up))
    votes = np.bincount(i * count + j, weights=weight, minlength=count * count).reshape(count, count)
    padded = np.pad(votes, 1)
    smooth = sum(padded[a : a + count, b : b + count] for a in range(3) for b in range(3))
    best = np.unravel_index(int(np.asarray(smooth).argmax()), votes.shape)
    first, second = _around(up)
    direction = up + (best[0] - half) * _BIN * first + (best[1] - half) * _BIN * second
    direction /= np.linalg.norm(direction)
    for window in _WINDOWS_DEG:
        inside = thin @ direction > math.cos(math.radians(window))
        if inside.sum() < _LEAST_SPLATS:
            return None
        direction = weight[inside] @ thin[inside]
        direction /= np.linalg.norm(direction)
    least = math.cos(math.radians(_WINDOWS_DEG[-1]))
    if direction @ up < least and weight[thin @ direction > least].sum() < _CLEARER * weight[along > least].sum():
        return None
    return np.asarray(direction)


def _layered(center: Floats, up: Floats) -> Floats | None:
    """The direction along which the heights of centers (N, 3) form the sharpest layers [m]."""
    first, second = _around(up)
    size = float(np.linalg.norm(np.percentile(center, 95, axis=0) - np.percentile(center, 5, axis=0)))
    place = np.zeros(2)
    reach = math.tan(math.radians(_REACH_DEG))
    usual = 0.0
    for number, degrees in enumerate(_STEPS_DEG):
        step = math.tan(math.radians(degrees))
        many = math.floor(reach / step) if number == 0 else 4
        layer = max(_LAYER_M, size * step / 2)
        ticks = np.arange(-many, many + 1) * step
        places = place + np.stack(np.meshgrid(ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 2)
        sharp = [_sharpness(center, up + a * first + b * second, layer) for a, b in places]
        usual = _sharpness(center, up, layer)
        place = places[int(np.argmax(sharp))]
    if max(sharp) < _CLEARER * usual and np.hypot(*place) > step:
        return None
    direction = up + place[0] * first + place[1] * second
    result: Floats = direction / np.linalg.norm(direction)
    return result


def _sharpness(center: Floats, direction: Floats, layer: float) -> float:
    """How much heights along a direction gather in layers: the chance that two are in one."""
    height = center @ (direction / np.linalg.norm(direction))
    low, high = np.percentile(height, [1, 99])
    at = np.clip((height - low) / layer, 0, max(1.0, (high - low) / layer)).astype(np.int64)
    share = np.bincount(at) / len(height)
    return float(share @ share)


def _on_plane(center: Floats, weight: Floats, up: Floats) -> Floats:
    """The direction that is perpendicular to the largest layer of places (N, 3) [m], if that is near the given one."""
    direction = up
    for band in _BANDS_M:
        height = center @ direction
        low, high = np.percentile(height, [0.5, 99.5])
        at = np.clip((height - low) / band, 0, (high - low) / band).astype(np.int64)
        sums = np.bincount(at, weights=weight)
        middle = low + (int(sums.argmax()) + 0.5) * band
        middle = float(np.median(height[np.abs(height - middle) <= band]))
        inside = np.abs(height - middle) <= band
        if inside.sum() < _LEAST_SPLATS:
            return up
        share = weight[inside] / weight[inside].sum()
        offset = center[inside] - share @ center[inside]
        spreads, axes = np.linalg.eigh((offset * share[:, None]).T @ offset)
        normal = axes[:, 0] * np.sign(axes[:, 0] @ up)
        if math.sqrt(spreads[1]) < _SPREAD_M or normal @ up < math.cos(math.radians(_PLANE_DEG)):
            return up
        direction = normal
    return direction
