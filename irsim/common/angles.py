"""Angles wrapped to an interval of one turn."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, overload

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["FULL_TURN", "wrap"]

FULL_TURN = 2 * math.pi
"""One turn [rad]."""


@overload
def wrap(angle: float, low: float = ...) -> float: ...


@overload
def wrap(angle: NDArray[np.float64], low: float = ...) -> NDArray[np.float64]: ...


def wrap(angle: Any, low: float = -math.pi) -> Any:
    """Return the angle of the same direction in [low, low + 2 pi).

    Args:
        angle: A number or an array of numbers [rad].
        low: Lower end of the interval [rad].
    """
    return (angle - low) % FULL_TURN + low
