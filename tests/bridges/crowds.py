"""Made-up recordings of pedestrians in the layouts of data sets; nothing of the data sets is in them."""

from __future__ import annotations

import math

FRAME_STEP, PERIOD = 6, 0.4
"""Pictures between two rows, and the time that they take [s]."""


def walks() -> dict[int, list[tuple[int, float, float]]]:
    """Id -> (number of the row, x, y [m]) of people who go straight, along an arc, and stand."""
    straight = [(row, -3.0 + 0.5123456789 * row, 1.25 + 0.01 * math.sin(row)) for row in range(14)]
    arc = [(row, 2.0 + 2.0 * math.cos(0.25 * row), 2.0 * math.sin(0.25 * row)) for row in range(4, 20)]
    still = [(row, 4.75, -1.5) for row in range(9, 12)]
    return {1: straight, 7: arc, 12: still}


def obsmat() -> str:
    """ETH: frame, id, x, z, y, vx, vz, vy; sorted by frames, from a frame that is not 0."""
    rows = sorted((row, who, x, y) for who, way in walks().items() for row, x, y in way)
    lines = []
    for row, who, x, y in rows:
        numbers = (780.0 + FRAME_STEP * row, float(who), x, 0.0, y, 0.1, 0.0, 0.2)
        lines.append("   ".join(f"{number:.16e}" for number in numbers))
    return "\n".join(lines) + "\n"


def trajnet(separator: str = "\t") -> str:
    """Frame id x y, as numbers with a decimal point, one person after the other."""
    lines = [
        separator.join((f"{780 + FRAME_STEP * row}.0", f"{who}.0", repr(x), repr(y)))
        for who, way in walks().items()
        for row, x, y in way
    ]
    return "\n".join(lines) + "\n"


def vsp(scale: float = 0.02) -> str:
    """UCY: splines whose points are pixels from the middle of the picture, with frames of 25 per second."""
    lines = [f"{len(walks())} - the number of splines"]
    for way in walks().values():
        lines.append(f"{len(way)} - Num of control points")
        for row, x, y in way:
            remark = " - (2D point, m_id)" if row == way[0][0] else ""
            lines.append(f"{x / scale!r} {y / scale!r} {100 + 10 * row} 42.5{remark}")
    return "\n".join(lines) + "\n"


def square(seconds: float = 120.0, people: int = 60) -> str:
    """Rows frame, id, x, y of people who walk through a square of 16 m x 10 m, one after the other, from all sides."""
    lines = []
    for who in range(people):
        angle = math.tau * 0.381966 * who
        ends = [(8 * math.cos(angle + turn), 5 * math.sin(angle + turn)) for turn in (0.0, 2.6 + 0.4 * math.sin(who))]
        speed = 1.1 + 0.3 * math.cos(3 * who)
        count = int(math.dist(*ends) / speed / PERIOD)
        first = int(who * seconds / people / PERIOD)
        for row in range(count + 1):
            x, y = ((1 - row / count) * a + row / count * b for a, b in zip(*ends, strict=True))
            lines.append(f"{FRAME_STEP * (first + row)}\t{who}\t{x:.3f}\t{y:.3f}")
    return "\n".join(lines) + "\n"
