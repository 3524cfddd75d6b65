"""Images drawn in place of bodies: bundled images, or files of the user."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.pictures import opened_picture
from irsim.common.records import ContentError
from irsim.graphics.scene.style import Color
from irsim.scenario.locate import BUNDLED, image_places

__all__ = ["BUNDLED", "Pictures"]

MAX_SIDE_PX = 512
"""Larger images are reduced to this length of the longer side [px]."""


class Pictures:
    """The images that a scenario's ``description`` keys name, each read once.

    Args:
        folder: Folder of the scenario, which is searched too.
        warn: Callback that receives a message about each image that is missing or unreadable.
    """

    def __init__(self, folder: str | Path | None = None, warn: Callable[[str], None] | None = None) -> None:
        self._folder = folder
        self._warn = warn
        self._known: dict[str, NDArray[np.uint8] | None] = {}
        self._tinted: dict[tuple[str, str], NDArray[np.uint8]] = {}

    def get(self, name: str) -> NDArray[np.uint8] | None:
        """Return the (H, W, 4) pixels of an image, or None if the image is missing or unreadable."""
        if name not in self._known:
            self._known[name] = self._read(name)
        return self._known[name]

    def tinted(self, name: str, color: Color | None) -> NDArray[np.uint8] | None:
        """Return an image with the hue of its colourful parts replaced; their brightness stays.

        Args:
            name: Name of the image.
            color: The new hue; None returns the image unchanged.

        Returns:
            (H, W, 4) pixels, or None if the image is missing or unreadable.
        """
        pixels = self.get(name)
        if pixels is None or color is None:
            return pixels
        key = name, str(color)
        if key not in self._tinted:
            self._tinted[key] = _tint(pixels, color)
        return self._tinted[key]

    def has(self, name: str) -> bool:
        """Whether the image exists and can be read."""
        return self.get(name) is not None

    def _read(self, name: str) -> NDArray[np.uint8] | None:
        problem = "not found"
        for path in image_places(name, self._folder):
            try:
                with opened_picture(path) as image:
                    image.thumbnail((MAX_SIDE_PX, MAX_SIDE_PX))
                    return np.asarray(image.convert("RGBA"))
            except (FileNotFoundError, NotADirectoryError):
                continue
            except (OSError, ContentError):
                problem = "cannot be read as an image"
        if self._warn is not None:
            self._warn(f"description image {name!r} {problem}: the shape is drawn instead")
        return None


def _tint(pixels: NDArray[np.uint8], color: Color) -> NDArray[np.uint8]:
    """Replace all colours except greys by shades of one colour; (H, W, 4) pixels."""
    from matplotlib.colors import to_rgb

    given: Any = color
    levels = pixels[..., :3].astype(np.float64)
    light, dark = levels.max(axis=2, keepdims=True), levels.min(axis=2, keepdims=True)
    share = np.clip(3 * (light - dark) / np.maximum(light, 1.0) - 1, 0.0, 1.0)  # 0 nearly grey, 1 colourful
    usual = np.quantile(light[share >= 1.0], 0.5) if (share >= 1.0).any() else 255.0
    wanted = np.array(to_rgb(given)) * np.minimum(255.0 * light / max(float(usual), 1.0), 255.0)
    result = pixels.copy()
    result[..., :3] = np.rint(levels + share * (wanted - levels)).astype(np.uint8)
    return result
