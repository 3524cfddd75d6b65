"""What the language has and this version does not simulate, found by asking the validator, not by a list."""

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
    """A key with a value that the validator refuses as not simulated yet.

    Attributes:
        section: ``world``, or ``robot`` (obstacles have the same keys).
        key: Key of that section.
        value: The value, or the name of the component.
        example: Key and value as YAML.
        message: What the validator says.
    """

    section: str
    key: str
    value: str
    example: str
    message: str


def find_gaps(schema: Node) -> list[Gap]:
    """Every key and value of ``world``, ``robot`` and ``obstacle`` that is language only, in the order of the schema.

    Each word, switch and component is tried in a small scenario of its own; combinations are not.

    Args:
        schema: That of the language.
    """
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))["properties"]
    found = []
    for section, base in (("world", _WORLD), ("robot", _ROBOT)):
        [keys] = [option["properties"] for option in mappings(schema, language[section])]
        for key, node in keys.items():
            for name, value in _values(schema, key, node):
                message = _refusal({"world": _WORLD, "robot": _ROBOT, section: {**base, key: value}})
                if message is not None:
                    found.append(Gap(section, key, name, f"{key}: {yaml_text(_name_first(value))}", message))
    return found


def _values(schema: Node, key: str, node: Node) -> Iterator[tuple[str, Any]]:
    """Values to try: every component, every word, a switch turned on."""
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


def _refusal(data: dict[str, Any]) -> str | None:
    """What the validator says about something that is not simulated yet, if it says so."""
    for item in read(data, strict=True).diagnostics:
        if item.code == "not-yet-simulated":
            return item.message
    return None
