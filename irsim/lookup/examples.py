"""Finds examples for a topic in the bundled templates, whose scenarios are tested."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import yaml

from irsim.bundled import templates
from irsim.common.data_files import read_yaml
from irsim.lookup.schema_walk import yaml_text

__all__ = ["example_of"]

MAX_LINE_LENGTH = 90
"""Longer values are written on several lines."""


def example_of(path: tuple[str, ...], component: str | None = None) -> str | None:
    """Return YAML for a path of the language from a template, or None if no template uses the path.

    Args:
        path: Words of the path, such as ``("robot", "vel_max")``.
        component: Name of the component at the end of the path, if it ends with a component.
    """
    names = path[:-1] if component is not None else path
    for section in dict.fromkeys((path[0], "robot" if path[0] == "obstacle" else path[0], "obstacle")):
        words = (section, *path[1:]) if path[0] in ("robot", "obstacle") else path
        values = [value for data in _scenarios() for value in _values(data, words)]
        lines = {yaml_text(value): value for value in values if value not in (None, {}, [])}
        if lines:
            fitting = [line for line in lines if len(line) <= MAX_LINE_LENGTH] or [min(lines, key=len)]
            best = lines[
                max(fitting, key=len)
                if component is not None
                else next((line for line in fitting if isinstance(lines[line], dict)), fitting[0])
            ]
            return _example_text(names[-1], best, component)
    return None


@cache
def _scenarios() -> tuple[Any, ...]:
    """Read the scenarios of all templates; cached, because the reference pages ask for hundreds of examples."""
    texts = (templates.scenario_file(name).read_text(encoding="utf-8") for name in templates.names())
    return tuple(read_yaml(text) for text in texts)


def _values(data: Any, words: tuple[str, ...]) -> Iterator[Any]:
    """Iterate over the values at a path; lists are searched, and names of components select mappings."""
    if isinstance(data, list):
        if not words and not any(isinstance(item, dict) for item in data):
            yield data
        for item in data if words or any(isinstance(item, dict) for item in data) else []:
            yield from _values(item, words)
    elif not words:
        yield data
    elif isinstance(data, dict):
        if words[0] in data:
            yield from _values(data[words[0]], words[1:])
        elif data.get("name", data.get("type")) == words[0]:
            yield from _values(data, words[1:])


_LISTS = ("bridges", "sensors", "zones")
"""Keys whose mappings stand in a list."""


def _example_text(name: str, value: Any, component: str | None) -> str:
    one = [value] if name in _LISTS and isinstance(value, dict) else value
    line = f"{name}: {yaml_text(one)}"
    if len(line) <= MAX_LINE_LENGTH + len(name) or not isinstance(value, dict):
        return line
    whole = {name: [value] if name in ("robot", "obstacle", *_LISTS) else value}
    return yaml.safe_dump(whole, sort_keys=False, default_flow_style=None, width=MAX_LINE_LENGTH).rstrip()
