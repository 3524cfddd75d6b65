"""Options that all distributions have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from irsim.options.base import Options

__all__ = ["MARGIN", "DistributionOptions", "Drawn", "WorldExtent"]

MARGIN = 0.5
"""Distance of drawn places from the edge of the world [m], unless the options say where they are."""


class DistributionOptions(Options):
    """How the objects of one entry are placed."""

    name: str
    """Name of the distribution."""


class WorldExtent(Protocol):
    """World data that a distribution may use: size [m] and middle."""

    @property
    def width(self) -> float:
        """Extent along x [m]."""

    @property
    def height(self) -> float:
        """Extent along y [m]."""

    @property
    def center(self) -> tuple[float, float]:
        """x, y of the middle [m]."""

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max [m]."""


@dataclass(frozen=True)
class Drawn:
    """Where a distribution with a kernel draws places.

    Attributes:
        low: Smallest x [m], y [m] and heading [rad] of a place, world frame.
        high: Greatest x, y and heading.
        min_distance: Smallest distance between the positions of its objects that the options ask for [m].
        kernel: Fields of the kernel, without the objects and the number of attempts.
        clear_of: Names of the objects and groups that its objects keep clear of, and how far from each [m].
    """

    low: list[float]
    high: list[float]
    min_distance: float
    kernel: Mapping[str, Any]
    clear_of: Sequence[tuple[str, float]] = ()
