"""The box around a footprint, for programs that know bodies as boxes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irsim.common.outline import Outline
from irsim.simulation.scene import SceneObject

__all__ = ["Box", "box_of"]

_THINNEST = 0.01
"""Smallest side of a box [m]: walls have no thickness."""


@dataclass(frozen=True)
class Box:
    """A box whose sides are along the axes of the body.

    Attributes:
        ahead: How far its middle is ahead of the origin of the body [m]: a car turns about its rear axle.
        left: How far its middle is to the left of it [m].
        length: Size along x [m].
        width: Size along y [m].
    """

    ahead: float
    left: float
    length: float
    width: float


def box_of(agent: SceneObject) -> Box:
    """The smallest such box around a footprint; around its circle if it has none."""
    low, high = Outline(agent.parts).box()
    if not np.isfinite(low).all():
        low, high = np.full(2, -agent.radius), np.full(2, agent.radius)
    (ahead, left), (length, width) = (low + high) / 2, np.maximum(high - low, _THINNEST)
    return Box(float(ahead), float(left), float(length), float(width))
