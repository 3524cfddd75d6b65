"""Everything about a benchmark that is known before its first episode: its result without episodes, and its tasks."""

from __future__ import annotations

import itertools
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from irsim.benchmarks.assumptions import Limit, assumptions_of, limits_of, unequal_note
from irsim.benchmarks.episode import Job, Task, check_policy, scenario_of
from irsim.benchmarks.policies import (
    chances_that_count,
    digests_of,
    job_keys,
    label_of,
    listed_policies,
    naming,
    opened_policies,
)
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.seeds import seeds_from, seeds_text
from irsim.common.arguments import as_given, check_whole_number
from irsim.common.installed import version
from irsim.diagnostics.errors import InputError, OverLimitError
from irsim.episodes.opening import findings_under_policy, unopened_findings
from irsim.episodes.suitability import unsuited
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import PolicySource
from irsim.policies.policy import Policy
from irsim.results.benchmark import BenchmarkResult
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

__all__ = ["DEFAULT_SEEDS", "Prepared", "prepare"]

DEFAULT_SEEDS = 10
"""Number of seeds if none are given."""


class Prepared(NamedTuple):
    """A benchmark before its first episode.

    Attributes:
        head: Its result without episodes.
        policies: The policies, opened.
        plan: Scenario, policy as text, and task of each episode, in the order of the result.
    """

    head: BenchmarkResult
    policies: list[Policy]
    plan: list[tuple[str, str, Task]]


def prepare(
    files: str | Path | Sequence[str | Path] | Mapping[str, str | Path | Document],
    policies: PolicySource | Sequence[PolicySource] | None = None,
    seeds: int | str | Iterable[int] = DEFAULT_SEEDS,
    *,
    behaviors: PolicySource | Sequence[PolicySource] | None = None,
    perturb: Perturbations | None = None,
    steps: int | None = None,
    strict: bool = False,
    imports: Sequence[str] = (),
    limits: Limits | None = None,
    most_episodes: int | None = None,
    until: EpisodeUntil = "done",
    groups: Mapping[str, Sequence[str]] | None = None,
    parts: Mapping[str, Mapping[str, Policy | None]] | None = None,
    send_maps: bool = False,
) -> Prepared:
    """Read the scenarios, open the policies, and plan every episode.

    Args, and errors, as of :func:`irsim.benchmark`; ``send_maps``: whether tasks carry the maps of their scenarios.
    """
    names, given = _named_sources(files)
    listed, where = listed_policies(policies, behaviors)
    chosen, perturbations = seeds_from(seeds), read_perturbations(perturb)
    texts = tuple(perturbation_text(item) for item in perturbations)
    if steps is not None:
        steps = check_whole_number("steps", steps)
    limits = limits or DEFAULT_LIMITS
    _check_size(names, listed, chosen, most_episodes)
    import_modules(imports)
    opened = opened_policies(listed, where, limits.root)
    wanted = [label_of(policy) for policy in opened]
    _check_names(names, wanted)
    warnings: dict[str, list[Finding]] = {}
    jobs: list[tuple[str, str, Job, Sequence[int]]] = []
    periods, chances, changes = dict[str, float](), dict[str, list[str]](), dict[str, list[str]]()
    unequal, certain = dict[str, str](), dict[str, list[str]]()
    settled: dict[str, ResolvedScenario] = {}
    for name, source in zip(names, given, strict=True):
        document = _document(source, limits)
        scenario, told = read_scenario(document, strict=strict, limits=document.limits)
        warnings[name] = [Finding.of(item) for item in told]
        if AS_WRITTEN not in wanted:
            warnings[name] = findings_under_policy(warnings[name], scenario)
        warnings[name] += unopened_findings(scenario, "a benchmark")
        warnings[name] += [Finding.of(item) for behavior in wanted for item in unsuited(behavior, scenario)]
        scenario = perturbed(scenario, perturbations, called=name if isinstance(source, Document) else None)
        periods[name], chances[name] = float(scenario.world.step_time), random_parts(scenario)
        if texts:
            changes[name] = perturbed_message(scenario)
        settled[name], limits_under = scenario, dict[str, dict[str, Limit]]()
        for number, (compared, behavior) in enumerate(zip(opened, wanted, strict=True)):
            policy = shared_with(compared, (parts or {}).get(name, {}))
            reached = ["policy"] if policy.stochastic else []
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
                maps=tuple(scenario.map_files.items()) if send_maps else (),
                **job_keys(policy),
            )
            with naming(where, number):
                check_policy(job)
                driven = scenario_of(job)
            reached += random_parts(driven)
            chances[name] += [part for part in reached if part not in chances[name]]
            if not chances_that_count(reached, [policy], scenario):
                certain.setdefault(name, []).append(behavior)
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
        certain={name: reached for name, reached in certain.items() if chances[name]},
        rows=[],
        groups={name: list(members) for name, members in (groups or {}).items()},
        episodes=[],
        notes=[],
        warnings=warnings,
        version=version(),
        engine=engine(),
        reproduce=_command(names, wanted, chosen, texts, steps, strict, imports),
    )
    return Prepared(head, opened, plan)


def _named_sources(files: Any) -> tuple[list[str], list[str | Document]]:
    """Names of the scenarios in the result, and the scenarios: paths, texts or documents."""
    if not isinstance(files, Mapping):
        given = _sources(files)
        return _names(given), list(given)
    documents = {name: source for name, source in files.items() if isinstance(source, Document)}
    others = _sources([source for source in files.values() if not isinstance(source, Document)])
    texts = iter(others)
    return list(map(str, files)), [documents[name] if name in documents else next(texts) for name in files]


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
