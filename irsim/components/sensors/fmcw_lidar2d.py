"""``fmcw_lidar2d``: a lidar that measures radial velocity too."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.sensors.lidar2d import BeamPlot, Lidar2d
from irsim.options.base import Options
from irsim.options.colors import Color
from irsim.options.registry import SENSORS
from irsim.options.units import Bool, Fraction, MetersPerSecond, Number, Points


class VelocityColors(Options):
    """How measured velocities are drawn; null is the value of the same key of the sensor, else the default."""

    velocity_color: Bool | None = None
    """Colour the beams by radial velocity (default true)."""
    velocity_color_max: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Radial speed drawn in full colour (default 2.0); 1.0 suits walking people."""
    velocity_linewidth: Annotated[Points, Field(ge=0)] | None = None
    """Width of beams that hit something (default 2.5)."""
    no_hit_linewidth: Annotated[Points, Field(ge=0)] | None = None
    """Width of beams that hit nothing (default 0.8)."""
    no_hit_alpha: Fraction | None = None
    """Opacity of beams that hit nothing (default 0.03)."""
    show_velocity_markers: Bool | None = None
    """Mark the points that beams hit (default true)."""
    velocity_marker_size: Annotated[Number, Field(ge=0)] | None = None
    """Area of the marks in square points (default 36)."""
    velocity_marker_edge_color: Color | None = None
    """Outline of the marks (default black)."""
    velocity_marker_edge_width: Annotated[Points, Field(ge=0)] | None = None
    """Width of the outline of the marks (default 0.6)."""
    zero_velocity_color: Color | None = None
    """Colour of hits without radial velocity (default #56B4E9)."""
    positive_velocity_color: Color | None = None
    """Colour of hits that move away (default #CC3311)."""
    negative_velocity_color: Color | None = None
    """Colour of hits that come nearer (default #0072B2)."""
    no_hit_color: Color | None = None
    """Colour of beams that hit nothing (default lightgray)."""


class FmcwPlot(VelocityColors, BeamPlot):
    """How an FMCW lidar is drawn."""


class FmcwLidar2d(VelocityColors, Lidar2d):
    """Lidar that measures range and radial velocity (positive: receding) of each beam's hit.

    Programs read the velocities as `radial_velocity` of the scan.
    """

    DRAWING: ClassVar[dict[str, Any]] = {
        "velocity_color": True,
        "velocity_color_max": 2.0,
        "velocity_linewidth": 2.5,
        "no_hit_linewidth": 0.8,
        "no_hit_alpha": 0.03,
        "show_velocity_markers": True,
        "velocity_marker_size": 36,
        "velocity_marker_edge_color": "black",
        "velocity_marker_edge_width": 0.6,
        "zero_velocity_color": "#56B4E9",
        "positive_velocity_color": "#CC3311",
        "negative_velocity_color": "#0072B2",
        "no_hit_color": "lightgray",
    }

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "fmcw_lidar2d", "number": 90, "range_max": 15.0}]}

    name: Literal["fmcw_lidar2d"] = "fmcw_lidar2d"  # type: ignore[assignment]  # a lidar2d with another name
    motion_compensate: Bool = False
    """Report the radial velocity of the target itself instead of the relative one: the sensor's own motion
    (ego-motion) is taken out. Of a sensor that stands still, both are the same."""
    velocity_noise_std: Annotated[MetersPerSecond, Field(ge=0)] = 0.0
    """Standard deviation of the noise of the radial velocity; it does not need `noise`."""
    plot: FmcwPlot = FmcwPlot()
    """Drawing options; they take precedence over the same keys of the sensor."""

    def drawing(self) -> dict[str, Any]:
        """Every velocity drawing option with its effective value."""
        chosen = dict(self.DRAWING)
        for source in (self, self.plot):
            chosen.update({key: getattr(source, key) for key in chosen if getattr(source, key) is not None})
        return chosen


SENSORS.register(FmcwLidar2d, kernel=core.FmcwLidar2dOptions)
