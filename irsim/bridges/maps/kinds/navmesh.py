"""``navmesh``: navigation meshes of Habitat, which Detour wrote.

The layout follows Detour's structures, little endian, without padding. A set begins with ``MSET``, version, number
of tiles and the parameters of the mesh; version 2 goes on with the settings of Habitat, whose size has changed over
time, so that the first tile is found by its magic. Each tile is a reference, a size and Detour's own blob ``DNAV``.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.maps.grid import spread
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, SceneTriangles, unusable
from irsim.common.arrays import Floats

__all__ = ["KIND", "Tile", "read_tiles"]

_SET = struct.Struct("<4sii3fffii")
_TILE = struct.Struct("<II")
_HEADER = struct.Struct("<4siiiiI9i3f6ff")
_SET_MAGIC, _TILE_MAGIC = b"TESM", b"VAND"
_TILE_VERSION = 7
_SETTINGS_ROOM = 512
"""Bytes after the header of a set within which the first tile begins."""
_MAX_TILES = 1 << 20
_GROUND = 0
"""Type of a polygon that is not a jump between two places."""
_POLYGON = np.dtype(
    [("link", "<u4"), ("verts", "<u2", 6), ("neighbors", "<u2", 6), ("flags", "<u2"), ("count", "u1"), ("kind", "u1")]
)
_DETAIL = np.dtype([("verts", "<u4"), ("triangles", "<u4"), ("vert_count", "u1"), ("count", "u1"), ("pad", "<u2")])


@dataclass(frozen=True)
class Tile:
    """A tile of a navigation mesh.

    Attributes:
        triangles: (T, 3, 3) corners in the frame of the file, y up.
        height, radius, climb: Size and step height of the agent that the mesh was made for [m].
    """

    triangles: Floats
    height: float
    radius: float
    climb: float


def read_tiles(path: Path, content: bytes) -> list[Tile]:
    """The tiles of a set.

    Raises:
        BridgeError: The file is damaged; the message has the place.
    """
    if len(content) < _SET.size:
        raise unusable(path, f"its header of {_SET.size} bytes ends after {len(content)}")
    magic, version, count, *_ = _SET.unpack_from(content)
    if magic != _SET_MAGIC:
        raise unusable(path, "it does not begin with the letters TESM of a set of Detour's meshes")
    if version not in (1, 2):
        raise unusable(path, f"it has version {version}, and 1 and 2 can be read")
    if not 0 <= count <= _MAX_TILES:
        raise unusable(path, f"its header promises {count:,} tiles")
    place = _SET.size
    if version == 2:
        first = content.find(_TILE_MAGIC, place + _TILE.size, place + _SETTINGS_ROOM)
        if first < 0 and count:
            raise unusable(path, f"no tile begins within {_SETTINGS_ROOM} bytes after its header")
        place = first - _TILE.size
    tiles = []
    for number in range(count):
        if place + _TILE.size > len(content):
            raise unusable(path, f"tile {number} of {count} is missing: it ends after {len(content):,} bytes")
        reference, size = _TILE.unpack_from(content, place)
        if reference == 0 or size == 0:
            break
        place += _TILE.size
        if place + size > len(content):
            what = f"tile {number} of {size:,} bytes begins at {place:,}, and it ends at {len(content):,}"
            raise unusable(path, what)
        tiles.append(_tile(path, memoryview(content)[place : place + size], place))
        place += size
    return tiles


def _tile(path: Path, blob: memoryview, place: int) -> Tile:
    if len(blob) < _HEADER.size:
        raise unusable(path, f"the tile at byte {place:,} has {len(blob)} bytes, less than its header")
    fields = _HEADER.unpack_from(blob)
    magic, version = fields[0], fields[1]
    if magic != _TILE_MAGIC or version != _TILE_VERSION:
        raise unusable(path, f"the tile at byte {place:,} is not one of Detour's version {_TILE_VERSION}")
    polygons, verts, links, details, detail_verts, detail_triangles = fields[6:12]
    height, radius, climb = fields[15:18]
    sizes = [
        (verts, 12), (polygons, _POLYGON.itemsize), (links, 12), (details, _DETAIL.itemsize), (detail_verts, 12),
        (detail_triangles, 4),
    ]  # fmt: skip
    starts = [_HEADER.size]
    for count, size in sizes:
        if count < 0 or starts[-1] + count * size > len(blob):
            raise unusable(path, f"the tile at byte {place:,} promises more than its {len(blob):,} bytes")
        starts.append(starts[-1] + count * size)
    if not all(np.isfinite(value) and 0 <= value < 1e6 for value in (height, radius, climb)):
        raise unusable(path, f"the tile at byte {place:,} is for an agent of height {height:g} and radius {radius:g}")
    points = np.frombuffer(blob, "<f4", 3 * verts, starts[0]).reshape(-1, 3)
    polygon = np.frombuffer(blob, _POLYGON, polygons, starts[1])
    detail = np.frombuffer(blob, _DETAIL, details, starts[3])
    extra = np.frombuffer(blob, "<f4", 3 * detail_verts, starts[4]).reshape(-1, 3)
    corners = np.frombuffer(blob, np.uint8, 4 * detail_triangles, starts[5]).reshape(-1, 4)
    triangles = _triangles(points, polygon, detail, extra, corners)
    if triangles is None:
        raise unusable(path, f"the tile at byte {place:,} has polygons whose vertices it does not have")
    if not np.isfinite(triangles).all() or np.abs(triangles).max(initial=0) > 1e7:
        raise unusable(path, f"the tile at byte {place:,} has vertices that are not numbers")
    return Tile(triangles.astype(np.float64), height, radius, climb)


def _triangles(
    points: NDArray[np.float32],
    polygon: NDArray[np.void],
    detail: NDArray[np.void],
    extra: NDArray[np.float32],
    corners: NDArray[np.uint8],
) -> NDArray[np.float32] | None:
    """(T, 3, 3) detail triangles of all polygons of the ground; None if an index is wrong."""
    ground = np.flatnonzero((polygon["kind"] >> 6) == _GROUND)
    if (ground >= len(detail)).any() or (polygon["count"][ground] > 6).any() or (polygon["count"][ground] < 3).any():
        return None
    counts = detail["count"][ground].astype(np.int64)
    which, offset = spread(counts)
    owner = ground[which]
    row = detail["triangles"][owner].astype(np.int64) + offset
    if (row >= len(corners)).any():
        return None
    index = corners[row, :3].astype(np.int64)
    own = polygon["count"][owner].astype(np.int64)[:, None]
    in_polygon = index < own
    vertex = np.take_along_axis(polygon["verts"][owner].astype(np.int64), np.minimum(index, 5), axis=1)
    beyond = detail["verts"][owner].astype(np.int64)[:, None] + index - own
    if (vertex[in_polygon] >= len(points)).any() or (beyond[~in_polygon] >= len(extra)).any():
        return None
    every = np.concatenate([points, extra])
    result: NDArray[np.float32] = every[np.where(in_polygon, vertex, len(points) + beyond)]
    return result


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> SceneTriangles:
    """Floors of a navigation mesh.

    Raises:
        BridgeError: The file is damaged or empty.
    """
    tiles = read_tiles(path, path.read_bytes())
    total = sum(len(tile.triangles) for tile in tiles)
    if not total:
        raise unusable(path, "it has no polygons")
    if total > limits.triangles:
        raise unusable(path, f"it has {total:,} triangles, and at most {limits.triangles:,} are read")
    corners = np.concatenate([tile.triangles for tile in tiles])
    floors = np.stack([corners[..., 0], -corners[..., 2], corners[..., 1]], axis=-1)
    radius = max(tile.radius for tile in tiles)
    notes = []
    if radius > 0:
        notes.append(
            f"its floors keep {radius:.2f} m from obstacles already, and robots keep clear of them in addition"
        )
    height, climb = max(tile.height for tile in tiles), max(tile.climb for tile in tiles)
    return SceneTriangles(
        "habitat_yup", floors=floors, headroom=height or None, climb=climb, radius=radius, notes=notes
    )


KIND = Kind(
    name="navmesh",
    title="a navigation mesh of Habitat",
    suffixes=(".navmesh",),
    accepts=lambda head: head.startswith(_SET_MAGIC),
    read=read,
    unused=("headroom", "slope", "ground", "climb", "up", "rotate", "meters_per_unit", "opacity", "lanes", "root"),
)
