"""``benchmark``: compare policies over scenarios and seeds."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal

import anyio
from mcp.server.mcpserver import Context
from mcp.types import CallToolResult, TextContent
from pydantic import BaseModel, ConfigDict, Field

from irsim.common.text import clean
from irsim.results.benchmark import CROWDED, seeds_of
from irsim.runs.store import RESULT
from irsim_mcp.answers import failure
from irsim_mcp.jobs import PARTIAL, readable
from irsim_mcp.limits import (
    MAX_BEHAVIORS,
    MAX_EPISODES,
    MAX_SCENARIOS,
    MAX_SEED,
    MAX_SEEDS,
    MAX_STEPS,
    MAX_WAIT_SECONDS,
)
from irsim_mcp.services import RecentTexts, Services, as_failure
from irsim_mcp.suites import call_to_repeat, policy_names, suite_of
from irsim_mcp.tool import StrictTool, reporter, strict

__all__ = ["PLACE", "Benchmark", "answer", "tool"]

PLACE = 6

_DESCRIPTION = """
    Compare policies: every scenario under every policy with the same seeds. Rows have shares of
    success, collision and timeout, the mean time as [value, low, high] (95 %), and seeds that failed; diff
    is the difference from the first, seed by seed; note: what deciding costs. Work over wait_s
    becomes a job. Next: get_job (detailed: more metrics), inspect_run with the job_id, or run_episode with a
    seed that failed.
"""
_SHARES = ("success", "collision", "timeout")
"""Outcomes whose shares a row has."""
_METRICS = ("time_to_goal",)
"""Metrics of a row."""
_DETAILED = (*_METRICS, "path_length", "velocity_avg", "spl", "min_clearance", "contacts_between_steps")
"""Metrics of a detailed row."""
_SOMETIMES = ("distance_to_human_min", "time_in_zone", "zone_crossings", "seen_ratio")
"""Metrics that a row has if they are defined anywhere."""
_DIFFERENCES = (*_SHARES, "time_to_goal", "path_length")
"""Values of which a row has differences to the first behavior."""
_MAX_ROWS = 50
_MAX_NOTES = 10
_DECIMALS = 3
_NO_ROOM = "No seed has room: use fewer or smaller objects, or smaller spreads."
"""Advice if no episode took place."""
_MAX_FAILED_SEEDS = 10
"""Number of seeds that a row lists of each kind of failure."""
_MAX_FAILURES = 3
"""Number of robots whose failures a row lists."""


class Benchmark(BaseModel):
    """The table of a benchmark, or the state of its job."""

    model_config = ConfigDict(extra="forbid")

    status: Literal["running", "finished", "cancelled", "interrupted"]
    summary: str
    job_id: str
    done: int
    total: int
    rows: list[dict[str, Any]] = []
    notes: list[str] = []
    artifact: str | None = None
    reproduce: str | None = None
    next: str


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def benchmark(
        ctx: Context[Any, Any],
        scenarios: Annotated[
            list[str],
            Field(description=f"1-{MAX_SCENARIOS} files of the workspace, YAML texts, or a suite (lookup suites)."),
        ],
        policies: Annotated[
            list[str] | None,
            Field(
                description=f"1-{MAX_BEHAVIORS} for all robots: rvo, '{{name: orca, timeHorizon: 5}}', sarl (lookup "
                "policies), net.npz. Default: as-written."
            ),
        ] = None,
        seeds: Annotated[int, Field(description=f"How many, 1-{MAX_SEEDS}.")] = 10,
        first_seed: Annotated[int | None, Field(ge=0, description="Default: 0 or a suite's. Tune on others.")] = None,
        perturb: Annotated[
            str | None,
            Field(
                max_length=500,
                description="Starts differ by seed: position=0.1,heading=10deg,speed=10% (each ±),delay=2 (0-2 s); "
                "objects=NAME,TAG: only these.",
            ),
        ] = None,
        max_steps: Annotated[int | None, Field(ge=1, le=MAX_STEPS, description="Default: the time limit.")] = None,
        wait_s: Annotated[int, Field(ge=0, le=MAX_WAIT_SECONDS)] = 45,
    ) -> Annotated[CallToolResult, Benchmark]:
        if any(suite_of(given) for given in scenarios):
            arguments, total = await _suite(services, scenarios, policies, seeds, first_seed, perturb, max_steps)
        else:
            chosen, first = policies or ["as-written"], first_seed or 0
            _check(scenarios, chosen, seeds)
            _check_last(first, seeds)
            arguments = {
                "files": _named(services, scenarios),
                "policies": chosen,
                "seeds": list(range(first, first + seeds)),
                "perturb": perturb,
                "steps": max_steps,
            }
            total = len(scenarios) * len(chosen) * seeds
        job = services.jobs.start("benchmark", arguments, total)
        try:
            state = await services.jobs.wait(job, wait_s, reporter(ctx, "episodes"))
        except anyio.get_cancelled_exc_class():
            services.jobs.cancel(job)
            raise
        if "error" in state:
            services.jobs.forget(job)  # the caller gets the error and no id
        return answer(state, services.is_there)

    return strict(
        benchmark, title="Compare policies", description=_DESCRIPTION, read_only=False, idempotent=True,
        former_names={"behaviors": "policies"},
    )  # fmt: skip


def _named(services: Services, scenarios: Sequence[str]) -> dict[str, str]:
    """Name of each scenario in the result -> its source; a text has its id, under which other tools take it.

    Raises:
        ToolError: A path is refused, a text is too large, or a scenario is given twice.
    """
    named: dict[str, str] = {}
    for item in scenarios:
        source = services.scenario_source(item)
        name = services.texts.remember(item) if "\n" in item else item if RecentTexts.is_id(item) else source
        if name in named:
            what = f"the scenario {clean(name)!r} is given twice"
            raise failure("bad-argument", what, where="scenarios", fix="give each once")
        named[name] = source
    return named


async def _suite(
    services: Services,
    scenarios: Sequence[str],
    policies: Sequence[str] | None,
    seeds: int,
    first: int | None,
    perturb: str | None,
    steps: int | None,
) -> tuple[dict[str, Any], int]:
    """The arguments of the job of a suite, and its number of episodes.

    Raises:
        ToolError: The suite has its own horizon; or see :func:`irsim_mcp.suites.plan_of`.
    """
    if steps:
        fix = "leave max_steps out"
        raise failure("bad-argument", "a suite has its own horizon", where="max_steps", fix=fix)
    if not 1 <= seeds <= MAX_SEEDS:
        raise failure("bad-argument", f"seeds must be 1 to {MAX_SEEDS}, got {seeds}", where="seeds", fix="give fewer")
    _check_last(first or 0, seeds)
    plan = await services.suite_plan(scenarios=list(scenarios), policies=policies, seeds=seeds, first=first)
    counts = len(plan["scenarios"]), len(plan["policies"]), seeds
    _check_size(*counts)
    return {"plan": plan | ({"perturb": [perturb]} if perturb else {})}, math.prod(counts)


def _check(scenarios: Sequence[str], policies: Sequence[str], seeds: int) -> None:
    if not scenarios or seeds < 1:
        what = "there must be at least one scenario" if not scenarios else f"seeds must be at least 1, got {seeds}"
        raise failure("bad-argument", what, where="scenarios" if not scenarios else "seeds", fix="give at least one")
    _check_size(len(scenarios), len(policies), seeds)


def _check_last(first: int, seeds: int) -> None:
    if first + seeds - 1 > MAX_SEED:
        what = f"{seeds} seeds from {first} on exceed {MAX_SEED}, the largest that run_episode takes"
        raise failure("bad-argument", what, where="first_seed", fix=f"give at most {MAX_SEED - seeds + 1}")


def _check_size(scenarios: int, policies: int, seeds: int) -> None:
    total = scenarios * policies * seeds
    in_all = f"{total:,}" if total <= MAX_SEED else "far too many"  # a number of 4,300 digits cannot be written
    within = scenarios <= MAX_SCENARIOS and policies <= MAX_BEHAVIORS and seeds <= MAX_SEEDS
    if not within or total > MAX_EPISODES:
        raise failure(
            "over-limit",
            f"{scenarios} scenarios x {policies} policies x {seeds} seeds = {in_all} episodes; at most "
            f"{MAX_SCENARIOS} x {MAX_BEHAVIORS} x {MAX_SEEDS}, and {MAX_EPISODES:,} in all",
            fix="ask for fewer seeds, or split them over several calls",
        )


def answer(state: dict[str, Any], is_there: Callable[[str], bool], detailed: bool = False) -> CallToolResult:
    """The result of the tools about the state of a job.

    Args:
        state: The state.
        is_there: Whether a scenario can still be given, so that the next call may name it.
        detailed: With more metrics, and how the robots failed.

    Raises:
        ToolError: The job failed, or others have changed its files.
    """
    with readable(state["id"]):
        return _answer(state, is_there, detailed)


def _answer(state: dict[str, Any], is_there: Callable[[str], bool], detailed: bool) -> CallToolResult:
    if "error" in state:
        raise as_failure(state["error"], None)
    report = Benchmark(
        status=state["status"],
        summary=f"{state['status']}: {state['done']} of {state['total']} episodes",
        job_id=state["id"],
        done=state["done"],
        total=state["total"],
        next="Look at the episodes that failed with run_episode and their seed.",
    )
    if state["status"] == "running":
        report.next = f"get_job job_id={state['id']}"
    elif "result" not in state:
        report.next = "No episode was completed; call benchmark again."
    else:
        _fill(report, state, RESULT if state["status"] == "finished" else PARTIAL, is_there, detailed)
        report.done, report.total = state["done"], state["total"]
        if state["status"] != "finished":
            why, more = "", "call benchmark again for all"
            if "why" in state:
                why, more = f"{clean(state['why'], 300)}. ", clean(state["fix"], 300)
            report.next = f"{why}This is the result of the {report.done} completed episodes; {more}."
    text = TextContent(type="text", text=_text(report))
    return CallToolResult(content=[text], structured_content=report.model_dump(exclude_none=True))


def _fill(report: Benchmark, state: dict[str, Any], file: str, is_there: Callable[[str], bool], detailed: bool) -> None:
    result, timing = state["result"], state.get("timing")
    extra = [key for key in _SOMETIMES if any(row["metrics"][key]["n"] for row in result["rows"])]
    labels = policy_names(result)
    report.rows = [
        _row(row, [*(_DETAILED if detailed else _METRICS), *extra], labels, detailed)
        for row in result["rows"][:_MAX_ROWS]
    ]
    report.summary = _summary(result, labels)
    notes = [f"{label} is {text}" for text, label in labels.items() if label != text] + list(result["notes"])
    notes += _decision_times(timing, labels)
    if len(result["rows"]) > _MAX_ROWS:
        notes.append(f"{len(result['rows']) - _MAX_ROWS} more rows are in the artifact")
    for name, warnings in result["warnings"].items():
        notes += [f"{name}: {w['code']} at {w['path']}: {w['message']}" for w in warnings if w["severity"] == "warning"]
    report.notes = [clean(note, 300) for note in notes[:_MAX_NOTES]]
    report.artifact = f".irsim/jobs/{report.job_id}/{file}"
    command = clean(result["reproduce"], 1000)
    report.reproduce = None if any(RecentTexts.is_id(name) for name in result["scenarios"]) else command
    lost = [e for e in result["episodes"] if e["outcome"] not in ("success", CROWDED)]
    if not lost:
        done = any(e["outcome"] == "success" for e in result["episodes"])
        report.next = "Every episode succeeded; compare times and paths." if done else _NO_ROOM
        return
    report.next = f"To see why: {call_to_repeat(result, lost[0], is_there)} ({lost[0]['outcome']})."


def _summary(result: dict[str, Any], labels: dict[str, str]) -> str:
    """Number of successes of each behavior over all scenarios, in words."""
    shares = []
    for behavior in result["behaviors"]:
        mine = [episode["outcome"] for episode in result["episodes"] if episode["behavior"] == behavior]
        ends = [outcome for outcome in mine if outcome != CROWDED]
        shares.append(f"{clean(labels[behavior])} {ends.count('success')}/{len(ends)}")
    periods = ", ".join(f"{period:g}" for period in sorted(set(result["step_time"].values())))
    counts = f"{len(result['episodes'])} episodes, step_time {periods} s; success: {', '.join(shares)}"
    return "; ".join([counts, *(clean(text, 200) for text in result["incidents"])])


def _decision_times(timing: dict[str, Any] | None, labels: dict[str, str]) -> list[str]:
    """A note on the wall-clock time that deciding takes; none if nothing was timed."""
    policies = (timing or {}).get("policies", {})
    times = {name: measured["per_robot"] for name, measured in policies.items() if "per_robot" in measured}
    each = [f"{clean(labels[name])} {one['mean_ms']:g} ({one['p95_ms']:g})" for name, one in times.items()]
    return (
        [f"deciding for one robot takes, in ms on this machine, mean (95th percentile): {', '.join(each)}"]
        if each
        else []
    )


def _row(row: dict[str, Any], metrics: Sequence[str], labels: dict[str, str], detailed: bool) -> dict[str, Any]:
    """One scenario under one behavior; numbers as [value, low, high], or only the value if there is no interval.

    ``n`` has the number of episodes in which a metric is defined, if not in all; ``diff.n`` the number of differences.
    """
    shown: dict[str, Any] = {
        "scenario": clean(row["scenario"], 100),
        "behavior": clean(labels[row["behavior"]]),
        "episodes": row["episodes"],
    }
    shown |= {key: _numbers(row[key], "rate") for key in _SHARES}
    shown |= _defined(row["metrics"], metrics, row["episodes"])
    zones = {
        clean(name): {key: _numbers(metric) for key, metric in zone.items()} for name, zone in row["zones"].items()
    }
    shown |= {"zones": zones} if zones else {}
    roles = {
        clean(name): {key: _numbers(metric) for key, metric in role.items()} for name, role in row["roles"].items()
    }
    shown |= {"roles": roles} if roles else {}
    diff = _defined(row["paired"], _DIFFERENCES, row["episodes"])
    shown |= {"diff": diff} if diff else {}
    if failed := seeds_of(row["failed"], _MAX_FAILED_SEEDS):
        robots = [
            clean(what) + (f" {n} of {row['episodes']}" if row["episodes"] > 1 else "")
            for what, n in list(row["failures"].items())[:_MAX_FAILURES]
        ]
        shown["failed"] = f"{failed} ({', '.join(robots)})" if detailed else failed
    if row["incidents"]:
        shown["incidents"] = row["incidents"]
    if row["incident_seeds"]:
        shown["incident_seeds"] = seeds_of(row["incident_seeds"], _MAX_FAILED_SEEDS)
    return shown


def _defined(values: dict[str, Any], keys: Sequence[str], episodes: int) -> dict[str, Any]:
    """The metrics that are defined, and the number of episodes in which they are, if not in all."""
    known = [key for key in keys if key in values and values[key]["n"]]
    fewer = {key: values[key]["n"] for key in known if values[key]["n"] < episodes}
    return {key: _numbers(values[key]) for key in known} | ({"n": fewer} if fewer else {})


def _numbers(estimate: dict[str, Any], value: str = "mean") -> list[float]:
    """Value and interval; only the value if there is no interval."""
    values = [estimate[value], estimate["low"], estimate["high"]]
    return [round(value, _DECIMALS) for value in values if value is not None]


def _text(report: Benchmark) -> str:
    """The result in words, with everything that the structured content has."""
    lines = [f"{report.status}: {report.summary}" if report.rows else report.summary]
    lines[0] += f" (job {report.job_id}, {report.done} of {report.total})"
    for row in report.rows:
        values = _lines(row, partly=row["success"][0] < 1) + [
            f"difference of {line}" for line in _lines(row.get("diff", {}))
        ]
        values += [f"failed: {row['failed']}"] if "failed" in row else []
        if "incident_seeds" in row:
            values.append(f"episodes with {row['incident_seeds']}")
        elif incidents := row.get("incidents"):
            values.append(f"episodes with {', '.join(f'{name}: {count}' for name, count in incidents.items())}")
        lines.append(f"- {row['scenario']}, {row['behavior']}, {row['episodes']} episodes: {'; '.join(values)}")
    lines += [f"Note: {note}" for note in report.notes]
    if report.artifact:
        lines.append(
            f"Episodes: inspect_run run_id={report.job_id}; more metrics: get_job job_id={report.job_id} detailed=true"
            f"; all: {report.artifact}"
        )
    if report.reproduce:
        lines.append(f"Again: {report.reproduce}")
    return "\n".join([*lines, f"Next: {report.next}"])


def _lines(row: dict[str, Any], partly: bool = False) -> list[str]:
    """Each number with its interval, and with the number of episodes in which it is defined, if not in all.

    Args:
        row: The numbers by key.
        partly: Some episodes failed, and the times are of the robots that arrived nevertheless.
    """
    fewer = row.get("n", {})
    some = " of robots that arrived" if partly else ""
    return [
        f"{key}{some if key == 'time_to_goal' else ''} {_shown(value)}" + (f" n={fewer[key]}" if key in fewer else "")
        for key, value in row.items()
        if isinstance(value, list)
    ]


def _shown(numbers: Sequence[float]) -> str:
    value, *interval = (f"{number:g}" for number in numbers)
    return f"{value} [{', '.join(interval)}]" if interval else value
