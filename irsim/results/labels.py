"""Short names for behaviors that are given with many options, and short lists of seeds. Nothing of the engine."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["labels_of", "seeds_of"]

_LONGEST = 24


def labels_of(behaviors: Sequence[str]) -> dict[str, str]:
    """What to call each behavior: a long one by its name and its place in the list, as ``orca #2``."""
    return {
        text: text if len(text) <= _LONGEST else f"{_name(text)} #{place}"
        for place, text in enumerate(behaviors, start=1)
    }


def _name(text: str) -> str:
    """The name in a behavior that is known to be one."""
    if not text.lstrip().startswith("{"):
        return text.strip()
    from irsim.scenario.yaml.document import load_text

    return str(load_text(text).data["name"])


def seeds_of(failed: dict[str, list[int]], most: int) -> str:
    """Which seeds failed: ``timeout: seeds 18, 23, 32; collision: seed 7``; empty if none did.

    Args:
        failed: Seeds by how they ended.
        most: Seeds at most of each.
    """
    told = []
    for outcome, seeds in failed.items():
        more = f" and {len(seeds) - most} more" if len(seeds) > most else ""
        told.append(f"{outcome}: seed{'s' * (len(seeds) > 1)} {', '.join(map(str, seeds[:most]))}{more}")
    return "; ".join(told)
