"""The background of a frame: sheets one above the other, put together again only where one of them has changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from numpy.typing import NDArray

from irsim.graphics.encoding.pixels import changed_box
from irsim.graphics.figure.tracks import Box, Canvas, LineLayer, TrailLayer, around, common, lay_over, part_of

__all__ = ["Background", "Resting", "Sheet", "TrackLayer"]

TrackLayer = LineLayer | TrailLayer


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
        renderer = canvas.renderer()
        for artist, _ in self._artists:
            artist.draw(renderer)
        self._image = np.asarray(renderer.buffer_rgba())
        opaque = self._image[..., 3] > 0
        self._box = changed_box(opaque) if opaque.any() else None
        return self.boxes

    @property
    def boxes(self) -> list[Box]:
        """Boxes outside of which the sheet is empty."""
        return [] if self._box is None else [self._box]

    def blend(self, patch: NDArray[np.float32], box: Box) -> None:
        """Lay the sheet over a patch (h, w, 3) of a picture."""
        assert self._image is not None
        if self._box is not None and (shared := common(self._box, box)) is not None:
            lay_over(part_of(patch, box, shared), self._image, shared)


Sheet = Resting | LineLayer | TrailLayer


class Background:
    """What lies below the moving things, as pixels."""

    def __init__(self) -> None:
        self._pixels: NDArray[np.uint8] | None = None
        self._furniture: NDArray[np.uint8] | None = None
        self._sheets: list[Sheet] = []
        self._key: Any = None

    def update(self, furniture: NDArray[np.uint8], sheets: Sequence[Sheet], canvas: Canvas) -> NDArray[np.uint8]:
        """Return the (height, width, 4) pixels of the sheets over the furniture, which must not be changed.

        Args:
            furniture: (height, width, 4) pixels below the sheets; another array if they have changed.
            sheets: The sheets, the lowest first.
            canvas: The canvas.
        """
        if not sheets:
            self._pixels, self._sheets = None, []
            return furniture
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
        for box in _merged(boxes):
            left, top, right, bottom = box
            patch = furniture[top:bottom, left:right, :3].astype(np.float32)
            for sheet in sheets:
                sheet.blend(patch, box)
            patch += 0.5  # rounds to the nearest level
            self._pixels[top:bottom, left:right, :3] = patch
        return self._pixels


def _identity(sheet: Sheet) -> Any:
    return sheet.key if isinstance(sheet, Resting) else id(sheet)


def _merged(boxes: Sequence[Box]) -> list[Box]:
    """Replace boxes that overlap by one around both."""
    merged: list[Box] = []
    for box in boxes:
        left, top, right, bottom = box
        apart = []
        for other in merged:
            if other[0] < right and left < other[2] and other[1] < bottom and top < other[3]:
                left, top, right, bottom = around([other, (left, top, right, bottom)]) or other
            else:
                apart.append(other)
        merged = [*apart, (left, top, right, bottom)]
    return merged
