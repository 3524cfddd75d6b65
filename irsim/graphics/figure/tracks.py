"""Layers of tracks: only what came new since the last frame is drawn, onto what stands.

A layer keeps pixels of its own: trails in one transparent image, to which new snapshots are added in the order of
time; lines as one mask of coverage each, because a translucent line that crosses itself is nowhere darker. The artist
of a layer draws the same for every other canvas, such as a PDF.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from irsim.graphics.figure.brush import paint, prepare
from irsim.graphics.figure.canvas import Box, Canvas, around, rgba
from irsim.graphics.figure.layers import PARTS, MarkLayer
from irsim.graphics.scene.scene import Mark
from irsim.graphics.scene.tracks import GrowingLine, GrowingTrail, Track

__all__ = ["LineLayer", "PixelLayer", "TrailLayer", "track_layers"]

PixelLayer = tuple[NDArray[np.uint8], int, int, tuple[float, float, float], float]
"""An image (h, w, 4) or a mask (h, w), left, top, and colour (0..255) and opacity (0..1) of the mask."""
_OVERLAP = 2
"""Number of segments of a line that are drawn again with its new ones, so that no joint shows."""
_ALIGNED_PX = 1e-4
"""Deviation up to which Agg takes a segment for horizontal or vertical."""
MAX_MASKS = 200
"""Lines of more objects are drawn again in every frame, because their masks would take too much memory."""
_OPAQUE = 255.0


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
        shown = set(self._tracks)
        if not shown.issuperset(self._masks):
            self._masks = {line: mask for line, mask in self._masks.items() if line in shown}
            return [canvas.clip, *self._extend(canvas)]
        return self._extend(canvas)

    def _extend(self, canvas: Canvas) -> list[Box]:
        boxes = []
        for line in self._tracks:
            mask = self._masks.get(line)
            if mask is None:
                color = rgba(line.color, line.alpha) if line.color is not None else (0.0, 0.0, 0.0, 0.0)
                mask = self._masks[line] = _Mask(canvas, color)
            if mask.count < line.count:
                boxes += mask.extend(canvas, line, self._scale, self._round)
        return boxes

    def layers(self) -> list[PixelLayer]:
        """Return the layer as masks with their colours."""
        result = []
        for line in self._tracks:
            mask = self._masks[line]
            if mask.box is not None:
                left, top, right, bottom = mask.box
                result.append((mask.coverage[top:bottom, left:right], left, top, mask.color, mask.alpha))
        return result

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
        self.color = color[0] * _OPAQUE, color[1] * _OPAQUE, color[2] * _OPAQUE
        self.alpha = color[3]
        self._aligned = True  # Agg draws lines along the axes of the picture at whole pixels
        self.box: Box | None = None

    def extend(self, canvas: Canvas, line: GrowingLine, scale: float, round_caps: bool) -> list[Box]:
        """Draw the new points of the line; return where that was."""
        start = max(0, self.count - 1 - _OVERLAP)
        points = line.points[start:]
        at_rest = self.count > 0 and bool((points[self.count - 1 - start :] == points[self.count - 1 - start]).all())
        self.count = line.count
        if at_rest or len(points) < 2:
            return []
        boxes = []
        if self._aligned and not _is_aligned(canvas.to_pixels(points)):
            self._aligned = False
            if start > 0 and self.box is not None:
                boxes, self.box = [self.box], None
                self.coverage = np.zeros_like(self.coverage)
                points = line.points
        width = line.stroke.width * (scale if line.stroke.metric else 1.0) * canvas.px_per_point
        box = canvas.painter.line_mask(self.coverage, points, width, round_caps, self._aligned)
        if box is None:
            return boxes
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
            self._renderer = canvas.new_renderer()
            self._image = np.asarray(self._renderer.buffer_rgba())
        new = _in_order_of_time(self._tracks, self._drawn)
        self._drawn = {trail: len(trail.snapshots) for trail in self._tracks}
        boxes = [canvas.clip] if gone else []
        if new:
            canvas.painter.take_boxes()
            canvas.unknown = False
            work, _ = prepare(new, self._scale)
            paint(canvas, (self._image, self._renderer), self._ax, work, ("butt", "miter"))
            painted = [canvas.clip] if canvas.unknown else canvas.painter.take_boxes()
            self._box = around([*([] if self._box is None else [self._box]), *painted])
            boxes += painted
        return boxes

    def layers(self) -> list[PixelLayer]:
        """Return the layer as an image."""
        if self._box is None:
            return []
        left, top, right, bottom = self._box
        return [(self._image[top:bottom, left:right], left, top, (0.0, 0.0, 0.0), 1.0)]

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


def _is_aligned(pixels: NDArray[np.float64]) -> bool:
    """Whether each segment of a line (N, 2) runs along an axis of the picture."""
    return bool((np.abs(np.diff(pixels, axis=0)) < _ALIGNED_PX).any(axis=1).all())
