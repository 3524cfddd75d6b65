"""Compatibility with IR-SIM 2.12: old module paths, old helpers, and the list of intended differences.

The list is data for the tests and for the published page, ``irsim/compat/README.md``.
"""

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
