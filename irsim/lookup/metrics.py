"""Metrics as topics: each by its key, and all of them."""

from __future__ import annotations

from irsim.lookup.answer import Answer, Key
from irsim.lookup.guides import GUIDES
from irsim.metrics.definitions import EPISODE_METRICS, METRICS, Metric

__all__ = ["METRIC_TOPICS", "all_metrics", "metric_answer", "metric_line", "metric_topic"]

_OVER_ROBOTS = {
    "mean": "Over the robots of an episode: their mean.",
    "min": "Over the robots of an episode: the least.",
    "max": "Over the robots of an episode: the greatest.",
    "all": "Over the robots of an episode: 1 if all have 1.",
}
_OF_EPISODES = frozenset(metric.key for metric in EPISODE_METRICS)


def metric_topic(key: str) -> str:
    """What to ask for: the key, but ``metric success`` where a guide goes by that word."""
    return f"metric {key}" if any(key in (name, *guide.words) for name, guide in GUIDES.items()) else key


METRIC_TOPICS: dict[str, Metric] = {metric_topic(metric.key): metric for metric in (*METRICS, *EPISODE_METRICS)}
"""All of them by what to ask for."""


def metric_answer(topic: str) -> Answer:
    """All about one of :data:`METRIC_TOPICS`."""
    metric = METRIC_TOPICS[topic]
    told = [f"{metric.text[:1].upper()}{metric.text[1:]}."]
    told.append("Of an episode as a whole." if metric.key in _OF_EPISODES else _OVER_ROBOTS[metric.robots])
    if metric.better is not None:
        told.append(f"{metric.better.capitalize()} is better.")
    about = Key(name=metric.key, type="a number", unit=metric.unit, text=metric.text)
    return Answer(
        topic=topic,
        kind="metric",
        title=f"metric {metric.key}",
        text=" ".join(told),
        about=about,
        example=f"irsim benchmark scenario.yaml --json  # {metric.key} is in metrics of every row and episode",
        see=["metrics"],
    )


def metric_line(metric: Metric) -> str:
    """Its unit, what it is and which way is better."""
    better = f"; {metric.better} is better" if metric.better is not None else ""
    return f"[{metric.unit}] {metric.text}{better}"


def all_metrics() -> Answer:
    """All keys."""
    groups = {
        "canonical": [metric for metric in METRICS if metric.canonical],
        "extras": [metric for metric in METRICS if not metric.canonical],
        "of an episode": list(EPISODE_METRICS),
    }
    return Answer(
        topic="metrics",
        kind="index",
        title="Metrics of episodes, as `irsim benchmark` gives them",
        text="Of a robot until it arrived; undefined where it has no meaning. L*: shortest way, T: time to goal.",
        groups={
            name: [Key(name=metric_topic(metric.key), text=metric_line(metric)) for metric in metrics]
            for name, metrics in groups.items()
        },
        example="irsim benchmark scenario.yaml --json",
    )
