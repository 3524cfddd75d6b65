"""``run_episode``: simulate one episode and report how it ended and why."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from mcp.server.mcpserver import Context
from mcp.types import CallToolResult, ImageContent, TextContent
from pydantic import Field, WithJsonSchema

from irsim.benchmarks.seeds import seeds_from
from irsim.common.text import clean, listed, plural
from irsim.diagnostics.errors import InputError
from irsim.results.concise import ConciseRun
from irsim.results.episode import EventRecord
from irsim.results.run import LOST_THINGS, MAX_CONCISE, MAX_DETAILED, RunResult, RunsResult
from irsim_mcp.answers import WorkerResult, failure, json_answer
from irsim_mcp.limits import MAX_RUN_SECONDS, MAX_RUN_SEEDS, MAX_SEED, MAX_STEPS
from irsim_mcp.resources import PAGE, uri
from irsim_mcp.services import ScenarioPath, ScenarioYaml, Services
from irsim_mcp.tool import StrictTool, reporter, strict
from irsim_mcp.tools.render_snapshot import table_lines
from irsim_mcp.tools.validate_scenario import caused, changes_of, new_collisions

__all__ = ["PLACE", "tool"]

PLACE = 4

_DESCRIPTION = """
    Simulate an episode until every robot has arrived or stopped, or time is up. Outcome is success (every robot
    reached its goal, no collision before), collision, or timeout; none is an error. The reason says what hit or passed
    through what, where, when, and distances to goals. Returns robots (unsuccessful first), first events, a run_id,
    kept 24 hours. With seeds, one call says all: findings, table of objects, `episodes`, the first that failed (or
    one) in full, with a picture. Next: after a failure make the call in `next`, change the scenario and run again.
"""
_SHARE = 0.7
"""Share of the time of a call in which episodes begin; the rest is for the picture."""
_MAX_LINES = 5
"""Number of failed episodes that the text says a line about."""
_TOLD = ("arrival", "waypoint", "zone_entry", "zone_exit", "line_crossing")
"""Kinds of events that other lines about a success tell."""
_MAX_MET = 3
"""Number of closest approaches that the text tells."""
_UNDRIVEN = "has no behavior"
"""Part of the reason of a run with a robot that nothing drives."""
_ARTIFACTS = ("events.json", "trace.csv")
"""Artifacts that the result names; the template of the resource names all."""
_STRIP = "strip=6"
"""Argument of ``render_snapshot`` that shows a run from its start to a step, 0 being its end."""


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def run_episode(
        ctx: Context[Any, Any],
        scenario_path: ScenarioPath = None,
        scenario_yaml: ScenarioYaml = None,
        seed: Annotated[
            int | None, Field(ge=0, le=MAX_SEED, description="Default: the scenario's, else drawn.")
        ] = None,
        seeds: Annotated[
            int | str | list[int] | None,
            WithJsonSchema({"type": ["integer", "string", "array"]}),
            Field(description=f"Several, at most {MAX_RUN_SEEDS}: 3, '0-19', [1, 4]."),
        ] = None,
        base: Annotated[str | None, Field(description="Scenario before an edit; with seeds.")] = None,
        policy: Annotated[str | None, Field(max_length=500, description="Of all robots, as in benchmark.")] = None,
        perturb: Annotated[str | None, Field(max_length=500, description="As in benchmark.")] = None,
        max_steps: Annotated[
            int | None,
            Field(ge=1, le=MAX_STEPS, description="Default: the scenario's time limit."),
        ] = None,
        until: Annotated[
            Literal["done", "time_limit"], Field(description="time_limit: a robot with loop patrols on.")
        ] = "done",
        max_wall_s: Annotated[
            int, Field(ge=1, le=MAX_RUN_SECONDS, description="Seconds of computing.")
        ] = MAX_RUN_SECONDS,
        response_format: Annotated[
            Literal["concise", "detailed", "json"],
            Field(
                description=f"detailed: paths, poses, waypoints; {MAX_DETAILED} robots and events instead of "
                f"{MAX_CONCISE}. json: as irsim run --json."
            ),
        ] = "concise",
    ) -> Annotated[CallToolResult, ConciseRun]:
        if seeds is not None and seed is not None:
            raise failure("bad-argument", "seed and seeds are given", where="seeds", fix="give one of them")
        if base is not None and seeds is None:
            seeds = 1 if seed is None else [seed]
        several = {} if seeds is None else {"seeds": _few(seeds), "wall_s": _SHARE * max_wall_s, **services.base(base)}
        rules = await services.suite_rules(scenario_path)
        data = await services.scenario_job(
            "run_seeds" if several else "run",
            scenario_path,
            scenario_yaml,
            seconds=max_wall_s,
            progress=reporter(ctx, "episodes" if several else "steps"),
            **(several or {"seed": seed}),
            steps=max_steps,
            policy=await services.suite_policy(scenario_path, policy),
            perturb=rules.get("perturb") if perturb is None else perturb,
            until=rules.get("until", until) if until == "done" else until,
        )
        given = services.given(scenario_path, scenario_yaml)
        services.note("ran", given)
        if several:
            return _of_seeds(data, services, given, response_format)
        result = RunResult.model_validate(data)
        episode = result.concise(
            detailed=response_format == "detailed",
            artifacts=None if result.run_id is None else {name: uri(result.run_id, name) for name in _ARTIFACTS},
            advice=_advice(result, given),
        )
        text = TextContent(type="text", text=episode.text())
        if response_format == "json":
            text = _json_answer(data, services.limits.text)
        return CallToolResult(content=[text], structured_content=episode.model_dump(exclude_none=True))

    return strict(
        run_episode, title="Run a scenario", description=_DESCRIPTION, read_only=False, idempotent=True, page=PAGE,
        former_names={"behavior": "policy"},
    )  # fmt: skip


def _few(seeds: int | str | list[int]) -> list[int]:
    """The seeds, one by one.

    Raises:
        ToolError: They are not valid, or too many.
    """
    try:
        chosen = seeds_from(seeds)
    except InputError as error:
        raise failure("bad-argument", error.message, where="seeds", fix=error.fix) from None
    if len(chosen) > MAX_RUN_SEEDS or max(chosen) > MAX_SEED:
        what = f"{len(chosen):,} seeds are given, at most {MAX_RUN_SEEDS} are run at once, each at most {MAX_SEED}"
        fix = "benchmark runs up to 100 seeds, as a job that may take longer"
        raise failure("over-limit", what, where="seeds", fix=fix)
    return chosen


def _of_seeds(data: WorkerResult, services: Services, given: str, form: str) -> CallToolResult:
    """The answer about several episodes: a line each, and the first that failed in full, with its picture.

    Of a scenario that was not drawn as it is it has the table of all objects, too, and a picture if none failed.
    """
    whole, new = RunsResult.model_validate(data["result"]), not services.was_done("looked", given)
    shown, detailed = whole.shown, form == "detailed"
    table = table_lines(data) if new and data["table"] is not None else []
    png = data["png"] if new or whole.failed else ""
    if table:
        services.note("looked", given)
    shown.warnings = whole.warnings
    artifacts = None if shown.run_id is None else {name: uri(shown.run_id, name) for name in _ARTIFACTS}
    advice, hits = _advice_on_seeds(whole, given, bool(png)), new_collisions(data["changes"])
    advice = caused(hits) if hits else advice
    changes = changes_of(data["changes"], detailed) or []
    episode = shown.concise(detailed=detailed, artifacts=artifacts, advice=advice)
    episode.summary = clean(f"{whole.summary}. Seed {shown.seed}: {episode.summary}", 600)
    episode.episodes = [_brief(one) for one in whole.episodes]
    several = [*_lines(episode.episodes), *_nearest(whole)] if len(episode.episodes) > 1 else []
    lines = [f"{whole.summary}.", *several, _found(whole)]
    lines += [f"{'Changes: ' if not k else '- '}{line}" for k, line in enumerate(changes)]
    lines += table
    picture = f" (the picture shows step {shown.decisive_step or shown.steps})" if png else ""
    if whole.failed or whole.same or picture:
        full = _whole(shown, episode)
        lines += [f"{'The first that failed, ' * bool(whole.failed and not whole.same)}seed {shown.seed}{picture}:"]
        lines += [*full.lines(), *_others(shown), *_meetings(data["closest"], shown), *_crossed(data["zones"])]
        lines += full.closing_lines()[0 if artifacts is None else 1 :]
    else:
        lines += [*(f"Warning: {warning}" for warning in episode.warnings), f"Next: {advice}"]
    content: list[TextContent | ImageContent] = [TextContent(type="text", text="\n".join(lines))]
    if form == "json":
        result = WorkerResult(data["result"])
        result.text = json.dumps(data["result"], separators=(",", ":"))
        content = [json_answer(result, services.limits.text, "give fewer seeds, or use response_format=detailed")]
    if png:
        content.append(ImageContent(type="image", data=png, mime_type="image/png"))
    return CallToolResult(content=[*content], structured_content=episode.model_dump(exclude_none=True))


def _others(shown: RunResult) -> list[str]:
    """A line about when obstacles arrived."""
    robots = {robot.name for robot in shown.robots}
    events = [event for event in shown.events if event.kind == "arrival" and event.object not in robots]
    when = [f"{clean(event.object)!r} at {event.time:g} s" for event in events]
    return [f"Obstacles at their last goals: {listed(when, MAX_CONCISE)}"] if when else []


def _crossed(zones: list[dict[str, Any]]) -> list[str]:
    """A line for each zone: who was there from when to when, or crossed it when."""
    rows: dict[str, list[str]] = {}
    for row in zones:
        until = "" if row["duration"] is None else f" to {row['time'] + row['duration']:g}"
        rows.setdefault(row["zone"], []).append(f"{clean(row['object'])!r} {row['time']:g}{until} s")
    return [f"Zone {clean(zone)!r}: {listed(some, MAX_CONCISE)}" for zone, some in rows.items()][:MAX_CONCISE]


def _meetings(closest: list[dict[str, Any]], shown: RunResult) -> list[str]:
    """A line about how near the objects that move came to one another, without what the lines of the robots say."""
    said = {(robot.name, robot.nearest) for robot in shown.robots}
    met: dict[frozenset[str], str] = {}
    for row in closest:
        name, other = row["robot"], row["to"]
        if row["kind"] != "static" and not said & {(name, other), (other, name)}:
            place = f"{row['edge_distance']:g} m at {row['time']:g} s"
            met.setdefault(frozenset((name, other)), f"{clean(name)!r} and {clean(other)!r} {place}")
    return [f"Closest to one another: {'; '.join([*met.values()][:_MAX_MET])}"] if met else []


def _brief(one: RunResult) -> dict[str, Any]:
    """An episode in a few values."""
    brief = {"seed": one.seed, "outcome": one.outcome, "sim_time": round(one.sim_time, 3), "run_id": one.run_id}
    why = None if one.reason is None else clean(one.reason, 160)
    return {key: value for key, value in {**brief, "reason": why}.items() if value is not None}


def _lines(episodes: list[dict[str, Any]]) -> list[str]:
    """A line for each episode that failed, up to a number, and one for all others."""
    failed = [one for one in episodes if one["outcome"] != "success"]
    why: dict[str, list[str]] = {}
    for one in failed[:_MAX_LINES]:
        why.setdefault(one.get("reason", "no reason"), []).append(f"{one['seed']}{_ending(one)}")
    lines = [f"- seed {', '.join(seeds)}: {reason}" for reason, seeds in why.items()]
    if more := [str(one["seed"]) for one in failed[_MAX_LINES:]]:
        lines.append(f"- also failed: {', '.join(more)}")
    good = [f"{one['seed']}{_ending(one)}" for one in episodes if one["outcome"] == "success"]
    times = [one["sim_time"] for one in episodes if one["outcome"] == "success"]
    span = f", after {min(times):g} to {max(times):g} s" if len(set(times)) > 1 else ""
    return [*lines, f"- success: seed {listed(good, MAX_CONCISE)}{span}"] if good else lines


def _nearest(whole: RunsResult) -> list[str]:
    """A line about how near robots came to anything in several episodes, and in which one nearest."""
    near = [(one.min_clearance, run.seed, one) for run in whole.episodes for one in run.robots]
    known = [(gap, seed, one) for gap, seed, one in near if gap is not None]
    if not known:
        return []
    gap, seed, one = min(known, key=lambda item: item[0])
    return [f"- nearest of all: {clean(one.name)!r} {gap:.3g} m from {clean(one.nearest or '')!r} with seed {seed}"]


def _ending(brief: dict[str, Any]) -> str:
    return " at {:g} s".format(brief["sim_time"]) + (f" ({brief['run_id']})" if "run_id" in brief else "")


def _whole(shown: RunResult, episode: ConciseRun) -> ConciseRun:
    """An episode in full, but no reason that its summary has, and only the events of robots if there are any.

    Of a success it has no event that other lines tell: arrivals, waypoints, and who was in which zone.
    """
    robots = {clean(robot.name) for robot in shown.robots}
    about = [event for event in episode.events if robots & {event.object, event.partner}] or episode.events
    if shown.outcome == "success":
        about = [event for event in about if event.kind.partition(" ")[0] not in _TOLD]
    reason = None if episode.reason and episode.reason in shown.summary else episode.reason
    changes = {"summary": clean(shown.summary, 400), "reason": reason, "events": about}
    return episode.model_copy(update=changes)


def _found(whole: RunsResult) -> str:
    """A line with the number of warnings, which have lines of their own, and the codes of the hints."""
    codes = dict.fromkeys(item.code for item in whole.warnings if item.severity == "hint")
    warned = sum(item.severity == "warning" for item in whole.warnings)
    warnings = plural(warned, "warning") if warned else "no warnings"
    return f"Check: {warnings}" + (f", {plural(len(codes), 'hint')} ({', '.join(codes)})" if codes else "")


def _advice_on_seeds(whole: RunsResult, given: str, seen: bool) -> str:
    """The next call to make after several episodes."""
    name, shown = given.removeprefix("scenario_path="), whole.shown
    more = f"benchmark scenarios=[{name!r}] seeds=20"
    if not shown.robots:
        return _advice(shown, given)
    doubtful = shown.jammed or any(robot.contacts_between_steps for robot in shown.robots)
    if not seen if whole.failed else doubtful:
        return _advice(shown, given)
    if whole.not_run:
        return f"{plural(len(whole.not_run), 'seed')} had no time: {more}."
    if not whole.failed:
        good = "If the picture is right, report it" if seen else "Report it"
        return f"{good}: {'every run is this one' if whole.same else f'nothing failed; for more: {more}'}."
    view = "speeds" if shown.outcome == "timeout" else "collisions"
    return f"If the picture does not say why: inspect_run run_id={shown.run_id} view={view}. Change it, and run again."


def _json_answer(data: WorkerResult, most: int) -> TextContent:
    """The complete JSON; if that is too long, the error says how the run ended and where to read the rest."""
    run, prefix = data["run_id"], f"the run is done, outcome {data['outcome']}, but "
    if run is None:
        return json_answer(data, most, "use response_format=detailed", prefix=prefix)
    views = f"inspect_run run_id={run} view=speeds, closest or collisions lists every robot, in pages"
    alternative = f"{views}; {uri(run, 'result.json')} has all; or use response_format=detailed"
    return json_answer(data, most, alternative, prefix=prefix)


def _advice(result: RunResult, given: str) -> str:
    """The next call to make; ``given`` is the argument that gives the scenario again."""
    seed, outcome = f" seed={result.seed}" if result.random else "", result.outcome
    run = f" {given}{seed}" if result.run_id is None else f" run_id={result.run_id}"
    if result.lost_code is not None:
        return f"The {LOST_THINGS[result.lost_code]} was lost: start it again, then run_episode {given}{seed}."
    if not result.robots:
        return "Nothing to run for: there are no robots, so no run succeeds or fails. Add a robot if one is to drive."
    jammed = set(result.jammed)
    if outcome == "success" and not jammed:
        if any(robot.contacts_between_steps for robot in result.robots):
            again = f"lower step_time, or set world.contacts: swept, and run_episode {given} again"
            look = "" if result.run_id is None else f" after inspect_run{run} view=collisions"
            return f"Do not trust this success: a robot touched something between two steps; {again}{look}."
        more = f"; try other seeds: run_episode {given} seeds=20" if result.random else ""
        if any(robot.laps is not None for robot in result.robots) and result.until == "done":
            more = f"; to see it patrol on, run_episode {given}{seed} until=time_limit{more}"
        return f"See it with render_snapshot{run} {_STRIP}{more}."
    if outcome == "timeout" and _UNDRIVEN in str(result.reason):
        return (
            f"Nothing to change if a program drives it or it stays; to try the layout: run_episode {given} policy=dash."
        )
    late = {robot.name for robot in result.robots if robot.outcome != "success"}
    if late and late <= set(result.parked) and not jammed:
        return f"Nothing to change if it is meant to stay; see it with render_snapshot{run} {_STRIP}."
    stopped = min((event.step for event in result.events if _stops(event, jammed)), default=None)
    step = stopped if outcome == "success" else result.decisive_step
    look = f"render_snapshot{run} {_STRIP}" + (f" step={step}" if step else "")
    view = "collisions" if outcome != "timeout" or stopped is not None else "speeds"
    whose = " robot=all" if step == stopped and stopped is not None else ""  # by default the table is about robots
    more = "" if result.run_id is None else f" and inspect_run{run} view={view}{whose}"
    if outcome == "success":
        return f"A collision stopped moving obstacles: intended? Look with {look}{more}."
    when = f" (step {step} decided it)" if step else ""
    return f"Look with {look}{when}{more}, change the scenario, and run again."


def _stops(event: EventRecord, jammed: set[str]) -> bool:
    """Whether an event is a collision that stopped one of these obstacles."""
    return event.kind == "collision" and bool(jammed & {event.object, event.partner})
