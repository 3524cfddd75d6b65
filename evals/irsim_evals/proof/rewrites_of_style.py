"""Rewrites of the text: the same values in another style, order or spelling."""

from __future__ import annotations

from typing import Any

import yaml

from irsim_evals.grader.scene import Scene
from irsim_evals.proof.rewrite import Data, dump, entries, rewrite


@rewrite
def flow_style(text: str, data: Data, scene: Scene) -> str | None:
    """Everything on as few lines as possible."""
    return dump(data, default_flow_style=True, width=10_000)


@rewrite
def block_style(text: str, data: Data, scene: Scene) -> str | None:
    """Every key on its own line."""
    return dump(data, default_flow_style=False)


@rewrite
def keys_reversed(text: str, data: Data, scene: Scene) -> str | None:
    """Keys in the opposite order, at every level."""

    def turned(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: turned(value[key]) for key in reversed(value)}
        return [turned(item) for item in value] if isinstance(value, list) else value

    return dump(turned(data))


@rewrite
def comments(text: str, data: Data, scene: Scene) -> str | None:
    """With comments."""
    return "# a scenario\n" + "".join(
        f"{line}  # so it is\n" if line.endswith("}") else f"{line}\n" for line in text.splitlines()
    )


@rewrite
def list_or_mapping(text: str, data: Data, scene: Scene) -> str | None:
    """A single entry without the list around it, or with one."""
    changed = False
    for section in ("robot", "obstacle"):
        given = data.get(section)
        if isinstance(given, list) and len(given) == 1:
            data[section], changed = given[0], True
        elif isinstance(given, dict):
            data[section], changed = [given], True
    return dump(data) if changed else None


@rewrite
def explicit_defaults(text: str, data: Data, scene: Scene) -> str | None:
    """Keys with their default values written out."""
    world = data.setdefault("world", {})
    for key in ("step_time", "sample_time", "control_mode", "collision_mode"):
        world.setdefault(key, getattr(scene.world, key))
    for _, entry in entries(data):
        entry.setdefault("static", False)
        entry.setdefault("unobstructed", False)
        entry.setdefault("goal_threshold", 0.1)
    return dump(data)


@rewrite
def anchors(text: str, data: Data, scene: Scene) -> str | None:
    """Equal mappings written once, with anchors and aliases."""
    known: dict[str, Any] = {}

    def shared(value: Any) -> Any:
        if isinstance(value, dict):
            made = {key: shared(item) for key, item in value.items()}
            return known.setdefault(repr(made), made)
        return [shared(item) for item in value] if isinstance(value, list) else value

    made = dump(shared(data))
    return made if "&id" in made else None


@rewrite
def numbers_otherwise(text: str, data: Data, scene: Scene) -> str | None:
    """Whole numbers with a decimal point, others in powers of ten."""

    class Odd(yaml.SafeDumper):
        pass

    def number(dumper: yaml.SafeDumper, value: float) -> Any:
        return dumper.represent_scalar("tag:yaml.org,2002:float", f"{value:.12e}")

    Odd.add_representer(float, number)
    return str(yaml.dump(data, Dumper=Odd, sort_keys=False, allow_unicode=True))


@rewrite
def entries_renamed(text: str, data: Data, scene: Scene) -> str | None:
    """Descriptive names where there were none."""
    changed = False
    for number, (section, entry) in enumerate(entries(data)):
        if "name" not in entry and entry.get("number", 1) == 1:
            entry["name"], changed = f"{section}-number-{number}", True
    return dump(data) if changed else None


@rewrite
def sections_swapped(text: str, data: Data, scene: Scene) -> str | None:
    """Obstacles and robots before the world."""
    return dump(
        {
            key: data[key]
            for key in sorted(
                data, key=lambda key: ("obstacle", "robot").index(key) if key in ("obstacle", "robot") else 2
            )
        }
    )


@rewrite
def sensor_by_type(text: str, data: Data, scene: Scene) -> str | None:
    """``type`` instead of ``name`` for sensors."""
    changed = False
    for _, entry in entries(data):
        for sensor in entry.get("sensors") or []:
            if isinstance(sensor, dict) and "name" in sensor:
                sensor["type"] = sensor.pop("name")
                changed = True
    return dump(data) if changed else None


@rewrite
def wrapped(text: str, data: Data, scene: Scene) -> str | None:
    """Behind a marker of the document, with blank lines."""
    return "---\n\n" + text.replace("\n", "\n\n") + "\n"
