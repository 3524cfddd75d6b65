"""Benchmarks in the tools: bundled suites by their names, and the episodes of a finished one as a table in pages.

``SUITE/SCENARIO`` is a scenario wherever one is expected, and ``SUITE`` a benchmark. The server only asks whether a
suite is meant (:func:`suite_of`); workers do the rest, which needs the engine.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import irsim
from irsim.common.text import clean
from irsim.diagnostics.errors import InputError
from irsim.results.benchmark import CROWDED
from irsim_mcp.answers import failure

if TYPE_CHECKING:
    from irsim.benchmarks.plan import Plan

__all__ = [
    "call_to_repeat",
    "check_finished",
    "episodes_table",
    "plan_of",
    "policy_names",
    "scenario_of_suite",
    "suite_of",
]


@lru_cache(maxsize=1)
def _names() -> frozenset[str]:
    folders = [Path(folder, "benchmarks", "suites") for folder in irsim.__path__]
    return frozenset(path.stem for folder in folders for path in folder.glob("*.yaml"))


def suite_of(given: str) -> str | None:
    """The bundled suite that a name begins with; None without a suite, or if a file is meant."""
    if "\n" in given or given.endswith((".yaml", ".yml")):
        return None
    name = given.partition("/")[0]
    return name if name in _names() else None


def scenario_of_suite(given: str, argument: str) -> str:
    """The text of one scenario of a bundled suite.

    Args:
        given: ``SUITE/SCENARIO``.
        argument: The tool's argument, for errors.

    Raises:
        InputError: The suite has no such scenario.
    """
    from irsim.benchmarks.suite import SuiteError
    from irsim.benchmarks.suite_plan import suite_scene

    try:
        scene = suite_scene(given)
    except SuiteError as error:
        raise _wrong(error.message, error.fix or "irsim suites lists them", argument) from None
    if scene is None:
        raise _wrong(f"{given!r} is not a scenario of a suite", "irsim suites lists them", argument)
    return scene.text


def plan_of(
    scenarios: Sequence[str], policies: Sequence[str] | None, seeds: int, root: Path, first: int | None = None
) -> Plan:
    """The plan of a benchmark of a suite, or of some of its scenarios.

    Args:
        scenarios: ``SUITE``, or ``SUITE/SCENARIO`` of one suite.
        policies: Names of its policies, other behaviors, or files; default: its policies.
        seeds: Number of seeds.
        root: The workspace, in which files must lie.
        first: First seed; default: the first one of the suite.

    Raises:
        InputError: A scenario is not of the suite.
        InputError, PolicyError: A policy is not valid.
    """
    from irsim.benchmarks.policies import opened_policies
    from irsim.benchmarks.suite_plan import suite_plan

    suites = [suite_of(given) for given in scenarios]
    suite = suites[0]
    if suite is None or set(suites) != {suite}:
        what = "scenarios of a suite are benchmarked without others"
        raise _wrong(what, "give one suite, or scenarios of one suite", "scenarios")
    known = [scenario.name for scenario in _whole(suite).scenarios]
    names = [given.partition("/")[2] for given in scenarios if "/" in given]
    for name in names:
        if not any(name in (one, one.rsplit("/", 1)[0], one.split("/", 1)[0]) for one in known):
            raise _unknown(suite, known, name, "scenarios")
    own = _known_policies(suite)
    opened_policies([text for text in policies or [] if text not in own], "policies", str(root))
    return suite_plan(
        suite,
        policies=policies or None,
        seeds=seeds if first is None else list(range(first, first + seeds)),
        scenarios=names or None,
    )


@lru_cache(maxsize=8)
def _whole(suite: str) -> Plan:
    from irsim.benchmarks.suite_plan import suite_plan

    return suite_plan(suite)


def _known_policies(suite: str) -> set[str]:
    """Names of the policies of a suite, whether it runs them by itself or not."""
    known_suite = _whole(suite).suite
    return set() if known_suite is None else {*known_suite.known_policies}


def _unknown(suite: str, known: Sequence[str], given: str, argument: str) -> InputError:
    from irsim.diagnostics.diagnostic import nearest

    near = nearest(given, known)
    fix = f"did you mean {suite}/{near}?" if near else f"choose from {', '.join(known)}"
    return _wrong(f"suite {suite} has no scenario {given!r}", fix, argument)


def _wrong(what: str, fix: str, argument: str) -> InputError:
    error = InputError(what, fix)
    error.where = argument
    return error


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


def episodes_table(
    state: Mapping[str, Any], limit: int, cursor: str | None, is_there: Callable[[str], bool]
) -> dict[str, Any]:
    """The episodes of a benchmark, those without success first, in the form of the tables of runs.

    Args:
        state: State of the job of a benchmark that has a result.
        limit: Greatest number of rows.
        cursor: ``next_cursor`` of the previous page.
        is_there: Whether a scenario can still be given.

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
        "again": call_to_repeat(result, episodes[start], is_there) if rows else "",
    }


def policy_names(result: Mapping[str, Any]) -> dict[str, str]:
    """Text of each policy → its short name, which a suite may give."""
    from irsim.benchmarks.labels import labels_of

    return labels_of(result["behaviors"]) | {text: name for name, text in result.get("policies", {}).items()}


def call_to_repeat(result: Mapping[str, Any], episode: Mapping[str, Any], is_there: Callable[[str], bool]) -> str:
    """The call that runs an episode again; a scenario that was given as text is named by its id.

    Args:
        result: The result of the benchmark.
        episode: The episode.
        is_there: Whether a scenario can still be given; if not, the answer says so.
    """
    name, behavior = episode["scenario"], episode["behavior"]
    if not result.get("suite") and not is_there(name):
        return f"run_episode with the text of {clean(name, 200)!r}, which is not there any more, seed={episode['seed']}"
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
