"""Frames as arrays of pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image

__all__ = ["Pixels", "changed_box", "differing", "even", "fit", "from_image", "to_image"]

Pixels = NDArray[np.uint8]
"""(H, W, 4) red, green, blue and a byte without meaning (always 255)."""

_WHITE = 255


def changed_box(changed: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Left, top, right, bottom of the True cells of (H, W); the first pixel when there is none."""
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    if not rows.size:
        return 0, 0, 1, 1
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def differing(before: Pixels, after: Pixels) -> NDArray[np.bool_]:
    """(H, W) whether a pixel changed between two frames of one size."""
    words: NDArray[np.bool_] = before.view(np.uint32)[..., 0] != after.view(np.uint32)[..., 0]
    return words


def to_image(pixels: Pixels) -> Image.Image:
    """An RGB image."""
    height, width = pixels.shape[:2]
    return Image.frombytes("RGB", (width, height), pixels.tobytes(), "raw", "RGBX")


def from_image(image: Image.Image) -> Pixels:
    """Pixels of an image of any mode; transparency is put on white."""
    if "A" in image.getbands() or "transparency" in image.info:
        image = Image.alpha_composite(Image.new("RGBA", image.size, "white"), image.convert("RGBA"))
    return np.array(image.convert("RGB").convert("RGBA"))


def fit(pixels: Pixels, width: int, height: int) -> Pixels:
    """Cut off at the right and bottom, or padded with white there, to a size [px]."""
    have_height, have_width = pixels.shape[:2]
    if (have_width, have_height) == (width, height):
        return pixels
    out = np.full((height, width, 4), _WHITE, np.uint8)
    part = pixels[:height, :width]
    out[: part.shape[0], : part.shape[1]] = part
    return out


def even(pixels: Pixels) -> Pixels:
    """Padded with white to even width and height, as video encoders want it."""
    height, width = pixels.shape[:2]
    return fit(pixels, width + width % 2, height + height % 2)
