"""IR-SIM 2.12 over the world of irsim: its names, and its differences as data for tests and the published page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.compat.differences import DIFFERENCES, KEY_DIFFERENCES, NAME_DIFFERENCES, Difference
    from irsim.compat.names import missing_names, reference_names

__all__ = ["DIFFERENCES", "KEY_DIFFERENCES", "NAME_DIFFERENCES", "Difference", "missing_names", "reference_names"]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "DIFFERENCES": "irsim.compat.differences",
        "Difference": "irsim.compat.differences",
        "KEY_DIFFERENCES": "irsim.compat.differences",
        "NAME_DIFFERENCES": "irsim.compat.differences",
        "missing_names": "irsim.compat.names",
        "reference_names": "irsim.compat.names",
    },
)
