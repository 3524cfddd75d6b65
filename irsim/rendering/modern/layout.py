"""Where the parts of a picture are, and how large: all lengths are in units `u` of 1/96 inch, or in metres."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.scene import Bounds
from irsim.graphics.scene.sizes import NORMAL, PRINT, SMALL, STRIP, Sizes

__all__ = [
    "NORMAL",
    "POINTS_PER_U",
    "PRINT",
    "SMALL",
    "UNITS_PER_INCH",
    "Layout",
    "Sizes",
    "fit",
    "nice_length",
    "nice_part",
]

UNITS_PER_INCH = 96.0
POINTS_PER_U = 72.0 / UNITS_PER_INCH
MIN_NORMAL_WIDTH = 600.0
"""A narrower picture has the small layout [u]."""
MIN_WIDTH = 210.0
"""Least width of a picture [u], so that its title fits."""
PRINT_SIDE = 302.0
"""Longer side of a picture for print [u], which is 8 cm."""
PRINT_RATIO = 3.125
"""Pixels per u of a picture for print, which is 300 dpi."""
_NICE = (1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True)
class Layout:
    """A picture of a part of a world.

    Attributes:
        sizes: Sizes of its parts.
        width, height: Size of the picture [u].
        ratio: Pixels per u.
        scale: u per metre.
        world: x from, x to, y from, y to of the part of the world that it shows [m].
        left, bottom: Place of its lower left corner in the picture [u].
    """

    sizes: Sizes
    width: float
    height: float
    ratio: float
    scale: float
    world: Bounds
    left: float
    bottom: float

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        return round(self.width * self.ratio), round(self.height * self.ratio)

    @property
    def dpi(self) -> float:
        """Pixels per inch."""
        return UNITS_PER_INCH * self.ratio

    @property
    def extent(self) -> Bounds:
        """X from, x to, y from, y to of the whole picture in the frame of the world [m]."""
        x, y = self.at(0.0, 0.0)
        right, top = self.at(self.width, self.height)
        return x, right, y, top

    def at(self, x: float, y: float) -> tuple[float, float]:
        """The point of the world [m] at a place of the picture [u], from its lower left corner."""
        return self.world[0] + (x - self.left) / self.scale, self.world[2] + (y - self.bottom) / self.scale

    def place(self, x: float, y: float) -> tuple[float, float]:
        """The place of a point of the world in the picture [u]."""
        return (x - self.world[0]) * self.scale + self.left, (y - self.world[2]) * self.scale + self.bottom

    def places(self, points: Floats) -> Floats:
        """Places of points (N, 2) of the world in the picture [u]."""
        start = np.array([self.world[0], self.world[2]])
        placed: Floats = (np.asarray(points, dtype=np.float64) - start) * self.scale + [self.left, self.bottom]
        return placed

    def moved(self, world: Bounds) -> Layout:
        """The same layout of another part of the world of the same size."""
        return self if world == self.world else replace(self, world=world)

    def metres(self, u: float) -> float:
        """A length of the picture in metres."""
        return u / self.scale


def fit(
    world: Bounds,
    side: float,
    *,
    box: tuple[float, float] | None = None,
    printed: bool = False,
    strip: bool = False,
    ratio: float = 1.0,
    fill: bool = False,
) -> Layout:
    """Fit a part of the world into a picture without empty margins.

    Args:
        world: x from, x to, y from, y to [m].
        side: Longer side of the picture [u].
        box: Greatest width and height of the picture [u], in place of ``side``.
        printed: Whether it has the layout for print.
        strip: Whether it has the layout of a moment in a strip.
        ratio: Pixels per u.
        fill: Whether the picture is as large as the box, with the world in its middle.
    """
    wide, high = box or (side, side)
    x0, x1, y0, y1 = world
    for sizes in (STRIP,) if strip else (PRINT,) if printed else (NORMAL, SMALL):
        scale = min(max(wide - 2 * sizes.pad, 1.0) / (x1 - x0), max(high - sizes.head - sizes.foot, 1.0) / (y1 - y0))
        width = min(wide, max(scale * (x1 - x0) + 2 * sizes.pad, min(MIN_WIDTH, wide)))
        width = wide if fill else width
        if sizes.kind != "normal" or width >= MIN_NORMAL_WIDTH:
            break
    height = high if fill else scale * (y1 - y0) + sizes.head + sizes.foot
    width, height = (max(1, round(value * ratio)) / ratio for value in (width, height))
    left = (width - scale * (x1 - x0)) / 2
    return Layout(
        sizes, width, height, ratio, scale, world, left, (height - sizes.head + sizes.foot - scale * (y1 - y0)) / 2
    )


def nice_length(least: float) -> float:
    """The smallest of …, 1, 2, 5, 10, … that is at least this length."""
    ten = 10.0 ** math.floor(math.log10(least))
    return next(step * ten for step in _NICE if step * ten >= least * (1 - 1e-9))


def nice_part(most: float) -> float:
    """The largest of …, 1, 2, 5, 10, … that is at most this length."""
    ten = 10.0 ** math.floor(math.log10(most))
    return max(step * ten for step in _NICE if step * ten <= most * (1 + 1e-9))
