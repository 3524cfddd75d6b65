"""Adds single marks, labels and images to any Matplotlib axes, each as an artist of its own."""

from __future__ import annotations

from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.text import Text
from matplotlib.transforms import Affine2D

from irsim.graphics.figure.brush import geometry_path, rgba
from irsim.graphics.figure.grids import GridLayer
from irsim.graphics.figure.patches import linewidth_from_data_units
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.scene.scene import Dots, GridImage, Label, Line, Mark, Picture

__all__ = ["add_dots", "add_grid", "add_label", "add_mark", "add_picture"]


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
