"""What differs between the episodes of a scenario, besides drawn places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["DrawnQuantity", "Variation", "VariedLevel"]


@dataclass(frozen=True, slots=True)
class DrawnQuantity:
    """A quantity that is drawn for each scene, uniformly; see ``Variation`` in ``irsim/_core.pyi``.

    Attributes:
        quantity: number, size, speed, acceleration, sensor_noise or latency.
        word: Name of the objects in the task.
        objects: Their ids.
        low, high: Range.
        same: Whether all objects share one draw.
    """

    quantity: str
    word: str
    objects: Sequence[int]
    low: float
    high: float
    same: bool = False


@dataclass(frozen=True, slots=True)
class VariedLevel:
    """What is drawn at one level of a curriculum: quantities, and one of some variants of the scenario."""

    drawn: Sequence[DrawnQuantity] = ()
    first_variant: int = 0
    variants: int = 0


@dataclass(frozen=True, slots=True)
class Variation:
    """What is drawn at each level, and the variants of all levels: the same objects elsewhere, of other shapes."""

    levels: Sequence[VariedLevel]
    variants: Sequence[ResolvedScenario] = ()
