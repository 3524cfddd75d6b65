"""Record what IR-SIM 2.12.0 makes of pictures and noise: run with an interpreter that has it, from this folder.

    /tmp/reference/bin/python tests/components/record.py

Writes `recorded/*.png` (drawn by this script) and `recorded/grids.npz` (what the reference reads).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

FOLDER = Path(__file__).parent / "recorded"
NOISE = [
    {"seed": 0},
    {"seed": 7, "fill": 0.2},
    {"seed": 3, "complexity": 0.05, "fractal": 3},
    {"seed": 11, "complexity": 0.3, "fractal": 2, "attenuation": 0.8, "fill": 0.5},
    {"seed": 123456789},
    {"seed": 2, "fill": 0.0},
    {"seed": 2, "fill": 1.0},
    {"seed": 5, "complexity": 0.25},
    {"seed": 5, "complexity": 0.5, "fractal": 4},
]
SIZES = [(24, 24), (31, 17)]


def pictures() -> dict[str, Image.Image]:
    """Small asymmetric pictures of every common mode."""
    rng = np.random.default_rng(3)
    grey = rng.integers(0, 256, (7, 11), dtype=np.uint8)
    grey[:2, :4] = 0
    color = rng.integers(0, 256, (7, 11, 3), dtype=np.uint8)
    return {
        "grey.png": Image.fromarray(grey),
        "dark.png": Image.fromarray(np.minimum(grey, 100)),
        "rgb.png": Image.fromarray(color),
        "rgba.png": Image.fromarray(rng.integers(0, 256, (7, 11, 4), dtype=np.uint8)),
        "opacity.png": Image.fromarray(rng.integers(0, 256, (7, 11, 2), dtype=np.uint8)),
        "bits.png": Image.fromarray(grey > 127),
        "deep.png": Image.fromarray(grey.astype(np.uint16) * 200),
        "palette.png": Image.fromarray(color).quantize(8),
        "rgb.bmp": Image.fromarray(color),
        "dark.bmp": Image.fromarray(np.minimum(grey, 100)),
        "grey.pgm": Image.fromarray(grey),
        "rgb.jpg": Image.fromarray(color),
    }


def main() -> None:
    """Draw, read, save."""
    from irsim.world.map import ImageGridGenerator, PerlinGridGenerator

    FOLDER.mkdir(exist_ok=True)
    grids = {}
    for name, picture in pictures().items():
        picture.save(FOLDER / name)
        grids[name] = ImageGridGenerator(str(FOLDER / name)).generate().grid
    for k, options in enumerate(NOISE):
        for width, height in SIZES:
            grid = PerlinGridGenerator(width, height, **options).generate().grid
            grids[f"noise_{k}_{width}"] = (grid > 50).astype(np.uint8)
    np.savez_compressed(FOLDER / "grids.npz", **grids)


if __name__ == "__main__":
    main()
