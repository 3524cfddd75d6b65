"""Labels in tables: short ones for behaviors with many options, lists of failed seeds, seeds without room."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.common.text import listed

__all__ = ["CROWDED", "LOST", "ending", "labels_of", "seeds_of"]

CROWDED = "placement-crowded"
"""Outcome of an episode of a benchmark whose seed leaves no room for an object."""

LOST = "policy-lost"
"""Name of what happens to an episode whose policy, in another process, cannot go on."""

MAX_LABEL = 24
"""Characters of a behavior that is its own label; a longer one is numbered."""


def ending(outcome: str, lost: str | None) -> str:
    """The word for how a run ended: its outcome, but ``lost`` if time was left when something was lost."""
    return "lost" if lost is not None and outcome == "timeout" else outcome


def labels_of(behaviors: Sequence[str]) -> dict[str, str]:
    """Return a label for each behavior: a long one gets its name and its place in the list, as ``orca #2``."""
    return {
        text: text if len(text) <= MAX_LABEL else f"{_name(text)} #{place}"
        for place, text in enumerate(behaviors, start=1)
    }


def _name(text: str) -> str:
    """Return the name in a behavior that is known to be valid."""
    if not text.lstrip().startswith("{"):
        return text.strip()
    from irsim.scenario.yaml.document import load_text

    return str(load_text(text).data["name"])


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
