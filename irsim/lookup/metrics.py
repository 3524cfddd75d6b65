"""The topics about metrics: one for each metric, and one that lists all."""

from __future__ import annotations

from irsim.lookup.answer import Answer, Key
from irsim.lookup.guides import GUIDES
from irsim.metrics.definitions import EPISODE_METRICS, METRICS, Metric

__all__ = ["METRIC_TOPICS", "all_metrics", "metric_answer", "metric_line", "metric_topic"]

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
