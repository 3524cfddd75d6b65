"""Scenes of maps, made by hand, meters: a furnished flat as triangles, z up, and navigation meshes of rectangles."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np

QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Sides of a box, counterclockwise from outside; corner k has x, y, z from the bits of k."""


def box(low, high, *, without: tuple[int, ...] = ()) -> np.ndarray:
    """(12, 3, 3) triangles of a box; sides are bottom, top, front (low y), back, left (low x), right."""
    ends = np.array([low, high], float)
    corners = np.array([[ends[k & 1, 0], ends[k >> 1 & 1, 1], ends[k >> 2, 2]] for k in range(8)])
    sides = [quad for number, quad in enumerate(QUADS) if number not in without]
    return np.array([[corners[k] for k in part] for a, b, c, d in sides for part in ((a, b, c), (a, c, d))])


def storey(base: float = 0.0, *, hole: bool = False) -> np.ndarray:
    """One storey, 8 m x 6 m inside: two rooms with a door between them, and furniture. Walls are hollow surfaces."""
    top = base + 2.7
    slab = [([-0.1, -0.1, base - 0.1], [8.1, 6.1, base])]
    if hole:  # where stairs come up
        slab = [
            ([-0.1, -0.1, base - 0.1], [8.1, 4.8, base]),
            ([-0.1, 4.8, base - 0.1], [0.0, 6.1, base]),
            ([4.2, 4.8, base - 0.1], [8.1, 6.1, base]),
            ([-0.1, 6.0, base - 0.1], [8.1, 6.1, base]),
        ]
    walls = [
        ([-0.1, -0.1, base], [0.0, 6.1, top]),
        ([8.0, -0.1, base], [8.1, 6.1, top]),
        ([0.0, -0.1, base], [8.0, 0.0, top]),
        ([0.0, 6.0, base], [8.0, 6.1, top]),
        ([5.0, 0.0, base], [5.12, 1.5, top]),
        ([5.0, 2.4, base], [5.12, 6.0, top]),
        ([5.0, 1.5, base + 2.05], [5.12, 2.4, top]),  # above the door
    ]
    furniture = [
        ([1.0, 1.0, base + 0.72], [2.6, 1.9, base + 0.75]),  # a table with four legs
        *(([x, y, base], [x + 0.05, y + 0.05, base + 0.72]) for x in (1.0, 2.55) for y in (1.0, 1.85)),
        ([6.2, 3.9, base], [7.8, 5.9, base + 0.5]),  # a bed
        ([3.4, 0.2, base], [4.6, 0.7, base + 0.45]),  # a bench
        ([2.0, 2.8, base], [4.0, 4.0, base + 0.02]),  # a rug
        ([7.5, 0.3, base + 1.7], [8.0, 1.5, base + 2.2]),  # a shelf above one's head
    ]
    parts = [box(*ends) for ends in [*slab, *walls, *furniture]]
    parts.append(box([5.4, 5.2, base], [6.0, 5.9, base + 2.0], without=(0,)))  # a cabinet without a bottom
    return np.concatenate(parts)


def flat() -> np.ndarray:
    """One storey with a ceiling whose top looks walkable."""
    return np.concatenate([storey(), box([-0.1, -0.1, 2.7], [8.1, 6.1, 2.8])])


def house() -> np.ndarray:
    """Two storeys, joined by stairs of 16 steps along the wall, and a roof."""
    steps = [box([0.2 + 0.25 * k, 5.0, 0.0], [0.2 + 0.25 * (k + 1), 5.98, 2.8 * (k + 1) / 16]) for k in range(16)]
    return np.concatenate([storey(), storey(2.8, hole=True), *steps, box([-0.1, -0.1, 5.5], [8.1, 6.1, 5.6])])


def y_up(triangles: np.ndarray) -> np.ndarray:
    """As glTF has it: x to the right, y up, z to the back."""
    return np.stack([triangles[..., 0], triangles[..., 2], -triangles[..., 1]], axis=-1)


def write_glb(file: Path, triangles: np.ndarray, *, change=None, binary: bytes | None = None) -> Path:
    """A glTF 2.0 binary file with one mesh; ``change`` may spoil its description."""
    points = y_up(triangles).reshape(-1, 3).astype("<f4")
    raw = points.tobytes() if binary is None else binary
    content = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": len(raw)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(raw)}],
        "accessors": [
            {
                "bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                "min": points.min(axis=0).tolist() if len(points) else [0, 0, 0],
                "max": points.max(axis=0).tolist() if len(points) else [0, 0, 0],
            }
        ],
    }  # fmt: skip
    if change is not None:
        change(content)
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(raw), b"BIN\0") + raw
    file.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return file


def write_obj(file: Path, triangles: np.ndarray) -> Path:
    """A Wavefront file, z up as given."""
    lines = [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in triangles.reshape(-1, 3)]
    lines += [f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}" for k in range(len(triangles))]
    file.write_text("\n".join(lines) + "\n")
    return file


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
