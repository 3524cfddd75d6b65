"""Topics about metrics, and about learning: tasks, rewards and what they are made of."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.learning.tasks.files import TASKS, open_task
from irsim.lookup.answer import Answer, Key
from irsim.lookup.guides import GUIDES
from irsim.lookup.schema_walk import Node, component_name, components, key, mappings, step, yaml_text
from irsim.metrics.definitions import EPISODE_METRICS, METRICS, Metric

__all__ = ["METRIC_TOPICS", "all_metrics", "metric_answer", "metric_line", "metric_topic", "task_answer"]

_OVER_ROBOTS = {
    "mean": "The value of an episode is the mean over its robots.",
    "min": "The value of an episode is the smallest one of its robots.",
    "max": "The value of an episode is the largest one of its robots.",
    "all": "The value of an episode is 1 if all of its robots have 1.",
}
_OF_EPISODES = frozenset(metric.key for metric in EPISODE_METRICS)


def metric_topic(key: str) -> str:
    """Return the topic of a metric: its key, or ``metric success`` if a guide has the same name."""
    return f"metric {key}" if any(key in (name, *guide.words) for name, guide in GUIDES.items()) else key


METRIC_TOPICS: dict[str, Metric] = {metric_topic(metric.key): metric for metric in (*METRICS, *EPISODE_METRICS)}
"""Topic -> metric."""


def metric_answer(topic: str) -> Answer:
    """Describe one of :data:`METRIC_TOPICS`."""
    metric = METRIC_TOPICS[topic]
    sentences = [f"{metric.text[:1].upper()}{metric.text[1:]}."]
    is_of_episode = metric.key in _OF_EPISODES
    sentences.append("It is a metric of the whole episode." if is_of_episode else _OVER_ROBOTS[metric.robots])
    if metric.better is not None:
        sentences.append(f"{metric.better.capitalize()} is better.")
    about = Key(name=metric.key, type="a number", unit=metric.unit, text=metric.text)
    return Answer(
        topic=topic,
        kind="metric",
        title=f"metric {metric.key}",
        text=" ".join(sentences),
        about=about,
        example=f"irsim benchmark scenario.yaml --json  # each row and episode has metrics.{metric.key}",
        see=["metrics"],
    )


def metric_line(metric: Metric) -> str:
    """Describe a metric in one line: unit, meaning, and whether higher or lower is better."""
    better = f"; {metric.better} is better" if metric.better is not None else ""
    return f"[{metric.unit}] {metric.text}{better}"


def _listed(metric: Metric) -> str:
    """Describe a metric as a line of the list: unit, a sign for what is better, meaning."""
    sign = {"more": " +", "less": " -", None: ""}[metric.better]
    return f"[{metric.unit}]{sign} {metric.text}"


def all_metrics() -> Answer:
    """Return the topic that lists all metrics."""
    groups = {
        "canonical": [metric for metric in METRICS if metric.canonical],
        "extras": [metric for metric in METRICS if not metric.canonical],
        "of an episode": list(EPISODE_METRICS),
    }
    return Answer(
        topic="metrics",
        kind="index",
        title="Metrics of episodes, which `irsim benchmark` computes",
        text="The metrics of a robot cover the time until it arrives; a metric without a meaning in an episode is "
        "undefined. L*: length of the shortest path, T: time to goal. After the unit, + says that more is better, - "
        "that less is.",
        groups={
            name: [Key(name=metric_topic(metric.key), text=_listed(metric)) for metric in metrics]
            for name, metrics in groups.items()
        },
        example="irsim benchmark scenario.yaml --json",
    )


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
        groups = {"one of": [Key(name=name, text=_text(option)) for name, option in named.items()]}
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
