"""How long policies take to decide: wall-clock times, which are no part of results and have a file of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

__all__ = ["Decisions", "timing_report", "was_timed"]

Decisions = Sequence[tuple[float, int]]
"""Wall-clock time [s] of each decision of a policy, and the number of robots that it decided for."""
_EARLIER = "its episodes were run before the benchmark was resumed"
_NONE = "no robot needed a decision"


def timing_report(policies: Mapping[str, Mapping[str, Decisions]], episodes: Mapping[str, int]) -> dict[str, Any]:
    """Summarise the times of decisions.

    Args:
        policies: Policy → the decisions of each episode that was timed.
        episodes: Policy → number of its episodes.

    Returns:
        For each policy ``mean_ms`` and ``p95_ms`` per decision and per robot, or the reason why there are none.
    """
    return {"policies": {name: _summary(found, episodes[name]) for name, found in policies.items()}}


def was_timed(report: Mapping[str, Any]) -> bool:
    """Whether a report has times."""
    return any("per_decision" in policy for policy in report["policies"].values())


def _summary(found: Mapping[str, Decisions], episodes: int) -> dict[str, Any]:
    pairs = np.array([pair for decisions in found.values() for pair in decisions], dtype=np.float64).reshape(-1, 2)
    if not len(pairs):
        return {"reason": _NONE if found else _EARLIER}
    each = np.repeat(pairs[:, 0] / pairs[:, 1], pairs[:, 1].astype(np.int64))
    return {
        "episodes": len(found),
        "episodes_in_all": episodes,
        "decisions": len(pairs),
        "robots_per_decision": round(float(pairs[:, 1].mean()), 3),
        "per_decision": _milliseconds(pairs[:, 0]),
        "per_robot": _milliseconds(each),
    }


def _milliseconds(seconds: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, float]:
    values = 1e3 * seconds
    return {"mean_ms": round(float(values.mean()), 5), "p95_ms": round(float(np.percentile(values, 95)), 5)}
