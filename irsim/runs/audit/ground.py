"""Effects of the ground of zones on the wheels of a body, in each step of a recorded run, without the engine."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.components.kinematics._presets import SURFACES
from irsim.runs.audit.artifact import Artifact, Body
from irsim.runs.audit.record import GroundFacts

__all__ = ["FIRM", "Footing", "Under", "footing_of", "track_of"]

Under = tuple[list[float], list[float], list[float], list[float]]
"""Slip, grip, spread and traction of both wheels in one step, see :class:`Footing`."""
FIRM: Under = ([0.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0])
"""Ground on which no wheel slips."""

_EDGE_M = 1e-9
"""A wheel that is nearer to the edge of an area is on either side of it [m]."""
_SLIP_STREAM = 13
"""Number of the random stream of slip."""
_USUAL_WIDTH_M = 0.3
"""Distance of the wheels of a body whose outline the seed decides [m]."""
_SIDES = ("diff", "diff_dynamic", "skid_steer")


@dataclass(frozen=True)
class Footing:
    """The ground under both wheels of a body: left and right, or front and rear, or the same one twice.

    Attributes:
        slip: (T - 1, 2) share of the way of each wheel that the body does not move; NaN where it is not known.
        grip: (T - 1, 2) factor on the friction of each wheel.
        spread: (T - 1, 2) track of skid steering as it turns, over the distance of its sides; 0 without a surface.
        traction: (T - 1, 2) speed over ground per speed of a side, where there is a surface.
    """

    slip: Floats
    grip: Floats
    spread: Floats
    traction: Floats

    @property
    def known(self) -> NDArray[np.bool_]:
        """(T - 1,) whether it is known which ground is under both wheels."""
        slips: Floats = self.slip.sum(axis=1)
        return ~np.isnan(slips)

    def at(self, step: int) -> Under:
        """The ground of one step, from row ``step`` to the next one."""
        slip, grip, spread, traction = (
            array[step].tolist() for array in (self.slip, self.grip, self.spread, self.traction)
        )
        return slip, grip, spread, traction

    def over_ground(self, forward: Floats, rate: Floats, track: float) -> tuple[Floats, Floats]:
        """(T - 1,) speed and yaw rate of a body on two wheels side by side, whose wheels turn as given."""
        left = (forward - 0.5 * track * rate) * (1 - self.slip[:, 0])
        right = (forward + 0.5 * track * rate) * (1 - self.slip[:, 1])
        return 0.5 * (left + right), (right - left) / track


def track_of(body: Body) -> float:
    """Distance of the wheels of a body that stand side by side [m]: the width of the body if its drive does not say."""
    track = (body.options.kinematics or {}).get("track")
    if isinstance(track, (int, float)):
        return float(track)
    if any(key.startswith("random") and value for key, value in (body.facts.form or {}).items()):
        return _USUAL_WIDTH_M
    sides = [y for part in body.drawn.outlines for _, y in part.vertices]
    for part in body.drawn.outlines:
        if part.kind == "circle":
            sides += [part.center[1] - part.radius, part.center[1] + part.radius]
    return max(sides) - min(sides) if sides and max(sides) > min(sides) else _USUAL_WIDTH_M


def _wheels(body: Body) -> Floats:
    """(2, 2) places of the wheels in the body frame [m]."""
    options = body.options.kinematics or {}
    if body.drive in _SIDES:
        return np.array([[0.0, 0.5 * track_of(body)], [0.0, -0.5 * track_of(body)]])
    if body.drive == "tricycle":
        return np.array([[body.options.wheelbase or 1.0, 0.0]] * 2)
    if body.drive == "single_track":
        return np.array([[float(options["front"]) + float(options["rear"]), 0.0], [0.0, 0.0]])
    return np.zeros((2, 2))


def _ring(zone: GroundFacts) -> Floats:
    if zone.rectangle is not None:
        x0, y0, x1, y1 = zone.rectangle
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    return np.array(zone.polygon or [], dtype=np.float64).reshape(-1, 2)


def _covers(zone: GroundFacts, at: Floats) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(K,) whether an area holds each of the points (K, 2), and whether they are on its edge."""
    if zone.circle is not None:
        away = np.hypot(*(at - np.array(zone.circle.center)).T) - zone.circle.radius
        return away <= 0, np.abs(away) < _EDGE_M
    inside, edge = np.zeros(len(at), dtype=bool), np.zeros(len(at), dtype=bool)
    corners = _ring(zone)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        way, to = b - a, at - a
        spans = (a[1] > at[:, 1]) != (b[1] > at[:, 1])
        side = way[0] * to[:, 1] - way[1] * to[:, 0]
        inside ^= spans & (side > 0 if b[1] > a[1] else side < 0)
        share = np.clip(to @ way / max(float(way @ way), 1e-300), 0, 1)
        edge |= np.hypot(*(to - share[:, None] * way).T) < _EDGE_M
    return inside, edge


def _normals(seed: int, number: int, first: int, count: int) -> Floats:
    """(count, 2) normal numbers of an object for slip, one row per step: Philox 4x64, then Box and Muller."""
    counter = ((_SLIP_STREAM << 128 | number << 64 | first) - 1) % 2**256  # NumPy counts before it draws
    words = [counter >> shift & 2**64 - 1 for shift in (0, 64, 128, 192)]
    bits = np.random.Philox(key=np.array([seed, 0], dtype=np.uint64), counter=np.array(words, dtype=np.uint64))
    even = (bits.random_raw(4 * count).reshape(-1, 4) >> np.uint64(11)).astype(np.float64) * 2.0**-53
    length, angle = np.sqrt(-2 * np.log(1 - even[:, 0])), 2 * np.pi * even[:, 1]
    return np.stack([length * np.cos(angle), length * np.sin(angle)], axis=1)


def footing_of(artifact: Artifact, body: Body, row: int) -> Footing | None:
    """The ground under the wheels of a body in each step; None if no area has a ground of its own."""
    grounds = [zone for zone in artifact.world.zones if zone.has_effect and zone.line is None]
    if not grounds:
        return None
    pose = artifact.pose[:-1, row]
    steps = len(pose)
    under = np.full((steps, 2), -1)
    edge = np.zeros((steps, 2), dtype=bool)
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    for wheel, (x, y) in enumerate(_wheels(body).tolist()):
        at = np.stack([pose[:, 0] + x * cosine - y * sine, pose[:, 1] + x * sine + y * cosine], axis=1)
        for index, zone in enumerate(grounds):  # the last area counts
            inside, on_edge = _covers(zone, at)
            under[inside, wheel] = index
            edge[:, wheel] = on_edge | edge[:, wheel] & ~inside
    footing = Footing(*(np.full((steps, 2), value) for value in (0.0, 1.0, 0.0, 1.0)))
    for index, zone in enumerate(grounds):
        there = under == index
        footing.slip[there], footing.grip[there] = zone.slip, zone.grip
        if zone.surface in SURFACES:
            values = SURFACES[str(zone.surface)].values
            footing.spread[there], footing.traction[there] = values["spread"], values["traction"]
    if any(zone.slip_std > 0 for zone in grounds):
        moves = ~np.isnan(pose[:, 0]) & ~artifact.stopped[:-1, row] & (_steps(artifact) >= _start(artifact, body))
        _add_wander(artifact, body, grounds, np.where(moves[:, None], under, -1), edge, footing)
    footing.slip[edge] = np.nan
    return footing


def _steps(artifact: Artifact) -> NDArray[np.int64]:
    return np.arange(artifact.first, artifact.last, dtype=np.int64)


def _start(artifact: Artifact, body: Body) -> int:
    """Number of steps in which a body waits."""
    return math.ceil(max(body.options.start_time, body.options.appear_time) / artifact.step_time - 1e-9)


def _add_wander(
    artifact: Artifact,
    body: Body,
    grounds: list[GroundFacts],
    under: NDArray[np.int_],
    edge: NDArray[np.bool_],
    footing: Footing,
) -> None:
    """Add the deviations of the slip, which last from step to step, to its means."""
    draws = _normals(artifact.meta.seed, body.facts.id, artifact.first, len(under))
    for wheel in range(2):
        wander = math.nan
        lost = False
        for step, index in enumerate(under[:, wheel].tolist()):
            lost = lost or bool(edge[step, wheel])
            zone = grounds[index]
            if index < 0 or zone.slip_std <= 0:
                continue
            draw = float(draws[step, wheel])
            if zone.slip_time > 0 and not math.isnan(wander):
                kept = math.exp(-artifact.step_time / zone.slip_time)
                wander = kept * wander + math.sqrt(1 - kept * kept) * draw
            else:
                wander = draw
            lost = lost and zone.slip_time > 0
            slip = math.nan if lost else min(max(zone.slip + zone.slip_std * wander, 0.0), 1.0)
            footing.slip[step, wheel] = slip
