"""Made-up files of splats, and a room made of them whose ground plan is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

FIELDS = (
    "x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
    "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
)  # fmt: skip
SH_0 = 0.28209479177387814


def table(rows: Any) -> NDArray[np.float64]:
    """Rows x, y, z, rgb, alpha, scales, quaternion -> the columns of a file."""
    rows = np.asarray(rows, dtype=np.float64).reshape(-1, 14)
    alpha = rows[:, 6]
    return np.column_stack([
        rows[:, :3], np.zeros((len(rows), 3)), (rows[:, 3:6] - 0.5) / SH_0, np.log(alpha / (1 - alpha)),
        np.log(rows[:, 7:10]), rows[:, 10:14],
    ])  # fmt: skip


def write_ply(
    path: Path,
    columns: NDArray[np.float64],
    *,
    fields: Sequence[str] = FIELDS,
    encoding: str = "binary_little_endian",
    kinds: dict[str, str] | None = None,
    count: int | str | None = None,
) -> Path:
    """Write a file; what differs from a good one is chosen by the caller."""
    names = {name: (kinds or {}).get(name, "float") for name in fields}
    codes = {"float": "f4", "double": "f8", "uchar": "u1", "int": "i4"}
    head = f"ply\nformat {encoding} 1.0\ncomment made up\nelement vertex {len(columns) if count is None else count}\n"
    head += "".join(f"property {kind} {name}\n" for name, kind in names.items()) + "end_header\n"
    if encoding == "ascii":
        body = "".join(" ".join(map(repr, row)) + "\n" for row in columns.tolist()).encode()
    else:
        order = "<" if encoding == "binary_little_endian" else ">"
        rows = np.zeros(len(columns), dtype=[(name, order + codes[kind]) for name, kind in names.items()])
        for number, name in enumerate(names):
            rows[name] = columns[:, number]
        body = rows.tobytes()
    path.write_bytes(head.encode() + body)
    return path


@dataclass(frozen=True)
class Room:
    """Columns of a file, corners x, y of what stands in the room (frame of irsim), and the size of the room."""

    columns: NDArray[np.float64]
    boxes: tuple[tuple[float, float, float, float], ...]
    size: tuple[float, float]

    def truth(self, origin: tuple[float, float], cell: float, shape: tuple[int, int]) -> NDArray[np.bool_]:
        """(nx, ny) cells into which a box reaches."""
        x, y = (origin[axis] + np.arange(shape[axis]) * cell for axis in (0, 1))
        taken = np.zeros(shape, dtype=bool)
        for left, low, right, high in self.boxes:
            taken |= ((x + cell > left) & (x < right))[:, None] & ((y + cell > low) & (y < high))[None, :]
        return taken


_TURN = np.sqrt(0.5)
_FACES = {0: (_TURN, 0.0, _TURN, 0.0), 1: (_TURN, _TURN, 0.0, 0.0), 2: (1.0, 0.0, 0.0, 0.0)}
"""Quaternions that turn the thin z axis of a splat along x, y and z."""


def room(
    seed: int = 1, *, spacing: float = 0.05, floaters: float = 0.05, axes: Any = None, shift: Any = (0, 0, 0)
) -> Room:
    """Walls, furniture, floor and ceiling of flat splats, and a share of faint ones; ``axes`` belong to irsim."""
    rng = np.random.default_rng(seed)
    width, height, wall, top = 8.0, 6.0, 0.2, 2.4
    offset = np.array([0.013, 0.021])  # no wall is at the border of cells
    solids = [
        ((0, 0, 0), (width, wall, top), (0.8, 0.75, 0.65)),
        ((0, height - wall, 0), (width, height, top), (0.75, 0.8, 0.7)),
        ((0, wall, 0), (wall, height - wall, top), (0.7, 0.7, 0.85)),
        ((width - wall, wall, 0), (width, height - wall, top), (0.8, 0.7, 0.7)),
        ((3.0, 2.6, 0), (4.6, 3.6, 0.8), (0.55, 0.35, 0.2)),
        ((6.0, 1.2, 0), (6.5, 1.7, top), (0.3, 0.5, 0.7)),
        ((1.6, 4.4, 0), (2.6, 5.0, 1.2), (0.35, 0.6, 0.35)),
    ]
    levels = ((0.0, (0.6, 0.6, 0.58)), (top, (0.9, 0.9, 0.9)))
    parts = [_face(rng, (0, 0), (width, height), 2, z, color, spacing) for z, color in levels]
    for low, high, color in solids:
        parts += _box(rng, np.array(low, float), np.array(high, float), color, spacing)
    solid = np.concatenate(parts)
    for low, high, _ in solids:  # the floor in them cannot be seen
        hidden = (solid[:, 2] < 0.05) & (solid[:, :2] > np.add(low[:2], 0.01)).all(axis=1)
        solid = solid[~(hidden & (solid[:, :2] < np.subtract(high[:2], 0.01)).all(axis=1))]
    solid[:, :2] += offset
    fog = np.zeros((round(floaters / (1 - floaters) * len(solid)), 14))
    fog[:, :3] = rng.uniform([0, 0, 0], [width, height, top], (len(fog), 3))
    fog[:, 3:6] = 0.7
    fog[:, 6] = rng.uniform(0.01, 0.12, len(fog))
    fog[:, 7:10] = rng.uniform(0.01, 0.08, (len(fog), 3))
    fog[:, 10:] = rng.normal(size=(len(fog), 4))
    columns = table(np.concatenate([solid, fog]))
    if axes is not None:
        columns = turned(columns, np.asarray(axes, float), np.asarray(shift, float))
    boxes = tuple((*np.add(low[:2], offset), *np.add(high[:2], offset)) for low, high, _ in solids)
    return Room(columns, boxes, (width, height))


def turned(columns: NDArray[np.float64], axes: NDArray[np.float64], shift: NDArray[np.float64]) -> NDArray[np.float64]:
    """Columns of a file in another frame, by a rotation and a shift."""
    from irsim.bridges.frames import quaternion_of

    result = columns.copy()
    result[:, :3] = columns[:, :3] @ axes.T + shift
    x, y, z, w = quaternion_of(axes)
    a, b, c, d = columns[:, 13:17].T
    result[:, 13:17] = np.column_stack([
        w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b, w * d + x * c - y * b + z * a,
    ])  # fmt: skip
    return result


def _face(
    rng: np.random.Generator, low: Any, high: Any, normal: int, at: float, color: Any, spacing: float
) -> NDArray[np.float64]:
    """Flat splats on a rectangle that is perpendicular to an axis."""
    sides = [np.arange(a + spacing / 2, b, spacing) for a, b in zip(low, high, strict=True)]
    first, second = (values.ravel() for values in np.meshgrid(*sides, indexing="ij"))
    rows = np.zeros((len(first), 14))
    others = [axis for axis in range(3) if axis != normal]
    rows[:, others[0]], rows[:, others[1]] = first, second
    rows[:, others] += rng.normal(0, spacing / 8, (len(rows), 2))
    rows[:, normal] = at
    rows[:, 3:6] = np.clip(np.asarray(color) + rng.normal(0, 0.03, (len(rows), 1)), 0.02, 0.98)
    rows[:, 6] = rng.uniform(0.8, 0.98, len(rows))
    rows[:, 7:10] = [spacing * 0.6, spacing * 0.6, 0.004]
    rows[:, 10:] = _FACES[normal]
    return rows


def _box(rng: np.random.Generator, low: Any, high: Any, color: Any, spacing: float) -> list[NDArray[np.float64]]:
    """The sides and the top of a box."""
    faces = []
    for normal in range(3):
        others = [axis for axis in range(3) if axis != normal]
        for at in (low[normal], high[normal]) if normal < 2 else (high[normal],):
            shade = np.asarray(color) * (1.0, 0.9, 1.1)[normal]
            faces.append(_face(rng, low[others], high[others], normal, at, shade, spacing))
    return faces
