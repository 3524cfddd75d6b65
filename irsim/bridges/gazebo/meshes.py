"""Prisms as files of meshes (Wavefront OBJ)."""

from __future__ import annotations

from irsim.common.arrays import Floats

__all__ = ["prism"]


def prism(corners: Floats, bottom: float, top: float) -> str:
    """A convex outline between two heights, as text of an OBJ file whose faces look outwards.

    Args:
        corners: (K, 2) counterclockwise [m].
        bottom: Height of its lower end [m].
        top: Height of its upper end [m].
    """
    count = len(corners)
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for z in (bottom, top) for x, y in corners.tolist()]
    for k in range(1, count - 1):
        lines.append(f"f 1 {k + 2} {k + 1}")
        lines.append(f"f {count + 1} {count + k + 1} {count + k + 2}")
    for k in range(count):
        a, b = k + 1, (k + 1) % count + 1
        lines.append(f"f {a} {b} {count + b}")
        lines.append(f"f {a} {count + b} {count + a}")
    return "\n".join(lines) + "\n"
