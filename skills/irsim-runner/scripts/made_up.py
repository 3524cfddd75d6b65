#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = []
# ///
"""Write a made-up file of another program, to try a bridge with.

A name that ends in .ply gets 4,000 Gaussian splats: a room of 6 m x 4 m with a box in it, z up. One in .txt gets
four pedestrians: rows of frame, id, x, y [m], with ten frames (0.4 s) between rows, as in TrajNet.

Exits with 0 if the file was written, 2 if its name ends otherwise.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

FIELDS = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"] + [
    f"{kind}_{number}" for kind, count in (("scale", 3), ("rot", 4)) for number in range(count)
]
Box = tuple[float, float, float, float, float]
"""Lower left and upper right corner, and height [m]."""
WALLS: tuple[Box, ...] = ((0, 0, 6, 0.1, 2), (0, 3.9, 6, 4, 2), (0, 0, 0.1, 4, 2), (5.9, 0, 6, 4, 2), (2, 1, 3, 2, 1))


def splats() -> Iterator[tuple[float, ...]]:
    """Flat splats on the floor, round ones in the walls and the box."""
    numbers = random.Random(1)
    for _ in range(1500):
        yield _splat((numbers.uniform(0, 6), numbers.uniform(0, 4), 0.0), (0.08, 0.08, 0.01), 0.2)
    for x0, y0, x1, y1, height in WALLS:
        for _ in range(500):
            place = numbers.uniform(x0, x1), numbers.uniform(y0, y1), numbers.uniform(0, height)
            yield _splat(place, (0.06, 0.06, 0.06), 0.8)


def _splat(place: tuple[float, float, float], sizes: tuple[float, float, float], grey: float) -> tuple[float, ...]:
    color = (grey - 0.5) / 0.28209479177387814  # of the zeroth spherical harmonic
    opacity = math.log(0.9 / 0.1)
    return (*place, color, color, color, opacity, *map(math.log, sizes), 1.0, 0.0, 0.0, 0.0)


def pedestrians() -> Iterator[str]:
    """Four people who walk to and fro between x = 0 and x = 8."""
    for frame in range(0, 300, 10):
        for person in range(4):
            x = 0.4 * frame / 10 * (0.6 + 0.1 * person)
            yield f"{frame} {person + 1} {x if person % 2 == 0 else 8 - x:.3f} {1.5 * person:.3f}\n"


def main() -> int:
    """Write the file that is named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="the file to write, such as room.ply or walk.txt")
    out: Path = parser.parse_args().out
    if out.suffix == ".ply":
        rows = list(splats())
        head = [f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n"]
        head += [f"property float {name}\n" for name in FIELDS]
        body = b"".join(struct.pack(f"<{len(FIELDS)}f", *row) for row in rows)
        out.write_bytes("".join([*head, "end_header\n"]).encode() + body)
    elif out.suffix == ".txt":
        out.write_text("".join(pedestrians()), encoding="utf-8")
    else:
        print(json.dumps({"said": f"{out}: the name must end in .ply or .txt"}))
        return 2
    print(json.dumps({"file": str(out)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
