"""Incidents of a benchmark besides outcomes: contacts of people and between steps, objects lost, seeds without room."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.common.text import listed, plural
from irsim.results.benchmark import CROWDED, LOST, EpisodeRow

__all__ = ["incident_counts", "incident_messages", "incident_seeds", "placed"]

_MAX_SEEDS = 5
"""Number of seeds without room that a message lists."""
_MAX_HEADLINE_SEEDS = 3
"""Number of seeds of an incident that a message lists."""


def placed(episodes: Sequence[EpisodeRow]) -> list[EpisodeRow]:
    """The episodes that took place: those whose seed had room for every object."""
    return [episode for episode in episodes if episode.outcome != CROWDED]


def incident_counts(episodes: Sequence[EpisodeRow]) -> dict[str, int]:
    """Number of episodes by incident; incidents that did not occur are left out."""
    return {key: len(affected) for key, affected in _episodes_with(episodes).items() if affected}


def incident_seeds(episodes: Sequence[EpisodeRow]) -> dict[str, list[int]]:
    """Seeds of the episodes of one row by incident; incidents that did not occur are left out."""
    return {
        key: sorted(episode.seed for episode in affected)
        for key, affected in _episodes_with(episodes).items()
        if affected
    }


def _episodes_with(episodes: Sequence[EpisodeRow]) -> dict[str, list[EpisodeRow]]:
    """Episodes with each incident."""
    return {
        "human_contacts": [episode for episode in episodes if episode.human_contacts > 0],
        "left": [episode for episode in episodes if episode.left],
        "jumped": [episode for episode in episodes if episode.jumped],
        "contacts_between_steps": [
            episode for episode in episodes if (episode.metrics.get("contacts_between_steps") or 0.0) > 0.0
        ],
        "seen": [episode for episode in episodes if (episode.metrics.get("seen_ratio") or 0.0) > 0.0],
        LOST: [episode for episode in episodes if episode.lost],
        CROWDED: [episode for episode in episodes if episode.outcome == CROWDED],
    }


def _seeds(seeds: Sequence[int]) -> str:
    """The first seeds in words, each once: ``seeds 1, 4, 7 and 2 more``."""
    each = sorted(set(seeds))
    return f"seed{'s' * (len(each) > 1)} {listed([str(seed) for seed in each], _MAX_HEADLINE_SEEDS)}"


def incident_messages(episodes: Sequence[EpisodeRow]) -> list[str]:
    """Incidents besides outcomes, with the number of episodes; empty without incidents.

    Args:
        episodes: The episodes of all scenarios and behaviors.
    """
    messages, seeds_of = list[str](), incident_seeds(episodes)
    words = {
        "contacts_between_steps": "robots touched something between steps in",
        "human_contacts": "contacts between people, or other moving obstacles, in",
        "left": "objects left the world in",
        "jumped": "objects jumped over their goal in",
        "seen": "robots were seen in",
    }
    for key, what in words.items():
        if key in seeds_of:
            contacts = sum(episode.human_contacts for episode in episodes) if key == "human_contacts" else 0
            count = f"{plural(contacts, 'contact')}; " if contacts else ""
            where = f"({count}{_seeds(seeds_of[key])})"
            messages.append(f"{what} {len(seeds_of[key])} of {len(placed(episodes))} episodes {where}")
    if LOST in seeds_of:
        why = next(episode.lost for episode in episodes if episode.lost)
        many = f"{len(seeds_of[LOST])} of {len(placed(episodes))} episodes"
        messages.append(f"the policy was lost in {many} ({_seeds(seeds_of[LOST])}), which ended there: {why}")
    for name in dict.fromkeys(episode.scenario for episode in episodes):
        mine = [episode for episode in episodes if episode.scenario == name]
        crowded = sorted({episode.seed for episode in mine if episode.outcome == CROWDED})
        if crowded:
            where = f" of {name}" if len({episode.scenario for episode in episodes}) > 1 else ""
            count = f"{len(crowded)} of {len({episode.seed for episode in mine})} seeds{where}"
            seeds = listed([str(seed) for seed in crowded], _MAX_SEEDS)
            messages.append(f"{count} had no room and do not count ({CROWDED}): {seeds}")
    return messages
