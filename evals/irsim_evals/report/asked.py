"""What the case of a trial asks, as far as the report needs it: files to start with, seeds, length of the episodes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from irsim_evals.cases.store import all_case_ids, case_of, given_pictures
from irsim_evals.results import Results, Trial, cases_hash

__all__ = ["Asked", "asked_of"]

_EPISODE_S = 10.0
"""Length of the episode that is drawn where a case has none [s]."""


@dataclass(frozen=True)
class Asked:
    """What a case asks.

    Attributes:
        known: Whether the case is one of those that are installed, unchanged.
        given: Files that the agent started with.
        seed: Seed of the first world.
        episode_seed: Seed of the first episode.
        episode_seconds: Its length [s].
        episode_behavior: Behavior that drives the robots in it instead of theirs.
        pictures: Pictures that the agent started with: name → content of the file.
    """

    known: bool = False
    given: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0
    episode_seed: int = 0
    episode_seconds: float = _EPISODE_S
    episode_behavior: str | None = None
    pictures: Mapping[str, bytes] = field(default_factory=dict)


def asked_of(results: Results) -> list[Asked]:
    """What the case of each trial asks; nothing is known if the trials were made with other cases than the present."""
    if results.cases != cases_hash():
        return [Asked() for _ in results.trials]
    found: dict[tuple[str, str], Asked] = {}
    for trial in results.trials:
        if trial.key not in found:
            found[trial.key] = _asked(trial)
    return [found[trial.key] for trial in results.trials]


def _asked(trial: Trial) -> Asked:
    if trial.verdict.case not in all_case_ids():
        return Asked()
    try:
        instance = case_of(trial.verdict.case, int(trial.verdict.instance) if trial.verdict.instance else None)
    except ValueError:  # an instance that is no number
        return Asked()
    case = instance.case
    plan = case.episodes[0] if case.episodes else None
    return Asked(
        known=True,
        given=case.files,
        seed=case.seeds[0],
        episode_seed=plan.seeds[0] if plan else case.seeds[0],
        episode_seconds=float(plan.seconds) if plan else _EPISODE_S,
        episode_behavior=plan.behavior if plan else None,
        pictures=given_pictures(instance),
    )
