"""Words of tables: how a run ended, lists of failed seeds, seeds that leave no room."""

from __future__ import annotations

from irsim.common.text import listed

__all__ = ["CROWDED", "LOST", "ending", "seeds_of"]

CROWDED = "placement-crowded"
"""Outcome of an episode of a benchmark whose seed leaves no room for an object."""

LOST = "policy-lost"
"""Name of what happens to an episode whose policy, in another process, cannot go on."""


def ending(outcome: str, lost: str | None) -> str:
    """The word for how a run ended: its outcome, but ``lost`` if time was left when something was lost."""
    return "lost" if lost is not None and outcome == "timeout" else outcome


def seeds_of(failed: dict[str, list[int]], most: int) -> str:
    """List the failed seeds: ``timeout: seeds 18, 23, 32; collision: seed 7``; empty if none failed.

    Args:
        failed: Seeds by outcome.
        most: Maximum number of seeds to list per outcome.
    """
    parts = []
    for outcome, seeds in failed.items():
        parts.append(f"{outcome}: seed{'s' * (len(seeds) > 1)} {listed([str(seed) for seed in seeds], most)}")
    return "; ".join(parts)
