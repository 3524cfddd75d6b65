"""Single marks, labels, images and shapes on any Matplotlib axes, each an artist of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Ellipse, Patch, PathPatch, Polygon, Rectangle, Wedge
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D

from irsim.diagnostics.errors import InputError
from irsim.graphics.figure.canvas import geometry_path, rgba
from irsim.graphics.figure.image_layers import GridLayer
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.scene import Dots, GridImage, Label, Line, Mark, Picture

__all__ = [
    "add_dots",
    "add_grid",
    "add_label",
    "add_mark",
    "add_picture",
    "draw_patch",
    "geometry_to_path",
    "linewidth_from_data_units",
    "set_patch_property",
]

_POINTS_PER_INCH = 72


def geometry_to_path(geometry: Any) -> Path:
    """Convert a shapely polygon, line, or collection of them to a Matplotlib path."""
    from shapely.geometry.polygon import orient

    pieces = []
    for piece in getattr(geometry, "geoms", [geometry]):
        rings = [piece]
        if piece.geom_type == "Polygon":
            oriented = orient(piece)  # Matplotlib leaves a hole open only if it runs opposite to the outline
            rings = [oriented.exterior, *oriented.interiors]
        for ring in rings:
            points = np.asarray(ring.coords)[:, :2]
            pieces.append(Path(points, closed=piece.geom_type != "LineString"))
    return Path.make_compound_path(*pieces)


def linewidth_from_data_units(linewidth: float, axis: Any, reference: str = "y") -> float:
    """Convert a line width in the units of the axes [m] to points.

    Args:
        linewidth: Width [m].
        axis: Matplotlib axes.
        reference: Direction whose scale is used, ``x`` or ``y``.
    """
    figure, box = axis.get_figure(), axis.get_position()
    if reference == "x":
        length, span = figure.bbox_inches.width * box.width, np.diff(axis.get_xlim())[0]
    else:
        length, span = figure.bbox_inches.height * box.height, np.diff(axis.get_ylim())[0]
    return float(linewidth * length * _POINTS_PER_INCH / span)


def set_patch_property(element: Any, **properties: Any) -> None:
    """Set colour, alpha, zorder, … of an artist; properties that are None stay unchanged."""
    element.set(**{key: value for key, value in properties.items() if value is not None})


def draw_patch(
    ax: Any,
    shape: str,
    state: Any = None,
    radius: float | None = None,
    width: float | None = None,
    height: float | None = None,
    vertices: Any = None,
    theta1: float | None = None,
    theta2: float | None = None,
    **kwargs: Any,
) -> Patch:
    """Add one shape to axes.

    Args:
        ax: Matplotlib axes.
        shape: ``circle``, ``rectangle``, ``ellipse``, ``wedge``, ``polygon`` or ``path``.
        state: x, y [m] and heading [rad], by default zeros.
        radius: Radius of a circle or wedge [m].
        width: Extent of a rectangle or ellipse along x [m].
        height: Extent of a rectangle or ellipse along y [m].
        vertices: (2, N) corners of a polygon in the world frame, or the Matplotlib path of a ``path``.
        theta1: First angle of a wedge [degrees].
        theta2: Last angle of a wedge [degrees].
        **kwargs: Arguments of the Matplotlib patch.

    Returns:
        The patch.

    Raises:
        ValueError: The shape is unknown.
    """
    x, y, theta = (*(np.zeros(3) if state is None else np.asarray(state, dtype=float).reshape(-1)), 0.0, 0.0)[:3]
    turn = float(np.degrees(theta))
    patch: Patch
    if shape == "circle":
        patch = Circle((x, y), radius or 0.5, **kwargs)
    elif shape == "rectangle" and vertices is None:
        patch = Rectangle(
            (x - (width or 1) / 2, y - (height or 1) / 2), width or 1, height or 1, angle=turn, rotation_point="center",
            **kwargs,
        )  # fmt: skip
    elif shape == "ellipse":
        patch = Ellipse((x, y), width or 1, height or 1, angle=turn, **kwargs)
    elif shape == "wedge":
        patch = Wedge((x, y), radius or 0.5, theta1 or 0.0, 360.0 if theta2 is None else theta2, **kwargs)
    elif shape in ("polygon", "rectangle"):
        patch = Polygon(np.asarray(vertices)[:2].T, **kwargs)
    elif shape == "path":
        patch = PathPatch(vertices, **kwargs)
    else:
        raise InputError(f"unknown shape {shape!r}", "choose circle, rectangle, ellipse, wedge or polygon")
    ax.add_patch(patch)
    return patch


def add_mark(ax: Axes, mark: Mark) -> Artist:
    """Add a mark: lines as a Matplotlib line, other geometries as a patch. The limits of the axes stay unchanged."""
    stroke = mark.stroke
    width = linewidth_from_data_units(stroke.width, ax) if stroke.metric else stroke.width
    edge = "none" if stroke.color is None else rgba(stroke.color, mark.alpha)
    if isinstance(mark.geometry, Line):
        line = Line2D(*mark.geometry.points.T, color=edge, linewidth=width, linestyle=stroke.style, zorder=mark.zorder)
        ax.add_artist(line)
        return line
    face = "none" if mark.fill is None else rgba(mark.fill, mark.alpha)
    patch = PathPatch(
        geometry_path(mark.geometry),
        facecolor=face,
        edgecolor=edge,
        linewidth=width,
        linestyle=stroke.style,
        zorder=mark.zorder,
    )
    ax.add_artist(patch)
    return patch


def add_dots(ax: Axes, dots: Dots) -> Artist:
    """Add round marks."""
    colors: Any = dots.colors
    edge = rgba(dots.edge_color)
    return ax.scatter(
        dots.points[:, 0],
        dots.points[:, 1],
        s=dots.area,
        c=colors,
        edgecolors=[edge],
        linewidths=dots.edge_width,
        zorder=dots.zorder,
    )


def add_label(ax: Axes, label: Label) -> Text:
    """Add a text."""
    return ax.text(
        label.x,
        label.y,
        label.text,
        color=rgba(label.color),
        fontsize=label.size,
        alpha=label.alpha,
        zorder=label.zorder,
        clip_on=True,
        parse_math=False,
    )


def add_picture(ax: Axes, picture: Picture, images: Pictures) -> AxesImage:
    """Add an image in place of a body."""
    image = AxesImage(ax, interpolation="antialiased", label=picture.name, zorder=picture.zorder, alpha=picture.alpha)
    image.set_data(images.tinted(picture.name, picture.tint))
    x, y, length, width = picture.box
    image.set_extent((x, x + length, y, y + width))
    px, py, theta = picture.pose
    image.set_transform(Affine2D().rotate(theta).translate(px, py) + ax.transData)
    ax.add_image(image)
    image.set_clip_path(ax.patch)
    return image


def add_grid(ax: Axes, grid: GridImage) -> AxesImage:
    """Add a map as an image."""
    layer = GridLayer(ax, grid.zorder)
    layer.show(grid)
    return layer.artist
