"""The Matplotlib figure of one world: it takes a scene, updates its artists in place, and returns pixels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox

from irsim.graphics.encoding.pixels import Pixels
from irsim.graphics.figure.background import TrackLayer
from irsim.graphics.figure.canvas import rgba
from irsim.graphics.figure.compositor import Compositor
from irsim.graphics.figure.glyphs import Glyphs, QuickText
from irsim.graphics.figure.image_layers import FogLayer, GridLayer
from irsim.graphics.figure.labels import LabelLayer, printable
from irsim.graphics.figure.layers import BeamLayer, MarkLayer, layer_key
from irsim.graphics.figure.pictures import Pictures
from irsim.graphics.figure.tracks import track_layers
from irsim.graphics.scene.scene import GridImage, Picture, Scene
from irsim.graphics.scene.style import Color
from irsim.graphics.scene.tracks import Track

__all__ = ["SceneFigure", "fitting_size", "inches"]

_TITLE_PAD_PT = 6.0
_TITLE_SIZE_PT = 12.0
MIN_TITLE_SIZE_PT = 5.0
"""A title that is too long for the figure is not made smaller than this [pt]."""
_TITLE_MARGIN_PX = 4.0
"""Distance that titles keep from the edge of the figure [px]."""
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
        figure: Figure to use, such as a window's; default: a new one without a window.
        pictures: Images drawn in place of bodies.
        halo: Give labels a white outline, so that they can be read on dark ground, and move them away from bodies.
        page: Colour of a figure without axes that the scene fills to its edges, with labels where the scene has them.

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
        page: Color | None = None,
    ) -> None:
        if figure is None:
            figure = Figure(figsize=inches(size, dpi), dpi=dpi)
            FigureCanvasAgg(figure)
        self.figure = figure
        self.axis, self.tight = axis and page is None, tight and page is None
        self._images = pictures or Pictures()
        self._halo, self._page = halo, page
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
        self._labels = LabelLayer(self.figure, self.ax, self._glyphs, halo=self._halo, placed=self._page is not None)
        self._pictures: dict[int, AxesImage] = {}
        self._extent: tuple[float, float, float, float] | None = None
        self._title: str | None = None
        ax = self.ax
        ax.set_aspect("equal")
        ax.set_xlabel("x [m]")
        ax.set_ylabel("y [m]")
        if not self.axis:
            ax.set_axis_off()
        if self._page is not None:
            self.figure.patch.set_facecolor(rgba(self._page))
            ax.set_position((0.0, 0.0, 1.0, 1.0))
            ax.set_aspect("auto")
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
        if self._page is None:
            self.ax.apply_aspect()
        if fit_title:
            self._fit_title()
        scale = self._points_per_metre()
        track_layers(self.ax, self._tracks, tracks, scale)
        groups: dict[tuple[Any, ...], list[Any]] = {key: [] for key in self._marks}
        for mark in scene.marks:
            groups.setdefault(layer_key(mark.part, mark.zorder, mark.stroke.round_caps), []).append(mark)
        for group in scene.groups:
            key = layer_key(group.part, group.zorder, group.looks[0][1].round_caps)
            groups.setdefault(key, []).append(group)
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
        self._labels.show(scene)
        if not self._settled:
            self._settled = True
            self.compositor.settle()

    def draw(self) -> None:
        """Draw the artists into the canvas."""
        layers: list[GridLayer | MarkLayer | FogLayer] = [*self._grids.values(), *self._marks.values()]
        layers += [] if self._fog is None or not self._fog.soft else [self._fog]
        resting: dict[Artist, tuple[int, int]] = {
            layer.artist: (layer.version, layer.resting_scenes) for layer in layers
        }
        self.compositor.draw(
            {**resting, **self._labels.versions},
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
        self._title_artist.set_text(printable(title))
        return longer

    def _fit_title(self) -> None:
        """Reduce the size of a title that is wider than the figure."""
        artist, box, width = self._title_artist, self.ax.bbox, self.figure.bbox.width
        artist.set_fontsize(_TITLE_SIZE_PT)
        middle = (box.x0 + box.x1) / 2
        available = 2 * min(middle, width - middle) - 2 * _TITLE_MARGIN_PX
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
