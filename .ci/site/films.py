"""Animated pictures of pages become films, an eighth of the size, of which a page shows the first picture at once."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from imageio_ffmpeg import get_ffmpeg_exe
from PIL import Image

__all__ = ["with_films"]

_EXACT = ("-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1")
"""Options with which the same pictures give the same bytes."""
_FORMAT = ("-vf", "scale=trunc(iw/2)*2:trunc(ih/2)*2", "-pix_fmt", "yuv420p", "-c:v", "libx264", "-crf", "23")


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
    if not film.exists():
        command = [get_ffmpeg_exe(), "-v", "error", "-i", str(gif), *_FORMAT, *_EXACT, "-movflags", "+faststart"]
        subprocess.run([*command, str(film)], check=True)
        with Image.open(gif) as picture:
            picture.convert("RGB").save(first)
    with Image.open(first) as picture:
        width, height = picture.size
    stem = source.removesuffix(".gif")
    return (
        f'<video autoplay loop muted playsinline controls aria-label="{alt}" poster="{stem}.png" width="{width}" '
        f'height="{height}" src="{stem}.mp4"></video>'
    )
