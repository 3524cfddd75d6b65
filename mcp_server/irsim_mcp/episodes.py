"""The episodes of a finished benchmark as a table in pages, and the call that runs one of them again."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from irsim.common.text import clean
from irsim.results.benchmark import CROWDED
from irsim_mcp.answers import failure

__all__ = ["call_to_repeat", "check_finished", "episodes_table", "policy_names"]

_COLUMNS = ("scenario", "behavior", "seed", "outcome", "time", "steps", "path_length", "min_clearance", "failed")
_MAX_FAILURES = 3
"""Number of robots without success that a row lists."""
_DECIMALS = 3
"""Decimals of numbers in the table."""


def check_finished(state: Mapping[str, Any]) -> None:
    """Check that a job has a result.

    Raises:
        ToolError: The job has no result, or has not finished.
    """
    if "result" not in state:
        fix = "get_job waits for it" if state["status"] == "running" else "call benchmark again"
        what = f"job {state['id']} is {state['status']}, {state['done']} of {state['total']} episodes are done"
        raise failure("bad-argument", what, where="run_id", fix=fix)


def episodes_table(state: Mapping[str, Any], limit: int, cursor: str | None) -> dict[str, Any]:
    """The episodes of a benchmark, those without success first, in the form of the tables of runs.

    Args:
        state: State of the job of a benchmark that has a result.
        limit: Greatest number of rows.
        cursor: ``next_cursor`` of the previous page.

    Raises:
        ToolError: The cursor is invalid.
    """
    result = state["result"]
    episodes = sorted(result["episodes"], key=lambda episode: episode["outcome"] == "success")
    start = _start(cursor, len(episodes))
    labels = policy_names(result)
    rows = [_row(episode, labels) for episode in episodes[start : start + limit]]
    lost = [episode for episode in episodes if episode["outcome"] not in ("success", CROWDED)]
    crowded = sum(episode["outcome"] == CROWDED for episode in episodes)
    without = f", and {crowded} without room ({CROWDED})" if crowded else ""
    shown = start + len(rows)
    return {
        "run_id": state["id"],
        "status": state["status"],
        "outcome": None,
        "view": "episodes",
        "summary": f"{len(episodes)} episodes, of which {len(lost)} without success (listed first){without}",
        "columns": list(_COLUMNS),
        "rows": rows,
        "total": len(episodes),
        "every": 1,
        "next_cursor": str(shown) if shown < len(episodes) else None,
        "notes": [clean(f"{label} is {text}", 300) for text, label in labels.items() if label != text],
        "again": call_to_repeat(result, episodes[start]) if rows else "",
    }


def policy_names(result: Mapping[str, Any]) -> dict[str, str]:
    """Text of each policy → its short name, which a suite may give."""
    from irsim.benchmarks.labels import labels_of

    return labels_of(result["behaviors"]) | {text: name for name, text in result.get("policies", {}).items()}


def call_to_repeat(result: Mapping[str, Any], episode: Mapping[str, Any]) -> str:
    """The call that runs an episode again; a scenario that was given as text is named by its id."""
    name, behavior = episode["scenario"], episode["behavior"]
    name = f"{result['suite']}/{name}" if result.get("suite") else name
    steps = re.search(r" --steps (\d+)", result["reproduce"])
    words = ["run_episode", f"scenario_path={clean(name, 200)!r}", f"seed={episode['seed']}"]
    words += [f"policy={clean(behavior, 500)!r}"] if behavior != "as-written" else []
    words += [f"perturb={'; '.join(result['perturb'])!r}"] if result["perturb"] else []
    words += [f"max_steps={steps[1]}"] if steps else []
    return " ".join(words)


def _row(episode: Mapping[str, Any], labels: Mapping[str, str]) -> list[Any]:
    fates = [f"{name}: {fate}" for name, fate in list(episode["failures"].items())]
    more = f"; {len(fates) - _MAX_FAILURES} more" if len(fates) > _MAX_FAILURES else ""
    metrics = [episode["metrics"].get(key) for key in ("path_length", "min_clearance")]
    return [
        episode["scenario"],
        labels[episode["behavior"]],
        episode["seed"],
        episode["outcome"],
        round(episode["sim_time"], _DECIMALS),
        episode["steps"],
        *(None if value is None else round(value, _DECIMALS) for value in metrics),
        clean("; ".join(fates[:_MAX_FAILURES]) + more, 300) or None,
    ]


def _start(cursor: str | None, total: int) -> int:
    if cursor is None:
        return 0
    if not (cursor.isascii() and cursor.isdigit() and int(cursor[:12]) < total):
        fix = "use next_cursor of the previous page"
        raise failure("bad-argument", f"{clean(cursor)!r} is not a valid cursor", where="cursor", fix=fix)
    return int(cursor)
