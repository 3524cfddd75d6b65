"""Types of NumPy arrays, and ranges of their indices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "range_of"]

Floats = NDArray[np.float64]
"""Array of floats; the docstring of its function gives shape, unit and frame."""


def range_of(chosen: NDArray[np.bool_]) -> slice | NDArray[np.bool_]:
    """The slice of the chosen ones if they follow one another, so that indexing makes no copy; else what is given."""
    found = np.flatnonzero(chosen)
    together = found.size > 0 and found[-1] - found[0] + 1 == found.size
    return slice(int(found[0]), int(found[-1]) + 1) if together else chosen
