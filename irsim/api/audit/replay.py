"""Runs episodes of a submission again: a sample that the auditor draws, over all rows."""

from __future__ import annotations

import secrets
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from irsim.api.audit.problems import Problems, flat, is_close
from irsim.api.audit.records import named_engine, rows_of
from irsim.api.audit.suite import Claim
from irsim.api.benchmark_report import record_episode
from irsim.benchmarks.comparison import episode_row
from irsim.benchmarks.pool import cores, run_tasks
from irsim.benchmarks.preparation import Prepared
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.stored import RESULTS
from irsim.benchmarks.submission import Manifest, sampled_episodes
from irsim.common.text import plural
from irsim.diagnostics.errors import IrsimError
from irsim.episodes.episode import Progress
from irsim.results.benchmark import EpisodeRow, SuiteResult
from irsim.runs.comparison import diff_runs
from irsim.simulation.engine import engine

__all__ = ["DEFAULT_REPLAYS", "Replay", "replay_episodes"]

DEFAULT_REPLAYS = 60
"""Number of episodes that are run again: if 5 % of the rows were changed, it misses them once in 20 audits."""
_OTHER_ENGINE = 1e-6
"""Relative difference up to which numbers of another engine count as equal."""


@dataclass
class Replay:
    """The episodes that were run again.

    Attributes:
        salt: The text that has drawn the sample.
        drawn: Number of episodes in the sample.
        by_policy: Name of a policy -> number of its episodes that were run again.
        left: Why some episodes of the sample were not run again, in words.
        rows: Scenario, policy and seed of the episodes that were run again.
    """

    salt: str = ""
    drawn: int = 0
    by_policy: Counter[str] = field(default_factory=Counter)
    left: list[str] = field(default_factory=list)
    rows: set[tuple[str, str, int]] = field(default_factory=set)

    @property
    def done(self) -> int:
        """Number of episodes that were run again."""
        return len(self.rows)


def replay_episodes(
    folder: Path,
    claim: Claim,
    ready: Prepared,
    result: SuiteResult,
    manifest: Manifest,
    problems: Problems,
    *,
    number: int | Literal["all"],
    salt: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Replay:
    """Run a sample of all episodes again, and compare their rows and, where they were recorded, their traces.

    Args:
        folder: The submission.
        claim: Its claim.
        ready: The benchmark that it claims to have run, prepared here.
        result: Its result.
        manifest: Its manifest.
        problems: Gets what differs.
        number: Number of episodes.
        salt: Text that draws the sample; default: a new random one.
        workers: Greatest number of processes.
        progress: Callback ``(episodes_done, episodes_total)``.
    """
    replay = Replay(salt or secrets.token_hex(8))
    rows = rows_of(claim, result)
    chosen = sampled_episodes(replay.salt, rows, len(rows) if number == "all" else number)
    replay.drawn = len(chosen)
    texts = claim.plan.policies
    places = {(scenario, text, task.seed): at for at, (scenario, text, task) in enumerate(ready.plan)}
    wanted = sorted((places[one[0], texts[one[1]], one[2]], one) for one in chosen if one[1] not in claim.missing)
    left = Counter(one[1] for one in chosen if one[1] in claim.missing)
    replay.left = [f"{plural(left[name], 'episode')} of {name} not replayed: {claim.missing[name]}" for name in left]
    try:
        tasks = [ready.plan[at][2] for at, _ in wanted]
        results = run_tasks(tasks, workers=workers or cores(), progress=progress) if tasks else []
        recorded = {(one.scenario, one.policy, one.seed): folder / one.folder for one in manifest.sample}
        for (at, key), measured in zip(wanted, results, strict=True):
            replay.by_policy[key[1]] += 1
            replay.rows.add(key)
            _compare_row(key, rows[key], episode_row(*ready.plan[at], measured), manifest, problems)
            if key in recorded:
                _compare_trace(key, recorded[key], claim, problems)
    except IrsimError as error:
        problems.add("submission-replay", RESULTS, f"an episode cannot be run again: {error}")
    if chosen and not replay.done:
        fix = "give the files of the policies: --policy-file NAME=FILE"
        problems.add("submission-replay", RESULTS, "none of the drawn episodes could be run again", fix=fix)
    return replay


def _compare_row(
    key: tuple[str, str, int], given: EpisodeRow, known: EpisodeRow, manifest: Manifest, problems: Problems
) -> None:
    """Compare a row with the one of the same episode, run here: to the bit by the same engine."""
    mine, theirs = flat(known.model_dump()), flat(given.model_dump())
    tolerance = 0.0 if manifest.engine == engine() else _OTHER_ENGINE
    names = sorted({*mine, *theirs}, key=lambda name: (name not in ("outcome", "steps"), name))
    odd = [name for name in names if not is_close(theirs.get(name), mine.get(name), tolerance)]
    if odd:
        by = named_engine(manifest)
        more = f" and {len(odd) - 1} other values" if len(odd) > 1 else ""
        what = f"{odd[0]}{more} of the row of {', '.join(map(str, key))} differ from the episode that was run again{by}"
        problems.add("submission-replay", RESULTS, what, given=theirs.get(odd[0]), allowed=mine.get(odd[0]))


def _compare_trace(key: tuple[str, str, int], record: Path, claim: Claim, problems: Problems) -> None:
    """Record an episode again, and compare the records step by step, to the bit."""
    scenario, name, seed = key
    plan = claim.plan
    policy = shared_with(claim.policies[plan.policies[name]], plan.parts().get(scenario, {}))
    planned = next(one for one in plan.scenarios if one.name == scenario)
    with tempfile.TemporaryDirectory() as place:
        if not record_episode(planned, seed, plan, policy, Path(place) / "again"):
            problems.note(f"the record of {scenario}, {name}, seed {seed} is not compared: its map cannot be copied")
            return
        difference = diff_runs(record, Path(place) / "again")
    if not difference.same:
        where = f"{record.parent.name}/{record.name}"
        problems.add("submission-replay", where, f"the same episode, recorded again, differs: {difference.summary}")
