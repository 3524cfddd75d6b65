"""Draws what sensors measure: beams of lidars, also coloured by radial velocity, cones of sonars, contact forces."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np

from irsim.common.arrays import Floats
from irsim.components.sensors._cones import ConeOptions
from irsim.graphics.scene.scene import Beams, Dots, Line, Mark, Sector, Stroke
from irsim.graphics.scene.style import Palette

__all__ = ["BEAM_ZORDER", "draw_cone", "draw_forces", "draw_scan"]

BEAM_ZORDER = 2
_DOT_ZORDER = 4
_CONTACT_ZORDER = 5
_CONE_ALPHA = 0.15


class Scan(Protocol):
    """The attributes of a lidar that a drawing uses; :class:`irsim.objects.sensors.lidar.Lidar2D` has them.

    Attributes:
        drawing: How radial velocities are drawn; None for a lidar that does not measure them.
    """

    obj_id: int
    number: int
    angle_list: Floats
    color: Any
    alpha: float
    colors: dict[int, tuple[str, float]]
    drawing: dict[str, Any] | None

    @property
    def scan_origin(self) -> Any:
        """(3, 1) pose of the sensor when it took the scan, world frame."""

    @property
    def range_data(self) -> Any:
        """(number,) ranges [m]."""

    @property
    def valid(self) -> Any:
        """(number,) which beams have hit something."""


def draw_scan(lidar: Scan, sensor: int = 0, origin: Any = None) -> Beams:
    """Return the beams of the present scan.

    Args:
        lidar: The lidar.
        sensor: Index among the sensors of the object.
        origin: Pose of the sensor in the world frame; by default the one at which it took the scan.
    """
    x, y, theta = np.asarray(lidar.scan_origin if origin is None else origin, dtype=np.float64).reshape(-1)[:3].tolist()
    angles, ranges = lidar.angle_list + theta, lidar.range_data
    ends = np.stack([x + ranges * np.cos(angles), y + ranges * np.sin(angles)], axis=1)
    beams = Beams(
        object=lidar.obj_id,
        sensor=sensor,
        origin=(x, y),
        ends=ends,
        color=lidar.color,
        alpha=lidar.alpha,
        zorder=BEAM_ZORDER,
        highlights=[(beam, c, a) for beam, (c, a) in lidar.colors.items() if 0 <= beam < lidar.number],
    )
    if lidar.drawing is not None:
        _add_velocities(beams, lidar, lidar.drawing)
    return beams


def _add_velocities(beams: Beams, lidar: Any, look: dict[str, Any]) -> None:
    from matplotlib.colors import to_rgba

    valid = lidar.valid
    beams.widths = np.where(valid, look["velocity_linewidth"], look["no_hit_linewidth"])
    if look["velocity_color"]:
        colors = velocity_colors(lidar.radial_velocity, look)
        colors[~valid] = to_rgba(look["no_hit_color"], look["no_hit_alpha"])
        beams.colors = colors
    if look["show_velocity_markers"] and valid.any():
        own = np.array(to_rgba(lidar.color))
        beams.dots = Dots(
            points=beams.ends[valid],
            colors=np.tile(own, (int(valid.sum()), 1)) if beams.colors is None else beams.colors[valid],
            area=float(look["velocity_marker_size"]),
            edge_color=look["velocity_marker_edge_color"],
            edge_width=float(look["velocity_marker_edge_width"]),
            zorder=_DOT_ZORDER,
        )


def velocity_colors(velocity: Floats, look: dict[str, Any]) -> Floats:
    """Return the RGBA colours of beams, (B, 4), which blend from zero velocity to ``velocity_color_max``.

    Args:
        velocity: Radial velocities, (B,) [m/s], positive when receding.
        look: Drawing options of the sensor.
    """
    from matplotlib.colors import to_rgba

    share = np.clip(np.abs(velocity) / look["velocity_color_max"], 0.0, 1.0)[:, None]
    rest = np.array(to_rgba(look["zero_velocity_color"]))
    away, near = (np.array(to_rgba(look[f"{way}_velocity_color"])) for way in ("positive", "negative"))
    colors: Floats = rest + share * (np.where(velocity[:, None] >= 0.0, away, near) - rest)
    return colors


def draw_cone(gauge: Any) -> list[Mark]:
    """Return the cone of a sensor that has one, up to its reading; nothing for other sensors.

    Args:
        gauge: The :class:`irsim.objects.sensors.gauge.Gauge` of an object.
    """
    options = gauge.options
    if not isinstance(options, ConeOptions):
        return []
    x, y, theta = gauge.parent.state.reshape(-1)[:3].tolist()
    (dx, dy, turn), half = options.offset, options.cone / 2
    x, y = x + math.cos(theta) * dx - math.sin(theta) * dy, y + math.sin(theta) * dx + math.cos(theta) * dy
    cone = Sector(x, y, gauge.read()["range"], theta + turn - half, theta + turn + half)
    color = Palette().lidar
    return [Mark(gauge.obj_id, "fov", cone, color, Stroke(color), _CONE_ALPHA, BEAM_ZORDER)]


def draw_forces(contact: Any, sensor: int = 0) -> tuple[list[Mark], list[Beams]]:
    """Return the lines of the contact forces on an object, and the dots at which they start.

    Args:
        contact: The :class:`irsim.objects.sensors.contact.Contact2D` of the object.
        sensor: Index among the sensors of the object.
    """
    reports = contact.reports
    if not reports:
        return [], []
    from matplotlib.colors import to_rgba

    points = np.array([report.point for report in reports])
    forces = np.array([report.normal * report.force for report in reports])
    number, alpha = contact.obj_id, contact.alpha
    stroke = Stroke(contact.color, contact.linewidth)
    marks = [
        Mark(number, "contact", Line(np.array([p, p + f * contact.force_scale])), None, stroke, alpha, _CONTACT_ZORDER)
        for p, f in zip(points, forces, strict=True)
    ]
    dots = Dots(
        points=points,
        colors=np.tile(to_rgba(contact.color, alpha), (len(points), 1)),
        area=contact.marker_size**2,
        edge_color=contact.color,
        edge_width=0.0,
        zorder=_CONTACT_ZORDER,
    )
    nothing = np.zeros((0, 2))
    beams = Beams(number, sensor, (0.0, 0.0), nothing, contact.color, alpha, _CONTACT_ZORDER)
    beams.dots = dots
    return marks, [beams]
