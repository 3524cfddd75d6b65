"""What is the same as in IR-SIM 2.12, what differs on purpose, and why: data for tests and for the published page."""

from irsim.compat.differences import DIFFERENCES, KEY_DIFFERENCES, NAME_DIFFERENCES, Difference
from irsim.compat.names import missing_names, reference_names

__all__ = [
    "DIFFERENCES",
    "KEY_DIFFERENCES",
    "NAME_DIFFERENCES",
    "Difference",
    "missing_names",
    "reference_names",
]
