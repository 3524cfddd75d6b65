"""Places where the image named by ``description`` is looked for."""

from __future__ import annotations

import sys
from pathlib import Path

__all__ = ["BUNDLED", "IMAGES", "image_places"]

IMAGES = Path(__file__).parents[2] / "graphics" / "images"
"""Folder of the bundled images."""
BUNDLED = ("car_green.png", "car_blue.png", "car_red.png", "diff_robot0.png", "diff_robot1.png")
"""Names of the bundled images, which show a robot from above, facing right."""


def image_places(name: str, folder: str | Path | None) -> list[Path]:
    """Candidates for an image file: as given, beside the script, beside the scenario (``folder``), bundled."""
    return [place / name for place in (Path(), Path(sys.path[0] or "."), *([Path(folder)] if folder else []), IMAGES)]
