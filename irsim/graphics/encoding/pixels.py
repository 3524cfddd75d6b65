"""Frames as arrays of pixels: comparison, conversion, padding."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image

__all__ = ["Pixels", "even", "fit", "from_image", "to_image"]

Pixels = NDArray[np.uint8]
"""(H, W, 4) red, green, blue and an unused byte (always 255)."""

_WHITE = 255


def to_image(pixels: Pixels) -> Image.Image:
    """Convert pixels to an RGB image."""
    height, width = pixels.shape[:2]
    image = Image.new("RGB", (width, height), None)  # without a color, because all pixels follow
    image.frombytes(np.ascontiguousarray(pixels), "raw", "RGBX")
    return image


def from_image(image: Image.Image) -> Pixels:
    """Convert an image of any mode to pixels; transparent areas become white."""
    if "A" in image.getbands() or "transparency" in image.info:
        image = Image.alpha_composite(Image.new("RGBA", image.size, "white"), image.convert("RGBA"))
    return np.array(image.convert("RGB").convert("RGBA"))


def fit(pixels: Pixels, width: int, height: int) -> Pixels:
    """Cut a frame at the right and bottom, or pad it with white there, to the given size [px]."""
    have_height, have_width = pixels.shape[:2]
    if (have_width, have_height) == (width, height):
        return pixels
    out = np.full((height, width, 4), _WHITE, np.uint8)
    part = pixels[:height, :width]
    out[: part.shape[0], : part.shape[1]] = part
    return out


def even(pixels: Pixels) -> Pixels:
    """Pad a frame with white to even width and height, which video encoders need."""
    height, width = pixels.shape[:2]
    return fit(pixels, width + width % 2, height + height % 2)
