"""Draws a figure into pixels, fast.

The axes and the layers that no longer change are drawn once and kept as a background; the other layers are drawn over a
copy of it. Tracks, which only grow, are part of the background too: where they have grown, it is put together again
from its sheets. The drawing order is Matplotlib's (by zorder), so a frame looks as ``figure.canvas.draw()`` would draw
it. For that reason only layers below the lowest changing one can be part of the background.

"Furniture" is what surrounds the scene: the paper, both axes with ticks and labels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, TypeGuard

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from irsim import _core as core
from irsim.graphics.encoding.pixels import Pixels
from irsim.graphics.figure.background import Background, Resting, Sheet, TrackLayer
from irsim.graphics.figure.canvas import Box, Canvas
from irsim.graphics.figure.glyphs import QuickText
from irsim.graphics.figure.image_layers import FogImage
from irsim.graphics.figure.layers import MarkArtist, Spokes

__all__ = ["Compositor"]

MIN_RESTING_SCENES = 2
"""Number of scenes without a change after which a layer becomes part of the background."""
MAX_CHANGES = 1000
"""Number of boxes that may have changed, above which all pixels count as changed."""


class Compositor:
    """Draws a figure that has a single axes.

    Args:
        figure: The figure; its canvas must be an Agg canvas (all of Matplotlib's usual windows have one).
        ax: The only axes of the figure.
    """

    def __init__(self, figure: Figure, ax: Axes) -> None:
        self.figure = figure
        self.ax = ax
        self._new: tuple[Any, tuple[Any, ...], Bbox | None] | None = None
        self._options: dict[str, Any] = {}
        self._spine_version = 0
        self.forget()

    def settle(self) -> None:
        """Note that the axes are as a new figure has them; the first furniture of such axes serves again."""
        options: dict[str, Any] = {str(name): value for name, value in dict.items(matplotlib.rcParams)}
        if options != self._options:
            self._new, self._options = None, options
        if self._new is not None:
            self._keep(*self._new)
        for part in self._parts():
            part.stale = False

    def _keep(self, furniture: Any, key: tuple[Any, ...] | None, box: Bbox | None) -> None:
        self._furniture, self._furniture_key, self._furniture_box = furniture, key, box

    def _parts(self) -> tuple[Artist, ...]:
        """Return the artists that make up the furniture; a change by a script makes one of them stale."""
        ax = self.ax
        return (ax.xaxis.label, ax.yaxis.label, ax.xaxis, ax.yaxis, ax.patch, self.figure.patch)

    def forget(self) -> None:
        """Drop the kept background: the next frame is drawn from scratch."""
        self._keep(None, None, None)
        self._background = Background()
        self._view: Canvas | None = None
        self._drawn: list[Box] | None = None
        self._changes: list[Box] | None = None
        self._spines: dict[Artist, Resting] = {}
        self._spine_key: tuple[Any, ...] | None = None

    def draw(self, versions: Mapping[Artist, tuple[int, int]], tracks: Mapping[Artist, TrackLayer]) -> None:
        """Draw everything into the canvas.

        Args:
            versions: Artist -> (version, number of scenes without a change). Artists that are not listed are drawn in
                every frame.
            tracks: Artist -> layer of the artists that only grow.
        """
        canvas, ax = self._canvas(), self.ax
        if len(self.figure.axes) != 1 or self.figure.texts or self.figure.artists or self.figure.legends:
            self.draw_without_cache()
            return
        spines = tuple(ax.spines.values())
        furniture: tuple[Artist, ...] = (ax.xaxis, ax.yaxis, ax.patch, *(() if ax.axison else spines))
        artists = [a for a in ax.get_children() if a.get_visible() and a not in furniture and not _is_empty(a)]
        artists.sort(key=lambda artist: artist.get_zorder())
        self._draw_furniture(canvas)
        frame = self._spine_sheets(spines)
        self._view = view = Canvas(ax, canvas.get_renderer(), self._view)
        sheets: list[Sheet] = []
        drawn = 0
        for artist in artists:
            version, resting_scenes = versions.get(artist, (0, 0))
            if artist in frame:
                sheets.append(frame[artist])
            elif (layer := tracks.get(artist)) is not None and layer.growing:
                sheets.append(layer)
            elif resting_scenes >= MIN_RESTING_SCENES:
                below = sheets[-1] if sheets else None
                sheet = below if isinstance(below, Resting) and below not in frame.values() else Resting()
                sheet.add(artist, version)
                sheets += [] if sheet is below else [sheet]
            else:
                break
            drawn += 1
        covers = [artist for artist in artists[drawn:] if _covers(artist)]
        resting = [artist for artist in covers if versions[artist][1] >= MIN_RESTING_SCENES]
        covers = resting if covers[:1] == resting[:1] else []  # what lies on the page rests on a page that rests
        if covers:  # covered in the background, and again in frames in which something reaches below them
            sheets.append(page := Resting())
            for artist in covers:
                page.add(artist, versions[artist][0])
        ground, changed = self._background.update(self._furniture, sheets, view)
        if changed is None or self._drawn is None:
            view.pixels[...] = ground
            self._note_change(None)
        else:
            core.copy_boxes(ground, view.pixels, [*self._drawn, *changed])
            self._note_change([*self._drawn, *changed])
        view.painter.take_boxes()
        view.unknown = False
        painted, reached = list[Box](), False
        for artist in artists[drawn:]:
            if artist in covers and not view.unknown:
                painted += view.painter.take_boxes()
                reached = reached or (isinstance(artist, MarkArtist) and artist.is_reached(view, painted))
                if not reached:
                    continue
            if artist in frame:
                frame[artist].lay_over(view)
            elif not (isinstance(artist, MarkArtist | Spokes | QuickText | FogImage) and artist.paint_on(view)):
                view.unknown = True
                artist.draw(view.renderer)
        self._drawn = None if view.unknown else painted + view.painter.take_boxes()
        self._note_change(self._drawn)

    def _note_change(self, boxes: list[Box] | None) -> None:
        """Note where the pixels may have changed; None for everywhere."""
        changes = self._changes
        self._changes = None if boxes is None or changes is None or len(changes) > MAX_CHANGES else changes + boxes

    def take_changes(self) -> list[Box] | None:
        """Return the boxes outside of which the pixels are as when this was last asked; None if all may differ."""
        changes, self._changes = self._changes, []
        return changes

    def _spine_sheets(self, spines: Sequence[Artist]) -> dict[Artist, Resting]:
        """Return the spines as sheets, which are drawn again only if a script or the view has changed them."""
        if self._furniture_key != self._spine_key:
            self._spines, self._spine_key = {}, self._furniture_key
        for spine in spines:
            if spine.stale or spine not in self._spines:
                self._spine_version += 1
                spine.stale = False
                self._spines[spine] = Resting()
                self._spines[spine].add(spine, self._spine_version)
        return self._spines

    def draw_without_cache(self) -> None:
        """Let Matplotlib draw everything, and keep no background."""
        draw_all: Any = FigureCanvasAgg.draw
        draw_all(self._canvas())
        self.forget()

    def _canvas(self) -> Any:
        if not isinstance(self.figure.canvas, FigureCanvasAgg):
            FigureCanvasAgg(self.figure)  # pyplot replaces the canvas of a window that is closed
        return self.figure.canvas

    def _draw_furniture(self, canvas: Any) -> None:
        ax, figure = self.ax, self.figure
        # Unless the axes fill their place, this applies the aspect, too, after which all transforms are made again.
        position = ax.get_position(original=ax.get_aspect() == "auto").bounds
        key = (*figure.get_size_inches(), figure.dpi, *ax.get_xlim(), *ax.get_ylim(), *position, ax.axison)
        parts = (ax.patch, ax.xaxis, ax.yaxis) if ax.axison else ()
        is_changed = any(part.stale for part in self._parts())
        if self._furniture is not None and key == self._furniture_key and not is_changed:
            return
        renderer = canvas.get_renderer()
        renderer.clear()
        self._drawn = None
        figure.patch.draw(renderer)
        for part in parts:
            part.draw(renderer)
        self._furniture, self._furniture_key = np.array(renderer.buffer_rgba()), key
        boxes = [part.get_tightbbox(renderer) for part in parts[1:]]
        self._furniture_box = Bbox.union([ax.bbox, *[box for box in boxes if box is not None]])
        if not is_changed and self._new is None:
            self._new = self._furniture, key, self._furniture_box
        for changed in self._parts():
            changed.stale = False

    def tight_box(self, pad_inches: float) -> tuple[int, int, int, int]:
        """Return the padded bounding box (left, top, right, bottom) [px] of the drawing, clipped to the figure.

        The figure must have been drawn before.
        """
        if self._furniture_box is None:
            renderer = self._canvas().get_renderer()
            inches = self.figure.get_tightbbox(renderer)
            box = Bbox(inches.get_points() * self.figure.dpi)
        else:
            boxes = [self._furniture_box]
            renderer = self._canvas().get_renderer()
            for artist in self.ax.get_children():
                if artist.get_visible() and not _is_inside(artist, self.ax):
                    result = artist.get_tightbbox(renderer)
                    if result is not None and math.isfinite(result.width) and math.isfinite(result.height):
                        boxes.append(result)
            box = Bbox.union(boxes)
        width, height = self.size
        pad = pad_inches * self.figure.dpi
        left, right = max(0, math.floor(box.x0 - pad)), min(width, math.ceil(box.x1 + pad))
        top, bottom = max(0, math.floor(height - box.y1 - pad)), min(height, math.ceil(height - box.y0 + pad))
        return left, top, right, bottom

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the canvas [px]."""
        width, height = self._canvas().get_width_height(physical=True)
        return int(width), int(height)

    def pixels(self, crop: tuple[int, int, int, int] | None = None) -> Pixels:
        """Return the last drawn frame; the next one is drawn into the same memory.

        Args:
            crop: Box to cut out: left, top, right, bottom [px].
        """
        rgba = np.asarray(self._canvas().buffer_rgba())
        if crop is not None:
            rgba = rgba[crop[1] : crop[3], crop[0] : crop[2]]
        return rgba


def _covers(artist: Artist) -> TypeGuard[MarkArtist | QuickText]:
    return isinstance(artist, MarkArtist | QuickText) and artist.covers


def _is_empty(artist: Artist) -> bool:
    """Whether an artist is a text without words."""
    return isinstance(artist, Text) and not artist.get_text()


def _is_inside(artist: Artist, ax: Axes) -> bool:
    """Whether an artist cannot reach beyond the area that the axes themselves cover."""
    if artist in (ax.xaxis, ax.yaxis, ax.patch) or artist in ax.spines.values():
        return True
    if isinstance(artist, QuickText):
        return artist is not ax.title
    return artist.get_clip_on() and (artist.get_clip_box() is not None or artist.get_clip_path() is not None)
