"""Reads a scenario as written, or with another behavior for every robot."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from irsim.common.arguments import as_given
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path, suggestion
from irsim.diagnostics.errors import InputError
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import Document, load_text
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = [
    "AS_WRITTEN",
    "behavior_text",
    "check_behavior_name",
    "merged_options",
    "parse_behavior",
    "raise_if_about_behavior",
    "read_with_behavior",
    "split_behaviors",
    "with_behavior",
]

AS_WRITTEN = "as-written"
"""Stands for the behaviors that the scenario itself gives its robots."""
_FIX = "give a name such as orca, or {name: orca, timeHorizon: 5}, or as-written for the scenario's own"
_KEPT = ("wander", "loop", "range_low", "range_high", "target_roles")
"""Options that say what a robot does, not how; they are kept when its behavior is replaced."""


def parse_behavior(text: str) -> dict[str, Any] | None:
    """The mapping that a behavior given as text means.

    Args:
        text: A name (``orca``), a name with options in YAML (``{name: orca, timeHorizon: 5}``), or ``as-written``.

    Returns:
        The mapping to write under ``behavior``; None for ``as-written``.

    Raises:
        InputError: The text is none of these.
    """
    text = text.strip()
    if text == AS_WRITTEN:
        return None
    if not text.startswith("{"):
        if not text or any(character in text for character in " :{}[],"):
            raise InputError(f"{text!r} is not a valid behavior", _FIX)
        return {"name": text}
    document = load_text(text)
    if document.problems or not isinstance(document.data, Mapping) or not isinstance(document.data.get("name"), str):
        raise InputError(f"{text!r} is not a valid behavior", _FIX)
    return dict(document.data)


def split_behaviors(text: str) -> list[str]:
    """The behaviors of a list as it is written on a command line: commas inside braces and brackets do not separate."""
    depth, parts = 0, [""]
    for character in text:
        depth += (character in "{[") - (character in "}]")
        if character == "," and depth <= 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


def behavior_text(behavior: str | Mapping[str, Any]) -> str:
    """A behavior as text, as it is written on a command line.

    Raises:
        InputError: The behavior is neither text nor a mapping.
    """
    if isinstance(behavior, str):
        return behavior.strip()
    if isinstance(behavior, Mapping):
        return yaml_flow(behavior)
    raise InputError(f"a behavior must be a name or a mapping, got {as_given(behavior)}", _FIX)


def check_behavior_name(behavior: str) -> None:
    """Refuse the name of an unknown behavior.

    Raises:
        InputError: No behavior has that name.
    """
    known = sorted({AS_WRITTEN, *BEHAVIORS.names(), *CUSTOM_BEHAVIORS.names(), *CUSTOM_GROUP_BEHAVIORS.names()})
    name = (parse_behavior(behavior) or {"name": AS_WRITTEN})["name"]
    if name not in known:
        fix = suggestion(name, known, f"choose one of {', '.join(known)}")
        raise InputError(f"there is no behavior {clean(name)!r}", fix)


def with_behavior(document: Document, behavior: Mapping[str, Any] | None, *, strict: bool) -> ResolvedScenario:
    """The scenario in which every robot that can move follows one behavior, see :func:`read_with_behavior`."""
    return read_with_behavior(document, behavior, strict=strict)[0]


def read_with_behavior(
    document: Document, behavior: Mapping[str, Any] | None, *, strict: bool
) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """The scenario in which every robot that can move follows one behavior, on its own.

    Robots keep their task (goals, ``wander``, ``loop``) and the roles that they avoid (``target_roles``). All other
    options are those given here, or defaults, even for robots that already have this behavior with other options.

    Args:
        document: The scenario as written.
        behavior: Value to write under ``behavior`` of every robot; None leaves everything as it is.
        strict: Treat what IR-SIM 2.12 ignores as an error.

    Returns:
        The scenario, and the warnings and hints about it.

    Raises:
        ScenarioError: The scenario cannot be used.
        InputError: The behavior has an unknown option or an invalid value, or cannot drive a robot of this
            scenario.
    """
    if behavior is None or not isinstance(document.data, Mapping):
        return or_raise(read(document, strict=strict, limits=document.limits))
    data = copy.deepcopy(dict(document.data))
    entries = data.get("robot")
    for entry in entries if isinstance(entries, list) else [entries]:
        if isinstance(entry, dict) and entry.get("kinematics") is not None:
            _set_behavior(entry, behavior)
    changed = read(replace(document, data=data, text=None, _root=None), strict=strict, limits=document.limits)
    for item in changed.diagnostics:
        raise_if_about_behavior(item, behavior)
    if changed.scenario is None:
        or_raise(read(document, strict=strict, limits=document.limits))  # these findings have line numbers
    return or_raise(changed)


def raise_if_about_behavior(item: Diagnostic, behavior: Mapping[str, Any]) -> None:
    """Raise a finding about the given behavior: it is an argument, so IR-SIM's leniency for files does not apply."""
    owner = item.path.index("behavior") + 1 if item.path[:1] == ("robot",) and "behavior" in item.path else None
    if owner is None:
        return
    keys = [part for part in item.path[owner:] if isinstance(part, str)]
    wrong = item.severity == "error" or (item.tolerated and keys[:1] != ["name"])
    if not wrong or (keys and keys[0] not in behavior):
        return
    place = format_path(item.path[:owner])
    known = item.allowed if isinstance(item.allowed, str) else ", ".join(item.allowed or ())
    fix = item.fix or (f"allowed is {known}" if known else "choose another behavior or other options")
    named = f"{place}: " if keys[:1] in ([], ["name"]) else "" if keys[-1] in item.message else f"{'.'.join(keys)}: "
    message = item.message.replace(f"'{place}'", f"behavior {behavior['name']}").replace(f"{place}.", "")
    raise InputError(named + message.rstrip("."), fix.replace(f"{place}.", ""))


def _set_behavior(entry: dict[str, Any], behavior: Mapping[str, Any]) -> None:
    """Replace the behavior of the robots of an entry."""
    own, group = entry.pop("behavior", None), entry.pop("group_behavior", None)
    if isinstance(own, list):
        entry["behavior"] = [merged_options(one, group, behavior) for one in own]
    else:
        entry["behavior"] = merged_options(own, group, behavior)


def merged_options(own: Any, group: Any, behavior: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of a behavior for a robot that keeps what its own or its group's behavior tells it to do."""
    own, group = _mapping(own), _mapping(group)
    kept = {key: source[key] for source in (group, own) for key in _KEPT if key in source}
    return {**kept, **behavior}


def _mapping(value: Any) -> dict[str, Any]:
    if isinstance(value, str):
        return {"name": value}
    return dict(value) if isinstance(value, Mapping) else {}
