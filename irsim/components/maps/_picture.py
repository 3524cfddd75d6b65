"""Reads picture files as grey levels."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.pictures import opened_picture
from irsim.common.records import ContentError
from irsim.common.text import clean
from irsim.components.maps._site import MapProblem, MapSite, Raster

if TYPE_CHECKING:
    from PIL import Image

    from irsim.common.arrays import Floats

__all__ = ["flattened", "image_raster", "open_picture", "upright"]

_WEIGHTS = (0.2989, 0.5870, 0.1140)
"""Weights of red, green and blue in a grey level (ITU-R BT.601, rounded as in MATLAB's rgb2gray)."""


def open_picture(path: Path, name: str, site: MapSite) -> tuple[NDArray[Any], bool]:
    """Pixels of a picture.

    Args:
        path: The file.
        name: Name of the file in messages.
        site: Upper bounds on the picture.

    Returns:
        (H, W) or (H, W, channels) pixels, and whether the file is a PNG.

    Raises:
        MapProblem: The file cannot be read, or has too many pixels.
    """
    try:
        with opened_picture(path) as image:
            site.check_cells(*image.size)
            converted: Image.Image = image
            if image.mode in ("P", "PA", "1", "CMYK", "YCbCr", "LAB", "HSV"):
                has_alpha = image.mode == "PA" or "transparency" in image.info
                converted = image.convert("RGBA" if has_alpha else "L" if image.mode == "1" else "RGB")
            return np.asarray(converted), image.format == "PNG"
    except (OSError, ContentError) as error:
        raise MapProblem(
            "map-unreadable",
            f"'{name}' cannot be read as a picture: {getattr(error, 'strerror', None) or error}",
            given=name,
            fix="save it as a grey PNG: black is occupied, white is free",
        ) from None


def flattened(pixels: NDArray[Any], name: str, site: MapSite) -> NDArray[Any]:
    """Pixels of a picture on white paper, without opacity; pixels that are opaque everywhere are returned as they are.

    Args:
        pixels: (H, W) or (H, W, channels).
        name: Name of the file in messages.
        site: Where the user hears how much of it is transparent.
    """
    if pixels.ndim == 2 or pixels.shape[-1] not in (2, 4):
        return pixels
    full = np.iinfo(pixels.dtype).max
    opacity = pixels[..., -1:] / full
    share = float((opacity < 1).mean())
    if not share:
        return pixels
    site.notes.append(
        (
            "map-transparent",
            f"{share:.1%} of '{clean(name)}' is transparent and counts as the white paper below it: free",
        )
    )
    colors = np.round(pixels[..., :-1] * opacity + full * (1 - opacity)).astype(pixels.dtype)
    return colors[..., 0] if colors.shape[-1] == 1 else colors


def upright(pixels: NDArray[Any]) -> NDArray[Any]:
    """Turn (H, W) rows from the top into (nx, ny) with i along +x and j along +y from the bottom."""
    return pixels.T[:, ::-1]


def image_raster(pixels: NDArray[Any], is_png: bool) -> Raster:
    """Occupancy of a picture: black is 100, white 0; colours count by brightness, opacity is ignored.

    Args:
        pixels: (H, W) or (H, W, channels).
        is_png: Whether to scale levels to [0, 1] in single precision, as Matplotlib reads PNG files.
    """
    full = float(np.iinfo(pixels.dtype).max) if np.issubdtype(pixels.dtype, np.integer) else 1.0
    plain = pixels if pixels.ndim == 2 else _one_channel(pixels)
    if plain is not None and plain.dtype == np.uint8:
        levels = np.arange(256, dtype=np.uint8)[None]
        greys = levels if pixels.ndim == 2 else np.stack([levels] * 3, axis=-1)
        return Raster(upright(plain), _occupancy(greys, is_png, full, int(plain.max()))[0])
    return Raster(np.ascontiguousarray(upright(_occupancy(pixels, is_png, full, None))))


def _occupancy(pixels: NDArray[Any], is_png: bool, full: float, peak: int | None) -> Floats:
    """Occupancies 100 (1 - grey); ``peak`` is the brightest level that occurs, None to look it up."""
    values: Any = pixels
    if is_png:
        values = (pixels / full).astype(np.float32) if pixels.dtype != np.bool_ else pixels.astype(np.float32)
    if values.ndim > 2:
        red, green, blue = (
            values[..., c].astype(np.float64) for c in (range(3) if values.shape[-1] > 2 else (0, 0, 0))
        )
        values = _WEIGHTS[0] * red + _WEIGHTS[1] * green + _WEIGHTS[2] * blue
    elif not is_png and full > 1:
        return np.asarray(100.0 * (1.0 - values / full), dtype=np.float64)
    if not is_png:
        top = float(values.max()) if peak is None else float(sum(_WEIGHTS) * peak)
        values = values / top if top > 1 else values
    return np.asarray(100.0 * (1.0 - values.astype(np.float64)), dtype=np.float64)


def _one_channel(pixels: NDArray[Any]) -> NDArray[Any] | None:
    """The grey channel of a picture without colours; None if it has colours."""
    if pixels.shape[-1] < 3:
        return pixels[..., 0]
    same = bool((pixels[..., 0] == pixels[..., 1]).all() and (pixels[..., 0] == pixels[..., 2]).all())
    return pixels[..., 0] if same else None
