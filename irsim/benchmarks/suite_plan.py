"""The plan of a suite: its scenarios, the chosen policies, protocols and seeds; and single scenarios by their names."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import yaml

from irsim.benchmarks.plan import Plan, PlannedScenario, map_hashes, short_hash
from irsim.benchmarks.policies import files_of
from irsim.benchmarks.roles import COMPARED
from irsim.benchmarks.suite import SUITES, WRITTEN_SUITES, Protocol, Suite, SuiteError, is_suite, load_suite
from irsim.benchmarks.suite_scenarios import Expanded, expand, step_time_of
from irsim.diagnostics.diagnostic import nearest, suggestion
from irsim.policies.registry import MIXED
from irsim.results.run import EpisodeUntil
from irsim.scenario.behavior_override import behavior_text, parse_behavior
from irsim.scenario.perturbation import perturbation_text, read_perturbations
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = ["suite_plan", "suite_policy", "suite_rules", "suite_scene"]

_MOST_SEEDS = 10_000
"""A plain number above this one, and above the suite's own seeds, is surely meant as a seed."""


def suite_plan(
    suite: str | Suite,
    *,
    policies: Sequence[str] | None = None,
    protocols: Sequence[Protocol] | None = None,
    seeds: int | Sequence[int] | None = None,
    full: bool = False,
    scenarios: Sequence[str] | None = None,
    perturb: Sequence[str] = (),
) -> Plan:
    """Everything that a run of a suite depends on.

    Args:
        suite: Name of a bundled suite, path of a file, or a suite.
        policies: Names of policies of the suite, or other policies, instead of all policies of the suite.
        protocols: Some of its protocols; default: all.
        seeds: Number of seeds, or the seeds, instead of the suite's.
        full: Run the number of seeds that the suite calls full.
        scenarios: Names of scenarios, with or without their protocol, or of their families; default: all.
        perturb: Perturbations instead of the suite's, as on the command line.

    Raises:
        SuiteError: There is no such suite, or it is not valid; or a protocol or scenario is not in it.
    """
    loaded, file = (suite, Path("suite.yaml")) if isinstance(suite, Suite) else load_suite(suite)
    kept = _chosen("protocol", protocols or loaded.protocols, loaded.protocols)
    every = expand(loaded, file)
    planned = dict(zip((one.name for one in every), _planned(every), strict=True))
    made = [one for one in every if one.protocol in kept]
    words = ["irsim", "benchmark", suite if isinstance(suite, str) else loaded.suite]
    if policies is not None:
        words += ["--policies", ",".join(policies)]
    if list(kept) != list(loaded.protocols):
        words += [word for name in kept for word in ("--protocol", name)]
    if scenarios is not None:
        names = _chosen("scenario", scenarios, sorted({name for one in made for name in _names(one)}))
        made = [one for one in made if not _names(one).isdisjoint(names)]
        words += [word for name in names for word in ("--scenario", name)]
    perturbations = read_perturbations(perturb) or tuple(loaded.perturb)
    words += [word for item in perturb for word in ("--perturb", item)]
    texts = _policies(loaded, policies)
    company = _company(loaded, made)
    own = [name for name in texts if name in loaded.known_policies]
    sources, digests = files_of(company | texts, dict.fromkeys([*company, *own], file.parent))
    chosen = _seeds(loaded, seeds, full)
    if isinstance(seeds, Sequence):
        words += ["--seeds", _listed(chosen)]
    elif len(chosen) != loaded.seeds.count:
        words += ["--seeds", str(len(chosen))]
    return Plan(
        name=loaded.suite,
        suite=loaded,
        scenarios=[planned[one.name] for one in made],
        policies=texts,
        company=company,
        sources=sources,
        digests=digests,
        seeds=chosen,
        suite_hash=_hash(loaded, list(planned.values())),
        until=loaded.until,
        perturb=[perturbation_text(item) for item in perturbations],
        reproduce=shlex.join(words),
    )


def _seeds(suite: Suite, wanted: int | Sequence[int] | None, full: bool) -> list[int]:
    """The seeds of a run: the suite's, some more or fewer from its first one on, or others."""
    if wanted is not None and full:
        raise SuiteError("full and a number of seeds contradict each other", "give one of them")
    if isinstance(wanted, Sequence):
        return list(wanted)
    if wanted is not None and wanted < 1:
        raise SuiteError(f"there must be at least one seed, got {wanted}", "give a number such as 20")
    if wanted is not None and wanted > max(suite.seeds.first, suite.seeds.full or 0, _MOST_SEEDS):
        what = f"{wanted:,} are more seeds than {suite.suite} is made for, from {suite.seeds.first:,} on"
        raise SuiteError(what, f"a plain number is how many there are: seed {wanted} alone is '{wanted}-{wanted}'")
    count = wanted or (suite.seeds.full if full and suite.seeds.full else suite.seeds.count)
    return [suite.seeds.first + k for k in range(count)]


def _listed(seeds: Sequence[int]) -> str:
    """Seeds as the command line takes them: never a plain number, which is a number of seeds."""
    if len(seeds) > 1 and list(seeds) == list(range(seeds[0], seeds[0] + len(seeds))):
        return f"{seeds[0]}-{seeds[-1]}"
    return ",".join(map(str, seeds)) + ("," if len(seeds) == 1 else "")


def _hash(suite: Suite, every: Sequence[PlannedScenario]) -> str:
    """Hash of a suite: everything that it says, with the files that it names, whatever part of it is run."""
    texts = [scenario.model_dump_json(exclude={"folder"}) for scenario in every]
    return short_hash("\n".join([suite.model_dump_json(exclude={"others"}), *texts]))


def _names(one: Expanded) -> set[str]:
    """Names that select a scenario: its name, its name under any protocol, the name of its family."""
    return {one.name, one.name.rsplit("/", 1)[0], one.family}


def _chosen(what: str, wanted: Sequence[str], known: Sequence[str]) -> list[str]:
    for name in wanted:
        if name not in known:
            fix = suggestion(name, known, f"choose from {', '.join(known)}")
            raise SuiteError(f"the suite has no {what} {name!r}", fix or "")
    return list(wanted)


def _policies(suite: Suite, wanted: Sequence[str] | None) -> dict[str, str]:
    """Label → policy as text. A name that the suite does not have is a policy of its own."""
    if wanted is not None and not wanted:
        raise SuiteError("there must be at least one policy, got none", f"choose from {', '.join(suite.policies)}")
    known = {name: behavior_text(policy) for name, policy in suite.known_policies.items()}
    return {name: known.get(name, name) for name in (suite.policies if wanted is None else wanted)}


def _company(suite: Suite, made: Sequence[Expanded]) -> dict[str, str]:
    """Name → policy as text of the ones that drive robots beside the compared policy; a text of its own is its name."""
    names = dict.fromkeys(name for one in made for name in one.policies.values() if name != COMPARED)
    known = {name: behavior_text(policy) for name, policy in suite.known_policies.items()}
    return {name: known.get(name, name) for name in names}


def _planned(made: Sequence[Expanded]) -> list[PlannedScenario]:
    drafts = [
        PlannedScenario(
            name=one.name, family=one.family, protocol=one.protocol, values=dict(one.values),
            folder=str(Path(one.folder).resolve()), text=_with_limit(one), policies=one.policies,
        )
        for one in made
    ]  # fmt: skip
    maps = map_hashes([draft.document() for draft in drafts])
    return [
        draft.model_copy(update={"maps": hashes, "folder": draft.folder if hashes else None})
        for draft, hashes in zip(drafts, maps, strict=True)
    ]


def _with_limit(one: Expanded) -> str:
    """The text of a scenario with the horizon of the suite as its time limit."""
    world = dict(one.data.get("world") or {})
    world["time_limit"] = round(one.steps * step_time_of(one.data), 9)
    return str(yaml.safe_dump({**one.data, "world": world}, sort_keys=False, allow_unicode=True))


def suite_scene(name: str | Path) -> PlannedScenario | None:
    """The scenario of a suite that a name means; None if the name does not begin with a suite.

    Args:
        name: ``SUITE/SCENARIO``, where the suite is bundled or a file.

    Raises:
        SuiteError: The suite is not valid, has no such scenario, or no scenario is named.
    """
    parts = _split(name)
    return None if parts is None else _scene(*parts)


def suite_policy(name: str | Path, policy: str) -> str:
    """The text of a policy for a scenario, which may be one of a suite.

    There a name of the suite means its policy, and the policies that share the scene have their robots.

    Args:
        name: ``SUITE/SCENARIO``, or another scenario.
        policy: Name of a policy, or text.

    Raises:
        SuiteError: The suite is not valid.
    """
    parts = _split(name)
    if parts is None:
        return policy
    suite, file = load_suite(parts[0])
    own = {known: behavior_text(given) for known, given in suite.known_policies.items()}
    driver = own.get(policy, policy)
    scene = next((one for one in expand(suite, file) if one.name == parts[1]), None)
    if scene is None or not scene.policies:
        return driver
    if driver.startswith("{") and (parse_behavior(driver) or {}).get("name") == MIXED:
        return driver  # says itself who drives which robots
    shared = {key: driver if one == COMPARED else own.get(one, one) for key, one in scene.policies.items()}
    return yaml_flow({"name": MIXED, "policies": shared})


def suite_rules(name: str | Path) -> tuple[list[str], EpisodeUntil] | None:
    """The rules of a suite for each episode of a scenario of it: perturbations as text, and when an episode ends.

    Args:
        name: ``SUITE/SCENARIO``, or another scenario, for which the result is None.

    Raises:
        SuiteError: The suite is not valid.
    """
    parts = _split(name)
    if parts is None:
        return None
    suite = load_suite(parts[0])[0]
    return [perturbation_text(item) for item in suite.perturb], suite.until


def _split(name: str | Path) -> tuple[str, str] | None:
    """The suite and the scenario of a name; None if it does not begin with a suite."""
    given = Path(name)
    if given.is_file() and not is_suite(str(name)):
        return None
    for suite in (given, *given.parents):
        word = suite.as_posix()
        if word in (*SUITES.names(), *WRITTEN_SUITES) or (suite.is_file() and is_suite(word)):
            return word, given.relative_to(suite).as_posix()
    return None


def _scene(suite: str, name: str) -> PlannedScenario:
    known = {scenario.name: scenario for scenario in suite_plan(suite).scenarios}
    if name in known:
        return known[name]
    near = nearest(name, list(known)) or next(iter(known))
    if name == ".":
        fix = f"irsim benchmark {suite} runs all; a single one is named {suite}/{near}"
        raise SuiteError(f"{suite} is a suite of {len(known)} scenarios", fix)
    raise SuiteError(f"{suite} has no scenario {name!r}", f"did you mean {suite}/{near}?")
