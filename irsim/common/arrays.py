"""Types of NumPy arrays, and ranges of their indices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "range_of"]

Floats = NDArray[np.float64]
"""Array of floats; the docstring of its function gives shape, unit and frame."""


def range_of(chosen: NDArray[np.bool_]) -> slice | NDArray[np.bool_]:
    """The slice of the chosen ones if they follow one another, so that indexing makes no copy; else what is given."""
    indices = np.flatnonzero(chosen)
    together = indices.size > 0 and indices[-1] - indices[0] + 1 == indices.size
    return slice(int(indices[0]), int(indices[-1]) + 1) if together else chosen
