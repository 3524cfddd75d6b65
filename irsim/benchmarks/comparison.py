"""``irsim.benchmark``: compare policies over scenarios and seeds, on all cores, with metrics and intervals.

The comparison is fair: every policy runs the same scenarios with the same seeds and horizons, and differences are
computed episode by episode.
"""

from __future__ import annotations

import itertools
import math
import shlex
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Any

from irsim.benchmarks.assumptions import Limit, assumptions_of, limits_of, unequal_note
from irsim.benchmarks.cluster import run_on_cluster
from irsim.benchmarks.episode import Job, Task, check_policy, scenario_of
from irsim.benchmarks.log import Log, check_places, logged, with_episodes
from irsim.benchmarks.policies import (
    chances_that_count,
    digests_of,
    job_keys,
    label_of,
    listed_policies,
    naming,
    opened_policies,
)
from irsim.benchmarks.pool import MAX_GROUP, cores, run_tasks
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.seeds import seeds_from, seeds_text
from irsim.benchmarks.timing import time_behavior, timing_report
from irsim.common.arguments import as_given, check_whole_number
from irsim.common.installed import version
from irsim.diagnostics.errors import InputError, OverLimitError
from irsim.episodes.episode import Progress
from irsim.episodes.opening import findings_under_policy, unopened_findings
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import PolicySource
from irsim.policies.policy import Policy
from irsim.results.benchmark import BenchmarkResult, EpisodeRow
from irsim.results.findings import Finding
from irsim.results.run import EpisodeUntil
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.open import document_of, import_modules, read_scenario
from irsim.scenario.perturbation import (
    Perturbations,
    perturbation_text,
    perturbed,
    perturbed_message,
    read_perturbations,
)
from irsim.scenario.resolve.resolved import ResolvedScenario, random_parts
from irsim.scenario.yaml.document import Document, load_text
from irsim.simulation.engine import engine

__all__ = ["AS_WRITTEN", "DEFAULT_SEEDS", "benchmark", "logged"]

DEFAULT_SEEDS = 10
"""Number of seeds if none are given."""
_SEEDS_PER_TURN = {False: 5, True: MAX_GROUP}
"""Number of seeds that one policy runs before the next one, so that an interrupted benchmark can be compared, too: few,
or where policies are networks as many as are run together."""
_COPIED = (
    *("outcome", "steps", "sim_time", "time_limit", "unreachable", "failures"),
    *("human_contacts", "left", "jumped", "lost", "zones", "roles"),
)
"""Keys of the result of an episode that its row repeats."""


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
    names, given = _named_sources(files)
    listed, where = listed_policies(policies, behaviors)
    chosen, perturbations = seeds_from(seeds), read_perturbations(perturb)
    texts = tuple(perturbation_text(item) for item in perturbations)
    if steps is not None:
        steps = check_whole_number("steps", steps)
    if workers is not None:
        workers = check_whole_number("workers", workers, 1)
    limits = limits or DEFAULT_LIMITS
    _check_size(names, listed, chosen, most_episodes)
    import_modules(imports)
    opened = opened_policies(listed, where, limits.root)
    wanted = [label_of(policy) for policy in opened]
    _check_names(names, wanted)
    warnings: dict[str, list[Finding]] = {}
    jobs: list[tuple[str, str, Job, Sequence[int]]] = []
    periods, chances, changes = dict[str, float](), dict[str, list[str]](), dict[str, list[str]]()
    unequal: dict[str, str] = {}
    settled: dict[str, ResolvedScenario] = {}
    for name, source in zip(names, given, strict=True):
        document = _document(source, limits)
        scenario, told = read_scenario(document, strict=strict, limits=document.limits)
        warnings[name] = [Finding.of(item) for item in told]
        if AS_WRITTEN not in wanted:
            warnings[name] = findings_under_policy(warnings[name], scenario)
        warnings[name] += unopened_findings(scenario, "a benchmark")
        scenario = perturbed(scenario, perturbations, called=name if isinstance(source, Document) else None)
        periods[name], chances[name] = float(scenario.world.step_time), random_parts(scenario)
        if texts:
            changes[name] = perturbed_message(scenario)
        settled[name], limits_under = scenario, dict[str, dict[str, Limit]]()
        for number, (compared, behavior) in enumerate(zip(opened, wanted, strict=True)):
            policy = shared_with(compared, (parts or {}).get(name, {}))
            if policy.stochastic and "policy" not in chances[name]:
                chances[name].append("policy")
            job = Job(
                text=str(document.text),
                path=document.path,
                steps=steps,
                strict=strict,
                imports=tuple(imports),
                limits=tuple(asdict(limits).items()),
                until=until,
                perturb=texts,
                name=name,
                maps=() if cluster is None else tuple(scenario.map_files.items()),
                **job_keys(policy),
            )
            with naming(where, number):
                check_policy(job)
                driven = scenario_of(job)
            chances[name] += [part for part in random_parts(driven) if part not in chances[name]]
            limits_under[behavior] = limits_of(driven, own=isinstance(policy, BehaviorPolicy))
            jobs.append((name, behavior, job, chosen))
        chances[name] = chances_that_count(chances[name], opened, scenario)
        if (note := unequal_note(limits_under)) is not None:
            unequal[name] = note
    plan = [
        (name, behavior, Task(job, seed))
        for name, behavior, job, every in jobs
        for seed in (every if chances[name] else every[:1])
    ]

    turn = _SEEDS_PER_TURN[any(policy.batch_invariant for policy in opened)]
    rank = {seed: position // turn for position, seed in enumerate(chosen)}
    turns = sorted(range(len(plan)), key=lambda number: (names.index(plan[number][0]), rank[plan[number][2].seed]))
    head = BenchmarkResult(
        scenarios=names,
        behaviors=wanted,
        information={label_of(one): words for one in opened if (words := one.knowledge())},
        digests=digests_of(opened),
        seeds=chosen,
        step_time=periods,
        perturb=list(texts),
        perturbed=changes,
        unequal=unequal,
        assumptions=assumptions_of(settled),
        random=chances,
        rows=[],
        groups={name: list(members) for name, members in (groups or {}).items()},
        episodes=[],
        notes=[],
        warnings=warnings,
        version=version(),
        engine=engine(),
        reproduce=_command(names, wanted, chosen, texts, steps, strict, imports),
    )

    def row(number: int, result: Mapping[str, Any]) -> EpisodeRow:
        name, behavior, task = plan[number]
        metrics = _without_nan(result["metrics"])
        copied = {key: result[key] for key in _COPIED}
        copied["roles"] = {role: _without_nan(values) for role, values in result["roles"].items()}
        return EpisodeRow(scenario=name, behavior=behavior, seed=task.seed, metrics=metrics, **copied)

    head, known = Log.known(log, head) if log is not None and resume else (head, {})
    check_places(known, [(name, behavior, task.seed) for name, behavior, task in plan])
    with nullcontext() if log is None else Log(log, head, known) as book:

        def keep(number: int, result: Mapping[str, Any]) -> None:
            if book is not None:
                book.add(turns[number], row(turns[number], result))

        turns = [number for number in turns if number not in known]
        ordered, report = [plan[number][2] for number in turns], _after(progress, len(known))
        if cluster is None:
            results = run_tasks(ordered, workers=workers or cores(), progress=report, kept=keep)
        else:
            results = run_on_cluster(ordered, address=cluster, workers=workers, progress=report, kept=keep)
    if timing is not None:
        timing.update(_timing(opened, plan, dict(zip(turns, results, strict=True))))
    episodes = known | {number: row(number, result) for number, result in zip(turns, results, strict=True)}
    return with_episodes(head, [episodes[number] for number in range(len(plan))])


def _without_nan(values: Mapping[str, float]) -> dict[str, float | None]:
    return {key: None if math.isnan(value) else value for key, value in values.items()}


def _after(progress: Progress | None, done: int) -> Progress | None:
    """A callback that counts episodes which were done before, too."""
    return None if progress is None else lambda now, total: progress(done + now, done + total)


def _sources(files: Any) -> list[str]:
    """The scenarios, given as paths or texts, as strings."""
    one = isinstance(files, (str, Path))
    if not one and (isinstance(files, (Mapping, bytes, bytearray)) or not isinstance(files, Iterable)):
        raise InputError(
            f"files must be scenarios, got {as_given(files)}", "give a path, the text of a scenario, or a list of them"
        )
    listed = [files] if one else list(files)
    for number, source in enumerate(listed):
        if not isinstance(source, (str, Path)):
            raise InputError(
                f"files[{number}] must be a scenario, got {as_given(source)}", "give a path or the text of a scenario"
            )
    return [str(source) for source in listed]


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


def _named_sources(files: Any) -> tuple[list[str], list[str | Document]]:
    """Names of the scenarios in the result, and the scenarios: paths, texts or documents."""
    if not isinstance(files, Mapping):
        given = _sources(files)
        return _names(given), list(given)
    documents = {name: source for name, source in files.items() if isinstance(source, Document)}
    others = _sources([source for source in files.values() if not isinstance(source, Document)])
    texts = iter(others)
    return list(map(str, files)), [documents[name] if name in documents else next(texts) for name in files]


def _names(given: list[str]) -> list[str]:
    """Names of the scenarios in the result."""
    texts = [source for source in given if "\n" in source]
    if len(texts) < 2:
        return ["(text)" if "\n" in source else source for source in given]
    number = itertools.count(1)
    return [f"(text {next(number)})" if "\n" in source else source for source in given]


def _document(source: str | Document, limits: Limits) -> Document:
    if isinstance(source, Document):
        return source
    if "\n" in source:
        return load_text(source, limits=limits)
    return document_of(source, None, limits)


def _check_names(names: list[str], policies: list[str]) -> None:
    for what, listed in (("scenario", names), ("policy", policies)):
        twice = next((name for name in listed if listed.count(name) > 1), None)
        if twice is not None:
            raise InputError(f"the {what} {twice!r} is given twice", "give each once")


def _check_size(names: list[str], policies: Sequence[Any], seeds: list[int], most: int | None) -> None:
    for what, given in (("scenarios", names), ("policies", policies)):
        if not given:
            raise InputError(f"there must be at least one of the {what}, got none", f"give at least one of the {what}")
    total = len(names) * len(policies) * len(seeds)
    if most is not None and total > most:
        product = f"{len(names)} scenarios x {len(policies)} policies x {len(seeds)} seeds = {total:,} episodes"
        raise OverLimitError(f"{product}; at most {most:,} are run at once", f"ask for at most {most:,}")


def _command(
    names: list[str],
    behaviors: list[str],
    seeds: list[int],
    perturb: Sequence[str],
    steps: int | None,
    strict: bool,
    imports: Sequence[str],
) -> str:
    files = [
        f"scenario{'' if name == '(text)' else name[6:-1]}.yaml" if name.startswith("(text") else name for name in names
    ]
    words: list[Any] = ["irsim", "benchmark", *files]
    if behaviors != [AS_WRITTEN]:
        words += ["--policies", ",".join(behaviors)]
    words += ["--seeds", seeds_text(seeds)]
    for text in perturb:
        words += ["--perturb", text]
    if steps is not None:
        words += ["--steps", steps]
    if strict:
        words.append("--strict")
    for name in imports:
        words += ["--import", name]
    return shlex.join(map(str, words))
