"""A 3-D figure of a world: the flat scene on the ground of a 3-D view."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

from irsim.graphics.encoding.pixels import Pixels
from irsim.graphics.figure.compositor import Compositor
from irsim.graphics.figure.figure import inches
from irsim.graphics.scene.scene import Beams, Circle, Geometry, Label, Line, Mark, Region, Scene, Segments, Spots
from irsim.graphics.scene.tracks import Track

__all__ = ["SceneFigure3D"]

_CIRCLE_CORNERS = 48
"""Number of corners of the polygon that stands for a circle."""
_LAYER_HEIGHT_M = 1e-3
"""Height [m] of one layer above the layer below; 3-D axes draw in order of depth, not of zorder."""


class SceneFigure3D:
    """Figure with 3-D axes; all marks of a scene are replaced in each frame.

    Args:
        size: Width and height [px].
        dpi: Pixels per inch.
        depth: Extent along z [m].
        axis: Draw axes, ticks and labels.
        figure: Figure to use, such as a window's; default: a new one without a window.

    Attributes:
        figure, ax: Matplotlib figure and axes, for drawing more.
    """

    def __init__(
        self, size: tuple[float, float], dpi: float, *, depth: float, axis: bool = True, figure: Figure | None = None
    ) -> None:
        if figure is None:
            figure = Figure(figsize=inches(size, dpi), dpi=dpi)
            FigureCanvasAgg(figure)
        self.figure, self.axis, self.depth = figure, axis, depth
        self.ax: Any = figure.add_subplot(projection="3d")
        self.compositor = Compositor(figure, self.ax)
        self.clear()

    def clear(self) -> None:
        """Remove everything drawn, including by scripts, and restore the initial view."""
        self.ax.clear()
        self._artists: list[Any] = []
        self._extent: tuple[float, float, float, float] | None = None
        if not self.axis:
            self.ax.set_axis_off()

    def show(self, scene: Scene, title: str | None, tracks: Sequence[Track] = ()) -> None:
        """Show a scene with its tracks; the angle and zoom of the view stay."""
        if scene.extent != self._extent:
            self._look_at(scene.extent)
        for artist in self._artists:
            if artist.axes is not None:  # None: a script has cleared the axes
                artist.remove()
        marks = [*scene.marks, *(mark for track in tracks for mark in track.marks())]
        self._artists = [self._mark(mark) for mark in marks]
        self._artists += [self._beams(beams) for beams in scene.beams if len(beams.ends)]
        self._artists += [self._label(label) for label in scene.labels]
        self.ax.set_title(title or "", parse_math=False)

    def _look_at(self, extent: tuple[float, float, float, float]) -> None:
        self._extent = extent
        left, right, low, top = extent
        self.ax.set_xlim(left, right)
        self.ax.set_ylim(low, top)
        self.ax.set_zlim(0.0, self.depth)
        self.ax.set_box_aspect((right - left, top - low, self.depth))
        self.ax.set_xlabel("x [m]")
        self.ax.set_ylabel("y [m]")
        self.ax.set_zlabel("z [m]")

    def _mark(self, mark: Mark) -> Any:
        height = _LAYER_HEIGHT_M * max(0.0, mark.zorder)
        lines = [_with_height(points, height) for points in outlines(mark.geometry)]
        edge = mark.stroke.color
        if isinstance(mark.geometry, Line):
            color = _rgba(edge if edge is not None else "none", mark.alpha)
            return self.ax.add_collection3d(Line3DCollection(lines, colors=[color], linestyles=mark.stroke.style))
        patch = Poly3DCollection(lines, linewidths=0.0 if mark.stroke.metric else mark.stroke.width)
        patch.set_facecolor(_rgba(mark.fill if mark.fill is not None else "none", mark.alpha))
        patch.set_edgecolor(_rgba(edge if edge is not None else "none", mark.alpha))
        return self.ax.add_collection3d(patch)

    def _beams(self, beams: Beams) -> Any:
        start = np.broadcast_to(np.array([*beams.origin, _LAYER_HEIGHT_M]), (len(beams.ends), 3))
        ends = _with_height(beams.ends, _LAYER_HEIGHT_M)
        color = _rgba(beams.color, beams.alpha)
        return self.ax.add_collection3d(Line3DCollection(np.stack([start, ends], axis=1), colors=[color]))

    def _label(self, label: Label) -> Any:
        return self.ax.text(label.x, label.y, 0.0, label.text, color=label.color, fontsize=label.size, parse_math=False)

    def draw(self) -> None:
        """Draw into the canvas."""
        self.compositor.draw_without_cache()

    def pixels(self, *, tight: bool, pad_inches: float = 0.1) -> tuple[Pixels, tuple[int, int, int, int]]:
        """Draw the figure and return its pixels, and the box (left, top, right, bottom) they were cut from [px]."""
        self.draw()
        box = self.compositor.tight_box(pad_inches) if tight else (0, 0, *self.compositor.size)
        return self.compositor.pixels(box), box


def outlines(geometry: Geometry) -> list[NDArray[np.float64]]:
    """Return the (M, 2) points of each ring or line of a geometry."""
    if isinstance(geometry, Region):
        return list(geometry.rings)
    if isinstance(geometry, Line):
        return [geometry.points]
    if isinstance(geometry, Segments):
        return list(geometry.points)
    if isinstance(geometry, Spots):
        return [ring for x, y in geometry.points.tolist() for ring in outlines(Circle(x, y, geometry.radius))]
    full = isinstance(geometry, Circle)
    first, last = (0.0, 2 * np.pi) if isinstance(geometry, Circle) else (geometry.start, geometry.end)
    angles = np.linspace(first, last, _CIRCLE_CORNERS, endpoint=not full)
    ring = geometry.radius * np.column_stack([np.cos(angles), np.sin(angles)]) + [geometry.x, geometry.y]
    return [ring if full else np.vstack([[geometry.x, geometry.y], ring])]


def _rgba(color: Any, alpha: float) -> tuple[float, float, float, float]:
    return to_rgba(color, alpha)


def _with_height(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    return np.column_stack([points[:, :2], np.full(len(points), height)])
