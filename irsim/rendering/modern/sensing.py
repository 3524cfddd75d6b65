"""Sensing: the free area and the hits of lidars, hits coloured by radial velocity, fields of view."""

from __future__ import annotations

import math

import numpy as np

from irsim.graphics.scene.glyphs import GLOW
from irsim.graphics.scene.scene import Beams, Line, Mark, Region, Sector, Spots, Stroke
from irsim.graphics.scene.style import Palette
from irsim.graphics.scene.theme import Theme, seen
from irsim.objects.sensors.lidar import FMCWLidar2D, Lidar2D
from irsim.rendering.modern.frame import stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Thing

__all__ = ["fov_marks", "measures_velocity", "scan_marks"]

_FOV_Z, _SCAN_Z, _HIT_Z, _STILL_HIT_Z, _DOPPLER_Z = 1.6, 1.7, 1.9, 4.1, 4.6
_FEW_SCANS = 3
_LEAST_ALPHA = 0.05
_FULL_TURN = 2 * math.pi - 0.1
_STILL_M_S = 0.15
"""A radial velocity up to this one counts as none [m/s]."""
_DOPPLER, _DOPPLER_STILL, _DOPPLER_RIM, _DOPPLER_EDGE = 5.0, 3.0, 0.6, 1.3
_FOV_ALPHA, _FOV_EDGE_ALPHA = 0.17, 0.7
_FOV_DASHES = (0, (4, 3))
_ARC_STEP = math.radians(3.0)


def measures_velocity(beams: Beams, thing: Thing) -> bool:
    """Whether a scan has a radial velocity for each hit."""
    lidar = thing.view.sensors[beams.sensor]
    return isinstance(lidar, FMCWLidar2D) and beams.colors is not None


def scan_marks(beams: Beams, thing: Thing, layout: Layout, theme: Theme, *, scans: int, area: bool) -> list[Mark]:
    """The area that a scan has found free, and what it has hit, in the colour of the robot whose scan it is.

    Args:
        beams: The scan.
        thing: Its robot.
        layout: The layout.
        theme: The colours.
        scans: Number of scans in the picture.
        area: Whether the free area is drawn.
    """
    lidar = thing.view.sensors[beams.sensor]
    if not isinstance(lidar, Lidar2D) or not len(beams.ends):
        return []
    number, ends = thing.number, np.ascontiguousarray(beams.ends, dtype=np.float64)
    own = beams.color if str(beams.color).lower() != Palette().lidar.lower() else thing.shades.edge
    color = seen(own, theme.paper, theme.least_edge)
    marks = list[Mark]()
    if area and len(ends) > 2:
        whole = lidar.angle_max - lidar.angle_min >= _FULL_TURN
        ring = ends if whole else np.concatenate([[beams.origin], ends])
        alpha = max(GLOW[theme.name] * min(1.0, _FEW_SCANS / scans), _LEAST_ALPHA)
        glow = (*beams.origin, float(lidar.range_max))
        marks.append(Mark(number, "scan", Region([ring]), color, Stroke(None), alpha, _SCAN_Z, glow))
    for beam, one, alpha in beams.highlights:
        line = Line(np.array([beams.origin, ends[beam]]))
        marks.append(Mark(number, "scan", line, None, stroke(seen(one, theme.paper, 3.0), 1.0), alpha, _HIT_Z))
    valid = np.asarray(lidar.valid, dtype=bool)
    if not valid.any():
        return marks
    if not isinstance(lidar, FMCWLidar2D) or beams.colors is None:
        spots = Spots(ends[valid], layout.metres(layout.sizes.hit / 2))
        return [*marks, Mark(number, "hit", spots, color, Stroke(None), 1.0, _HIT_Z)]
    velocity = np.asarray(lidar.radial_velocity)
    still = valid & (np.abs(velocity) <= _STILL_M_S)
    near, away = valid & (velocity < -_STILL_M_S), valid & (velocity > _STILL_M_S)
    for chosen, fill, edge, size, zorder in (
        (still, theme.zero, Stroke(None), _DOPPLER_STILL, _STILL_HIT_Z),
        (away, None, stroke(theme.away, _DOPPLER_EDGE), _DOPPLER, _DOPPLER_Z),
        (near, theme.near, stroke(theme.paper, _DOPPLER_RIM), _DOPPLER, _DOPPLER_Z),
    ):
        if chosen.any():
            spots = Spots(np.ascontiguousarray(ends[chosen]), layout.metres(size / 2))
            marks.append(Mark(number, "hit", spots, fill, edge, 1.0, zorder))
    return marks


def fov_marks(shape: Mark, thing: Thing, theme: Theme) -> list[Mark]:
    """A field of view, which fades with the distance, with a dashed edge."""
    plot = thing.record.plot
    chosen = plot.fov_color if "fov_color" in thing.chosen else None
    color = seen(chosen, theme.paper, theme.least_edge) if chosen is not None else theme.near
    color = thing.shades.edge if chosen is None and thing.kind == "robot" else color
    edge = stroke(color, 1.0, _FOV_DASHES)
    ring = _ring_of(shape)
    reach = 1.0001 * float(np.hypot(*(ring - thing.drawn_at[:2]).T).max())
    glow = (*thing.drawn_at[:2], reach / 0.9)  # the rim stays visible: it is the edge of the view
    return [
        Mark(thing.number, "fov", Region([ring]), color, Stroke(None), _FOV_ALPHA, _FOV_Z, glow),
        Mark(thing.number, "fov", Region([ring]), None, edge, _FOV_EDGE_ALPHA, _FOV_Z + 0.01),
    ]


def _ring_of(mark: Mark) -> np.ndarray:
    shape = mark.geometry
    if isinstance(shape, Region):
        return shape.rings[0]
    whole = not isinstance(shape, Sector)
    start, end = (0.0, 2 * math.pi) if whole else (shape.start, shape.end)  # type: ignore[union-attr]
    angles = np.linspace(start, end, max(8, math.ceil((end - start) / _ARC_STEP)), endpoint=not whole)
    x, y, radius = shape.x, shape.y, shape.radius  # type: ignore[union-attr]
    arc = np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)
    return arc if whole else np.concatenate([[(x, y)], arc])
