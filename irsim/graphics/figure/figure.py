"""The Matplotlib figure of one world: it takes a scene, updates its artists in place, and returns pixels."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox, IdentityTransform, Transform
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.graphics.encoding.pixels import Pixels
from irsim.graphics.figure.background import TrackLayer
from irsim.graphics.figure.brush import rgba
from irsim.graphics.figure.compositor import Compositor
from irsim.graphics.figure.glyphs import Glyphs, QuickText
from irsim.graphics.figure.grids import GridLayer
from irsim.graphics.figure.layers import BeamLayer, FogLayer, MarkLayer, layer_key
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.figure.tracks import track_layers
from irsim.graphics.scene.labels import bodies_by_size, free_places, leader
from irsim.graphics.scene.scene import Bounds, GridImage, Label, Picture, Scene
from irsim.graphics.scene.tracks import Track

__all__ = ["SceneFigure", "fitting_size", "inches"]

_TITLE_PAD_PT = 6.0
_TITLE_SIZE_PT = 12.0
MIN_TITLE_SIZE_PT = 5.0
"""A title that is too long for the figure is not made smaller than this [pt]."""
_LABEL_MARGIN_PX = 4.0
"""Distance that labels keep from the edge of the axes, and titles from the edge of the figure [px]."""
_LABEL_ZORDER_STEP = 0.01
"""Added to the zorder of labels, so that they cover marks of the same zorder."""
MAX_CACHED_EXTENTS = 2000
"""Number of label sizes after which the cache of label sizes is emptied."""
_HALO_WIDTH_PT = 2.0
_NAMING_PARTS = ("name", "goal")
"""Labels that stand beside the thing that they name, with a line to it if they have no room there."""
_LEADER_COLOR = "#555555"
_LEADER_WIDTH_PT = 0.7
_LEADER_ZORDER = 9.5
_ROUNDING_RESERVE_PX = 0.01
"""Added to the size of a figure, because Matplotlib truncates a product such as 599.9999 px to 599 px."""
_PADDING_PT = 8.0
"""Space between the drawing and the edge of the figure [pt]."""
MAX_DECORATION_SHARE = 0.7
"""Share of the figure that ticks and labels may take; beyond that the layout stays as it is."""
_POINTS_PER_INCH = 72.0
_MARGINS_INCH = {True: (0.75, 0.85), False: (0.25, 0.45)}
"""Whether ticks and labels are drawn -> (left plus right, top plus bottom) margin around the axes [inch]."""
MIN_WIDTH_INCH = 3.6
"""Smallest width of a figure [inch], so that its title fits."""


class SceneFigure:
    """Figure and axes in world coordinates, equal aspect.

    Args:
        size: Width and height [px].
        dpi: Pixels per inch.
        axis: Draw axes, ticks and labels.
        tight: Fit the axes to the figure.
        figure: Figure to use, such as that of a window; default: a new one without a window.
        pictures: Images drawn in place of bodies.
        halo: Give labels a white outline, so that they can be read on dark ground, and move them away from bodies.

    Attributes:
        figure, ax: Matplotlib figure and axes, for drawing more.
    """

    def __init__(
        self,
        size: tuple[float, float],
        dpi: float,
        *,
        axis: bool = True,
        tight: bool = True,
        figure: Figure | None = None,
        pictures: Pictures | None = None,
        halo: bool = False,
    ) -> None:
        if figure is None:
            figure = Figure(figsize=inches(size, dpi), dpi=dpi)
            FigureCanvasAgg(figure)
        self.figure = figure
        self.axis, self.tight = axis, tight
        self._images = pictures or Pictures()
        self._halo = halo
        self._effects: list[AbstractPathEffect] = (
            [withStroke(linewidth=_HALO_WIDTH_PT, foreground="white")] if halo else []
        )
        self.ax: Axes = figure.add_subplot()
        self.compositor = Compositor(figure, self.ax)
        self._glyphs = Glyphs()
        self._start()

    def _start(self) -> None:
        self._marks: dict[tuple[Any, ...], MarkLayer] = {}
        self._tracks: dict[tuple[Any, ...], TrackLayer] = {}
        self._beams: dict[tuple[int, int], BeamLayer] = {}
        self._fog: FogLayer | None = None
        self._grids: dict[int, GridLayer] = {}
        self._labels: dict[tuple[int, str], Text] = {}
        self._leaders: LineCollection | None = None
        self._extents: dict[tuple[str, float, float], Bounds] = {}
        self._pictures: dict[int, AxesImage] = {}
        self._extent: tuple[float, float, float, float] | None = None
        self._title: str | None = None
        ax = self.ax
        ax.set_aspect("equal")
        ax.set_xlabel("x [m]")
        ax.set_ylabel("y [m]")
        if not self.axis:
            ax.set_axis_off()
        self._title_artist = self._quick_title()
        self.compositor.forget()
        self._settled = False

    def _quick_title(self) -> Text:
        """Replace the title of the axes by a QuickText at the same place."""
        original = self.ax.set_title("", pad=_TITLE_PAD_PT, y=1.0)
        title = QuickText(self._glyphs, x=0.5, y=1.0, text="", parse_math=False, fontsize=_TITLE_SIZE_PT, ha="center")
        title.set_figure(self.figure)
        title.axes = self.ax
        title.set_transform(original.get_transform())
        title.set_clip_box(None)
        self.ax.title = title
        return title

    def clear(self) -> None:
        """Remove everything drawn, including by scripts, and return to a view of the whole world."""
        self.ax.clear()
        self._start()

    def show(self, scene: Scene, title: str | None, tracks: Sequence[Track] = ()) -> None:
        """Bring the artists up to date.

        Args:
            scene: Scene to show.
            title: Text above the axes, or None.
            tracks: Tracks that belong to the scene but are not among its marks.
        """
        first = self._extent is None
        self._look_at(scene)
        fit_title = self._show_title(title or "")
        if first and self.tight:
            self._enlarge_axes()
        self.ax.apply_aspect()
        if fit_title:
            self._fit_title()
        scale = self._points_per_metre()
        track_layers(self.ax, self._tracks, tracks, scale)
        groups: dict[tuple[Any, ...], list[Any]] = {key: [] for key in self._marks}
        for mark in scene.marks:
            groups.setdefault(layer_key(mark.part, mark.zorder, mark.stroke.round_caps), []).append(mark)
        for key, marks in groups.items():
            if key not in self._marks:
                self._marks[key] = MarkLayer(self.ax, key)
            self._marks[key].show(marks, scale)
        for shown, beam_layer in self._beams.items():
            if not any(shown == (beams.object, beams.sensor) for beams in scene.beams):
                beam_layer.show(None)
        for beams in scene.beams:
            shown = beams.object, beams.sensor
            if shown not in self._beams:
                self._beams[shown] = BeamLayer(self.ax, beams.zorder)
            self._beams[shown].show(beams)
        if scene.fog is not None:
            self._fog = self._fog or FogLayer(self.ax, scene.fog.zorder)
            self._fog.show(scene.fog)
        self._show_grids(scene.grids)
        self._show_pictures(scene.pictures)
        self._show_labels(scene)
        if not self._settled:
            self._settled = True
            self.compositor.settle()

    def draw(self) -> None:
        """Draw the artists into the canvas."""
        layers: list[GridLayer | MarkLayer] = [*self._grids.values(), *self._marks.values()]
        self.compositor.draw(
            {layer.artist: (layer.version, layer.resting_scenes) for layer in layers},
            {layer.artist: layer for layer in self._tracks.values()},
        )

    def pixels(self, *, tight: bool, pad_inches: float = 0.1) -> tuple[Pixels, tuple[int, int, int, int]]:
        """Draw the figure and return its pixels.

        Returns:
            The pixels, and the box (left, top, right, bottom) they were cut from [px].
        """
        self.draw()
        box = self.compositor.tight_box(pad_inches) if tight else (0, 0, *self.compositor.size)
        return self.compositor.pixels(box), box

    # parts -----------------------------------------------------------------------------------------------------------
    def _look_at(self, scene: Scene) -> None:
        if scene.extent != self._extent:
            self._extent = scene.extent
            self.ax.set_xlim(scene.extent[0], scene.extent[1])
            self.ax.set_ylim(scene.extent[2], scene.extent[3])
        if scene.center is not None:
            for value, get, set_ in (
                (scene.center[0], self.ax.get_xlim, self.ax.set_xlim),
                (scene.center[1], self.ax.get_ylim, self.ax.set_ylim),
            ):
                low, high = get()
                set_(value - (high - low) / 2, value + (high - low) / 2)

    def _enlarge_axes(self) -> None:
        """Let the axes fill the figure, except for the space that ticks, labels and title need."""
        renderer, figure, ax = self._renderer(), self.figure, self.ax
        ax.apply_aspect()
        boxes = [artist.get_tightbbox(renderer) for artist in ((ax.xaxis, ax.yaxis) if self.axis else ())]
        outer = Bbox.union([ax.bbox, *(box for box in boxes if box is not None)])
        title = self._title_artist.get_window_extent(renderer)
        pad = _PADDING_PT * figure.dpi / _POINTS_PER_INCH
        width, height = figure.bbox.width, figure.bbox.height
        left, right = (ax.bbox.x0 - outer.x0 + pad) / width, (outer.x1 - ax.bbox.x1 + pad) / width
        bottom, top = (ax.bbox.y0 - outer.y0 + pad) / height, (max(outer.y1, title.y1) - ax.bbox.y1 + pad) / height
        if left + right < MAX_DECORATION_SHARE and bottom + top < MAX_DECORATION_SHARE:
            figure.subplots_adjust(left=left, right=1 - right, bottom=bottom, top=1 - top)

    def _points_per_metre(self) -> float:
        low, high = self.ax.get_ylim()
        return float(self.ax.bbox.height / (high - low) * _POINTS_PER_INCH / self.figure.dpi)

    def _show_title(self, title: str) -> bool:
        """Set the title; return whether it is longer than before, so that its size must be checked."""
        if title == self._title:
            return False
        longer = self._title is None or len(title) > len(self._title)
        self._title = title
        self._title_artist.set_text(_printable(title))
        return longer

    def _fit_title(self) -> None:
        """Reduce the size of a title that is wider than the figure."""
        artist, box, width = self._title_artist, self.ax.bbox, self.figure.bbox.width
        artist.set_fontsize(_TITLE_SIZE_PT)
        middle = (box.x0 + box.x1) / 2
        available = 2 * min(middle, width - middle) - 2 * _LABEL_MARGIN_PX
        needed = artist.get_window_extent(self._renderer()).width
        if needed > available:
            artist.set_fontsize(max(MIN_TITLE_SIZE_PT, _TITLE_SIZE_PT * available / needed))

    def _renderer(self) -> Any:
        return self.figure.canvas.get_renderer()  # type: ignore[attr-defined]

    def _show_grids(self, grids: Sequence[GridImage]) -> None:
        for number, layer in self._grids.items():
            if not any(grid.object == number for grid in grids):
                layer.show(None)
        for grid in grids:
            if grid.object not in self._grids:
                self._grids[grid.object] = GridLayer(self.ax, grid.zorder)
            self._grids[grid.object].show(grid)

    def _show_pictures(self, pictures: Sequence[Picture]) -> None:
        shown = {picture.object for picture in pictures}
        for number, image in self._pictures.items():
            image.set_visible(number in shown)
        for picture in pictures:
            artist = self._pictures.get(picture.object)
            label = f"{picture.name} {picture.tint}"
            if artist is None or artist.get_label() != label:
                if artist is not None:
                    artist.remove()
                artist = AxesImage(self.ax, interpolation="antialiased", label=label)
                artist.set_data(self._images.tinted(picture.name, picture.tint))
                self.ax.add_image(artist)
                self._pictures[picture.object] = artist
            x, y, length, width = picture.box
            artist.set_extent((x, x + length, y, y + width))
            px, py, theta = picture.pose
            artist.set_transform(Affine2D().rotate(theta).translate(px, py) + self.ax.transData)
            artist.set_alpha(picture.alpha)
            artist.set_zorder(picture.zorder)
            artist.set_clip_path(self.ax.patch)

    def _show_labels(self, scene: Scene) -> None:
        labels = scene.labels
        if not labels and not self._labels:
            return
        shown: dict[tuple[int, str], tuple[Label, Text]] = {}
        view, data = self.ax.bbox, self.ax.transData
        anchors = data.transform([label.anchor for label in labels]) if labels else np.empty((0, 2))
        inside: NDArray[np.bool_] = (anchors >= (view.x0, view.y0)) & (anchors <= (view.x1, view.y1))
        seen: NDArray[np.bool_] = np.all(inside, axis=1)
        for label in compress(labels, seen.tolist()):
            key = label.object, label.part
            text = self._labels.get(key)
            if text is None:
                text = self._labels[key] = QuickText(self._glyphs, parse_math=False, clip_on=False)
                text.set_path_effects(self._effects)
                self.ax.add_artist(text)
            shown[key] = label, text
            text.set_visible(True)
            text.set_text(_printable(label.text))
            text.set_position((label.x, label.y))
            text.set_color(rgba(label.color))
            text.set_fontsize(label.size)
            text.set_alpha(label.alpha)
            text.set_zorder(label.zorder + _LABEL_ZORDER_STEP)
        for key, text in self._labels.items():
            if key not in shown:
                text.set_visible(False)
        if shown:
            self._move_labels(list(shown.values()), anchors[seen], scene)

    def _move_labels(self, shown: list[tuple[Label, Text]], anchors: Floats, scene: Scene) -> None:
        """Shift labels that the edge of the axes would cut or that would cover another label.

        Goal labels give way to all others. With halo, a label that stands away from its thing gets a line to it.
        """
        order = sorted(range(len(shown)), key=lambda i: shown[i][0].part == "goal")
        labels, texts = [shown[i][0] for i in order], [shown[i][1] for i in order]
        anchors = anchors[order]
        view, data = self.ax.bbox, self.ax.transData
        starts = data.transform([text.get_position() for text in texts])
        boxes = np.array([self._extent_of(text) for text in texts]) + np.concatenate([starts, starts], axis=1)
        margin = _LABEL_MARGIN_PX * np.array([1.0, 1.0, -1.0, -1.0])
        names = np.array([self._halo and label.part in _NAMING_PARTS for label in labels])
        lifts = np.zeros_like(starts)  # the descenders of a name stand above its body, too
        lifts[names, 1] = np.maximum(starts[names, 1] - boxes[names, 1], 0.0)
        boxes += np.concatenate([lifts, lifts], axis=1)
        half = np.maximum(np.abs(boxes[:, :2] - anchors), 1.0)
        things = np.concatenate([anchors - half, anchors + half], axis=1)

        def bodies() -> tuple[Floats, Floats]:
            small, walls = bodies_by_size(scene)
            return _in_pixels(small, data), _in_pixels(walls, data)

        moves = free_places(boxes, things, np.array(view.extents) + margin, bodies, clear=self._halo)
        moved = data.inverted().transform(starts + lifts + moves)
        for text, move, (x, y) in zip(texts, (lifts + moves).tolist(), moved.tolist(), strict=True):
            if move != [0.0, 0.0]:
                text.set_position((x, y))
        if self._halo:
            placed = boxes + np.concatenate([moves, moves], axis=1)
            self._show_leaders([leader(placed[i], things[i]) for i in np.flatnonzero(names)])

    def _show_leaders(self, lines: list[Floats | None]) -> None:
        """Draw thin lines [px] from labels to the things that they name."""
        if self._leaders is None:
            self._leaders = LineCollection(
                [],
                colors=_LEADER_COLOR,
                linewidths=_LEADER_WIDTH_PT,
                zorder=_LEADER_ZORDER,
                transform=IdentityTransform(),
            )
            self.ax.add_collection(self._leaders, autolim=False)
        self._leaders.set_segments([line for line in lines if line is not None])

    def _extent_of(self, text: Text) -> Bounds:
        """Return left, bottom, right and top of a label relative to its position [px]."""
        key = text.get_text(), float(text.get_fontsize()), float(self.figure.dpi)
        extent = self._extents.get(key)
        if extent is None:
            if len(self._extents) >= MAX_CACHED_EXTENTS:
                self._extents.clear()
            box = text.get_window_extent(self._renderer())
            x, y = self.ax.transData.transform(text.get_position())
            extent = self._extents[key] = float(box.x0 - x), float(box.y0 - y), float(box.x1 - x), float(box.y1 - y)
        return extent


def _in_pixels(boxes: list[Bounds], data: Transform) -> Floats:
    """Transform (K, 4) boxes in the world to pixels."""
    corners = np.array(boxes, dtype=np.float64).reshape(-1, 2)
    return np.asarray(data.transform(corners), dtype=np.float64).reshape(-1, 4)


def _printable(text: str) -> str:
    """Replace control characters, which fonts lack, by spaces."""
    return "".join(character if character.isprintable() or character == "\n" else " " for character in text)


def inches(size: tuple[float, float], dpi: float) -> tuple[float, float]:
    """Convert the size of a canvas from pixels to inches."""
    return (size[0] + _ROUNDING_RESERVE_PX) / dpi, (size[1] + _ROUNDING_RESERVE_PX) / dpi


def fitting_size(width: float, height: float, side: float, dpi: float, *, axis: bool = True) -> tuple[float, float]:
    """Return the size of a figure that shows a world without empty margins.

    Args:
        width: Width of the world [m].
        height: Height of the world [m].
        side: Longer side of the figure [px].
        dpi: Pixels per inch.
        axis: Whether ticks and labels are drawn, which need space.

    Returns:
        Width and height [px]; the width is large enough for a title.
    """
    across, up = _MARGINS_INCH[axis][0] * dpi, _MARGINS_INCH[axis][1] * dpi
    scale = min((side - across) / width, (side - up) / height)
    return min(side, max(scale * width + across, MIN_WIDTH_INCH * dpi)), min(side, max(scale * height + up, dpi))
