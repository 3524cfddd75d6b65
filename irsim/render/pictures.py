"""Images drawn in place of bodies: the bundled ones, or a file of the user's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from irsim.scenario.images import BUNDLED, image_places

__all__ = ["BUNDLED", "Pictures"]

_LONGEST = 512
"""Side that larger images are reduced to [px]."""


class Pictures:
    """The images that a scenario's ``description`` keys name, each read once.

    Args:
        folder: Folder of the scenario, looked in as well.
        warn: Told about an image that is missing or unreadable, once.
    """

    def __init__(self, folder: str | Path | None = None, warn: Callable[[str], None] | None = None) -> None:
        self._folder = folder
        self._warn = warn
        self._known: dict[str, NDArray[np.uint8] | None] = {}

    def get(self, name: str) -> NDArray[np.uint8] | None:
        """(H, W, 4) pixels; None where there is no such image."""
        if name not in self._known:
            self._known[name] = self._read(name)
        return self._known[name]

    def has(self, name: str) -> bool:
        """Whether there is such an image."""
        return self.get(name) is not None

    def _read(self, name: str) -> NDArray[np.uint8] | None:
        problem = "not found"
        for path in image_places(name, self._folder):
            try:
                with Image.open(path) as image:
                    image.thumbnail((_LONGEST, _LONGEST))
                    return np.asarray(image.convert("RGBA"))
            except (FileNotFoundError, NotADirectoryError):
                continue
            except (OSError, ValueError, Image.DecompressionBombError):
                problem = "cannot be read as an image"
        if self._warn is not None:
            self._warn(f"description image {name!r} {problem}: the shape is drawn instead")
        return None
