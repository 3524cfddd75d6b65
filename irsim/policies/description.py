"""Lists policies, and says what each observes and returns."""

from __future__ import annotations

import inspect
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irsim.options.knowledge import knowledge_text
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import behavior_names, is_installed, names_file, names_trained, open_policy
from irsim.policies.mixed import MixedPolicy
from irsim.policies.networks.network_policy import NetworkPolicy
from irsim.policies.policy import Needs, Policy
from irsim.policies.random import RandomPolicy
from irsim.policies.registry import MIXED, POLICIES, RANDOM
from irsim.policies.trained import trained_policies
from irsim.scenario.behavior_override import AS_WRITTEN

__all__ = ["PolicyInfo", "describe_policy", "list_policies"]

_IN_ENGINE = "runs in the engine; irsim describe behavior {} has its options"


@dataclass(frozen=True)
class PolicyInfo:
    """A policy in words.

    Attributes:
        name: Text that opens it.
        kind: ``behavior``, ``built-in``, ``trained``, ``plug-in`` or ``file``.
        about: Its purpose.
        output: Its result: ``control``, ``velocity``, or ``engine`` for a behavior.
        needs: Observations besides the state and the goal of the robot.
        knows: Class of its information, such as ``circles+intent``; empty if that is not known.
        facts_known: That information in words.
        drives: Names of the drives that it controls; ``any``.
        decision_dt: Time between two decisions [s]; None: every step.
        options: Option → its default in words; ``required`` without one.
        meanings: Option → what it means.
        unseen: Things that it does not see; empty if that is not known.
        install: How to install the package that it needs; None if nothing is missing.
        digest: SHA-256 of its file; None without one.
        facts: Facts of a network: parts that it observes, what it returns, layers, sizes, card.
    """

    name: str
    kind: str
    about: str
    output: str
    needs: list[str]
    drives: list[str]
    knows: str = ""
    facts_known: str = ""
    decision_dt: float | None = None
    options: dict[str, str] = field(default_factory=dict)
    meanings: dict[str, str] = field(default_factory=dict)
    unseen: str = ""
    install: str | None = None
    digest: str | None = None
    facts: dict[str, Any] = field(default_factory=dict)


def list_policies() -> list[PolicyInfo]:
    """All policies that have a name; files are policies, too."""
    behaviors = sorted(behavior_names(), key=lambda name: (name != AS_WRITTEN, name))
    return [
        *map(_behavior, behaviors),
        _random(),
        _mixed(),
        *map(describe_policy, trained_policies()),
        *(_plugin(name) for name in POLICIES.names()),
    ]


def describe_policy(text: str, folder: str | Path | None = None) -> PolicyInfo:
    """Describe a policy, which is opened if it is a file or has options.

    Raises:
        As :func:`irsim.open_policy`.
    """
    if text in POLICIES.names():
        return _plugin(text)
    if text == MIXED:
        return _mixed()
    policy = open_policy(text, folder=folder)
    if isinstance(policy, BehaviorPolicy):
        return _behavior(policy.name)
    if text == RANDOM:
        return _random()
    return _info(text, _kind(text, policy), policy, _about(policy), {})


def _kind(text: str, policy: Policy) -> str:
    if names_file(text):
        return "file"
    if names_trained(text):
        return "trained"
    return "built-in" if policy.name in (RANDOM, MIXED) else "plug-in"


def _behavior(name: str) -> PolicyInfo:
    if name == AS_WRITTEN:
        about, options, drives = "The behavior that the scenario gives each robot.", {}, ["any"]
    else:
        feature = BEHAVIORS.get(name)
        about = "" if feature is None else _about(feature.options)
        options = {} if feature is None else {"…": _IN_ENGINE.format(name)}
        drives = ["any"] if feature is not None else CUSTOM_BEHAVIORS.drives(name) or ["any"]
    about, told = about or "Registered in Python.", _knowledge(BehaviorPolicy(name))
    return PolicyInfo(name, "behavior", about, "engine", [], drives, *told, options=options)


def _random() -> PolicyInfo:
    return _info(RANDOM, "built-in", RandomPolicy(), _about(RandomPolicy), _options(RandomPolicy))


def _mixed() -> PolicyInfo:
    about, options = _about(MixedPolicy), _options(MixedPolicy)
    parts = "what its parts say"
    return PolicyInfo(
        MIXED, "built-in", about, parts, [parts], [parts], options=options, meanings=_arguments(MixedPolicy)
    )


def _plugin(name: str) -> PolicyInfo:
    maker: Any = POLICIES.get(name)
    return _info(name, "plug-in", maker, _about(maker), _options(maker))


def _info(name: str, kind: str, policy: Any, about: str, options: dict[str, str]) -> PolicyInfo:
    """Describe a policy, or the class or function that makes it."""
    known = isinstance(policy, Policy) or (isinstance(policy, type) and issubclass(policy, Policy))
    needs = policy.needs if known and isinstance(policy.needs, Needs) else Needs()
    package = policy.package if known else None
    knows, facts_known = _knowledge(policy) if isinstance(policy, Policy) else ("", "")
    wanted = [] if package is None else [f"the package {package[0]}"]
    drives = sorted(policy.drives) if known and policy.drives is not None else ["any"]
    return PolicyInfo(
        name=name,
        kind=kind,
        about=about,
        output=policy.output if known else "known once it is made",
        needs=[*_words(needs), *wanted],
        knows=knows,
        facts_known=facts_known,
        drives=["any"] if known and policy.output == "velocity" else drives,
        decision_dt=policy.decision_dt if known else None,
        options=options,
        meanings={key: text for key, text in _arguments(policy).items() if key in options},
        install=None if package is None or is_installed(package[0]) else package[1],
        unseen=_unseen(needs) if isinstance(policy, NetworkPolicy) else "",
        digest=policy.digest if known else None,
        facts=policy.describe() if isinstance(policy, NetworkPolicy) else {},
    )


def _knowledge(policy: Policy) -> tuple[str, str]:
    """The class of what a policy knows, and that in words; empty if it is not known."""
    known = policy.known()
    return (policy.knowledge() or "", "" if known is None else knowledge_text(known))


def _words(needs: Needs) -> list[str]:
    result = []
    if needs.neighbors:
        reach = "" if math.isinf(needs.neighbor_range) else f" within {needs.neighbor_range:g} m"
        static = ", also static ones" if needs.static_neighbors else ""
        result.append(f"{needs.neighbors} nearest neighbors{reach}{static}")
    if needs.scan:
        result.append("a lidar" if needs.beams is None else f"a lidar with {needs.beams} beams")
    if needs.map:
        result.append(f"the map in cells of {needs.map_resolution:g} m")
    return result


def _unseen(needs: Needs) -> str:
    """Things that a network with these needs does not see."""
    if needs.scan or needs.map:
        return ""
    if not needs.neighbors:
        return "anything but itself and its goal"
    return "walls and maps" if needs.static_neighbors else "static obstacles, walls and maps"


def _about(thing: Any) -> str:
    """The first sentence of a docstring, or what a network says about itself."""
    own = getattr(thing, "about", None)
    if isinstance(thing, NetworkPolicy):
        own = thing.head.card.description
    text = own if isinstance(own, str) and own else inspect.getdoc(thing if callable(thing) else type(thing)) or ""
    return " ".join(text.split("\n\n")[0].split())


def _options(maker: Any) -> dict[str, str]:
    try:
        parameters = inspect.signature(maker).parameters.values()
    except (TypeError, ValueError):
        return {}
    named = [one for one in parameters if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)]
    return {one.name: "required" if one.default is one.empty else repr(one.default) for one in named}


def _arguments(maker: Any) -> dict[str, str]:
    """Argument → its description in a Google docstring."""
    _, _, section = (inspect.getdoc(maker) or "").partition("\nArgs:\n")
    result: dict[str, str] = {}
    for line in section.splitlines():
        if not line.startswith(" "):
            break
        if named := re.match(r" {4}(\w+)(?: \([^)]*\))?: (.+)", line):
            result[named[1]] = named[2].strip()
        elif result:
            result[[*result][-1]] += f" {line.strip()}"
    return {name: text.replace("``", "`") for name, text in result.items()}
