"""Other ways to write the same world: each must be accepted wherever the original is."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from typing import Any

import yaml

from irsim_evals.grader.scene import Scene

__all__ = ["REWRITES", "rewrites_of"]

Data = dict[str, Any]
Rewrite = Callable[[str, Data, Scene], str | None]
REWRITES: dict[str, Rewrite] = {}


def rewrite(function: Rewrite) -> Rewrite:
    """Register a rewrite under its name."""
    REWRITES[function.__name__] = function
    return function


def rewrites_of(text: str, scene: Scene) -> Iterator[tuple[str, str]]:
    """Name and text of each rewrite that applies to a scenario.

    Args:
        text: The scenario as written.
        scene: Its world with the first seed.
    """
    data = yaml.safe_load(text)
    for name, make in REWRITES.items():
        found = make(text, copy.deepcopy(data), scene)
        if found is not None and found != text:
            yield name, found


def _dump(data: Data, **options: Any) -> str:
    return str(yaml.safe_dump(data, sort_keys=False, allow_unicode=True, **options))


def _entries(data: Data) -> list[tuple[str, Data]]:
    found = []
    for section in ("robot", "obstacle"):
        given = data.get(section)
        items = given if isinstance(given, list) else [given] if isinstance(given, dict) else []
        found += [(section, entry) for entry in items if isinstance(entry, dict)]
    return found


@rewrite
def flow_style(text: str, data: Data, scene: Scene) -> str | None:
    """Everything on as few lines as possible."""
    return _dump(data, default_flow_style=True, width=10_000)


@rewrite
def block_style(text: str, data: Data, scene: Scene) -> str | None:
    """Every key on its own line."""
    return _dump(data, default_flow_style=False)


@rewrite
def keys_reversed(text: str, data: Data, scene: Scene) -> str | None:
    """Keys in the opposite order, at every level."""

    def turned(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: turned(value[key]) for key in reversed(value)}
        return [turned(item) for item in value] if isinstance(value, list) else value

    return _dump(turned(data))


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
    return _dump(data) if changed else None


@rewrite
def explicit_defaults(text: str, data: Data, scene: Scene) -> str | None:
    """Keys with their default values written out."""
    world = data.setdefault("world", {})
    for key in ("step_time", "sample_time", "control_mode", "collision_mode"):
        world.setdefault(key, getattr(scene.world, key))
    for _, entry in _entries(data):
        entry.setdefault("static", False)
        entry.setdefault("unobstructed", False)
        entry.setdefault("goal_threshold", 0.1)
    return _dump(data)


@rewrite
def anchors(text: str, data: Data, scene: Scene) -> str | None:
    """Equal mappings written once, with anchors and aliases."""
    known: dict[str, Any] = {}

    def shared(value: Any) -> Any:
        if isinstance(value, dict):
            made = {key: shared(item) for key, item in value.items()}
            return known.setdefault(repr(made), made)
        return [shared(item) for item in value] if isinstance(value, list) else value

    made = _dump(shared(data))
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
def one_entry_each(text: str, data: Data, scene: Scene) -> str | None:
    """Groups written out: one entry for each object, with its own pose and goal."""
    if scene.env.scenario.placements or not any(entry.get("number", 1) > 1 for _, entry in _entries(data)):
        return None
    bodies = iter(scene.bodies)
    made: Data = {key: value for key, value in data.items() if key not in ("robot", "obstacle")}
    for section, entry in _entries(data):
        for _ in range(entry.get("number", 1)):
            body = next(bodies)
            one = {key: value for key, value in entry.items() if key not in ("number", "distribution", "state", "goal")}
            if any(
                isinstance(value, list) and value and isinstance(value[0], list)
                for key, value in one.items()
                if key != "waypoints"
            ):
                return None
            one["state"] = [round(value, 9) for value in body.pose]
            one["group"] = body.group
            if body.goals and "waypoints" not in one:
                one["goal"] = [round(value, 9) for value in body.goals[-1]]
            if one.get("color") == "cycle" or isinstance(one.get("color"), list):
                one["color"] = body.color
            if isinstance(one.get("name"), list):
                one["name"] = body.name
            made.setdefault(section, []).append(one)
    return _dump(made)


@rewrite
def entries_renamed(text: str, data: Data, scene: Scene) -> str | None:
    """Descriptive names where there were none."""
    changed = False
    for number, (section, entry) in enumerate(_entries(data)):
        if "name" not in entry and entry.get("number", 1) == 1:
            entry["name"], changed = f"{section}-number-{number}", True
    return _dump(data) if changed else None


def _rectangles(data: Data, change: Callable[[Data, Data], None]) -> str | None:
    """Apply a change to each static obstacle with the shape of a rectangle and one pose."""
    changed = False
    for section, entry in _entries(data):
        shape, state = entry.get("shape"), entry.get("state")
        if section != "obstacle" or "kinematics" in entry or not isinstance(shape, dict) or entry.get("number", 1) != 1:
            continue
        if shape.get("name") != "rectangle" or not isinstance(state, list) or isinstance(state[0], list):
            continue
        change(entry, shape)
        changed = True
    return _dump(data) if changed else None


@rewrite
def rectangles_as_polygons(text: str, data: Data, scene: Scene) -> str | None:
    """Rectangular obstacles as polygons with four corners in the world frame."""

    def change(entry: Data, shape: Data) -> None:
        x, y, *rest = entry["state"]
        heading = rest[0] if rest else 0.0
        c, s = math.cos(heading), math.sin(heading)
        a, b = shape.get("length", 1.0) / 2, shape.get("width", 1.0) / 2
        corners = [(-a, -b), (a, -b), (a, b), (-a, b)]
        entry["shape"] = {
            "name": "polygon",
            "vertices": [[round(x + c * u - s * v, 9), round(y + s * u + c * v, 9)] for u, v in corners],
        }
        entry["state"] = [0, 0, 0]

    return _rectangles(data, change)


@rewrite
def rectangles_turned(text: str, data: Data, scene: Scene) -> str | None:
    """Rectangular obstacles a quarter turn further, with length and width exchanged."""

    def change(entry: Data, shape: Data) -> None:
        shape["length"], shape["width"] = shape.get("width", 1.0), shape.get("length", 1.0)
        x, y, *rest = entry["state"]
        entry["state"] = [x, y, round((rest[0] if rest else 0.0) + math.pi / 2, 9)]

    return _rectangles(data, change)


@rewrite
def slightly_off(text: str, data: Data, scene: Scene) -> str | None:
    """Positions of robots a tenth of a millimetre off."""
    changed = False
    for section, entry in _entries(data):
        state = entry.get("state")
        if section == "robot" and isinstance(state, list) and state and isinstance(state[0], (int, float)):
            state[0], changed = state[0] + 1e-4, True
    return _dump(data) if changed else None


@rewrite
def obstacles_in_reverse(text: str, data: Data, scene: Scene) -> str | None:
    """Obstacles in the opposite order."""
    given = data.get("obstacle")
    if not isinstance(given, list) or len(given) < 2 or scene.env.scenario.placements:
        return None
    data["obstacle"] = given[::-1]
    return _dump(data)


@rewrite
def sections_swapped(text: str, data: Data, scene: Scene) -> str | None:
    """Obstacles and robots before the world."""
    return _dump(
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
    for _, entry in _entries(data):
        for sensor in entry.get("sensors") or []:
            if isinstance(sensor, dict) and "name" in sensor:
                sensor["type"] = sensor.pop("name")
                changed = True
    return _dump(data) if changed else None


@rewrite
def wrapped(text: str, data: Data, scene: Scene) -> str | None:
    """Behind a marker of the document, with blank lines."""
    return "---\n\n" + text.replace("\n", "\n\n") + "\n"
