"""The background of a frame: sheets one above the other, put together again only where one of them has changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from numpy.typing import NDArray

from irsim import _core as core
from irsim.graphics.figure.canvas import Box, Canvas
from irsim.graphics.figure.tracks import LineLayer, PixelLayer, TrailLayer

__all__ = ["Background", "Resting", "Sheet", "TrackLayer"]

TrackLayer = LineLayer | TrailLayer
_NO_COLOR = (0.0, 0.0, 0.0)


class Resting:
    """A sheet of artists that do not change."""

    def __init__(self) -> None:
        self._artists: list[tuple[Artist, int]] = []
        self._image: NDArray[np.uint8] | None = None
        self._box: Box | None = None

    def add(self, artist: Artist, version: int) -> None:
        """Put an artist on top of the sheet."""
        self._artists.append((artist, version))

    @property
    def key(self) -> tuple[Any, ...]:
        """Differs between sheets that look different."""
        return tuple((id(artist), version) for artist, version in self._artists)

    def keep(self, earlier: Resting) -> None:
        """Take over the pixels of a sheet with the same key."""
        self._image, self._box = earlier._image, earlier._box

    def update(self, canvas: Canvas) -> list[Box]:
        """Draw the artists if that has not been done; see :meth:`irsim.graphics.figure.tracks.TrailLayer.update`."""
        if self._image is not None:
            return []
        renderer = canvas.scratch()
        for artist, _ in self._artists:
            artist.draw(renderer)
        drawn = np.asarray(renderer.buffer_rgba())
        self._box = core.opaque_box(drawn)
        left, top, right, bottom = self._box or (0, 0, 0, 0)
        self._image = drawn[top:bottom, left:right].copy()
        drawn[top:bottom, left:right] = 0
        return self.boxes

    @property
    def boxes(self) -> list[Box]:
        """Boxes outside of which the sheet is empty."""
        return [] if self._box is None else [self._box]

    def lay_over(self, canvas: Canvas) -> None:
        """Lay the sheet over the canvas."""
        self.update(canvas)
        for image, left, top, _, _ in self.layers():
            canvas.painter.image(canvas.pixels, image, left, top)

    def layers(self) -> list[PixelLayer]:
        """Return the sheet as an image."""
        if self._box is None or self._image is None:
            return []
        return [(self._image, self._box[0], self._box[1], _NO_COLOR, 1.0)]


Sheet = Resting | LineLayer | TrailLayer


class Background:
    """The picture below the moving things, as pixels."""

    def __init__(self) -> None:
        self._pixels: NDArray[np.uint8] | None = None
        self._furniture: NDArray[np.uint8] | None = None
        self._sheets: list[Sheet] = []
        self._key: Any = None

    def update(
        self, furniture: NDArray[np.uint8], sheets: Sequence[Sheet], canvas: Canvas
    ) -> tuple[NDArray[np.uint8], list[Box] | None]:
        """Put the background together.

        Args:
            furniture: (height, width, 4) pixels below the sheets; another array if they have changed.
            sheets: The sheets, the lowest first.
            canvas: The canvas.

        Returns:
            The (height, width, 4) pixels of the sheets over the furniture, which must not be changed, and the boxes
            outside of which they are as before; None if they are new.
        """
        if not sheets:
            same = furniture is self._furniture and not self._sheets
            self._pixels, self._furniture, self._sheets = None, furniture, []
            return furniture, [] if same else None
        same = (
            self._pixels is not None
            and furniture is self._furniture
            and canvas.key == self._key
            and [_identity(sheet) for sheet in sheets] == [_identity(sheet) for sheet in self._sheets]
        )
        if same:
            for sheet, earlier in zip(sheets, self._sheets, strict=True):
                if isinstance(sheet, Resting) and isinstance(earlier, Resting):
                    sheet.keep(earlier)
        boxes = [box for sheet in sheets for box in sheet.update(canvas)]
        if not same or self._pixels is None:
            self._pixels = furniture.copy()
            boxes = [box for sheet in sheets for box in sheet.boxes]
        self._furniture, self._sheets, self._key = furniture, list(sheets), canvas.key
        if boxes:
            core.compose(self._pixels, furniture, boxes, [layer for sheet in sheets for layer in sheet.layers()])
        return self._pixels, boxes if same else None


def _identity(sheet: Sheet) -> Any:
    return sheet.key if isinstance(sheet, Resting) else id(sheet)
