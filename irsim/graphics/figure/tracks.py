"""Layers of tracks: only what came new since the last frame is drawn, onto what stands.

A layer keeps pixels of its own: trails in one transparent image, to which new snapshots are added in the order of
time; lines as one mask of coverage each, because a translucent line that crosses itself is nowhere darker. `blend` lays
a part of the layer over a picture. The artist of a layer draws the same for every other canvas, such as that of a PDF.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.path import Path
from matplotlib.transforms import IdentityTransform
from numpy.typing import NDArray

from irsim.graphics.figure.layers import PARTS, MarkLayer, paint, rgba
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Mark
from irsim.graphics.scene.tracks import GrowingLine, GrowingTrail, Track

__all__ = ["Box", "Canvas", "LineLayer", "TrailLayer", "around", "common", "lay_over", "part_of", "track_layers"]

Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of a canvas [px], top row first."""
_MARGIN_PX = 2
"""Margin around what is drawn, for antialiased edges."""
_OVERLAP = 2
"""Number of segments of a line that are drawn again with its new ones, so that no joint shows."""
_ALIGNED_PX = 1e-4
"""Deviation up to which Agg takes a segment for horizontal or vertical."""
MAX_MASKS = 200
"""Lines of more objects are drawn again in every frame, because their masks would take too much memory."""
_POINTS_PER_INCH = 72.0
_OPAQUE = 255.0


class Canvas:
    """The canvas that layers draw for: its size, its resolution and its view of the world.

    Attributes:
        key: Differs between canvases on which the same track has other pixels.
        box: The area of the axes.
    """

    def __init__(self, ax: Axes, size: tuple[int, int]) -> None:
        figure: Any = ax.figure
        self.width, self.height = size
        self.dpi = float(figure.dpi)
        self.matrix: NDArray[np.float64] = ax.transData.get_matrix()
        self.clip = ax.bbox.frozen()
        self.key = (size, self.dpi, self.matrix.tobytes(), self.clip.bounds)
        self.box = self.within(self.clip.x0, self.clip.y0, self.clip.x1, self.clip.y1)

    def within(self, left: float, bottom: float, right: float, top: float, margin: float = 0.0) -> Box:
        """Return the pixels that a box (from the lower left corner of the canvas) with a margin touches."""
        return (
            min(self.width, max(0, math.floor(left - margin))),
            min(self.height, max(0, math.floor(self.height - top - margin))),
            max(0, min(self.width, math.ceil(right + margin))),
            max(0, min(self.height, math.ceil(self.height - bottom + margin))),
        )

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert points (N, 2) of the world to pixels from the lower left corner."""
        return np.asarray(points @ self.matrix[:2, :2].T + self.matrix[:2, 2])

    def renderer(self) -> Any:
        """Return a transparent canvas of the same size."""
        new: Any = RendererAgg
        return new(self.width, self.height, self.dpi)


class LineLayer:
    """Lines of one zorder and kind of ends.

    Attributes:
        artist: Draws them on any canvas.
    """

    def __init__(self, ax: Axes, zorder: float, round_caps: bool) -> None:
        self._marks = MarkLayer(ax, (zorder, PARTS.index("trajectory"), round_caps))
        self.artist = self._marks.artist
        self.artist.before = self._collect
        self._round = round_caps
        self._tracks: list[GrowingLine] = []
        self._scale = 0.0
        self._forget(None)

    def _forget(self, key: Any) -> None:
        self._key = key
        self._masks: dict[GrowingLine, _Mask] = {}
        self._scratch: Any = None
        self._brush: Any = None

    @property
    def growing(self) -> bool:
        """Whether the layer can keep its pixels."""
        return len(self._tracks) <= MAX_MASKS

    def show(self, tracks: Sequence[Any], points_per_metre: float) -> None:
        """Show exactly these lines."""
        self._tracks, self._scale = list(tracks), points_per_metre
        self.artist.set_visible(bool(tracks))

    def _collect(self) -> None:
        self._marks.show([mark for line in self._tracks for mark in line.marks()], self._scale)

    def update(self, canvas: Canvas) -> list[Box]:
        """Draw what came new.

        Returns:
            The boxes in which the layer has changed.
        """
        if canvas.key != self._key:
            self._forget(canvas.key)
            self._scratch = canvas.renderer()
            self._brush = self._scratch.new_gc()
            self._brush.set_foreground((1.0, 1.0, 1.0, 1.0), isRGBA=True)
            self._brush.set_capstyle("round" if self._round else "butt")
            self._brush.set_joinstyle("round")
            self._brush.set_clip_rectangle(canvas.clip)
        shown = set(self._tracks)
        if not shown.issuperset(self._masks):
            self._masks = {line: mask for line, mask in self._masks.items() if line in shown}
            return [canvas.box, *self._extend(canvas)]
        return self._extend(canvas)

    def _extend(self, canvas: Canvas) -> list[Box]:
        boxes = []
        for line in self._tracks:
            mask = self._masks.get(line)
            if mask is None:
                color = rgba(line.color, line.alpha) if line.color is not None else (0.0, 0.0, 0.0, 0.0)
                mask = self._masks[line] = _Mask(canvas, color)
            if mask.count < line.count:
                boxes += mask.extend(canvas, self._scratch, self._brush, line, self._scale)
        return boxes

    def blend(self, patch: NDArray[np.float32], box: Box) -> None:
        """Lay the layer over a patch (h, w, 3) of a picture."""
        for line in self._tracks:
            mask = self._masks[line]
            if mask.box is None or (shared := common(mask.box, box)) is None:
                continue
            left, top, right, bottom = shared
            covered = mask.coverage[top:bottom, left:right]
            if covered.any():
                _over(part_of(patch, box, shared), mask.color, covered * np.float32(mask.alpha / _OPAQUE))

    @property
    def boxes(self) -> list[Box]:
        """Boxes outside of which the layer is empty."""
        return [mask.box for mask in self._masks.values() if mask.box is not None]


class _Mask:
    """Coverage of one line.

    Attributes:
        count: Number of points drawn.
        coverage: (H, W) 0..255; memory is taken only where it is not 0.
        box: Where it is not 0, or None.
    """

    def __init__(self, canvas: Canvas, color: tuple[float, float, float, float]) -> None:
        self.count = 0
        self.coverage: NDArray[np.uint8] = np.zeros((canvas.height, canvas.width), np.uint8)
        self.color: NDArray[np.float32] = np.array(color[:3], np.float32) * np.float32(_OPAQUE)
        self.alpha = color[3]
        self._aligned = True  # Agg draws lines along the axes of the picture at whole pixels
        self.box: Box | None = None

    def extend(self, canvas: Canvas, scratch: Any, brush: Any, line: GrowingLine, scale: float) -> list[Box]:
        """Draw the new points of the line; return where that was."""
        start = max(0, self.count - 1 - _OVERLAP)
        points = line.points[start:]
        at_rest = self.count > 0 and bool((points[self.count - 1 - start :] == points[self.count - 1 - start]).all())
        self.count = line.count
        if at_rest or len(points) < 2:
            return []
        pixels = canvas.pixels(points)
        boxes = []
        if self._aligned and not _is_aligned(pixels):
            self._aligned = False
            if start > 0 and self.box is not None:
                boxes, self.box = [self.box], None
                self.coverage = np.zeros_like(self.coverage)
                pixels = canvas.pixels(line.points)
        stroke = line.stroke
        width = stroke.width * (scale if stroke.metric else 1.0)
        reach = width / 2 * canvas.dpi / _POINTS_PER_INCH + _MARGIN_PX
        (x0, y0), (x1, y1) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
        box = common(canvas.within(x0, y0, x1, y1, reach), canvas.box)
        if box is None:
            return boxes
        brush.set_linewidth(width)
        brush.set_snap(None if self._aligned else False)
        scratch.draw_path(brush, Path(pixels), IdentityTransform())
        left, top, right, bottom = box
        drawn = np.asarray(scratch.buffer_rgba())[top:bottom, left:right, 3]
        covered = self.coverage[top:bottom, left:right]
        np.maximum(covered, drawn, out=covered)
        drawn[...] = 0
        self.box = around([box, self.box or box])
        return [*boxes, box]


class TrailLayer:
    """Snapshots of one zorder, the earlier ones below the later ones.

    Attributes:
        artist: Draws them on any canvas.
    """

    growing = True

    def __init__(self, ax: Axes, zorder: float) -> None:
        self._ax = ax
        self._marks = MarkLayer(ax, (zorder, PARTS.index("trail"), False))
        self.artist = self._marks.artist
        self.artist.before = self._collect
        self._tracks: list[GrowingTrail] = []
        self._scale = 0.0
        self._forget(None)

    def _forget(self, key: Any) -> None:
        self._key = key
        self._drawn: dict[GrowingTrail, int] = {}
        self._renderer: Any = None
        self._image: NDArray[np.uint8] = np.empty((0, 0, 4), np.uint8)
        self._box: Box | None = None

    def show(self, tracks: Sequence[Any], points_per_metre: float) -> None:
        """Show exactly these trails."""
        self._tracks, self._scale = list(tracks), points_per_metre
        self.artist.set_visible(bool(tracks))

    def _collect(self) -> None:
        self._marks.show(_in_order_of_time(self._tracks, {}), self._scale)

    def update(self, canvas: Canvas) -> list[Box]:
        """Draw what came new.

        Returns:
            The boxes in which the layer has changed.
        """
        gone = canvas.key != self._key or not set(self._tracks).issuperset(self._drawn)
        if gone:
            self._forget(canvas.key)
            self._renderer = canvas.renderer()
            self._image = np.asarray(self._renderer.buffer_rgba())
        new = _in_order_of_time(self._tracks, self._drawn)
        self._drawn = {trail: len(trail.snapshots) for trail in self._tracks}
        if new:
            paint(self._renderer, self._ax, new, self._scale, ("butt", "miter"))
        boxes = [box for box in (_mark_box(mark, canvas) for mark in new) if box is not None]
        self._box = around([*([] if self._box is None else [self._box]), *boxes])
        return [canvas.box] if gone else boxes

    def blend(self, patch: NDArray[np.float32], box: Box) -> None:
        """Lay the layer over a patch (h, w, 3) of a picture."""
        if self._box is not None and (shared := common(self._box, box)) is not None:
            lay_over(part_of(patch, box, shared), self._image, shared)

    @property
    def boxes(self) -> list[Box]:
        """Boxes outside of which the layer is empty."""
        return [] if self._box is None else [self._box]


def track_layers(
    ax: Axes, known: dict[tuple[Any, ...], LineLayer | TrailLayer], tracks: Sequence[Track], points_per_metre: float
) -> None:
    """Distribute tracks to layers, which are made when they are needed.

    Args:
        ax: Axes in world coordinates.
        known: The layers, by zorder, part and ends of lines; new ones are added.
        tracks: All tracks that are shown.
        points_per_metre: Scale of the view, for line widths given in metres.
    """
    groups: dict[tuple[Any, ...], list[Track]] = {key: [] for key in known}
    for track in tracks:
        caps = isinstance(track, GrowingLine) and track.stroke.round_caps
        groups.setdefault((float(track.zorder), track.part, caps), []).append(track)
    for key, members in groups.items():
        if key not in known:
            known[key] = LineLayer(ax, key[0], key[2]) if key[1] == "trajectory" else TrailLayer(ax, key[0])
        known[key].show(members, points_per_metre)


def _in_order_of_time(trails: Sequence[GrowingTrail], drawn: Mapping[GrowingTrail, int]) -> list[Mark]:
    """Return the snapshots that have not been drawn, earlier steps first, then in the order of the trails."""
    new = [
        (index * trail.every, rank, trail.snapshots[index])
        for rank, trail in enumerate(trails)
        for index in range(drawn.get(trail, 0), len(trail.snapshots))
    ]
    return [mark for _, _, mark in sorted(new, key=lambda entry: entry[:2])]


def _mark_box(mark: Mark, canvas: Canvas) -> Box | None:
    x0, y0, x1, y1 = bounds(mark.geometry)
    corners = canvas.pixels(np.array([(x0, y0), (x1, y1)]))
    margin = mark.stroke.width * canvas.dpi / _POINTS_PER_INCH + _MARGIN_PX
    (left, bottom), (right, top) = corners.tolist()
    return common(canvas.within(left, bottom, right, top, margin), canvas.box)


def _is_aligned(pixels: NDArray[np.float64]) -> bool:
    """Whether each segment of a line (N, 2) runs along an axis of the picture."""
    return bool((np.abs(np.diff(pixels, axis=0)) < _ALIGNED_PX).any(axis=1).all())


def part_of(patch: NDArray[np.float32], box: Box, part: Box) -> NDArray[np.float32]:
    """Return the part of a patch that shows ``box`` that lies in a smaller box."""
    left, top = box[:2]
    return patch[part[1] - top : part[3] - top, part[0] - left : part[2] - left]


def around(boxes: Sequence[Box]) -> Box | None:
    """Return the box around others; None without others."""
    if not boxes:
        return None
    lefts, tops, rights, bottoms = zip(*boxes, strict=True)
    return min(lefts), min(tops), max(rights), max(bottoms)


def common(box: Box, other: Box) -> Box | None:
    """Return the part that two boxes share, or None."""
    left, top, right, bottom = (
        max(box[0], other[0]), max(box[1], other[1]), min(box[2], other[2]), min(box[3], other[3])
    )  # fmt: skip
    return (left, top, right, bottom) if left < right and top < bottom else None


def lay_over(patch: NDArray[np.float32], image: NDArray[np.uint8], box: Box) -> None:
    """Lay a part of a transparent image (H, W, 4) over a patch (h, w, 3)."""
    left, top, right, bottom = box
    part = image[top:bottom, left:right]
    if part[..., 3].any():
        _over(patch, part[..., :3].astype(np.float32), part[..., 3] * np.float32(1 / _OPAQUE))


def _over(patch: NDArray[np.float32], color: NDArray[np.float32], alpha: NDArray[np.float32]) -> None:
    """Lay a colour, (3,) or (h, w, 3), with an opacity (h, w) of 0..1 over a patch (h, w, 3)."""
    patch += (color - patch) * alpha[..., None]
