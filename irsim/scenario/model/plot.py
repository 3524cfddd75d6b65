"""How one object is drawn."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irsim.options.base import Options
from irsim.options.colors import Color
from irsim.options.units import Bool, Count, Fraction, Integer, Meters, Number, Points
from irsim.options.vectors import Point

__all__ = ["ObjectPlot"]

LineStyle = Annotated[str, Field(strict=True, examples=["-", "--", ":", "-."])]
Width = Annotated[Points, Field(ge=0)]


class ObjectPlot(Options):
    """How an object, its goal, trail, labels and sensors are drawn. A null colour is the object's own."""

    obj_color: Color | None = None
    """Fill colour of the footprint."""
    obj_alpha: Fraction = 1.0
    """Opacity of the footprint."""
    obj_linestyle: LineStyle = "-"
    """Line style of the outline."""
    obj_linewidth: Width = 1.0
    """Width of the outline."""
    obj_zorder: Number | None = None
    """Drawing order; null is 3 for robots, 1 for obstacles, 2 for images."""

    show_goal: Bool = False
    """Draw the footprint at the goal."""
    goal_color: Color | None = None
    """Colour of the goal."""
    goal_alpha: Fraction = 0.5
    """Opacity of the goal."""
    goal_zorder: Number = 1
    """Drawing order of the goal."""
    show_goal_text: Bool = False
    """Label the goal; needs `show_text` and `show_goal`."""
    show_goals: Bool = False
    """Accepted for old files, without effect."""

    show_text: Bool = False
    """Label the object."""
    text_color: Color = "k"
    """Colour of the labels."""
    text_size: Annotated[Points, Field(gt=0)] = 10
    """Size of the labels."""
    text_alpha: Fraction = 1.0
    """Opacity of the labels."""
    text_zorder: Number = 2
    """Drawing order of the labels."""
    text_position: Point | None = None
    """Offset of the label from the position; null is up and left of the footprint."""

    show_arrow: Bool | None = None
    """Draw the heading; null draws it for movable objects that have one (not `omni`)."""
    arrow_color: Color = "#F0E442"
    """Colour of the heading arrow."""
    arrow_length: Annotated[Meters, Field(ge=0)] = 0.4
    """Length of the heading arrow."""
    arrow_width: Annotated[Meters, Field(ge=0)] = 0.6
    """Width of the heading arrow."""
    arrow_alpha: Fraction = 1.0
    """Opacity of the heading arrow."""
    arrow_zorder: Number = 3
    """Drawing order of the heading arrow."""

    show_trajectory: Bool = False
    """Draw the trajectory as a line."""
    traj_color: Color | None = None
    """Colour of the trajectory."""
    traj_style: LineStyle = "-"
    """Line style of the trajectory."""
    traj_width: Annotated[Meters, Field(ge=0)] | None = None
    """Width of the trajectory; null is the width of the object."""
    traj_alpha: Fraction = 0.5
    """Opacity of the trajectory."""
    traj_zorder: Number = 0
    """Drawing order of the trajectory."""
    keep_traj_length: Count = 0
    """Number of latest states in the trajectory; 0 is all."""

    show_trail: Bool = False
    """Draw snapshots of the footprint along the trajectory."""
    trail_freq: Annotated[Integer, Field(ge=1)] = 2
    """Number of steps between two snapshots."""
    trail_type: Annotated[str, Field(strict=True)] | None = None
    """Shape of the snapshots: `circle`, `rectangle`, `polygon`, `ellipse`, ...; null is the object's own."""
    trail_edgecolor: Color | None = None
    """Colour of the outline of the snapshots."""
    trail_linewidth: Width = 0.8
    """Width of the outline of the snapshots."""
    trail_alpha: Fraction = 0.7
    """Opacity of the snapshots."""
    trail_fill: Bool = False
    """Fill the snapshots."""
    trail_color: Color | None = None
    """Fill colour of the snapshots."""
    trail_zorder: Number = 0
    """Drawing order of the snapshots."""
    keep_trail_length: Count = 0
    """Number of latest snapshots that are drawn; 0 is all."""

    show_sensor: Bool = True
    """Draw the sensors."""
    show_fov: Bool = False
    """Draw the field of view; needs `fov` and `fov_radius`."""
    fov_color: Color = "#56B4E9"
    """Fill colour of the field of view."""
    fov_edge_color: Color = "#0072B2"
    """Colour of the outline of the field of view."""
    fov_alpha: Fraction = 0.5
    """Opacity of the field of view."""
    fov_zorder: Number = 1
    """Drawing order of the field of view."""
