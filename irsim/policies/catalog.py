"""Opens policies from what people write: names, mappings with options, files, functions and policy objects."""

from __future__ import annotations

import inspect
import math
import os
from collections.abc import Callable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from irsim.common.arguments import as_given, is_number
from irsim.common.hashing import digest
from irsim.common.keywords import answers_misspelt
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest, suggestion
from irsim.diagnostics.errors import CodedError, InputError, PolicyError
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.mixed import MixedPolicy
from irsim.policies.observations import Observations
from irsim.policies.policy import FunctionPolicy, Policy
from irsim.policies.random import RandomPolicy
from irsim.policies.registry import MIXED, POLICIES, RANDOM, RL_RVO_AUTHORS
from irsim.policies.trained import COMMON_NAMES, trained_policies, trained_policy
from irsim.scenario.behavior_override import AS_WRITTEN, behavior_text, parse_behavior, split_behaviors
from irsim.scenario.locate import why_outside
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = [
    "SUFFIXES",
    "PolicySource",
    "UnknownPolicyError",
    "behavior_names",
    "file_of",
    "files_beside",
    "has_inner_files",
    "is_installed",
    "is_network",
    "names_file",
    "names_trained",
    "open_policy",
    "policy_names",
    "with_file",
]

PolicySource = Policy | Callable[[Observations], Any] | str | os.PathLike[str] | Mapping[str, Any]
"""Input of :func:`open_policy`."""
SUFFIXES = (".npz", ".onnx")
"""Suffixes of files that hold policies."""
_TORCH_SUFFIXES = (".pt", ".pth", ".pkl")
"""Suffixes of files of PyTorch."""
MAX_FILE_BYTES = 500_000_000
"""Largest file of a policy."""


class UnknownPolicyError(InputError):
    """No policy has that name, or there is no such file."""

    code = "unknown-policy"


def behavior_names() -> list[str]:
    """Names of the policies that are behaviors, sorted."""
    return sorted({AS_WRITTEN, *BEHAVIORS.names(), *CUSTOM_BEHAVIORS.names(), *CUSTOM_GROUP_BEHAVIORS.names()})


def policy_names() -> list[str]:
    """Names of all policies that are not files, sorted."""
    return sorted({*behavior_names(), RANDOM, MIXED, *POLICIES.names(), *trained_policies()})


@answers_misspelt
def open_policy(source: PolicySource, *, folder: str | Path | None = None, root: str | Path | None = None) -> Policy:
    """Open a policy.

    Args:
        source: A policy object; a function ``f(observations)`` that returns controls; the name of a behavior
            (``orca``), of ``as-written``, of ``random``, of a trained policy that ships with irsim or of a plug-in; the
            path of an ``.npz`` or ``.onnx`` file; or one of these names with options, as a mapping or as YAML text
            (``{name: orca, timeHorizon: 5}``).
        folder: Folder that relative paths start from; default: the current one.
        root: Folder that files must lie in. With it only built-in policies and files are opened: no code runs that
            irsim does not have.

    Returns:
        The policy. Its ``text`` is the source as written, None for objects and functions.

    Raises:
        UnknownPolicyError: There is no such policy or file; the message names the most similar one.
        InputError: The text is not a policy.
        PolicyError: The policy cannot be made with these options, or its file cannot be used.
    """
    given: Any = os.fspath(source) if isinstance(source, os.PathLike) else source
    if isinstance(given, Policy):
        if not getattr(given, "name", ""):
            given.name = type(given).__name__
        return given
    if isinstance(given, type) and issubclass(given, Policy):
        raise InputError(f"{given.__name__} is a class of policies", f"give an object: {given.__name__}(…)")
    if not isinstance(given, (str, Mapping)):
        if callable(given) and root is None:
            return FunctionPolicy(given)
        fix = "give a name, a file, a mapping with a name, or a function of observations"
        raise InputError(f"a policy cannot be {as_given(given)}", fix)
    text = behavior_text(given)
    name, keys = _parsed(text)
    if name.endswith(SUFFIXES):
        return _from_file(text, name, keys, folder, root)
    if name in behavior_names():
        return BehaviorPolicy(text)
    if _is_trained(name):
        trained = _network(trained_policy(name), text, name, keys)
        trained.source = text
        return trained
    if name == RANDOM:
        return _named(_made(name, RandomPolicy, keys), text)
    if name == MIXED:
        return _mixed(text, keys, folder, root)
    if name == RL_RVO_AUTHORS:
        return _with_weights(text, keys, folder, root)
    maker = POLICIES.get(name) if root is None else None
    if maker is None:
        raise _unknown(name, root)
    return _named(_made(name, maker, keys), text)


def _mixed(text: str, keys: Mapping[str, Any], folder: str | Path | None, root: str | Path | None) -> Policy:
    """A policy of several; errors name the part."""
    parts = keys.get("policies")
    opened: Any = parts
    if isinstance(parts, Mapping):
        opened = {str(key): open_policy(one, folder=folder, root=root) for key, one in parts.items()}
    policy = _made(MIXED, MixedPolicy, {**keys, "policies": opened} if "policies" in keys else keys)
    policy.text = text
    return policy


def _with_weights(text: str, keys: dict[str, Any], folder: str | Path | None, root: str | Path | None) -> Policy:
    """The policy whose weights the user brings; a plug-in may have replaced it."""
    maker = POLICIES.get(RL_RVO_AUTHORS)
    assert maker is not None
    given = keys.get("weights")
    if isinstance(given, str):
        keys = {**keys, "weights": str(_path_inside(given, folder, root))}
    policy = _named(_made(RL_RVO_AUTHORS, maker, keys), text)
    if isinstance(given, str):
        policy.source = yaml_flow({"name": RL_RVO_AUTHORS, **keys, "weights": str(Path(keys["weights"]).resolve())})
    return policy


def names_trained(text: str) -> bool:
    """Whether the text of a policy names one that was trained and ships with irsim.

    Raises:
        InputError: The text is not a policy.
    """
    return _is_trained(_parsed(text)[0])


def _is_trained(name: str) -> bool:
    return name in trained_policies() and name not in POLICIES.names()  # a plug-in may replace one


def is_network(text: str) -> bool:
    """Whether the text of a policy names a file, or a policy that is read from one: trained, or with brought weights.

    Raises:
        InputError: The text is not a policy.
    """
    name, options = _parsed(text)
    if (parts := _part_texts(name, options)) is not None:
        return any(map(is_network, parts))
    return name.endswith(SUFFIXES) or _is_trained(name) or name == RL_RVO_AUTHORS


def _part_texts(name: str, options: Mapping[str, Any]) -> Iterator[str] | None:
    """The policies of a mixed one as texts; None of another policy."""
    parts = options.get("policies") if name == MIXED else None
    if not isinstance(parts, Mapping):
        return None
    return (behavior_text(one) for one in parts.values() if isinstance(one, (str, Mapping)))


def names_file(text: str) -> bool:
    """Whether the text of a policy names a file.

    Raises:
        InputError: The text is not a policy.
    """
    return file_of(text) is not None


def has_inner_files(text: str) -> bool:
    """Whether an option of a policy names a file: one of several policies, or brought weights.

    Raises:
        InputError: The text is not a policy.
    """
    name, options = _parsed(text)
    if (parts := _part_texts(name, options)) is not None:
        return any(names_file(one) or has_inner_files(one) for one in parts)
    return name == RL_RVO_AUTHORS and "weights" in options


def file_of(text: str) -> Path | None:
    """The file that the text of a policy names; None if it names none.

    Raises:
        InputError: The text is not a policy.
    """
    name = _parsed(text)[0]
    return Path(name) if name.endswith(SUFFIXES) else None


def files_beside(path: Path) -> list[Path]:
    """The files that a policy may have beside its own: the document of an ONNX model."""
    return [path.with_suffix(".json")] if path.suffix == ".onnx" else []


def with_file(text: str, path: Path) -> str:
    """The text of a policy that is a file, with another path and the same options."""
    options = _parsed(text)[1]
    return yaml_flow({"name": str(path), **options}) if options else str(path)


def _parsed(text: str) -> tuple[str, dict[str, Any]]:
    """Name and options of a policy that is given as text."""
    plain = text.endswith(SUFFIXES) and not text.startswith("{")
    try:
        options = {"name": text} if plain else parse_behavior(text)
    except InputError:
        fix = "give a name such as orca, a file (.npz, .onnx), or {name: orca, timeHorizon: 5}"
        if len(split_behaviors(text)) > 1:
            fix = "give one policy; irsim benchmark --policies A,B compares several"
        raise InputError(f"{clean(text)!r} is not a policy", fix) from None
    name = AS_WRITTEN if options is None else str(options["name"])
    return name, {key: value for key, value in (options or {}).items() if key != "name"}


def _unknown(name: str, root: str | Path | None) -> UnknownPolicyError:
    known = policy_names() if root is None else sorted({*behavior_names(), RANDOM, MIXED, *trained_policies()})
    near = COMMON_NAMES.get(name.lower()) or nearest(name, known)
    fix = f"did you mean {near}?" if near else f"choose one of {', '.join(known)}, or a file (.npz, .onnx)"
    if root is not None and name in POLICIES.names():
        fix = "plug-ins are not run here; choose a behavior or a file of the workspace"
    if name.endswith(_TORCH_SUFFIXES):
        fix = "irsim convert makes a policy file (.npz) of weights of PyTorch"
    return UnknownPolicyError(f"there is no policy {clean(name)!r}", fix, "policy", known)


def _made(name: str, maker: Callable[..., Any], options: Mapping[str, Any]) -> Policy:
    """The policy of a maker with options."""
    if (unknown := _unknown_option(name, maker, options)) is not None:
        raise unknown
    package = getattr(maker, "package", None)
    if package is not None and not is_installed(package[0]):
        raise PolicyError("missing-extra", f"the policy {clean(name)!r} needs the package {package[0]}", package[1])
    try:
        made = maker(**options)
    except CodedError:
        raise
    except Exception as error:
        if (missing := _missing_option(name, maker, options)) is not None:
            raise missing from error
        what = f"policy {clean(name)!r} cannot be made: {clean(str(error), 300)}"
        raise PolicyError("policy-failed", what, f"irsim policies {clean(name)} lists its options") from error
    if not isinstance(made, Policy):
        what = f"{clean(name)!r} made {as_given(made)}, which is not a policy"
        raise PolicyError("policy-failed", what, "return an object of a class derived from irsim.Policy")
    return made


def _unknown_option(name: str, maker: Callable[..., Any], options: Mapping[str, Any]) -> PolicyError | None:
    """The error for the first option that a policy does not have; None if it may have all of them."""
    try:
        parameters = inspect.signature(maker).parameters.values()
    except (TypeError, ValueError):
        return None  # calling the maker will tell
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    known = [parameter.name for parameter in parameters if parameter.kind is not parameter.VAR_POSITIONAL]
    key = next((key for key in options if key not in known), None)
    if key is None:
        return None
    fix = suggestion(key, known, f"its options are {', '.join(known)}" if known else "leave it out")
    return PolicyError("policy-failed", f"policy {clean(name)!r} has no option {clean(key)!r}", fix)


def _missing_option(name: str, maker: Callable[..., Any], options: Mapping[str, Any]) -> PolicyError | None:
    """The error for the first option that a policy requires and that is not given; None if all are."""
    try:
        parameters = inspect.signature(maker).parameters.values()
    except (TypeError, ValueError):
        return None
    named = [one for one in parameters if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)]
    key = next((one.name for one in named if one.default is one.empty and one.name not in options), None)
    if key is None:
        return None
    what = f"policy {clean(name)!r} needs the option {key}"
    return PolicyError(
        "policy-failed", what, f"write {{name: {clean(name)}, {key}: …}}; irsim policies {name} explains"
    )


def is_installed(package: str) -> bool:
    """Whether a Python package can be imported."""
    try:
        return find_spec(package) is not None
    except (ImportError, ValueError):
        return False


def _named(policy: Policy, text: str) -> Policy:
    """The policy, with the text that opens it."""
    policy.text = policy.source = text
    if not getattr(policy, "name", ""):
        policy.name = text
    return policy


def _digest(path: Path) -> str:
    """SHA-256 of a file, and of those beside it that belong to it."""
    beside = (other.read_bytes() for other in files_beside(path) if other.is_file())
    return digest(path.read_bytes(), *beside)


def _path_inside(name: str, folder: str | Path | None, root: str | Path | None) -> Path:
    """The path that a text names, from a folder, or inside of the root.

    Raises:
        PolicyError: It is outside of the root.
    """
    if root is not None and (why := why_outside(name, Path(root))) is not None:
        fix = "put the file into the workspace and name it relative to that"
        raise PolicyError("path-outside-workspace", f"{clean(name)!r} {why}", fix, where="policy")
    return Path(root if root is not None else folder or ".", name)


def _from_file(
    text: str, name: str, options: Mapping[str, Any], folder: str | Path | None, root: str | Path | None
) -> Policy:
    """A network from a file of the user."""
    path = _path_inside(name, folder, root)
    if path.is_dir():
        raise UnknownPolicyError(f"{clean(name)!r} is a folder", "give the path of a file")
    if not path.is_file():
        beside = [one.name for one in sorted(path.parent.glob("*")) if one.suffix in SUFFIXES][:1000]
        near = nearest(path.name, beside)
        fix = f"did you mean {Path(name).with_name(near)}?" if near else "check the path; irsim policies lists names"
        raise UnknownPolicyError(f"there is no file {clean(name)!r}", fix)
    if path.stat().st_size > MAX_FILE_BYTES:
        raise PolicyError("over-limit", f"{clean(name)!r} has more than {MAX_FILE_BYTES:,} bytes", "use a smaller file")
    return _network(path, text, name, options)


def _network(path: Path, text: str, name: str, options: Mapping[str, Any]) -> Policy:
    """A network; its only option is the time between two decisions."""
    from irsim.policies.networks import open_network

    period = options.get("decision_dt")
    unknown = [key for key in options if key != "decision_dt"]
    if unknown or (period is not None and not (is_number(period) and 0 < period < math.inf)):
        what = f"decision_dt must be a time [s] above 0, got {as_given(period)}"
        what = f"{clean(unknown[0])!r} is not an option of a file" if unknown else what
        fix = "the only option is decision_dt" if unknown else "write a number of seconds such as 0.25"
        raise PolicyError("policy-failed", f"{clean(name)!r}: {what}", fix, where="policy")
    policy = open_network(path)
    if period is not None:
        policy.decision_dt = float(period)
    policy.stochastic = False
    policy.text, policy.digest = text, _digest(path)
    policy.source = with_file(text, path.resolve())
    return policy
