"""What happened in the episodes of a benchmark besides their outcomes, in words and numbers."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.common.text import listed
from irsim.results.benchmark import EpisodeRow
from irsim.results.labels import CROWDED

__all__ = ["incident_counts", "incident_messages", "incident_seeds", "placed"]

_MAX_SEEDS = 5
"""Number of seeds that a message lists."""


def placed(episodes: Sequence[EpisodeRow]) -> list[EpisodeRow]:
    """The episodes that took place: those whose seed had room for every object."""
    return [episode for episode in episodes if episode.outcome != CROWDED]


def incident_counts(episodes: Sequence[EpisodeRow]) -> dict[str, int]:
    """Number of episodes by incident; incidents that did not occur are left out."""
    return {key: len(found) for key, found in _episodes_with(episodes).items() if found}


def incident_seeds(episodes: Sequence[EpisodeRow]) -> dict[str, list[int]]:
    """Seeds of the episodes of one row by incident; incidents that did not occur are left out."""
    return {key: sorted(episode.seed for episode in found) for key, found in _episodes_with(episodes).items() if found}


def _episodes_with(episodes: Sequence[EpisodeRow]) -> dict[str, list[EpisodeRow]]:
    """Episodes with each incident."""
    return {
        "human_contacts": [episode for episode in episodes if episode.human_contacts > 0],
        "left": [episode for episode in episodes if episode.left],
        "jumped": [episode for episode in episodes if episode.jumped],
        "seen": [episode for episode in episodes if (episode.metrics.get("seen_ratio") or 0.0) > 0.0],
        CROWDED: [episode for episode in episodes if episode.outcome == CROWDED],
    }


def incident_messages(episodes: Sequence[EpisodeRow]) -> list[str]:
    """What happened besides outcomes, with the number of episodes; empty if nothing did.

    Args:
        episodes: The episodes of all scenarios and behaviors.
    """
    counts, found = incident_counts(episodes), []
    of_all = f" of {len(placed(episodes))} episodes"
    if many := counts.get("human_contacts"):
        contacts = sum(episode.human_contacts for episode in episodes)
        found.append(f"contacts between people in {many}{of_all} ({contacts} contact{'s' * (contacts != 1)})")
    if many := counts.get("left"):
        found.append(f"objects left the world in {many}{of_all}")
    if many := counts.get("jumped"):
        found.append(f"objects jumped over their goal in {many}{of_all}")
    if many := counts.get("seen"):
        found.append(f"robots were seen in {many}{of_all}")
    for name in dict.fromkeys(episode.scenario for episode in episodes):
        mine = [episode for episode in episodes if episode.scenario == name]
        crowded = sorted({episode.seed for episode in mine if episode.outcome == CROWDED})
        if crowded:
            where = f" of {name}" if len({episode.scenario for episode in episodes}) > 1 else ""
            count = f"{len(crowded)} of {len({episode.seed for episode in mine})} seeds{where}"
            seeds = listed([str(seed) for seed in crowded], _MAX_SEEDS)
            found.append(f"{count} had no room and do not count ({CROWDED}): {seeds}")
    return found
