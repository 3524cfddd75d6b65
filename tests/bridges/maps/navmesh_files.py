"""Navigation meshes as Detour writes them, made up of rectangles."""

from __future__ import annotations

import struct

import numpy as np


def tile(rectangles, *, height=1.5, radius=0.1, climb=0.2, change=None) -> bytes:
    """One tile; each rectangle, x0, y0, x1, y1, z in the frame of irsim, becomes a polygon with a detail vertex."""
    verts, polygons, details, extra, triangles = [], [], [], [], []
    for x0, y0, x1, y1, z in rectangles:
        first = len(verts)
        verts += [(x0, z, -y0), (x1, z, -y0), (x1, z, -y1), (x0, z, -y1)]
        polygons.append(struct.pack("<I6H6HHBB", 0xFFFFFFFF, *range(first, first + 4), 0, 0, *[0] * 6, 1, 4, 0))
        details.append(struct.pack("<IIBBH", len(extra), len(triangles), 1, 4, 0))
        extra.append(((x0 + x1) / 2, z, -(y0 + y1) / 2))
        triangles += [bytes((a, b, 4, 0)) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
    counts = {
        "polygons": len(polygons), "verts": len(verts), "links": 2, "details": len(details), "extra": len(extra),
        "triangles": len(triangles),
    }  # fmt: skip
    if change is not None:
        counts = {**counts, **change}
    points = np.array(verts, "<f4").reshape(-1, 3)
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    header = struct.pack(
        "<4siiiiI9i3f6ff",
        b"VAND", 7, 0, 0, 0, 0,
        *(counts[key] for key in ("polygons", "verts", "links", "details", "extra", "triangles")), 0, 0, len(polygons),
        height, radius, climb, *low, *high, 20.0,
    )  # fmt: skip
    body = points.tobytes() + b"".join(polygons) + bytes(24) + b"".join(details)
    return header + body + np.array(extra, "<f4").tobytes() + b"".join(triangles)


def mesh_set(*tiles: bytes, version: int = 1, settings: int = 80) -> bytes:
    """A file of tiles; version 2 has settings of some size after its header."""
    head = struct.pack("<4sii3fffii", b"TESM", version, len(tiles), 0, 0, 0, 10, 10, 128, 1024)
    parts = [struct.pack("<II", 1 + k, len(blob)) + blob for k, blob in enumerate(tiles)]
    return head + (bytes(settings) if version > 1 else b"") + b"".join(parts)


TWO_ROOMS = ((0.0, 0.0, 4.0, 3.0, 0.1), (4.0, 1.0, 4.5, 2.0, 0.1), (4.5, 0.0, 7.0, 3.0, 0.1))
"""Two rooms with a door between them."""
UPSTAIRS = ((0.0, 0.0, 3.0, 3.0, 3.0),)
