"""``irsim.benchmark``: compare policies over scenarios and seeds, on all cores, with metrics and intervals.

The comparison is fair: every policy runs the same scenarios with the same seeds and horizons, and differences are
computed episode by episode.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from irsim.benchmarks.cluster import run_on_cluster
from irsim.benchmarks.episode import Task
from irsim.benchmarks.log import Log, check_places, logged, with_episodes
from irsim.benchmarks.policies import (
    label_of,
)
from irsim.benchmarks.pool import MAX_GROUP, cores, run_tasks
from irsim.benchmarks.preparation import DEFAULT_SEEDS, prepare
from irsim.benchmarks.timing import time_behavior, timing_report
from irsim.common.arguments import check_whole_number
from irsim.common.keywords import answers_misspelt
from irsim.episodes.episode import Progress
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import PolicySource
from irsim.policies.policy import Policy
from irsim.results.benchmark import BenchmarkResult, EpisodeRow
from irsim.results.run import EpisodeUntil
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import Limits
from irsim.scenario.perturbation import (
    Perturbations,
)
from irsim.scenario.yaml.document import Document

__all__ = ["AS_WRITTEN", "DEFAULT_SEEDS", "benchmark", "episode_row", "logged"]

_SEEDS_PER_TURN = {False: 5, True: MAX_GROUP}
"""Number of seeds that one policy runs before the next one, so that an interrupted benchmark can be compared, too: few,
or where policies are networks as many as are run together."""
_COPIED = (
    *("outcome", "steps", "sim_time", "time_limit", "unreachable", "failures"),
    *("human_contacts", "left", "jumped", "lost", "zones", "roles"),
)
"""Keys of the result of an episode that its row repeats."""


@answers_misspelt
def benchmark(
    files: str | Path | Sequence[str | Path] | Mapping[str, str | Path | Document],
    policies: PolicySource | Sequence[PolicySource] | None = None,
    seeds: int | str | Iterable[int] = DEFAULT_SEEDS,
    *,
    behaviors: PolicySource | Sequence[PolicySource] | None = None,
    perturb: Perturbations | None = None,
    steps: int | None = None,
    strict: bool = False,
    imports: Sequence[str] = (),
    workers: int | None = None,
    cluster: str | None = None,
    limits: Limits | None = None,
    most_episodes: int | None = None,
    progress: Progress | None = None,
    log: str | Path | None = None,
    resume: bool = False,
    until: EpisodeUntil = "done",
    groups: Mapping[str, Sequence[str]] | None = None,
    parts: Mapping[str, Mapping[str, Policy | None]] | None = None,
    timing: dict[str, Any] | None = None,
) -> BenchmarkResult:
    """Run every scenario under every policy with every seed, and compare.

    Results depend neither on the number of workers nor on the cluster. A scenario that leaves nothing to chance is run
    once per policy.
    An episode whose seed leaves no room for an object has the outcome ``placement-crowded`` and counts in no mean.

    Args:
        files: Scenario files; a string with a line break is the text of a scenario, called ``(text)`` in the result. A
            mapping gives them other names in the result.
        policies: Policies of all robots, as :func:`irsim.open_policy` takes them: names of behaviors (``orca``) or of
            plug-ins, with options as mappings in Python or as YAML text (``{name: orca, timeHorizon: 5}``), files
            (``model.npz``), functions, policies, or ``as-written`` for the behaviors of the scenario (default).
            Differences are to the first one.
        behaviors: Another name of ``policies``.
        seeds: The number of seeds (0, 1, 2, …), or the seeds: a list, or text such as ``5-9`` or ``1,4,7``.
        perturb: Changes by each seed, to see whether a scenario still works when things start slightly differently:
            one or several of a mapping such as ``{"position": 0.1, "heading": 0.2, "speed": 0.1, "delay": 2}``, text
            as on the command line (``position=0.1,heading=10deg,objects=scout``), or a
            :class:`irsim.scenario.perturbation.Perturbation`, which describes the keys. Draws are uniform.
        steps: Horizon in steps, which overrides ``world.time_limit``.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules to import first, for behaviors that they register.
        workers: Greatest number of processes; default: the number of cores of this machine, or of the cluster.
        cluster: Address of a Ray cluster that runs the episodes: ``auto`` (the one of RAY_ADDRESS or of this machine,
            started if missing), ``ray://host:port``, or ``host:port`` on a machine of the cluster. Its machines
            need this version of irsim, and the modules of ``imports``; scenarios and maps are sent to them.
        limits: Limits of the loader and of each run.
        most_episodes: Greatest number of episodes; more are refused.
        progress: Callback ``(episodes_done, episodes_total)``.
        log: File to which every episode is written as soon as it is done; ``irsim.benchmarks.logged(log)`` reads their
            result, also after the benchmark was interrupted.
        resume: Go on with the log of an interrupted benchmark: its episodes are not run again.
        until: ``done`` ends an episode when every robot has arrived or stopped, ``first_collision`` also when one
            collides.
        groups: Name of a group → its scenarios, which are summarised together as ``(all NAME)``.
        parts: Name of a scenario → name or tag of its robots → the policy that drives them, whatever policy is
            compared, or None for the compared one. The result then has metrics by role.
        timing: Receives the wall-clock times of decisions, see :func:`irsim.benchmarks.timing.timing_report`.

    Raises:
        ScenarioError: A scenario has errors, perhaps only with one of the policies; ScenarioNotFoundError: there is no
            such file.
        OverLimitError: More episodes or steps are requested than the limits allow.
        InputError: There is no such policy, or the seeds, a perturbation or another argument are invalid.
        PolicyError: A policy cannot drive the robots of a scenario, or failed.
        RunError: The log cannot be written.
        ExtraError: Ray is not installed; ClusterError: no cluster answers, or it has another irsim or lacks a module.
        WorkerError: Several processes have died in the same episode.
    """
    if workers is not None:
        workers = check_whole_number("workers", workers, 1)
    head, opened, plan = prepare(
        files, policies, seeds, behaviors=behaviors, perturb=perturb, steps=steps, strict=strict, imports=imports,
        limits=limits, most_episodes=most_episodes, until=until, groups=groups, parts=parts,
        send_maps=cluster is not None,
    )  # fmt: skip
    turn = _SEEDS_PER_TURN[any(policy.batch_invariant for policy in opened)]
    rank = {seed: position // turn for position, seed in enumerate(head.seeds)}
    place = {name: position for position, name in enumerate(head.scenarios)}
    turns = sorted(range(len(plan)), key=lambda number: (place[plan[number][0]], rank[plan[number][2].seed]))
    head, known = Log.known(log, head) if log is not None and resume else (head, {})
    check_places(known, [(name, behavior, task.seed) for name, behavior, task in plan])
    with nullcontext() if log is None else Log(log, head, known) as book:

        def keep(number: int, result: Mapping[str, Any]) -> None:
            if book is not None:
                book.add(turns[number], episode_row(*plan[turns[number]], result))

        turns = [number for number in turns if number not in known]
        ordered, report = [plan[number][2] for number in turns], _after(progress, len(known))
        if cluster is None:
            results = run_tasks(ordered, workers=workers or cores(), progress=report, kept=keep)
        else:
            results = run_on_cluster(ordered, address=cluster, workers=workers, progress=report, kept=keep)
    if timing is not None:
        timing.update(_timing(opened, plan, dict(zip(turns, results, strict=True))))
    episodes = known | {
        number: episode_row(*plan[number], result) for number, result in zip(turns, results, strict=True)
    }
    return with_episodes(head, [episodes[number] for number in range(len(plan))])


def episode_row(scenario: str, behavior: str, task: Task, result: Mapping[str, Any]) -> EpisodeRow:
    """The row of an episode.

    Args:
        scenario: Name of its scenario in the results.
        behavior: Its policy as text.
        task: Its task.
        result: The answer of :func:`irsim.benchmarks.pool.run_tasks` to the task.
    """
    metrics, copied = _without_nan(result["metrics"]), {key: result[key] for key in _COPIED}
    copied["roles"] = {role: _without_nan(values) for role, values in result["roles"].items()}
    return EpisodeRow(scenario=scenario, behavior=behavior, seed=task.seed, metrics=metrics, **copied)


def _without_nan(values: Mapping[str, float]) -> dict[str, float | None]:
    return {key: None if math.isnan(value) else value for key, value in values.items()}


def _after(progress: Progress | None, done: int) -> Progress | None:
    """A callback that counts episodes which were done before, too."""
    return None if progress is None else lambda now, total: progress(done + now, done + total)


def _timing(
    opened: Sequence[Policy], plan: Sequence[tuple[str, str, Task]], results: Mapping[int, Mapping[str, Any]]
) -> dict[str, Any]:
    """The times of decisions in the episodes that were run now; of behaviors, in the first one of each scenario."""
    labels = [behavior for _, behavior, _ in plan]
    times: dict[str, dict[str, Any]] = {label_of(policy): {} for policy in opened}
    engine = {label_of(policy) for policy in opened if isinstance(policy, BehaviorPolicy)}
    timed: set[tuple[str, str]] = set()
    for number, result in sorted(results.items()):
        scenario, behavior, task = plan[number]
        if "decisions" in result:
            times[behavior][str(number)] = result["decisions"]
        elif behavior in engine and (scenario, behavior) not in timed:
            timed.add((scenario, behavior))
            times[behavior][str(number)] = time_behavior(task.job, task.seed)
    return timing_report(times, {name: labels.count(name) for name in times})
