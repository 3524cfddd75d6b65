"""Finds the parts of the language that this version does not simulate, by validating each key and component."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from irsim.lookup.schema_walk import Node, alternatives, components, mappings, yaml_text
from irsim.scenario.read import read

__all__ = ["Gap", "find_gaps"]

_WORLD: dict[str, Any] = {"width": 10, "height": 10}
_ROBOT: dict[str, Any] = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "state": [1, 1, 0],
    "goal": [8, 8],
    "behavior": {"name": "dash"},
}


@dataclass(frozen=True)
class Gap:
    """A key with a value that the validator rejects as not simulated yet.

    Attributes:
        section: ``world``, or ``robot`` (obstacles have the same keys).
        key: Key of that section.
        value: The value, or the name of the component.
        example: Key and value as YAML.
        message: Message of the validator.
    """

    section: str
    key: str
    value: str
    example: str
    message: str


def find_gaps(schema: Node) -> list[Gap]:
    """Return the keys and values of ``world``, ``robot`` and ``obstacle`` that are not simulated, in schema order.

    Each word, switch and component is validated in a small scenario of its own; combinations are not tried.

    Args:
        schema: JSON Schema of the language.
    """
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))["properties"]
    found = []
    for section, base in (("world", _WORLD), ("robot", _ROBOT)):
        [keys] = [option["properties"] for option in mappings(schema, language[section])]
        for key, node in keys.items():
            for name, value in _values(schema, key, node):
                message = _find_refusal({"world": _WORLD, "robot": _ROBOT, section: {**base, key: value}})
                if message is not None:
                    found.append(Gap(section, key, name, f"{key}: {yaml_text(_name_first(value))}", message))
    return found


def _values(schema: Node, key: str, node: Node) -> Iterator[tuple[str, Any]]:
    """Iterate over the values to try: each component, each word, and true for a switch."""
    for name, option in components(schema, node).items():
        value = option.get("examples", [{"name": name}])[0]
        yield name, [value] if key == "sensors" else value
    for option in alternatives(schema, node):
        for word in [option["const"]] if "const" in option else option.get("enum", []):
            if isinstance(word, str) and not key.endswith("color"):
                yield word, word
        if option.get("type") == "boolean":
            yield "true", True


def _name_first(value: Any) -> Any:
    if isinstance(value, list):
        return [_name_first(item) for item in value]
    return {"name": value["name"], **value} if isinstance(value, dict) else value


def _find_refusal(data: dict[str, Any]) -> str | None:
    """Return the message of the validator about something that is not simulated yet, or None."""
    for item in read(data, strict=True).diagnostics:
        if item.code == "not-yet-simulated":
            return item.message
    return None
