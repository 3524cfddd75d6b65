"""Maps as the ROS map server stores them: a YAML file and a picture.

The meaning of the keys follows http://wiki.ros.org/map_server (modes trinary, scale and raw).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.records import ContentError, read_text
from irsim.common.text import clean
from irsim.common.yaml.plain import SMALL, read_plain_yaml
from irsim.components.maps._grid import with_unknown
from irsim.components.maps._picture import open_picture, upright
from irsim.components.maps._site import FREE, HALF, OCCUPIED, UNKNOWN, MapProblem, MapSite, Raster, cells_along

__all__ = ["RosMeta", "find_picture", "occupancy_of", "pixels_of", "read_meta", "ros_raster"]

MODES = ("trinary", "scale", "raw")
_YAML = replace(SMALL, bytes=64 * 1024)
"""Limits of the YAML file of a map."""
_NUMBER = re.compile(r"[-+]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|\.?(?:inf|nan))\Z", re.IGNORECASE)
"""A number of YAML 1.2, or as C++ writes it."""
_SWITCHES = {"true": 1.0, "false": 0.0}
_SAMPLES = 3
"""Samples per cell and axis, so that thin walls survive a rotation."""
_EXTENT_TOLERANCE = 1e-9
"""Relative difference of two extents that count as equal."""
_FREE_PIXEL = 254
"""Grey level of free cells, as the saver of the map server writes it."""
_UNKNOWN_PIXEL = 205
"""Grey level of unknown cells, as the saver of the map server writes it."""


@dataclass(frozen=True)
class RosMeta:
    """Content of the YAML file.

    Attributes:
        image: Name of the picture.
        resolution: Side of a pixel [m].
        origin: x, y [m] and yaw [rad] of the lower left corner.
        negate: Whether white is occupied.
        occupied_thresh, free_thresh: Occupancies (0 to 1) above and below which a pixel is occupied and free.
        mode: ``trinary``, ``scale`` or ``raw``.
        remarks: Notes for the user about how the file was read.
    """

    image: str
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    negate: bool = False
    occupied_thresh: float = 0.65
    free_thresh: float = 0.196
    mode: str = "trinary"
    remarks: tuple[str, ...] = ()

    def as_yaml(self) -> str:
        """The file's text."""
        x, y, yaw = self.origin
        return (
            f"image: {self.image}\nmode: {self.mode}\nresolution: {self.resolution!r}\n"
            f"origin: [{x!r}, {y!r}, {yaw!r}]\nnegate: {int(self.negate)}\n"
            f"occupied_thresh: {self.occupied_thresh!r}\nfree_thresh: {self.free_thresh!r}\n"
        )


def read_meta(path: Path, name: str) -> RosMeta:
    """The YAML file of a map.

    Raises:
        MapProblem: The file describes no map, or has a wrong value; the message names the key.
    """
    try:
        text = read_text(path, _YAML.bytes).replace("\t", " ")  # readers of ROS take tabs for spaces
        data = read_plain_yaml(text, _YAML)
    except ContentError as error:
        raise _wrong(name, f"it cannot be read as YAML: {error.message}") from None
    if not isinstance(data, dict):
        raise _wrong(name, "it must be a mapping with the keys image, resolution and origin")
    for key in ("image", "resolution"):
        if key not in data:
            raise _wrong(name, f"'{key}' is missing")
    resolution = _number(data["resolution"], name, "resolution")
    if not 0 < resolution < math.inf:
        raise _wrong(name, f"'resolution' must be positive, got {resolution:g}")
    origin = data.get("origin", [0.0, 0.0, 0.0])
    if not isinstance(origin, list) or len(origin) not in (2, 3):
        raise _wrong(name, "'origin' must be [x, y, yaw]")
    turned = _as_number(origin[2]) if len(origin) == 3 else 0.0
    remarks = () if turned is None or not math.isnan(turned) else ("the yaw of its origin is not a number: 0 is taken",)
    x, y, yaw = (_number(value, name, "origin") for value in [*origin[:2], *([] if remarks else origin[2:]), 0.0][:3])
    occupied, free = (
        _number(data.get(key, standard), name, key)
        for key, standard in (("occupied_thresh", 0.65), ("free_thresh", 0.196))
    )
    if not 0 <= free <= occupied <= 1:
        raise _wrong(name, f"0 <= free_thresh <= occupied_thresh <= 1 must hold, got {free:g} and {occupied:g}")
    mode = str(data.get("mode", "trinary" if _number(data.get("trinary", 1), name, "trinary") else "scale")).lower()
    if mode not in MODES:
        raise _wrong(name, f"'mode' must be one of {', '.join(MODES)}, got '{clean(mode, 40)}'")
    if not isinstance(data["image"], str):
        raise _wrong(name, "'image' must be the name of a picture")
    negate = bool(_number(data.get("negate", 0), name, "negate"))
    return RosMeta(data["image"], resolution, (x, y, yaw), negate, occupied, free, mode, remarks)


def occupancy_of(pixels: NDArray[Any], meta: RosMeta) -> Floats:
    """Occupancy of each pixel.

    Args:
        pixels: (H, W) or (H, W, channels), 8 or 16 bits or floats.
        meta: Thresholds and mode.

    Returns:
        (H, W) occupancies 0 to 100, -1 where unknown.
    """
    values = pixels.astype(np.float64)
    scale = float(np.iinfo(pixels.dtype).max) if np.issubdtype(pixels.dtype, np.integer) else 1.0
    alpha: Floats | None = None
    if values.ndim > 2:
        channels = values.shape[-1]
        if channels in (2, 4):
            alpha = values[..., -1] / scale
        values = values[..., : 1 if channels < 3 else 3].mean(axis=-1)
    if meta.mode == "raw":
        level = values * (255.0 / scale)
        return np.where(level <= 100, level, UNKNOWN)
    part = values / scale if meta.negate else 1.0 - values / scale
    between: Any = UNKNOWN
    if meta.mode == "scale":
        between = np.round(99 * (part - meta.free_thresh) / max(meta.occupied_thresh - meta.free_thresh, 1e-12))
    out = np.where(part > meta.occupied_thresh, OCCUPIED, np.where(part < meta.free_thresh, FREE, between))
    if meta.mode == "scale" and alpha is not None:
        out = np.where(alpha < 1.0, UNKNOWN, out)
    return out


def pixels_of(values: NDArray[Any], meta: RosMeta) -> NDArray[np.uint8]:
    """Pixels from which :func:`occupancy_of` reads these occupancies back.

    Args:
        values: (nx, ny) occupancies 0 to 100, -1 where unknown.
        meta: Thresholds and mode.

    Returns:
        (H, W) grey levels, or in mode ``scale`` with unknown cells (H, W, 2) with opacity.
    """
    rows = values[:, ::-1].T
    if meta.mode == "raw":
        return np.where(rows < 0, 255, np.clip(np.round(rows), 0, 100)).astype(np.uint8)
    if meta.mode == "trinary":
        unknown = round(255 * (1 - (meta.occupied_thresh + meta.free_thresh) / 2))
        unknown = _UNKNOWN_PIXEL if meta.free_thresh < 1 - _UNKNOWN_PIXEL / 255 < meta.occupied_thresh else unknown
        grey = np.where(rows < 0, unknown, np.where(rows > HALF, 0, _FREE_PIXEL))
    else:
        part = meta.free_thresh + np.clip(rows, 0, 100) / 99 * (meta.occupied_thresh - meta.free_thresh)
        part = np.where(rows <= 0, 0.0, np.where(rows > 99, 1.0, part))
        grey = np.round(255 * (1 - part))
    if meta.negate:
        grey = 255 - grey
    grey = grey.astype(np.uint8)
    if meta.mode == "scale" and (rows < 0).any():
        return np.stack([grey, np.where(rows < 0, 0, 255).astype(np.uint8)], axis=-1)
    return grey


def ros_raster(path: Path, name: str, site: MapSite, unknown: float) -> Raster:
    """A map over the rectangle of the world if the scenario gives one, else over its own rectangle.

    Args:
        path: The YAML file.
        name: Name of the file in messages.
        site: The world, and where to look for files.
        unknown: Occupancy of unknown cells; negative if they stay unknown.

    Raises:
        MapProblem: The file or its picture cannot be used.
    """
    meta = read_meta(path, name)
    site.notes += [("map-read-as", remark) for remark in meta.remarks]
    pixels, _ = open_picture(find_picture(meta.image, path, site), meta.image, site)
    values = np.ascontiguousarray(upright(occupancy_of(pixels, meta)))
    width, height, origin = _extent(values.shape, meta)
    if not all(map(math.isfinite, (width, height, *origin))):
        raise _wrong(name, f"pixels of {meta.resolution:g} m make a map of infinite size")
    wanted = (
        site.width if site.width is not None else width,
        site.height if site.height is not None else height,
        site.origin if site.origin is not None else origin,
    )
    size = cells_along(wanted[0], meta.resolution), cells_along(wanted[1], meta.resolution)
    site.check_cells(*size)
    aligned = meta.origin[2] == 0.0 and size == values.shape and wanted[2] == origin
    width_fits = abs(wanted[0] - width) <= _EXTENT_TOLERANCE * width
    height_fits = abs(wanted[1] - height) <= _EXTENT_TOLERANCE * height
    if not (aligned and width_fits and height_fits):
        values = _resample(values, meta, size, wanted, unknown)
    missing = values < 0
    values = np.where(missing, unknown, values)
    return Raster(values, None, wanted[0], wanted[1], wanted[2], float(missing.mean()))


def find_picture(image: str, path: Path, site: MapSite) -> Path:
    """The picture of a map; one that is named by a path of another computer is taken from beside the YAML file.

    Args:
        image: Name of the picture as the file gives it.
        path: The YAML file.
        site: Where to look, and where the user hears what was taken.

    Raises:
        MapProblem: There is no such picture.
    """
    try:
        return site.find(image, beside=path.parent)
    except MapProblem as problem:
        elsewhere = PureWindowsPath(image)  # which takes both kinds of slashes
        near = elsewhere.name
        if not (near and (elsewhere.anchor or "\\" in image)):
            raise
        try:
            located = site.find(near, beside=path.parent)
        except MapProblem:
            raise problem from None
    said = f"the picture '{clean(image)}' cannot be used here: '{clean(near)}' beside the YAML file is taken instead"
    site.notes.append(("map-read-as", said))
    return located


def _extent(shape: tuple[int, ...], meta: RosMeta) -> tuple[float, float, tuple[float, float]]:
    """Width, height and lower left corner [m] of the box round the (rotated) picture, in whole cells.

    Of pixels that are too large for numbers, they are infinite or not numbers.
    """
    r, (x, y, yaw) = meta.resolution, meta.origin
    if yaw == 0.0:
        return shape[0] * r, shape[1] * r, (x, y)
    c, s = math.cos(yaw), math.sin(yaw)
    with np.errstate(over="ignore", invalid="ignore"):
        corners = np.array([(0, 0), (shape[0], 0), (0, shape[1]), shape[:2]]) * r @ np.array([[c, s], [-s, c]])
        low, high = corners.min(axis=0), corners.max(axis=0)
        cells = np.ceil((high - low) / r - 1e-6)
    return float(cells[0] * r), float(cells[1] * r), (x + float(low[0]), y + float(low[1]))


def _resample(
    values: Floats,
    meta: RosMeta,
    size: tuple[int, int],
    wanted: tuple[float, float, tuple[float, float]],
    unknown: float,
) -> Floats:
    """Occupancy of each wanted cell: the highest of several samples of the picture, unknown outside of it.

    Where unknown cells stay unknown, one unknown sample makes a cell unknown that is not occupied.
    """
    (nx, ny), (x, y, yaw) = size, meta.origin
    c, s = math.cos(yaw), math.sin(yaw)
    best, least = np.full(size, -math.inf), np.full(size, math.inf)
    offsets = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    for a in offsets:
        for b in offsets:
            px = wanted[2][0] + (np.arange(nx)[:, None] + a) * (wanted[0] / nx) - x
            py = wanted[2][1] + (np.arange(ny)[None, :] + b) * (wanted[1] / ny) - y
            i = np.floor((c * px + s * py) / meta.resolution).astype(np.int64)
            j = np.floor((-s * px + c * py) / meta.resolution).astype(np.int64)
            known = (i >= 0) & (j >= 0) & (i < values.shape[0]) & (j < values.shape[1])
            sampled = values[np.where(known, i, 0), np.where(known, j, 0)]
            sampled = np.where(known & (sampled >= 0), sampled, UNKNOWN)
            best, least = np.maximum(best, sampled), np.minimum(least, sampled)
    return with_unknown(best, least) if unknown < 0 else best


def _number(value: Any, name: str, key: str) -> float:
    """A number as readers of ROS take it: an exponent needs no point, quotes change nothing, true is 1.

    Raises:
        MapProblem: The value is not a number, or not finite.
    """
    number = _as_number(value)
    if number is not None and math.isfinite(number):
        return number
    raise _wrong(name, f"'{key}' must be a number, got {clean(repr(value), 60)}")


def _as_number(value: Any) -> float | None:
    """The number that a value stands for; None if the value is not a number."""
    if isinstance(value, str):
        return (
            float(value.replace(".inf", "inf").replace(".nan", "nan"))
            if _NUMBER.match(value)
            else _SWITCHES.get(value.lower())
        )
    try:
        return float(value) if isinstance(value, (int, float)) else None
    except OverflowError:
        return math.inf


def _wrong(name: str, why: str) -> MapProblem:
    return MapProblem(
        "map-unreadable",
        f"'{name}' is not a ROS map: {why}",
        given=name,
        fix="give the YAML file with the keys image, resolution, origin, negate, occupied_thresh and free_thresh",
    )
