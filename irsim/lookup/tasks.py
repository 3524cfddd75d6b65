"""Answers about tasks: what learning adds to a scenario."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.learning.tasks.files import TASKS, open_task
from irsim.lookup.answer import Answer, Key
from irsim.lookup.schema_walk import Node, component_name, components, key, mappings, step, yaml_text

__all__ = ["task_answer"]

_ABOUT = (
    "A task file says what learning adds to a scenario: who learns, what it observes, what its actions mean, what it "
    "earns, and when episodes end. `irsim.learning.Env(FILE)` is one for Gymnasium; `irsim validate FILE` checks it."
)


def task_answer(words: Sequence[str]) -> Answer | None:
    """Describe a task, or a key of one, or a bundled task; None if there is no such key or task.

    Args:
        words: The path below ``task``, such as ``reward progress``, or the name of a bundled task.
    """
    if len(words) == 1 and words[0] in TASKS.names():
        return _bundled(words[0])
    schema = TASKS.schema()
    nodes: list[Node] = [schema]
    for word in words:
        nodes = step(schema, nodes, word)
    if not nodes:
        return None
    node, path = nodes[0], ["task", *words]
    named = components(schema, node)
    chosen = bool(words) and component_name(node) == words[-1] if "properties" in node else False
    if len(named) > 1 and not chosen:
        groups = {"one of": [_line(name, option) for name, option in named.items()]}
    else:
        groups = {"keys": _keys(schema, node)}
    about = None if not words or chosen else key(schema, words[-1], node)
    if not words:
        groups["bundled tasks"] = [
            Key(name=f"task.{name}", text=open_task(TASKS.bundled(name))[0].title) for name in TASKS.names()
        ]
    return Answer(
        topic=".".join(path),
        kind="component" if chosen else "key" if words else "index",
        title=".".join(path) if words else "Tasks: scenarios to learn in",
        text=_ABOUT if not words else _text(node) if about is None else about.text,
        about=about,
        groups={name: keys for name, keys in groups.items() if keys},
        example=_EXAMPLE if not words else _example(schema, node),
        see=["policies", "suites"] if not words else ["task"],
    )


def _bundled(name: str) -> Answer:
    file = TASKS.bundled(name)
    task, _ = open_task(file)
    return Answer(
        topic=f"task.{name}",
        kind="component",
        title=f"bundled task {name}",
        text=f"{task.title}. {task.about.strip()} To change it, write what stands below into a file of your own.",
        example=file.read_text(encoding="utf-8"),
        see=["task", "policies"],
    )


def _keys(schema: Node, node: Node) -> list[Key]:
    keys: dict[str, Key] = {}
    for option in mappings(schema, node):
        required = option.get("required", [])
        for name, child in option["properties"].items():
            keys.setdefault(name, key(schema, name, child, name in required))
    return list(keys.values())


def _line(name: str, option: Node) -> Key:
    return Key(name=name, text=_text(option))


def _text(node: Node) -> str:
    return " ".join(str(node.get("description", "")).split())


def _example(schema: Node, node: Node) -> str | None:
    examples = [option["examples"] for option in (node, *mappings(schema, node)) if option.get("examples")]
    return yaml_text(examples[0][0]) if examples else None


_EXAMPLE = """\
task: to_the_goal
title: One robot with a lidar drives to its goal
template: training-arena
parameters: {robots: 1}
horizon: 30
observation:
  - {name: scan, sectors: 36}
  - {name: goal, features: [nearness, cos, sin]}
  - {name: own, features: [vx, yaw_rate]}
reward:
  - {name: progress, weight: 1.0}
  - {name: arrival, weight: 5.0}
  - {name: collision, weight: -5.0}
"""
