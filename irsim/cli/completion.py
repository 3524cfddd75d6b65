"""Values that the TAB key offers: policies, topics, templates, suites, tasks, runs and keys of settings.

``irsim --install-completion`` teaches it to the shell. Without an offer the shell completes names of files.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any

__all__ = ["offers"]

_LISTS = ("overlays", "policies")
"""Parameters that take several values, separated by commas."""
_RECENT = 20
"""Number of runs that are offered."""


def offers(command: str, parameter: str) -> Callable[[Any, Any, str], list[str]] | None:
    """Return what completes a parameter, called with context, parameter and the begun word; None for any other one.

    Args:
        command: Words of the command, such as ``bridge page``.
        parameter: Name of the parameter in Python.
    """
    make = _OFFERS.get(f"{command} {parameter}", _OFFERS.get(parameter))
    if make is None:
        return None

    def complete(context: Any, _: Any, begun: str) -> list[str]:
        first, comma, last = begun.rpartition(",") if parameter in _LISTS else ("", "", begun)
        return [first + comma + name for name in sorted(set(make(context))) if name.startswith(last)]

    return complete


def _found(module: str, name: str) -> Any:
    """A name of a module that only this completion needs."""
    return getattr(import_module(module), name)


def _overlays(_: Any) -> Iterable[str]:
    names: Iterable[str] = _found("irsim.api.overlays", "OVERLAYS")
    return names


def _policies(_: Any) -> Iterable[str]:
    return [one.name for one in _found("irsim.policies.description", "list_policies")()]


def _topics(context: Any) -> Iterable[str]:
    schema = _found("irsim.scenario.model.json_schema", "json_schema")()
    paths = _found("irsim.lookup.search", "all_topics")(schema)
    names = (path.rpartition(".")[2] for path in paths)  # a key or a component alone is a topic, too
    lists = ("codes", "differences", "events", "guides", "metrics", "policies", "suites", "templates")
    events, tasks = _found("irsim.common.event_kinds", "EVENTS"), (f"task.{name}" for name in _tasks(context))
    return [*paths, *names, *lists, *events, *tasks, *_suites(context), *_policies(context)]


def _templates(_: Any) -> Iterable[str]:
    names: Iterable[str] = _found("irsim.bundled.templates", "names")()
    return names


def _suites(_: Any) -> Iterable[str]:
    names: Iterable[str] = _found("irsim.benchmarks.suite", "SUITES").names()
    return names


def _tasks(_: Any) -> Iterable[str]:
    names: Iterable[str] = _found("irsim.learning.tasks.files", "TASKS").names()
    return names


def _runs(_: Any) -> Iterable[str]:
    runs = _found("irsim.runs.store", "recent_ids")(_found("irsim.runs.store", "runs_folder")(), _RECENT)
    return [*runs, *("last", "last-1")[: len(runs)]]


def _formats(_: Any) -> Iterable[str]:
    names: Iterable[str] = _found("irsim.bridges.export.registry", "format_names")()
    return names


def _parameters(context: Any) -> Iterable[str]:
    """Keys of ``irsim new NAME --set``, which is read before."""
    names = [word for word in (context.params.get("name"), *context.args) if word in _templates(context)]
    load = _found("irsim.bundled.templates", "load")
    return [f"{key}=" for name in names[:1] for key in load(name).parameters]


def _settings(_: Any) -> Iterable[str]:
    return [f"{key}=" for key in _found("irsim.learning.training.settings", "TrainingSettings").model_fields]


_OFFERS: dict[str, Callable[[Any], Iterable[str]]] = {
    "policy": _policies,
    "policies": _policies,
    "policies name": _policies,
    "describe topic": _topics,
    "new name": _templates,
    "new settings": _parameters,
    "benchmark files": _suites,
    "audit files": _runs,
    "train task": _tasks,
    "train options": _settings,
    "export runs": _runs,
    "export to": _formats,
    "run": _runs,
    "before": _runs,
    "after": _runs,
    "render file": _runs,
    "render overlays": _overlays,
}
"""A parameter, or a command and its parameter -> the function that lists its values."""
