"""Animated pictures of pages become films, an eighth of the size, of which a page shows the first picture at once."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from PIL import Image, ImageSequence

from irsim.graphics.encoding.video import VideoWriter

__all__ = ["with_films"]

_FPS = 10
_EXACT = ("-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact")
"""Options with which the same pictures give the same bytes."""


def with_films(text: str, path: Path) -> str:
    """A page whose animated GIFs are films.

    Args:
        text: The page.
        path: Its file; films and first pictures are written beside the GIFs.
    """
    return re.sub(r'<img alt="([^"]*)" src="([^"]*\.gif)" />', lambda found: _film(path.parent, *found.groups()), text)


def _film(folder: Path, alt: str, source: str) -> str:
    gif = folder / source
    film, first = gif.with_suffix(".mp4"), gif.with_suffix(".png")
    with Image.open(gif) as animation:
        width, height = animation.size
        if not film.exists():
            animation.convert("RGB").save(first)
            writer = VideoWriter(film, fps=_FPS, quality=5.5, output_params=_EXACT)
            for picture in ImageSequence.Iterator(animation):
                for _ in range(round(picture.info["duration"] * _FPS / 1000)):
                    writer.add(np.asarray(picture.convert("RGBA")))
            writer.close()
    stem = source.removesuffix(".gif")
    return (
        f'<video autoplay loop muted playsinline controls aria-label="{alt}" poster="{stem}.png" width="{width}" '
        f'height="{height}" src="{stem}.mp4"></video>'
    )
