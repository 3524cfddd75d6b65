"""Layers of a figure: marks and beams as few Matplotlib collections, one per layer, updated in place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.collections import Collection, PathCollection
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from irsim.common.arrays import Floats
from irsim.graphics.figure.brush import Work, paint, prepare
from irsim.graphics.figure.canvas import Box, Canvas, around, geometry_path, rgba, without_glow
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import SOLID, Beams, Dots, Group, Mark, Scene
from irsim.graphics.scene.style import Color

__all__ = [
    "PARTS",
    "BeamLayer",
    "MarkArtist",
    "MarkLayer",
    "Spokes",
    "hint_colors",
    "layer_key",
    "opaque_colors",
]

PARTS = (
    *(
        "paper",
        "grid",
        "field",
        "zone",
        "hatch",
        "contour",
        "trail",
        "trajectory",
        "plan",
        "bead",
        "fov",
        "scan",
        "hit",
        "goal",
    ),
    *("halo", "body", "beams", "arrow", "dart", "belief", "head", "ring", "contact", "badge", "sign", "frame", "foot"),
)
"""Drawing order of the parts that have the same zorder."""

_RANKS = {part: rank for rank, part in enumerate(PARTS)}

ZORDER_STEP = 1e-3
"""Added to the zorder per rank in `PARTS`.

Matplotlib draws artists of equal zorder in the order in which they were added, which is not the order of the parts.
"""

_BEAM_WIDTH_PT = 1.0
_NEAR_PX = 0.01
"""Boxes that overlap by less do not reach each other."""
_TRANSPARENT = (0.0, 0.0, 0.0, 0.0)
_OPAQUE = 255.0
_FAR, _NEAR = 40.0, 3.0
"""Dashed lines that leave the view, made so many times larger, are cut to the view, made so many times larger."""


def layer_key(part: str, zorder: float, round_caps: bool = False) -> tuple[Any, ...]:
    """Return the key of the layer that a mark belongs to; keys sort in drawing order."""
    return float(zorder), _RANKS[part], round_caps


class MarkArtist(PathCollection):
    """Shows marks: painted in batches on a pixel canvas if their strokes allow it, as a collection elsewhere.

    Attributes:
        before: Called before the marks are drawn; it may bring them up to date.
        fill: Makes the paths of the collection from the marks.
        items: The marks, one by one or in groups.
        scale: Points per metre, for line widths given in metres.
        ends: Styles of caps and joins of strokes.
        covers: Whether the marks are the page, which hides what reaches out of the world in whole pixels, or lie on it.
    """

    before: Callable[[], None] | None = None
    fill: Callable[[], None]
    items: Sequence[Mark | Group] = ()
    scale = 0.0
    ends = ("butt", "miter")
    covers = False
    _work: Sequence[Work] = ()
    _is_plain = True
    _prepared: Sequence[Mark | Group] | None = None
    _places: Sequence[Sequence[float]] = ()
    _places_of: Sequence[Mark | Group] | None = None
    _places_key: Any = None

    @property
    def marks(self) -> list[Mark]:
        """The marks, one by one."""
        return [mark for item in self.items for mark in (item.marks() if isinstance(item, Group) else [item])]

    def draw(self, renderer: Any) -> None:
        """Draw the marks."""
        if not self.get_visible():
            return
        if not (isinstance(renderer, RendererAgg) and self.paint_on(Canvas(self.axes, renderer))):
            if self.before is not None:
                self.before()
            self.fill()
            super().draw(renderer)

    def paint_on(self, canvas: Canvas) -> bool:
        """Paint the marks if their strokes allow it; return whether that was done."""
        if self.before is not None:
            self.before()
        if self._prepared is not self.items:
            self._work, self._is_plain = prepare(self.items, self.scale, self._work)
            self._prepared = self.items
        if self._is_plain and self._work:
            paint(canvas, (canvas.pixels, canvas.renderer), self.axes, self._work, self.ends)
        return self._is_plain

    def is_reached(self, canvas: Canvas, boxes: Sequence[Box]) -> bool:
        """Whether the box around boxes of pixels reaches below the marks."""
        outer = around(boxes)
        if outer is None or not self.items:
            return False
        if self._places_of is not self.items or self._places_key != canvas.key:
            corners = np.array([bounds(mark.geometry) for mark in self.marks]).reshape(-1, 2)
            self._places = canvas.to_pixels(corners).reshape(-1, 4).tolist()
            self._places_of, self._places_key = self.items, canvas.key
        x0, y0, x1, y1 = outer[0], canvas.height - outer[3], outer[2], canvas.height - outer[1]
        return any(
            x1 > left + _NEAR_PX and x0 < right - _NEAR_PX and y1 > bottom + _NEAR_PX and y0 < top - _NEAR_PX
            for left, bottom, right, top in self._places
        )


class MarkLayer:
    """All marks of one kind and zorder.

    Attributes:
        artist: The collection that shows them.
        version: Number of changes of the content.
        resting_scenes: Number of consecutive scenes without a change.
    """

    def __init__(self, ax: Axes, key: tuple[Any, ...]) -> None:
        self.key = key
        caps, joins = ("round", "round") if key[2] else ("butt", "miter")
        joins = "round" if key[1] == PARTS.index("trajectory") else joins
        self.artist = MarkArtist([], capstyle=caps, joinstyle=joins, zorder=key[0] + ZORDER_STEP * key[1])
        self.artist.fill, self.artist.ends = self._fill, (caps, joins)
        self.artist.covers = key[1] in (PARTS.index("frame"), PARTS.index("foot"))
        ax.add_collection(self.artist, autolim=False)
        self.version = self.resting_scenes = 0
        self._filled: list[Mark] = []
        self._paths: list[Path] = []

    def show(self, items: Sequence[Mark | Group], points_per_metre: float) -> None:
        """Show exactly these marks.

        Args:
            items: The marks and groups; the same Python objects as last time count as unchanged.
            points_per_metre: Scale of the view, for line widths given in metres.
        """
        old, artist = self.artist.items, self.artist
        if _same_at_start(old, items) == len(old) == len(items) and points_per_metre == artist.scale:
            self.resting_scenes += 1
            return
        self.version += 1
        self.resting_scenes = 0
        artist.items, artist.scale, artist.stale = list(items), points_per_metre, True

    def _fill(self) -> None:
        """Make paths, colours and lines of the collection."""
        artist, scale = self.artist, self.artist.scale
        marks = [plain for mark in artist.marks for plain in without_glow(mark)]
        same = _same_at_start(self._filled, marks)
        self._filled = marks
        self._paths[same:] = [geometry_path(mark.geometry) for mark in marks[same:]]
        pairs = zip(self._paths, marks, strict=True)
        artist.set_paths([p if mark.stroke.style in SOLID else _near_view(p, artist.axes) for p, mark in pairs])
        artist.set_facecolor(_colors([mark.fill for mark in marks], [mark.alpha for mark in marks]))
        artist.set_edgecolor(_colors([mark.stroke.color for mark in marks], [mark.alpha for mark in marks]))
        widths = [mark.stroke.width * (scale if mark.stroke.metric else 1.0) for mark in marks]
        artist.set_linewidth(_shorten(widths) or [0.0])
        artist.set_linestyle(_shorten([mark.stroke.style for mark in marks]) or ["-"])


def _near_view(path: Path, axes: Any) -> Path:
    """Return a path in world coordinates, cut to the surroundings of the view if it reaches far beyond them.

    Agg makes every dash of a line, seen or not, which takes hours for a line of 1e9 m.
    """
    view, to_pixels = axes.bbox, axes.transData
    reach = path.get_extents(to_pixels)
    wide = view.expanded(_FAR, _FAR)
    if np.size(path.vertices) == 0 or (wide.contains(*reach.min) and wide.contains(*reach.max)):
        return path
    around, seen = view.expanded(_NEAR, _NEAR), to_pixels.transform_path(path)
    if path.codes is None:
        seen = seen.cleaned(clip=tuple(around.extents), remove_nans=True)
        seen = Path(seen.vertices[:-1], seen.codes[:-1])  # without the STOP at the end
    else:
        seen = seen.clip_to_bbox(around)
    cut: Path = to_pixels.inverted().transform_path(seen)
    return cut


def _same_at_start(old: Sequence[Mark | Group], new: Sequence[Mark | Group]) -> int:
    """Return the number of marks at the start of two lists that are the same Python objects."""
    pairs = enumerate(zip(old, new, strict=False))
    return next((i for i, (a, b) in pairs if a is not b), min(len(old), len(new)))


class BeamLayer:
    """The beams of one sensor, which change in every scene."""

    def __init__(self, ax: Axes, zorder: float) -> None:
        self._ax = ax
        self.artist = Spokes(zorder + ZORDER_STEP * PARTS.index("beams"))
        ax.add_collection(self.artist, autolim=False)
        self._dots: PathCollection | None = None

    def show(self, beams: Beams | None) -> None:
        """Show a scan, or nothing for None."""
        self.artist.set_visible(beams is not None)
        self._show_dots(None if beams is None else beams.dots)
        if beams is None:
            return
        colors: Any = np.empty((len(beams.ends), 4))
        colors[:] = rgba(beams.color, beams.alpha) if beams.colors is None else beams.colors
        for beam, color, alpha in beams.highlights:
            colors[beam] = rgba(color, alpha)
        widths = np.full(len(beams.ends), _BEAM_WIDTH_PT) if beams.widths is None else beams.widths
        self.artist.set_beams(beams.origin, beams.ends, colors, widths)

    def _show_dots(self, dots: Dots | None) -> None:
        if self._dots is not None:
            self._dots.set_visible(dots is not None)
        if dots is None:
            return
        if self._dots is None:
            self._dots = self._ax.scatter([], [], zorder=dots.zorder)
        self._dots.set_offsets(dots.points)
        self._dots.set_sizes([dots.area])
        colors: Any = dots.colors
        self._dots.set_facecolor(colors)
        self._dots.set_edgecolor(rgba(dots.edge_color))
        self._dots.set_linewidth(dots.edge_width)

    def remove(self) -> None:
        """Remove the artists from the axes."""
        self.artist.remove()
        if self._dots is not None:
            self._dots.remove()


class Spokes(Collection):
    """Lines from one point: painted on a pixel canvas; elsewhere one unit line, rotated and stretched for each."""

    def __init__(self, zorder: float) -> None:
        super().__init__(facecolors="none", linewidths=_BEAM_WIDTH_PT, zorder=zorder)
        self._paths = [Path([(0.0, 0.0), (1.0, 0.0)])]
        self._matrices = np.empty((0, 3, 3))
        self._origin, self._ends = (0.0, 0.0), np.empty((0, 2))
        self._colors, self._widths = np.empty((0, 4)), np.empty(0)

    def set_beams(self, origin: tuple[float, float], ends: Floats, colors: Floats, widths: Floats) -> None:
        """Set the lines from ``origin`` to ``ends`` (B, 2), with ``colors`` (B, 4) and ``widths`` (B,) in points."""
        self._origin, self._ends, self._colors, self._widths = origin, ends, colors, widths
        self.stale = True

    def get_transforms(self) -> Any:
        """Return the (B, 3, 3) matrices that turn the unit line into lines from (0, 0)."""
        return self._matrices

    def draw(self, renderer: Any) -> None:
        """Draw the lines."""
        if not self.get_visible():
            return
        if isinstance(renderer, RendererAgg) and self.axes is not None:
            self.paint_on(Canvas(self.axes, renderer))
            return
        self._fill()
        super().draw(renderer)

    def paint_on(self, canvas: Canvas) -> bool:
        """Paint the lines; return True."""
        inks = (self._colors * _OPAQUE + 0.5).astype(np.uint8)
        ends = np.ascontiguousarray(self._ends, dtype=np.float64)
        canvas.painter.beams(canvas.pixels, self._origin, ends, inks, self._widths * canvas.px_per_point)
        return True

    def _fill(self) -> None:
        """Make offsets and matrices of the collection.

        The offsets already move each line to its origin, so the data transform is used without its translation.
        """
        assert self.axes is not None
        self._matrices = np.zeros((len(self._ends), 3, 3))
        self._matrices[:, :2, 0] = self._ends - self._origin
        self._matrices[:, 2, 2] = 1.0
        self.set_offsets(np.tile(self._origin, (len(self._ends), 1)))
        colors: Any = self._colors
        self.set_edgecolor(colors)
        self.set_linewidth(self._widths.tolist())
        linear = self.axes.transData.get_matrix().copy()
        linear[:2, 2] = 0.0
        self.set_transform(Affine2D(linear))
        self.set_offset_transform(self.axes.transData)


def opaque_colors(scene: Scene) -> list[tuple[int, int, int]]:
    """Return the colours (0..255) that a reduced palette must keep: white, black, opaque marks, some labels."""
    colors = [rgba(mark.fill)[:3] for mark in scene.all_marks() if mark.fill is not None and mark.alpha == 1]
    colors += [rgba(label.color)[:3] for label in scene.labels if label.part in ("field", "plan")]
    levels = [(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), *dict.fromkeys(colors)]
    return [(round(r * 255), round(g * 255), round(b * 255)) for r, g, b in levels]


def hint_colors(scene: Scene, tokens: Iterable[str]) -> list[tuple[int, int, int]]:
    """Return the colours (0..255) that a reduced palette must keep of a picture that is drawn with a table of colours.

    These are the colours of the table that the picture has, and the other opaque colours of its bodies and lines.
    """
    marks = [mark for mark in scene.all_marks() if mark.alpha == 1]
    used = [mark.fill for mark in marks] + [mark.stroke.color for mark in marks if mark.part != "trajectory"]
    used += [label.color for label in scene.labels]
    levels = dict.fromkeys(rgba(color)[:3] for color in used if color is not None)
    first = [rgba(token)[:3] for token in tokens if rgba(token)[:3] in levels]
    ordered = dict.fromkeys([*first, *levels])
    return [(round(r * 255), round(g * 255), round(b * 255)) for r, g, b in ordered]


def _shorten(values: list[Any]) -> list[Any]:
    """Return only the first value if all are equal: collections repeat the values of a list that is too short."""
    return values[:1] if all(value == values[0] for value in values) else values


def _colors(colors: Sequence[Color | None], alphas: Sequence[float]) -> Any:
    """Return (N, 4) RGBA, with None as transparent.

    If all colours are None, the array is (0, 4), and Matplotlib draws nothing.
    """
    if all(color is None for color in colors):
        return np.empty((0, 4))
    levels = [_TRANSPARENT if c is None else rgba(c, a) for c, a in zip(colors, alphas, strict=True)]
    return np.array(levels, dtype=np.float64)
