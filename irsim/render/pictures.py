"""Images drawn in place of bodies: the bundled ones, or a file of the user's."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = ["BUNDLED", "find_picture", "load_picture"]

_FOLDER = Path(__file__).parent / "images"
BUNDLED = ("car_green.png", "car_blue.png", "car_red.png", "diff_robot0.png", "diff_robot1.png")
"""Names that need no file; seen from above, facing right."""


def find_picture(name: str, folder: str | Path | None = None) -> Path | None:
    """The file behind a ``description``.

    Args:
        name: File name or path.
        folder: Folder of the scenario, looked in as well.

    Returns:
        The first that exists: the path as given, beside the script, in ``folder``, bundled; None if there is none.
    """
    places = [Path(), Path(sys.path[0] or "."), *([Path(folder)] if folder is not None else []), _FOLDER]
    found = (place / name for place in places)
    return next((path for path in found if path.is_file()), None)


def load_picture(path: Path) -> NDArray[np.uint8]:
    """(H, W, 4) pixels of an image file.

    Raises:
        OSError: Not an image.
    """
    from PIL import Image

    with Image.open(path) as image:
        return np.asarray(image.convert("RGBA"))
