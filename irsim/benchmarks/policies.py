"""The policies of a benchmark: opened once, named in results, and opened again in each process that runs episodes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

from irsim.diagnostics.errors import InputError, PolicyError
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import UnknownPolicyError, is_network, open_policy
from irsim.policies.policy import Policy
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = [
    "chances_that_count",
    "digests_of",
    "files_of",
    "job_keys",
    "label_of",
    "listed_policies",
    "naming",
    "open_again",
    "open_planned",
    "opened_policies",
]


def listed_policies(policies: Any, behaviors: Any) -> tuple[list[Any], str]:
    """The policies that a caller gives, as a list, and the argument that has them.

    Raises:
        InputError: Both arguments are given.
    """
    if policies is not None and behaviors is not None:
        raise InputError("policies and behaviors are two names of one argument", "give only policies")
    given, where = (behaviors, "behaviors") if policies is None else (policies, "policies")
    if given is None:
        return [AS_WRITTEN], where
    one = isinstance(given, (str, Mapping, Path, Policy)) or not isinstance(given, Iterable)
    return [given] if one else list(given), where


def opened_policies(given: Sequence[Any], where: str, root: str | None = None) -> list[Policy]:
    """Open the policies of a list.

    Args:
        given: The policies.
        where: Name of the argument that has them.
        root: Folder that files must lie in, see :func:`irsim.open_policy`.

    Raises:
        InputError: One of them is not a policy; the error names its place.
        UnknownPolicyError: There are no such policies; the error names all of them.
    """
    opened: list[Policy] = []
    unknown: list[UnknownPolicyError] = []
    for number, policy in enumerate(given):
        try:
            with naming(where, number):
                opened.append(open_policy(policy, root=root))
        except UnknownPolicyError as error:
            unknown.append(error)
    if len(unknown) == 1:
        raise unknown[0]
    if unknown:
        fixes = dict.fromkeys(error.fix or "" for error in unknown)
        raise UnknownPolicyError("; ".join(error.message for error in unknown), "; ".join(fixes), where=where)
    return opened


@contextmanager
def naming(where: str, number: int) -> Iterator[None]:
    """Context in which errors name one of the policies as their cause."""
    try:
        yield
    except (InputError, PolicyError) as error:
        error.where = f"{where}[{number}]"
        raise


def label_of(policy: Policy) -> str:
    """The text of a policy in results: what opens it, or the name of one that only this program has."""
    return policy.text or policy.name


def chances_that_count(chances: Sequence[str], policies: Iterable[Policy], scenario: ResolvedScenario) -> list[str]:
    """The random parts of a scenario that can change an episode under these policies.

    Noise of sensors does so only if they are read: a policy that observes scans or may do anything, or the fog.
    """
    readers = any(policy.needs.scan or policy.stochastic for policy in policies)
    if list(chances) == ["sensor noise"] and not readers and not scenario.world.fog_map:
        return []
    return list(chances)


def digests_of(policies: Iterable[Policy]) -> dict[str, str]:
    """Text of each policy that is a file → SHA-256 of the file."""
    return {label_of(policy): policy.digest for policy in policies if policy.digest is not None}


def files_of(policies: Mapping[str, str], folders: Mapping[str, Path]) -> tuple[dict[str, str], dict[str, str]]:
    """Texts and hashes that a plan stores of policies that are files.

    Args:
        policies: Name in the results → text.
        folders: Name → folder that the path of its file is relative to; default: the current one.

    Returns:
        Name → text that opens it from any folder, and name → SHA-256 of its file (only for policies that are files).
    """
    opened = {name: open_policy(text, folder=folders.get(name)) for name, text in policies.items() if is_network(text)}
    return {name: str(one.source) for name, one in opened.items()}, {
        name: str(one.digest) for name, one in opened.items()
    }


def open_planned(policies: Mapping[str, str], sources: Mapping[str, str], digests: Mapping[str, str]) -> list[Policy]:
    """Open the policies of a plan.

    Args:
        policies: Name in the results → text.
        sources: Name → text that opens the policy from any folder, where it differs.
        digests: Name → SHA-256 of the file (only for policies that are files).

    Raises:
        PolicyError: The file of one has changed since.
    """
    opened = []
    for name, text in policies.items():
        policy = open_policy(sources.get(name, text))
        if policy.digest != digests.get(name):
            what = f"the file of policy {name!r} has changed since the benchmark was started"
            raise PolicyError("other-benchmark", what, "restore the file, or start again in another folder")
        policy.text = text
        opened.append(policy)
    return opened


def job_keys(policy: Policy) -> dict[str, Any]:
    """The fields of a :class:`irsim.benchmarks.episode.Job` that say which policy drives."""
    if isinstance(policy, BehaviorPolicy):
        return {"behavior": label_of(policy)}
    local = None if policy.source is not None else policy
    return {"behavior": AS_WRITTEN, "policy": policy.source, "digest": policy.digest, "local": local}


@lru_cache(maxsize=8)
def open_again(source: str, digest: str | None) -> Policy:
    """The policy that a text opens, in any process; the last few are kept.

    Raises:
        PolicyError: Its file has changed since the benchmark began.
    """
    policy = open_policy(source)
    if policy.digest != digest:
        what = f"the file of policy {policy.name!r} has changed since the benchmark began"
        raise PolicyError("other-benchmark", what, "restore the file, or start the benchmark again")
    return policy
