"""Options that all distributions have in common."""

from __future__ import annotations

from irsim.options.base import Options

__all__ = ["DistributionOptions"]


class DistributionOptions(Options):
    """How the objects of one entry are placed."""

    name: str
    """Name of the distribution."""
