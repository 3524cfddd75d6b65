"""Options that all reward terms have in common."""

from __future__ import annotations

from irsim.options.base import Options
from irsim.options.units import Number

__all__ = ["RewardOptions"]


class RewardOptions(Options):
    """Keys that every reward term takes."""

    name: str
    """Name of the term."""
    weight: Number = 1.0
    """Factor of the term; negative for a cost."""
